//! Everything a step writes besides the state, sized once. A column that a method does not use
//! is empty.

use crate::integrate::matrix::{BlockMatrix, Targets};
use crate::real::{Mat3, Real, Sum, Vec3};

/// Work columns, borrowed. Lengths: one entry a vertex where not said otherwise.
#[derive(Debug, Default)]
pub struct Scratch<'a> {
    /// Sum of all forces, N.
    pub forces: &'a mut [Vec3],
    /// Forces on element corners, [`Model::force_scratch`](crate::forces::Model::force_scratch).
    pub elements: &'a mut [Vec3],
    /// Candidate positions, m.
    pub next_positions: &'a mut [Vec3],
    /// Candidate velocities, m/s.
    pub next_velocities: &'a mut [Vec3],

    /// Positions inside the step: RK4 and Newton's method.
    pub stage_positions: &'a mut [Vec3],
    /// Velocities inside the step: RK4.
    pub stage_velocities: &'a mut [Vec3],

    /// BDF2: the state before the last step, and whether there is one.
    pub previous_positions: &'a mut [Vec3],
    /// BDF2.
    pub previous_velocities: &'a mut [Vec3],
    /// BDF2: extrapolated positions that the stage starts from.
    pub base_positions: &'a mut [Vec3],
    /// BDF2.
    pub base_velocities: &'a mut [Vec3],
    /// BDF2: whether the previous state is known.
    pub has_history: bool,

    /// Implicit: the system matrix.
    pub matrix: BlockMatrix<'a>,
    /// Implicit: where each term's blocks go.
    pub targets: Targets<'a>,
    /// Implicit: packed element Jacobians,
    /// [`Model::tangent_scratch`](crate::forces::Model::tangent_scratch) scalars.
    pub tangents: &'a mut [Real],
    /// Implicit: change of the velocities.
    pub solution: &'a mut [Vec3],
    /// Implicit.
    pub residual: &'a mut [Vec3],
    /// Newton's method: the residual that a solve started from.
    pub base_residual: &'a mut [Vec3],
    /// Implicit.
    pub direction: &'a mut [Vec3],
    /// Implicit.
    pub products: &'a mut [Vec3],
    /// Implicit.
    pub preconditioned: &'a mut [Vec3],
    /// Implicit: the block Jacobi preconditioner.
    pub inverse_diagonal: &'a mut [Mat3],
    /// Implicit: one for each [`PART`](crate::integrate::conjugate_gradient::PART) vertices.
    pub partials: &'a mut [Sum],
}

/// The owned columns.
#[cfg(feature = "alloc")]
pub use owned::ScratchColumns;

#[cfg(feature = "alloc")]
mod owned {
    use alloc::vec;
    use alloc::vec::Vec;

    use super::{BlockMatrix, Mat3, Real, Scratch, Sum, Vec3};
    use crate::forces::Model;
    use crate::integrate::conjugate_gradient::PART;
    use crate::integrate::matrix::Pattern;
    use crate::integrate::{Method, Scheme};

    /// Owned work columns, sized for a model and a scheme.
    #[derive(Clone, Debug, Default)]
    pub struct ScratchColumns {
        forces: Vec<Vec3>,
        elements: Vec<Vec3>,
        pub(crate) next_positions: Vec<Vec3>,
        pub(crate) next_velocities: Vec<Vec3>,
        stage_positions: Vec<Vec3>,
        stage_velocities: Vec<Vec3>,
        pub(crate) previous_positions: Vec<Vec3>,
        pub(crate) previous_velocities: Vec<Vec3>,
        base_positions: Vec<Vec3>,
        base_velocities: Vec<Vec3>,
        pub(crate) has_history: bool,
        pattern: Pattern,
        blocks: Vec<Mat3>,
        tangents: Vec<Real>,
        solution: Vec<Vec3>,
        residual: Vec<Vec3>,
        base_residual: Vec<Vec3>,
        direction: Vec<Vec3>,
        products: Vec<Vec3>,
        preconditioned: Vec<Vec3>,
        inverse_diagonal: Vec<Mat3>,
        partials: Vec<Sum>,
    }

    impl ScratchColumns {
        /// Columns for `vertices` vertices.
        pub fn build(vertices: usize, model: &Model<'_>, scheme: &Scheme) -> Self {
            let column = |used: bool| vec![Vec3::ZERO; if used { vertices } else { 0 }];
            let implicit = scheme.method.is_implicit();
            let iterates = implicit && scheme.newton > 1;
            let (rk4, bdf2) = (scheme.method == Method::Rk4, scheme.method == Method::Bdf2);
            let pattern = if implicit { Pattern::build(vertices, model) } else { Pattern::default() };
            Self {
                forces: column(true),
                elements: vec![Vec3::ZERO; model.force_scratch()],
                next_positions: column(true),
                next_velocities: column(true),
                stage_positions: column(rk4 || iterates),
                stage_velocities: column(rk4),
                previous_positions: column(bdf2),
                previous_velocities: column(bdf2),
                base_positions: column(bdf2),
                base_velocities: column(bdf2),
                has_history: false,
                blocks: vec![Mat3::ZERO; pattern.columns.len()],
                pattern,
                tangents: vec![0.0; if implicit { model.tangent_scratch() } else { 0 }],
                solution: column(implicit),
                residual: column(implicit),
                base_residual: column(iterates),
                direction: column(implicit),
                products: column(implicit),
                preconditioned: column(implicit),
                inverse_diagonal: vec![Mat3::ZERO; if implicit { vertices } else { 0 }],
                partials: vec![0.0; if implicit { vertices.div_ceil(PART) } else { 0 }],
            }
        }

        /// The borrowed view that a step takes.
        pub fn view(&mut self) -> Scratch<'_> {
            Scratch {
                forces: &mut self.forces,
                elements: &mut self.elements,
                next_positions: &mut self.next_positions,
                next_velocities: &mut self.next_velocities,
                stage_positions: &mut self.stage_positions,
                stage_velocities: &mut self.stage_velocities,
                previous_positions: &mut self.previous_positions,
                previous_velocities: &mut self.previous_velocities,
                base_positions: &mut self.base_positions,
                base_velocities: &mut self.base_velocities,
                has_history: self.has_history,
                targets: self.pattern.targets(),
                matrix: BlockMatrix {
                    offsets: &self.pattern.offsets,
                    columns: &self.pattern.columns,
                    blocks: &mut self.blocks,
                },
                tangents: &mut self.tangents,
                solution: &mut self.solution,
                residual: &mut self.residual,
                base_residual: &mut self.base_residual,
                direction: &mut self.direction,
                products: &mut self.products,
                preconditioned: &mut self.preconditioned,
                inverse_diagonal: &mut self.inverse_diagonal,
                partials: &mut self.partials,
            }
        }
    }
}
