//! The fastest modes of a scene, by power iteration on its tangents: what the steps of explicit
//! methods are limited by.

use alloc::vec::Vec;

use crate::dispatch::Serial;
use crate::forces::matrix::multiply;
use crate::forces::{TangentScale, write_tangents};
use crate::integrate::stability::Mode;
use crate::integrate::{Jacobian, Method, Preconditioner, Scheme};
use crate::real::{Real, Sum, Vec3, dot_sum};
use crate::scene::BuiltScene;
use crate::scratch::ScratchColumns;

/// Iterations by which a quotient must be steady: a start without the fastest mode lingers with the
/// next.
const STEADY: u32 = 100;

/// `S = -(position df/dx + velocity df/dv)` of all terms where a scene's particles are.
#[derive(Clone, Debug)]
pub struct Tangent<'a> {
    scene: &'a BuiltScene,
    scratch: ScratchColumns,
}

impl<'a> Tangent<'a> {
    /// Of a scene.
    pub fn of(scene: &'a BuiltScene, position: Real, velocity: Real, jacobian: Jacobian) -> Self {
        let preconditioner = Preconditioner::BlockJacobi;
        let scheme = Scheme { method: Method::BackwardEuler, newton: 1, tolerance: 0.0, preconditioner, jacobian };
        let mut scratch = ScratchColumns::build(scene, &scheme);
        let s = &mut scratch.view();
        let (x, scale) = (&scene.particles.positions, TangentScale { position, velocity });
        write_tangents(&scene.model.view(), x, scale, jacobian, &s.assembly_map, s.tangents, &mut s.matrix, &Serial);
        Self { scene, scratch }
    }

    /// `out = (mass_factor M + S) p`.
    pub fn multiply(&mut self, mass_factor: Real, p: &[Vec3], out: &mut [Vec3]) {
        multiply(&self.scratch.view().matrix, &self.scene.particles.masses, mass_factor, p, out, &Serial);
    }

    /// `p . S p / p . M p` of a column that moves no held axis, and `S p`.
    fn quotient(&mut self, p: &[Vec3], product: &mut [Vec3]) -> Sum {
        self.multiply(0.0, p, product);
        let masses = &self.scene.particles.masses;
        let above: Sum = p.iter().zip(&*product).map(|(&p, &q)| dot_sum(p, q)).sum();
        let below: Sum = p.iter().zip(masses).map(|(&p, &m)| Sum::from(m) * dot_sum(p, p)).sum();
        above / below
    }

    /// The largest eigenvalue of `M^-1 S` and its vector, of unit length, without the held axes: by
    /// power iteration, until the quotient of 100 iterations differs by no more than `tolerance` of
    /// itself or `most` are done. What is not yet steady is less than the eigenvalue. Where S is
    /// nothing the eigenvalue is 0.
    pub fn fastest_mode(&mut self, tolerance: Sum, most: u32) -> (Sum, Vec<Vec3>) {
        let inverse_masses = &self.scene.particles.inverse_masses;
        let pins = self.scene.pins.view();
        let mut p: Vec<_> = (0..inverse_masses.len() as u32).map(scattered).collect();
        pins.filter(&mut p);
        let mut product = p.clone();
        let (mut quotient, mut steady) = (0.0, 0);
        // The quotient's error is the square of the vector's.
        for _ in 0..most {
            let next = self.quotient(&p, &mut product);
            steady = if (next - quotient).abs() <= tolerance * next.abs() { steady + 1 } else { 0 };
            quotient = next;
            product.iter_mut().zip(inverse_masses).for_each(|(q, &w)| *q *= w);
            pins.filter(&mut product);
            let length = libm::sqrt(product.iter().map(|&q| dot_sum(q, q)).sum());
            // Nothing moves, or nothing answers.
            if length.is_nan() || length <= 0.0 {
                return (0.0, p);
            }
            p.iter_mut().zip(&product).for_each(|(p, &q)| *p = q / length as Real);
            if steady >= STEADY {
                break;
            }
        }
        (quotient, p)
    }
}

/// A vector that has some of every mode, the same each time.
fn scattered(index: u32) -> Vec3 {
    // [Vigna 2015], as a hash.
    let mut bits = u64::from(index).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut next = || {
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9).wrapping_add(0x94d0_49bb_1331_11eb);
        (bits >> 40) as Real / (1u32 << 23) as Real - 1.0
    };
    Vec3::new(next(), next(), next())
}

/// The mode with the most stiffness and the one with the most damping, where a scene's particles are
/// and by no more than `most` iterations each; the same where nothing damps.
pub fn fastest_modes(scene: &BuiltScene, tolerance: Sum, most: u32) -> [Mode; 2] {
    let mut stiff = Tangent::of(scene, 1.0, 0.0, Jacobian::Projected);
    let mut damped = Tangent::of(scene, 0.0, 1.0, Jacobian::Projected);
    let (stiffness, p) = stiff.fastest_mode(tolerance, most);
    let (most_damping, q) = damped.fastest_mode(tolerance, most);
    let mut product = p.clone();
    let damping = damped.quotient(&p, &mut product);
    let first = Mode { stiffness, damping: damping.max(0.0) };
    if most_damping <= 0.0 {
        return [first; 2];
    }
    [first, Mode { stiffness: stiff.quotient(&q, &mut product).max(0.0), damping: most_damping }]
}
