//! The interface of a force term to the model. A term over elements gives its [kernels](super::element::Element)
//! and a few [facts](super::element::ElementTerm) instead.

use super::matrix::BlockMatrix;
use super::{Energy, Jacobian, TangentScale, Term};
use crate::dispatch::Dispatch;
use crate::particles::Positions;
use crate::real::{Real, Vec3};
use crate::traffic::TrafficSizes;

/// A force term. Every force is affine in the velocities.
pub trait ForceTerm {
    /// Adds the forces to `f`, N. `scratch` has [`Self::force_scratch`] vectors.
    fn add_forces(
        &self,
        masses: &[Real],
        x: Positions<'_>,
        v: &[Vec3],
        scratch: &mut [Vec3],
        f: &mut [Vec3],
        dispatch: &impl Dispatch,
    );

    /// The stored energy, J. `name` is the name under which the model has the term.
    fn energy(&self, name: Term, masses: &[Real], x: Positions<'_>) -> Energy;

    /// Adds `-(position Kx + velocity Kv)` to `matrix`. `slots` is the place of each of the
    /// [blocks](Self::blocks) in its row, `scratch` has [`Self::tangent_scratch`] scalars. A term without a
    /// [Jacobian](Self::has_jacobian) adds nothing.
    fn add_tangents(
        &self,
        _x: &[Vec3],
        _scale: TangentScale,
        _jacobian: Jacobian,
        _slots: &[u16],
        _scratch: &mut [Real],
        _matrix: &mut BlockMatrix<'_>,
        _dispatch: &impl Dispatch,
    ) {
    }

    /// Row and column of each block of the Jacobian, in the order of `slots`. Blocks that only add to the diagonal
    /// may be left out.
    fn blocks(&self) -> impl Iterator<Item = (u32, u32)> {
        core::iter::empty()
    }

    /// Whether the term has a Jacobian. A force that does not depend on the motion has none.
    fn has_jacobian(&self) -> bool {
        false
    }

    /// Whether the forces at zero velocity are minus the slope of the stored energy.
    fn is_conservative(&self) -> bool {
        true
    }

    /// Whether any force depends on velocities.
    fn dissipates(&self) -> bool {
        false
    }

    /// The largest strain rate at the velocities `v`, 1/s.
    fn strain_rate(&self, _v: &[Vec3]) -> Real {
        0.0
    }

    /// The largest rate at which edges stretch at the positions `x` and the velocities `v`, 1/s.
    fn stretch_rate(&self, _x: &[Vec3], _v: &[Vec3]) -> Real {
        0.0
    }

    /// Number of vectors that [`Self::add_forces`] needs as scratch.
    fn force_scratch(&self) -> usize {
        0
    }

    /// Number of scalars that [`Self::add_tangents`] needs as scratch.
    fn tangent_scratch(&self) -> usize {
        0
    }

    /// Bytes of the columns.
    fn bytes(&self) -> usize;

    /// Bytes that [`Self::add_forces`] streams.
    fn force_traffic(&self, vertices: usize) -> usize;

    /// Bytes that [`Self::add_tangents`] streams.
    fn tangent_traffic(&self, _sizes: TrafficSizes) -> usize {
        0
    }
}
