//! Work columns: all data that a step writes besides the state. They are allocated once. A column that
//! a method does not use is empty.

use crate::forces::matrix::{AssemblyMap, BlockMatrix};
use crate::integrate::coarse::{CoarseFactor, Patches};
use crate::integrate::columns::Sums;
use crate::integrate::per_cloth::ClothSolve;
use crate::particles::PositionsMut;
use crate::real::{Mat3, Real, Vec3};

/// Whether columns may be left out to save memory. The page leaves none out, and is smaller without the code.
pub(crate) const MAY_BE_LEAN: bool = !cfg!(small);

/// Work columns, borrowed. They have one entry per vertex unless stated otherwise.
#[derive(Debug, Default)]
pub struct Scratch<'a> {
    /// Sum of all forces, N. Euler's explicit methods need it only where [work](crate::work_done) is measured.
    pub forces: &'a mut [Vec3],
    /// Forces on element corners, N: [`Model::force_scratch`](crate::forces::Model::force_scratch) vectors.
    pub elements: &'a mut [Vec3],
    /// Positions after the step, until it is committed, m.
    pub next_positions: &'a mut [Vec3],
    /// Change of the positions in the step, m.
    pub displacements: &'a mut [Vec3],
    /// Change of the velocities in the step, inside implicit methods in a stage, m/s. Explicit Euler methods first write
    /// the forces here, N.
    pub velocity_changes: &'a mut [Vec3],

    /// RK4, implicit methods, and where [work](crate::work_done) is measured: positions inside the step, m. RK4 needs
    /// no rounding errors.
    pub stage_positions: PositionsMut<'a>,
    /// Midpoint, RK4, implicit methods, and where work is measured: velocities inside the step, m/s.
    pub stage_velocities: &'a mut [Vec3],
    /// Implicit, and where work is measured: the [forces on pins](crate::integrate::pin_forces), one per pin, N.
    pub pin_forces: &'a mut [Vec3],

    /// BDF2, and implicit midpoint with a largest error: change of the positions in the last step, m.
    pub previous_displacements: &'a mut [Vec3],
    /// BDF2, and implicit midpoint with a largest error: change of the velocities in the last step, m/s.
    pub previous_velocity_changes: &'a mut [Vec3],
    /// BDF2: from the positions to the extrapolated ones that the stage starts from, m.
    pub base_offsets: &'a mut [Vec3],
    /// BDF2: extrapolated velocities that the stage starts from, m/s.
    pub base_velocities: &'a mut [Vec3],
    /// The length of the last step if this one continues it, s. [`step::take`](crate::step::take) sets it.
    pub last_step: Option<Real>,

    /// Implicit: the system matrix.
    pub matrix: BlockMatrix<'a>,
    /// Implicit: the place of each term's blocks in the matrix.
    pub assembly_map: AssemblyMap<'a>,
    /// Implicit: packed element Jacobians,
    /// [`Model::tangent_scratch`](crate::forces::Model::tangent_scratch) scalars.
    pub tangents: &'a mut [Real],
    /// Implicit: change of the velocities, the solution of the linear system, m/s.
    pub solution: &'a mut [Vec3],
    /// Implicit: residual without contacts, kg m/s.
    pub residual: &'a mut [Vec3],
    /// Implicit: residual with the impulses of contacts, kg m/s.
    pub gradient: &'a mut [Vec3],
    /// Newton's method with line search: the residual at the start of a linear solve.
    pub base_residual: &'a mut [Vec3],
    /// Implicit: search direction of conjugate gradients.
    pub direction: &'a mut [Vec3],
    /// Implicit: product of the system matrix with the search direction.
    pub products: &'a mut [Vec3],
    /// Implicit: the preconditioned residual.
    pub preconditioned: &'a mut [Vec3],
    /// Implicit: the block Jacobi preconditioner.
    pub inverse_diagonal: &'a mut [Mat3],
    /// Two-level preconditioner: the patches.
    pub patches: Patches<'a>,
    /// Two-level preconditioner: the factor of the small matrix of the patches.
    pub coarse: CoarseFactor<'a>,
    /// Implicit: one entry per cloth.
    pub cloths: &'a mut [ClothSolve],
    /// Implicit: partial sums, one entry per [`PART`](crate::integrate::columns::PART) vertices.
    pub partials: &'a mut [Sums],
}

