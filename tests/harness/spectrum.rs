//! The implicit matrix of a scene, asked through its products only, and its fastest mode.

use glam::DVec3;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::forces::matrix::multiply;
use muslin_core_f64::forces::{TangentScale, write_tangents};
use muslin_core_f64::integrate::{Jacobian, Method};
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::scratch::ScratchColumns;

use crate::net::linearised;
use crate::rng::Rng;

/// `-(position df/dx + velocity df/dv)` of all terms where a scene's particles are.
pub struct Tangent {
    scratch: ScratchColumns,
    masses: Vec<f64>,
}

impl Tangent {
    /// Of a scene.
    pub fn of(scene: &BuiltScene, position: f64, velocity: f64, jacobian: Jacobian) -> Self {
        let (x, model) = (&scene.particles.positions, scene.model.view());
        let mut scratch = ScratchColumns::build(scene, &linearised(Method::BackwardEuler));
        let s = &mut scratch.view();
        let scale = TangentScale { position, velocity };
        write_tangents(&model, x, scale, jacobian, &s.targets, s.tangents, &mut s.matrix, &Serial);
        Self { scratch, masses: scene.particles.masses.clone() }
    }

    /// `out = (mass_factor M + S) p`.
    pub fn multiply(&mut self, mass_factor: f64, p: &[DVec3], out: &mut [DVec3]) {
        multiply(&self.scratch.view().matrix, &self.masses, mass_factor, p, out, &Serial);
    }

    /// The largest eigenvalue of `M^-1 S` and its vector, of unit length, by power iteration.
    pub fn fastest_mode(&mut self) -> (f64, Vec<DVec3>) {
        let (masses, mut rng) = (self.masses.clone(), Rng::new(1));
        let mut p: Vec<_> = masses.iter().map(|_| rng.cube(1.0)).collect();
        let mut q = p.clone();
        let (mut lambda, mut steady) = (0.0, 0);
        // The quotient's error is the square of the vector's.
        while steady < 100 {
            self.multiply(0.0, &p, &mut q);
            let (mut above, mut below) = (0.0, 0.0);
            for ((p, q), m) in p.iter().zip(&q).zip(&masses) {
                above += p.dot(*q);
                below += m * p.length_squared();
            }
            let quotient: f64 = above / below;
            steady = if (quotient - lambda).abs() <= 1e-12 * quotient { steady + 1 } else { 0 };
            lambda = quotient;
            let length = q.iter().zip(&masses).map(|(q, m)| q.length_squared() / (m * m)).sum::<f64>().sqrt();
            for ((p, &q), m) in p.iter_mut().zip(&q).zip(&masses) {
                *p = q / (m * length);
            }
        }
        (lambda, p)
    }
}
