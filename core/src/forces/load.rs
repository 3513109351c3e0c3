//! Loads, f = constant in the world.

use super::matrix::BlockMatrix;
use super::term::ForceTerm;
use super::{Energy, Jacobian, TangentScale, Term};
use crate::dispatch::Dispatch;
use crate::real::{Real, Sum, Vec3, dot_sum};
use crate::traffic::{TrafficSizes, VECTOR};

/// Loads on some vertices.
#[derive(Clone, Copy, Debug)]
pub struct Loads<'a> {
    /// The loaded vertices. A vertex may carry several loads.
    pub vertices: &'a [u32],
    /// The force of each, N.
    pub forces: &'a [Vec3],
    /// The sum of f . x at the start, J.
    pub reference: Sum,
}

impl ForceTerm for Loads<'_> {
    fn add_forces(&self, _: &[Real], _: &[Vec3], _: &[Vec3], _: &mut [Vec3], f: &mut [Vec3], _: &impl Dispatch) {
        for (&vertex, &force) in self.vertices.iter().zip(self.forces) {
            f[vertex as usize] += force;
        }
    }

    /// The potential energy, zero at the start. It counts as that of gravity.
    fn energy(&self, _: Term, _: &[Real], x: &[Vec3]) -> Energy {
        let work = self.vertices.iter().zip(self.forces).map(|(&vertex, &force)| dot_sum(force, x[vertex as usize]));
        Energy { gravity: self.reference - work.sum::<Sum>(), ..Energy::default() }
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
        size_of_val(self.vertices) + size_of_val(self.forces)
    }

    /// Reads the loads, reads and writes the forces of their vertices.
    fn force_traffic(&self, _: usize) -> usize {
        self.bytes() + 2 * self.vertices.len() * VECTOR
    }

    fn tangent_traffic(&self, _: TrafficSizes) -> usize {
        0
    }
}

/// The owned columns of [`Loads`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct LoadColumns {
    /// The loaded vertices.
    pub vertices: alloc::vec::Vec<u32>,
    /// The force of each, N.
    pub forces: alloc::vec::Vec<Vec3>,
    /// The sum of f . x at the start, J.
    pub reference: Sum,
}

#[cfg(feature = "alloc")]
impl LoadColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Loads<'_> {
        Loads { vertices: &self.vertices, forces: &self.forces, reference: self.reference }
    }
}