impl Scratch<'_> {
    /// The same columns for a shorter time.
    pub fn reborrow(&mut self) -> Scratch<'_> {
        Scratch {
            forces: self.forces,
            elements: self.elements,
            next_positions: self.next_positions,
            displacements: self.displacements,
            velocity_changes: self.velocity_changes,
            stage_velocities: self.stage_velocities,
            pin_forces: self.pin_forces,
            previous_displacements: self.previous_displacements,
            previous_velocity_changes: self.previous_velocity_changes,
            base_offsets: self.base_offsets,
            base_velocities: self.base_velocities,
            assembly_map: self.assembly_map,
            tangents: self.tangents,
            solution: self.solution,
            residual: self.residual,
            gradient: self.gradient,
            base_residual: self.base_residual,
            direction: self.direction,
            products: self.products,
            preconditioned: self.preconditioned,
            inverse_diagonal: self.inverse_diagonal,
            patches: self.patches,
            cloths: self.cloths,
            partials: self.partials,
            last_step: self.last_step,
            stage_positions: PositionsMut { rounded: self.stage_positions.rounded, low: self.stage_positions.low },
            matrix: BlockMatrix { blocks: self.matrix.blocks, ..self.matrix },
            coarse: CoarseFactor {
                values: self.coarse.values,
                own: self.coarse.own,
                elastic_values: self.coarse.elastic_values,
                elastic_own: self.coarse.elastic_own,
                inverse_diagonal: self.coarse.inverse_diagonal,
                rounded: self.coarse.rounded,
                vector: self.coarse.vector,
                motions: self.coarse.motions,
            },
        }
    }
}

/// The owned columns of [`Scratch`].
#[cfg(feature = "alloc")]
pub use owned::ScratchColumns;

#[cfg(feature = "alloc")]
mod owned {
    use alloc::vec;
    use alloc::vec::Vec;
    use core::ops::Range;

    use super::{BlockMatrix, ClothSolve, CoarseFactor, Mat3, PositionsMut, Real, Scratch, Vec3};
    use crate::forces::matrix::Block;
    use crate::forces::sparsity::SparsityPattern;
    use crate::integrate::coarse::{Dense, MODES};
    use crate::integrate::columns::{PART, Sums};
    use crate::integrate::patches::PatchColumns;
    use crate::integrate::{Method, Preconditioner, Scheme};
    use crate::real::{Lanes, Sum, to_f64};
    use crate::scene::BuiltScene;
    use crate::traffic::TrafficSizes;

    /// Owned work columns, sized for a scene and a scheme.
    #[derive(Clone, Debug, Default)]
    pub struct ScratchColumns {
        forces: Vec<Vec3>,
        elements: Vec<Vec3>,
        pub(crate) next_positions: Vec<Vec3>,
        displacements: Vec<Vec3>,
        velocity_changes: Vec<Vec3>,
        stage_positions: Vec<Vec3>,
        low_stage_positions: Vec<Vec3>,
        stage_velocities: Vec<Vec3>,
        pin_forces: Vec<Vec3>,
        pub(crate) previous_displacements: Vec<Vec3>,
        pub(crate) previous_velocity_changes: Vec<Vec3>,
        base_offsets: Vec<Vec3>,
        base_velocities: Vec<Vec3>,
        pattern: SparsityPattern,
        blocks: Vec<Block>,
        tangents: Vec<Real>,
        solution: Vec<Vec3>,
        residual: Vec<Vec3>,
        gradient: Vec<Vec3>,
        base_residual: Vec<Vec3>,
        direction: Vec<Vec3>,
        products: Vec<Vec3>,
        preconditioned: Vec<Vec3>,
        inverse_diagonal: Vec<Mat3>,
        partials: Vec<Sums>,
        cloths: Vec<ClothSolve>,
        patches: PatchColumns,
        coarse_values: Vec<Sum>,
        coarse_own: Vec<Dense>,
        elastic_values: Vec<Sum>,
        elastic_own: Vec<Dense>,
        coarse_inverse_diagonal: Vec<Sum>,
        coarse_rounded: Vec<Real>,
        coarse_vector: Vec<Real>,
        coarse_motions: Vec<[Lanes; 3]>,
    }

    /// The vertices of each cloth. A scene that was not built from a description may lack them; then it is one cloth.
    fn cloths(scene: &BuiltScene) -> Vec<Range<u32>> {
        match &scene.cloths[..] {
            [] => core::iter::once(0..scene.particles.positions.len() as u32).collect(),
            cloths => cloths.iter().map(|cloth| cloth.vertices.clone()).collect(),
        }
    }

