//! Motions of free cloths as a whole, in a solve and after it: they take up the momentum and the angular momentum that are
//! left. A preconditioner moves each vertex by its own stiffness, and would wrinkle cloth in a long fall.

use glam::DVec3;

use super::IntegratorStatistics;
use super::columns::{dot, sum_parts};
use super::conjugate_gradient::Iterate;
use super::convex_term::ConvexTerm;
use super::per_cloth::{self, ClothSolve};
use super::stopping::UNBALANCED;
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::forces::matrix;
use crate::real::{Real, Sum, Vec3, to_f64, vec3};
use crate::scratch::Scratch;

/// Roundings of the elasticity of a vertex in a motion of its cloth as a whole: those of the blocks of its row.
const ROUNDED: Real = 16.0;

/// Adds the momentum and the angular momentum that a solve with contacts left of free cloths to the changes of their
/// velocities: the next solve takes them up. If they were lost, the rests of all steps would add up, and a sheet that
/// should slide would stick. `to_velocity` is the change of the velocity over that of the solution.
#[cfg_attr(small, optimize(size), inline(never))]
pub(crate) fn pass_on(s: &mut Scratch<'_>, to_velocity: Real) {
    for (index, cloth) in s.cloths.iter().enumerate().filter(|(_, cloth)| cloth.is_free()) {
        let range = per_cloth::range(s.cloths, index);
        let x = s.stage_positions.rounded.part(range.clone());
        let [momentum, moment] = cloth.wrench(x, s.gradient.part(range.clone()));
        let left = cloth.body.with_momentum(momentum, moment * cloth.radius);
        let [drift, turn] = [left.drift, left.velocity].map(|of| vec3(of.into()) * to_velocity);
        for (change, &x) in s.velocity_changes.part_mut(range).iter_mut().zip(x) {
            *change += drift + turn.cross(cloth.arm(x) * cloth.radius as Real);
        }
    }
}

impl Iterate<'_, '_> {
    /// Writes the direction in which free cloths move as a whole, so that no momentum and no moment
    /// is left. Returns whether any cloth moves.
    #[cfg_attr(small, optimize(size))]
    #[inline(never)]
    pub(super) fn aim(&mut self, term: &dyn ConvexTerm) -> bool {
        let moves = |i: &Self, index: usize, cloth: &ClothSolve| {
            cloth.is_free() && (term.is_zero() || !i.leaves_little(index, UNBALANCED))
        };
        if !self.cloths.iter().enumerate().any(|(index, cloth)| moves(self, index, cloth)) {
            return false;
        }
        per_cloth::write_blocks(self.cloths, self.positions, term);
        self.slope = 0.0;
        for (index, cloth) in self.cloths.iter().enumerate() {
            let range = per_cloth::range(self.cloths, index);
            if !moves(self, index, cloth) {
                self.direction.part_mut(range).fill(Vec3::ZERO);
                continue;
            }
            let x = self.positions.part(range.clone());
            let left = cloth.wrench(x, self.residual.part(range.clone()));
            let motion = [0, 1].map(|k| cloth.blocks.at(k).inverse() * vec3(left.at(k).into()));
            let motion = motion.map(|of| if of.is_finite() { of } else { Vec3::ZERO });
            for (direction, &x) in self.direction.part_mut(range).iter_mut().zip(x) {
                *direction = motion[0] + motion[1].cross(cloth.arm(x));
            }
            self.slope += left.iter().zip(motion).map(|(left, of)| left.dot(DVec3::from(to_f64(of)))).sum::<Sum>();
        }
        true
    }

    /// Moves along the direction. Returns the squared norm of the new residual.
    #[cfg_attr(small, optimize(size))]
    #[inline(never)]
    pub(super) fn translate(
        &mut self,
        term: &mut dyn ConvexTerm,
        statistics: &mut IntegratorStatistics,
        dispatch: &impl Dispatch,
    ) -> Sum {
        statistics.matrix_products += 1;
        let curvature = self.multiply_rigid(dispatch);
        if let Some(length) = self.search(term, curvature) {
            self.advance(term, length, dispatch);
        }
        self.gradient(term, dispatch)
    }

    /// Writes the product of the matrix with such a direction. Returns the curvature along it. Where the elasticity is only
    /// rounding it counts as zero: beside it a stiff cloth would lose its masses.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn multiply_rigid(&mut self, dispatch: &impl Dispatch) -> Sum {
        let Self { system, direction, product, partials, .. } = self;
        let direction = &**direction;
        let [curvature, _] = sum_parts(product, partials, dispatch, |range, q| {
            matrix::multiply_rows(system.matrix, system.masses, 0.0, direction, range.start, q);
            let direction = direction.part(range.clone());
            let offsets = system.matrix.offsets.part(range.clone());
            let rows = offsets.iter().zip(system.masses.part(range)).zip(direction);
            for (q, ((&first, &mass), &p)) in q.iter_mut().zip(rows) {
                let Some(diagonal) = system.matrix.blocks.element(first as usize) else { continue };
                let own = matrix::to_mat3(diagonal).abs() * p.abs();
                let rounding = ROUNDED * Real::EPSILON * own.max_element();
                let elastic = if q.abs().max_element() < rounding { Vec3::ZERO } else { *q };
                *q = elastic + p * mass;
            }
            [dot(direction, q), 0.0]
        });
        system.pins.filter(product);
        curvature
    }
}
