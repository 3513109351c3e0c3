//! Gravity, f = m g.

use super::matrix::BlockMatrix;
use super::term::ForceTerm;
use super::{Energy, Jacobian, TangentScale, Term};
use crate::dispatch::Dispatch;
use crate::real::{Real, Sum, Vec3, dot_sum};
use crate::traffic::{SCALAR, TrafficSizes};

/// The acceleration g, m/s^2.
#[derive(Clone, Copy, Debug)]
pub struct Gravity(pub Vec3);

impl Gravity {
    /// The view that kernels take: there is nothing to borrow.
    pub fn view(&self) -> Self {
        *self
    }
}

impl ForceTerm for Gravity {
    /// Sets the forces: gravity is the first term, so that no other pass needs to clear them.
    fn add_forces(
        &self,
        masses: &[Real],
        _: &[Vec3],
        _: &[Vec3],
        _: &mut [Vec3],
        f: &mut [Vec3],
        dispatch: &impl Dispatch,
    ) {
        let gravity = self.0;
        dispatch.run(f, |start, part| {
            for (f, &mass) in part.iter_mut().zip(&masses[start..]) {
                *f = gravity * mass;
            }
        });
    }

    /// The potential energy, zero at the origin.
    fn energy(&self, _: Term, masses: &[Real], x: &[Vec3]) -> Energy {
        let gravity = -masses.iter().zip(x).map(|(&m, &x)| dot_sum(self.0 * m, x)).sum::<Sum>();
        Energy { gravity, ..Energy::default() }
    }

    fn add_tangents(
        &self,
        _: &[Vec3],
        _: TangentScale,
        _: Jacobian,
        _: &[u16],
        _: &mut [Real],
        _: &mut BlockMatrix<'_>,
        _: &impl Dispatch,
    ) {
    }

    fn has_jacobian(&self) -> bool {
        false
    }

    fn dissipates(&self) -> bool {
        false
    }

    fn bytes(&self) -> usize {
        0
    }

    /// Reads the masses.
    fn force_traffic(&self, vertices: usize) -> usize {
        vertices * SCALAR
    }

    fn tangent_traffic(&self, _: TrafficSizes) -> usize {
        0
    }
}