    /// Patches of a scene. A scene that was not built from a description may lack the material coordinates; then the
    /// current positions are used.
    fn patches(scene: &BuiltScene, pattern: &SparsityPattern) -> PatchColumns {
        let (positions, pins) = (&scene.particles.positions, &scene.pins.view());
        if scene.material.len() == positions.len() {
            return PatchColumns::build(&scene.material, &cloths(scene), pattern, pins);
        }
        let material: Vec<_> = positions.iter().map(|&x| to_f64(x).into()).collect();
        PatchColumns::build(&material, &cloths(scene), pattern, pins)
    }

    impl ScratchColumns {
        /// Allocates the columns for a scene and a scheme.
        #[cfg_attr(small, optimize(size))]
        pub fn build(scene: &BuiltScene, scheme: &Scheme) -> Self {
            let (vertices, model) = (scene.particles.positions.len(), &scene.model.view());
            let column = |used: bool| vec![Vec3::ZERO; if used { vertices } else { 0 }];
            let implicit = scheme.method.is_implicit();
            let searches = implicit && scheme.newton > 1;
            let (rk4, bdf2) = (scheme.method == Method::Rk4, scheme.method == Method::Bdf2);
            let has_more = scheme.method.has_more_columns();
            let history = bdf2 || (scheme.method == Method::ImplicitMidpoint && scheme.error.is_some());
            let pattern = if implicit { SparsityPattern::build(vertices, model) } else { SparsityPattern::default() };
            let patches = if implicit && scheme.preconditioner == Preconditioner::TwoLevel {
                patches(scene, &pattern)
            } else {
                PatchColumns::default()
            };
            let [coarse_rows, coarse_values] = patches.sizes();
            let [elastic_rows, elastic_values] = if scene.contact.is_some() { patches.sizes() } else { [0; 2] };
            let solved = if implicit { cloths(scene) } else { Vec::new() };
            Self {
                forces: column(has_more),
                elements: vec![Vec3::ZERO; model.force_scratch()],
                next_positions: column(true),
                displacements: column(true),
                velocity_changes: column(true),
                stage_positions: column(rk4 || implicit),
                low_stage_positions: column(implicit),
                stage_velocities: column(has_more),
                pin_forces: Vec::new(),
                previous_displacements: column(history),
                previous_velocity_changes: column(history),
                base_offsets: column(bdf2),
                base_velocities: column(bdf2),
                blocks: vec![Block::default(); pattern.columns.len()],
                pattern,
                tangents: vec![0.0; if implicit { model.tangent_scratch() } else { 0 }],
                solution: column(implicit),
                residual: column(implicit),
                gradient: column(implicit),
                base_residual: column(searches),
                direction: column(implicit),
                products: column(implicit),
                preconditioned: column(implicit),
                inverse_diagonal: vec![Mat3::ZERO; if implicit { vertices } else { 0 }],
                partials: vec![[0.0; 2]; if implicit { vertices.div_ceil(PART) } else { 0 }],
                cloths: solved.into_iter().map(|cloth| ClothSolve::up_to(cloth.end)).collect(),
                patches,
                coarse_values: vec![0.0; coarse_values],
                coarse_own: vec![[[0.0; MODES]; MODES]; coarse_rows / MODES],
                elastic_values: vec![0.0; elastic_values],
                elastic_own: vec![[[0.0; MODES]; MODES]; elastic_rows / MODES],
                coarse_inverse_diagonal: vec![0.0; coarse_rows],
                coarse_rounded: vec![0.0; coarse_values],
                coarse_vector: vec![0.0; coarse_rows],
                coarse_motions: vec![[Lanes::ZERO; 3]; coarse_rows / MODES],
            }
        }

        /// Adds the columns in which work is measured: those of a stage, if the method has none, and those of pins.
        pub(crate) fn add_work(&mut self, pins: usize) {
            self.pin_forces.resize(if self.solution.is_empty() { 0 } else { pins }, Vec3::ZERO);
            let vertices = self.next_positions.len();
            let stage = [&mut self.stage_positions, &mut self.low_stage_positions, &mut self.stage_velocities];
            stage.into_iter().chain([&mut self.forces]).for_each(|column| column.resize(vertices, Vec3::ZERO));
        }

        /// Removes the columns in which work is measured.
        pub(crate) fn remove_work(&mut self, method: Method) {
            let keep = |column: &mut Vec<Vec3>, is_used: bool| column.truncate(if is_used { column.len() } else { 0 });
            let (rk4, implicit) = (method == Method::Rk4, method.is_implicit());
            let has_more = method.has_more_columns();
            self.pin_forces.clear();
            keep(&mut self.stage_positions, rk4 || implicit);
            keep(&mut self.low_stage_positions, implicit);
            keep(&mut self.stage_velocities, has_more);
            keep(&mut self.forces, has_more);
        }

