//! One oscillator, x'' = -x - 2 zeta x', under every explicit method as it is written on paper; z is
//! the step.

use glam::DMat2;
use muslin_core_f64::integrate::Method;

use super::bisect::bisect;

/// A method that has a largest stable step.
pub struct Explicit {
    /// The method.
    pub method: Method,
    /// What a step multiplies (x, v) with, by z and zeta.
    update: fn(f64, f64) -> DMat2,
}

/// All of them.
pub const EXPLICIT: [Explicit; 4] = [
    Explicit { method: Method::ExplicitEuler, update: |z, zeta| series(z, zeta, 1) },
    Explicit {
        method: Method::SymplecticEuler,
        // Damping is that of the old velocity.
        update: |z, zeta| {
            let kept = 1.0 - 2.0 * zeta * z;
            DMat2::from_cols_array(&[1.0 - z * z, -z, z * kept, kept])
        },
    },
    Explicit { method: Method::Midpoint, update: |z, zeta| series(z, zeta, 2) },
    Explicit { method: Method::Rk4, update: |z, zeta| series(z, zeta, 4) },
];

/// The exponential of the step's matrix as far as a power.
fn series(z: f64, zeta: f64, powers: u32) -> DMat2 {
    let step = DMat2::from_cols_array(&[0.0, -1.0, 1.0, -2.0 * zeta]) * z;
    let (mut sum, mut term) = (DMat2::IDENTITY, DMat2::IDENTITY);
    for k in 1..=powers {
        term = term * step * (1.0 / f64::from(k));
        sum += term;
    }
    sum
}

/// The larger modulus of the eigenvalues.
fn spectral_radius(m: DMat2) -> f64 {
    let half = 0.5 * (m.x_axis.x + m.y_axis.y);
    let square = half * half - m.determinant();
    if square < 0.0 { m.determinant().sqrt() } else { half.abs() + square.sqrt() }
}

impl Explicit {
    /// The least z at which a step amplifies.
    pub fn limit(&self, zeta: f64) -> f64 {
        // Rounding leaves the undamped symplectic radius within 1e-15 of 1.
        let grows = |z: f64| spectral_radius((self.update)(z, zeta)) > 1.0 + 1e-14;
        // Beyond the limit it may shrink again.
        let high = (1..4000).map(|k| 1e-3 * f64::from(k)).find(|&z| grows(z)).unwrap_or(f64::INFINITY);
        bisect([high - 1e-3, high], grows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_limits_are_met() {
        let ratios = [0.0, 0.01, 0.05, 0.1, 0.3, 0.5, 1.0, 2.0];
        let published = [
            [0.0, 0.02, 0.1, 0.2, 0.6, 1.0, 2.0, 0.536],
            [2.0, 1.980, 1.9025, 1.810, 1.488, 1.236, 0.828, 0.472],
            [0.0, 0.444, 0.800, 1.050, 1.647, 2.0, 2.0, 0.536],
            [2.828, 2.849, 2.910, 2.951, 2.835, 2.6225, 2.785, 0.746],
        ];
        for (explicit, limits) in EXPLICIT.into_iter().zip(published) {
            for (zeta, want) in ratios.into_iter().zip(limits) {
                let got = explicit.limit(zeta);
                assert!((got - want).abs() <= 6e-4, "{} at {zeta}: {got}, published {want}", explicit.method.name());
            }
        }
    }
}
