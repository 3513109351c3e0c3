//! The fastest mode of a scene, by products with its implicit matrix; here until the core has it.

use glam::DVec3;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::forces::{TangentScale, matrix, write_tangents};
use muslin_core_f64::integrate::{Jacobian, Method};
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::scratch::ScratchColumns;

use super::lab::{linearised, scatter3};

/// The largest eigenvalue of `-M^-1 df/dx` where a scene's particles are, 1/s^2, and its vector, of
/// unit length, by power iteration.
pub fn fastest_mode(built: &BuiltScene) -> (f64, Vec<DVec3>) {
    let (x, masses, model) = (&built.particles.positions, &built.particles.masses, built.model.view());
    let mut columns = ScratchColumns::build(built, &linearised(Method::BackwardEuler));
    let s = &mut columns.view();
    let scale = TangentScale { position: 1.0, velocity: 0.0 };
    write_tangents(&model, x, scale, Jacobian::Exact, &s.targets, s.tangents, &mut s.matrix, &Serial);
    let mut p: Vec<_> = (0..x.len()).map(scatter3).collect();
    let mut q = p.clone();
    let (mut lambda, mut steady) = (0.0, 0);
    // The quotient's error is the square of the vector's.
    while steady < 100 {
        matrix::multiply(&s.matrix, masses, 0.0, &p, &mut q, &Serial);
        let above: f64 = p.iter().zip(&q).map(|(p, q)| p.dot(*q)).sum();
        let below: f64 = p.iter().zip(masses).map(|(p, m)| m * p.length_squared()).sum();
        let quotient = above / below;
        steady = if (quotient - lambda).abs() <= 1e-12 * quotient { steady + 1 } else { 0 };
        lambda = quotient;
        let length = q.iter().zip(masses).map(|(q, m)| q.length_squared() / (m * m)).sum::<f64>().sqrt();
        for ((p, &q), m) in p.iter_mut().zip(&q).zip(masses) {
            *p = q / (m * length);
        }
    }
    (lambda, p)
}
