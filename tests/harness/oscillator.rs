//! One oscillator, x'' = -w^2 x - 2 zeta w x' with w = 1 and z = w h, under every one-step method, from the
//! method's definition.

use glam::DMat2;
use muslin_core_f64::integrate::Method;

/// The matrix by which one step multiplies (x, v).
pub fn update(method: Method, z: f64, zeta: f64) -> DMat2 {
    let i = DMat2::IDENTITY;
    let l = DMat2::from_cols_array(&[0.0, -1.0, 1.0, -2.0 * zeta]) * z;
    let kept = 1.0 - 2.0 * zeta * z;
    match method {
        Method::ExplicitEuler => i + l,
        // The damping force uses the old velocity.
        Method::SymplecticEuler => DMat2::from_cols_array(&[1.0 - z * z, -z, z * kept, kept]),
        Method::Midpoint => i + l + l * l * 0.5,
        Method::Rk4 => i + l + l * l * (1.0 / 2.0) + l * l * l * (1.0 / 6.0) + l * l * l * l * (1.0 / 24.0),
        Method::BackwardEuler => (i - l).inverse(),
        Method::ImplicitMidpoint => (i - l * 0.5).inverse() * (i + l * 0.5),
        Method::Bdf2 => unreachable!("has two steps"),
    }
}

/// The larger modulus of the eigenvalues.
pub fn spectral_radius(m: DMat2) -> f64 {
    let half = 0.5 * (m.x_axis.x + m.y_axis.y);
    let square = half * half - m.determinant();
    if square < 0.0 { m.determinant().sqrt() } else { half.abs() + square.sqrt() }
}

/// The smallest z at which a step amplifies: the spectral radius first exceeds 1 there.
pub fn stable_limit(method: Method, zeta: f64) -> f64 {
    // Rounding leaves the undamped symplectic radius within 1e-15 of 1.
    let grows = |z: f64| spectral_radius(update(method, z, zeta)) > 1.0 + 1e-14;
    let mut high = (1..).map(|k| 1e-3 * f64::from(k)).find(|&z| grows(z)).expect("explicit methods have a limit");
    let mut low = high - 1e-3;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if grows(middle) { high = middle } else { low = middle }
    }
    high
}
