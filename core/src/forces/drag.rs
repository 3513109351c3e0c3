//! Linear drag, f = -c v.

use super::matrix::{BlockMatrix, add};
use super::term::ForceTerm;
use super::{Energy, Jacobian, TangentScale, Term};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::particles::Positions;
use crate::real::{Real, Vec3, scaled_identity};
use crate::traffic::{TrafficSizes, VECTOR};

/// Linear drag.
#[derive(Clone, Copy, Debug)]
pub struct Drag<'a> {
    /// c of each vertex, N s/m.
    pub coefficients: &'a [Real],
}

impl ForceTerm for Drag<'_> {
    fn add_forces(
        &self,
        _: &[Real],
        _: Positions<'_>,
        v: &[Vec3],
        _: &mut [Vec3],
        f: &mut [Vec3],
        dispatch: &impl Dispatch,
    ) {
        dispatch.run(f, |start, part| {
            for ((f, &v), &coefficient) in part.iter_mut().zip(v.part(start..)).zip(self.coefficients.part(start..)) {
                *f -= v * coefficient;
            }
        });
    }

    fn energy(&self, _: Term, _: &[Real], _: Positions<'_>) -> Energy {
        Energy::default()
    }

    /// Clears the matrix first: drag is the first term with a Jacobian, so that no other pass needs to clear it.
    fn add_tangents(
        &self,
        _: &[Vec3],
        scale: TangentScale,
        _: Jacobian,
        _: &[u16],
        _: &mut [Real],
        matrix: &mut BlockMatrix<'_>,
        dispatch: &impl Dispatch,
    ) {
        dispatch.run(matrix.rows_mut(), |start, mut rows| {
            rows.clear();
            for i in 0..rows.count() {
                let Some(diagonal) = rows.row(i).element_mut(0) else { continue };
                add(diagonal, &scaled_identity(scale.velocity * self.coefficients.at(start + i)));
            }
        });
    }

    /// Drag stores no energy, and at zero velocity it has no force to compute.
    fn is_conservative(&self) -> bool {
        false
    }

    fn has_jacobian(&self) -> bool {
        true
    }

    fn dissipates(&self) -> bool {
        true
    }

    fn bytes(&self) -> usize {
        size_of_val(self.coefficients)
    }

    /// Reads the velocities, reads and writes the forces.
    fn force_traffic(&self, vertices: usize) -> usize {
        self.bytes() + 3 * vertices * VECTOR
    }

    fn tangent_traffic(&self, _: TrafficSizes) -> usize {
        self.bytes()
    }
}

/// The owned columns of [`Drag`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct DragColumns {
    /// c of each vertex, N s/m.
    pub coefficients: alloc::vec::Vec<Real>,
}

#[cfg(feature = "alloc")]
impl DragColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Drag<'_> {
        Drag { coefficients: &self.coefficients }
    }
}
