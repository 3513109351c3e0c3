//! The fastest modes of a scene, by power iteration on its tangents. They limit the time steps of
//! explicit methods.

use alloc::vec::Vec;

use crate::dispatch::Dispatch;
use crate::forces::matrix::multiply;
use crate::forces::{TangentScale, write_tangents};
use crate::integrate::stability::Mode;
use crate::integrate::{Jacobian, Method, Scheme};
use crate::real::{Real, Sum, Vec3, dot_sum};
use crate::scene::BuiltScene;
use crate::scratch::ScratchColumns;

/// Number of consecutive iterations in which the quotient must be steady. A start vector with little of
/// the fastest mode stays near the next one for many iterations.
const STEADY: u32 = 100;

/// `S = -(position df/dx + velocity df/dv)` of all terms, at the positions of a scene's particles.
#[derive(Clone, Debug)]
pub struct Tangent<'a> {
    scene: &'a BuiltScene,
    scratch: ScratchColumns,
}

impl<'a> Tangent<'a> {
    /// The tangent of a scene. `position` and `velocity` are the factors in S.
    pub fn of(
        scene: &'a BuiltScene,
        position: Real,
        velocity: Real,
        jacobian: Jacobian,
        dispatch: &impl Dispatch,
    ) -> Self {
        let scheme = Scheme { jacobian, ..Scheme::fixed(Method::BackwardEuler, 0.0) };
        let mut scratch = ScratchColumns::build(scene, &scheme);
        let s = &mut scratch.view();
        let (x, scale) = (&scene.particles.positions, TangentScale { position, velocity });
        write_tangents(&scene.model.view(), x, scale, jacobian, &s.assembly_map, s.tangents, &mut s.matrix, dispatch);
        Self { scene, scratch }
    }

    /// `out = (mass_factor M + S) p`.
    pub fn multiply(&mut self, mass_factor: Real, p: &[Vec3], out: &mut [Vec3], dispatch: &impl Dispatch) {
        multiply(&self.scratch.view().matrix, &self.scene.particles.masses, mass_factor, p, out, dispatch);
    }

    /// Rayleigh quotient `p . S p / p . M p` of a column that is zero on all fixed axes. Writes `S p` to
    /// `product`.
    fn quotient(&mut self, p: &[Vec3], product: &mut [Vec3], dispatch: &impl Dispatch) -> Sum {
        self.multiply(0.0, p, product, dispatch);
        let masses = &self.scene.particles.masses;
        let above: Sum = p.iter().zip(&*product).map(|(&p, &q)| dot_sum(p, q)).sum();
        let below: Sum = p.iter().zip(masses).map(|(&p, &m)| Sum::from(m) * dot_sum(p, p)).sum();
        above / below
    }

    /// The largest eigenvalue of `M^-1 S` without the fixed axes, and its unit eigenvector, by power
    /// iteration. Stops when the quotient changes by at most `tolerance` of itself in 100 consecutive
    /// iterations, after `most` iterations, or when the dispatch [stops](Dispatch::stopped). A quotient that is not
    /// yet steady is less than the eigenvalue. If S is zero, the eigenvalue is 0.
    #[cfg_attr(small, optimize(size))]
    pub fn fastest_mode(&mut self, tolerance: Sum, most: u32, dispatch: &impl Dispatch) -> (Sum, Vec<Vec3>) {
        let inverse_masses = &self.scene.particles.inverse_masses;
        let pins = self.scene.pins.view();
        let mut p: Vec<_> = (0..inverse_masses.len() as u32).map(scattered).collect();
        pins.filter(&mut p);
        let mut product = p.clone();
        let (mut quotient, mut steady) = (0.0, 0);
        // The error of the quotient scales with the square of the error of the vector.
        for _ in 0..most {
            let next = self.quotient(&p, &mut product, dispatch);
            steady = if (next - quotient).abs() <= tolerance * next.abs() { steady + 1 } else { 0 };
            quotient = next;
            product.iter_mut().zip(inverse_masses).for_each(|(q, &w)| *q *= w);
            pins.filter(&mut product);
            let length = libm::sqrt(product.iter().map(|&q| dot_sum(q, q)).sum());
            // All axes are fixed, or S is zero.
            if length.is_nan() || length <= 0.0 {
                return (0.0, p);
            }
            p.iter_mut().zip(&product).for_each(|(p, &q)| *p = q / length as Real);
            if steady >= STEADY || dispatch.stopped() {
                break;
            }
        }
        (quotient, p)
    }
}

/// Pseudo-random vector for a vertex, the same in every run. A start column of them contains every mode.
fn scattered(index: u32) -> Vec3 {
    // The generator of [Vigna 2015], used as a hash of the index.
    let mut bits = u64::from(index).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut next = || {
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9).wrapping_add(0x94d0_49bb_1331_11eb);
        (bits >> 40) as Real / (1u32 << 23) as Real - 1.0
    };
    Vec3::new(next(), next(), next())
}

/// The mode with the largest stiffness and the mode with the largest damping, at the positions of a
/// scene's particles, with at most `most` iterations each. Without damping the first is returned twice. If the dispatch
/// [stops](Dispatch::stopped), the modes are too slow.
#[cfg_attr(small, optimize(size))]
pub fn fastest_modes(scene: &BuiltScene, tolerance: Sum, most: u32, dispatch: &impl Dispatch) -> [Mode; 2] {
    let mut stiff = Tangent::of(scene, 1.0, 0.0, Jacobian::Projected, dispatch);
    let mut damped = Tangent::of(scene, 0.0, 1.0, Jacobian::Projected, dispatch);
    let (stiffness, p) = stiff.fastest_mode(tolerance, most, dispatch);
    let (most_damping, q) = damped.fastest_mode(tolerance, most, dispatch);
    let mut product = p.clone();
    let damping = damped.quotient(&p, &mut product, dispatch);
    let first = Mode { stiffness, damping: damping.max(0.0) };
    if most_damping <= 0.0 {
        return [first; 2];
    }
    [first, Mode { stiffness: stiff.quotient(&q, &mut product, dispatch).max(0.0), damping: most_damping }]
}
