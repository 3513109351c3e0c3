//! Longest stable steps of the explicit methods, from the stability of one oscillator
//! `x'' = -stiffness x - damping x'` [Hairer 1996, IV.2].

use super::Method;
use crate::real::Sum;

/// A mode of a linearised scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Square of the angular frequency, 1/s^2.
    pub stiffness: Sum,
    /// Damping rate, 1/s.
    pub damping: Sum,
}

/// Amplification per step, beyond 1, that still counts as rounding.
const ROUNDING: Sum = 1e-14;

/// The search ends at this multiple of 1 / |eigenvalue|: no explicit method is stable beyond it.
const FARTHEST: u32 = 4;

/// Number of equal intervals, up to [`FARTHEST`], that are searched for the limit.
const PARTS: u32 = 4096;

impl Mode {
    /// The longest stable step, s: 0 if every step amplifies the mode, `None` if no step does.
    #[cfg_attr(small, optimize(size))]
    pub fn longest_step(&self, method: Method) -> Option<Sum> {
        let [real, imaginary] = self.eigenvalue();
        let size = libm::hypot(real, imaginary);
        if size == 0.0 {
            return None;
        }
        let degree = match method {
            Method::ExplicitEuler => 1,
            Method::Midpoint => 2,
            Method::Rk4 => 4,
            Method::SymplecticEuler => return Some(self.longest_symplectic_step()),
            Method::BackwardEuler | Method::ImplicitMidpoint | Method::Bdf2 => return None,
        };
        if real == 0.0 && degree < 4 {
            return Some(0.0);
        }
        let amplifies = |h: Sum| amplification(degree, [real * h / size, imaginary * h / size]) > 1.0 + ROUNDING;
        let part = Sum::from(FARTHEST) / Sum::from(PARTS);
        let mut high = (1..PARTS).map(|k| part * Sum::from(k)).find(|&h| amplifies(h))?;
        let mut low = high - part;
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if amplifies(middle) { high = middle } else { low = middle }
        }
        Some(low / size)
    }

    /// The limit of symplectic Euler with damping of the old velocity, s; undamped `2 / omega`.
    fn longest_symplectic_step(&self) -> Sum {
        4.0 / (self.damping + libm::sqrt(self.damping * self.damping + 4.0 * self.stiffness))
    }

    /// Real and imaginary part of the eigenvalue of largest modulus, 1/s.
    fn eigenvalue(&self) -> [Sum; 2] {
        let half = 0.5 * self.damping;
        let square = half * half - self.stiffness;
        let root = libm::sqrt(square.abs());
        if square < 0.0 { [-half, root] } else { [-half - root, 0.0] }
    }
}

/// Modulus at `z = real + i imaginary` of the Taylor polynomial of exp up to the power `degree`.
fn amplification(degree: u32, [real, imaginary]: [Sum; 2]) -> Sum {
    let [mut a, mut b] = [1.0, 0.0];
    for power in (1..=degree).rev() {
        let scale = 1.0 / Sum::from(power);
        [a, b] = [1.0 + scale * (a * real - b * imaginary), scale * (a * imaginary + b * real)];
    }
    libm::hypot(a, b)
}

/// The longest step that is stable for all `modes`, s; `None` if every step is.
pub fn longest_step(modes: &[Mode], method: Method) -> Option<Sum> {
    modes.iter().filter_map(|mode| mode.longest_step(method)).min_by(Sum::total_cmp)
}