        /// Removes the column of the forces of elements, which are computed for each vertex then, and the elastic part of the
        /// coarse factor, which is summed for each factor then.
        pub(crate) fn remove_spare(&mut self) {
            self.elements.clear();
            self.elastic_values.clear();
            self.elastic_own.clear();
        }

        /// The held axes of each vertex, empty without patches, and the changes in the last step.
        pub(crate) fn of_pins(&mut self) -> (&mut [u8], [&mut [Vec3]; 2]) {
            let previous = [&mut self.previous_displacements, &mut self.previous_velocity_changes];
            (self.patches.held_mut(), previous.map(|column| &mut column[..]))
        }

        /// Sizes that the memory traffic depends on.
        pub fn sizes(&self) -> TrafficSizes {
            TrafficSizes {
                vertices: self.next_positions.len(),
                blocks: [self.pattern.columns.len(), self.pattern.mirrored.len()],
                coarse_values: self.coarse_values.len(),
            }
        }

        /// Bytes of the columns.
        pub fn bytes(&self) -> usize {
            let vectors = [
                &self.forces,
                &self.elements,
                &self.next_positions,
                &self.displacements,
                &self.velocity_changes,
                &self.stage_positions,
                &self.low_stage_positions,
                &self.stage_velocities,
                &self.pin_forces,
                &self.previous_displacements,
                &self.previous_velocity_changes,
                &self.base_offsets,
                &self.base_velocities,
                &self.solution,
                &self.residual,
                &self.gradient,
                &self.base_residual,
                &self.direction,
                &self.products,
                &self.preconditioned,
            ];
            vectors.iter().map(|column| size_of_val(&column[..])).sum::<usize>()
                + self.pattern.bytes()
                + size_of_val(&self.blocks[..])
                + size_of_val(&self.tangents[..])
                + size_of_val(&self.inverse_diagonal[..])
                + size_of_val(&self.partials[..])
                + size_of_val(&self.cloths[..])
                + self.patches.bytes()
                + size_of_val(&self.coarse_values[..])
                + size_of_val(&self.coarse_own[..])
                + size_of_val(&self.elastic_values[..])
                + size_of_val(&self.elastic_own[..])
                + size_of_val(&self.coarse_inverse_diagonal[..])
                + size_of_val(&self.coarse_rounded[..])
                + size_of_val(&self.coarse_vector[..])
                + size_of_val(&self.coarse_motions[..])
        }

        /// The borrowed view that a step takes.
        pub fn view(&mut self) -> Scratch<'_> {
            Scratch {
                forces: &mut self.forces,
                elements: &mut self.elements,
                next_positions: &mut self.next_positions,
                displacements: &mut self.displacements,
                velocity_changes: &mut self.velocity_changes,
                stage_positions: PositionsMut {
                    rounded: &mut self.stage_positions,
                    low: &mut self.low_stage_positions,
                },
                stage_velocities: &mut self.stage_velocities,
                pin_forces: &mut self.pin_forces,
                previous_displacements: &mut self.previous_displacements,
                previous_velocity_changes: &mut self.previous_velocity_changes,
                base_offsets: &mut self.base_offsets,
                base_velocities: &mut self.base_velocities,
                last_step: None,
                assembly_map: self.pattern.assembly_map(),
                matrix: BlockMatrix {
                    offsets: &self.pattern.offsets,
                    columns: &self.pattern.columns,
                    mirrored_offsets: &self.pattern.mirrored_offsets,
                    mirrored: &self.pattern.mirrored,
                    blocks: &mut self.blocks,
                },
                tangents: &mut self.tangents,
                solution: &mut self.solution,
                residual: &mut self.residual,
                gradient: &mut self.gradient,
                base_residual: &mut self.base_residual,
                direction: &mut self.direction,
                products: &mut self.products,
                preconditioned: &mut self.preconditioned,
                inverse_diagonal: &mut self.inverse_diagonal,
                partials: &mut self.partials,
                cloths: &mut self.cloths,
                patches: self.patches.view(),
                coarse: CoarseFactor {
                    values: &mut self.coarse_values,
                    own: &mut self.coarse_own,
                    elastic_values: &mut self.elastic_values,
                    elastic_own: &mut self.elastic_own,
                    inverse_diagonal: &mut self.coarse_inverse_diagonal,
                    rounded: &mut self.coarse_rounded,
                    vector: &mut self.coarse_vector,
                    motions: &mut self.coarse_motions,
                },
            }
        }
    }
}
