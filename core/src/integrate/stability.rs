//! The longest steps of explicit methods, from the stability of one oscillator
//! `x'' = -stiffness x - damping x'` [Hairer 1996, IV.2].

use super::Method;
use crate::real::Sum;

/// A mode of a linearised scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// The square of its frequency, 1/s^2.
    pub stiffness: Sum,
    /// 1/s.
    pub damping: Sum,
}

/// By how much a step may amplify and still be rounding.
const ROUNDING: Sum = 1e-14;

/// Beyond this many times the inverse of an eigenvalue none of the methods is stable.
const FARTHEST: u32 = 4;

/// Parts into which the way there is divided in search of the limit.
const PARTS: u32 = 4096;

impl Mode {
    /// The longest stable step, s: 0 where every step amplifies, none where no step does.
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

    /// With the damping of the old velocity; undamped `2 / omega`.
    fn longest_symplectic_step(&self) -> Sum {
        4.0 / (self.damping + libm::sqrt(self.damping * self.damping + 4.0 * self.stiffness))
    }

    /// Real and imaginary part of the eigenvalue that is farthest from 0, 1/s.
    fn eigenvalue(&self) -> [Sum; 2] {
        let half = 0.5 * self.damping;
        let square = half * half - self.stiffness;
        let root = libm::sqrt(square.abs());
        if square < 0.0 { [-half, root] } else { [-half - root, 0.0] }
    }
}

/// Modulus of the exponential's series up to the power `degree` at `z`.
fn amplification(degree: u32, [real, imaginary]: [Sum; 2]) -> Sum {
    let [mut a, mut b] = [1.0, 0.0];
    for power in (1..=degree).rev() {
        let scale = 1.0 / Sum::from(power);
        [a, b] = [1.0 + scale * (a * real - b * imaginary), scale * (a * imaginary + b * real)];
    }
    libm::hypot(a, b)
}

/// The longest step that is stable in each of some modes, s; none where every step is.
pub fn longest_step(modes: &[Mode], method: Method) -> Option<Sum> {
    modes.iter().filter_map(|mode| mode.longest_step(method)).min_by(Sum::total_cmp)
}
