//! Where a solve stops: at the preconditioned residual of every cloth and, with contacts, when little momentum and angular
//! momentum is left. Beside the residual of a heavy cloth, that of a light one would not count.

use super::Method;
use super::conjugate_gradient::Iterate;
use super::per_cloth;
use crate::column::Column;
use crate::real::Sum;

/// Limit of iterations. A solve that reaches it is counted as unconverged.
const MOST_ITERATIONS: u32 = 20_000;

/// Limit of iterations of a solve with contacts. The response corrects a solve that reaches it. In single precision, a
/// solve of cloth that is stretched a thousandfold may never converge.
const MOST_WITH_CONTACTS: u32 = 2_000;

/// Relative residual that a solve within a velocity reaches at least. In short steps from rest the whole solution can
/// be less than the velocity: without this the cloth would hover.
const ROUGHLY: Sum = 0.1;

/// The same for implicit midpoint, which does not damp what solves leave: rounding would make free cloth ring.
const UNDAMPED: Sum = 0.01;

/// The same as [`ROUGHLY`] without patches, whose motions [complete](Iterate::complete) the solution.
const WITHOUT_PATCHES: Sum = 1e-3;

/// Momentum that a solve with contacts may leave of a free cloth, relative to the impulse of its contacts. The next
/// solve [takes it up](super::rigid_motions::pass_on).
pub(super) const UNBALANCED: Sum = 0.03;

/// The same after the last updates of the bounds of friction.
pub(super) const ROUGHLY_BALANCED: Sum = 0.1;

/// The same of a cloth that pins hold: it is lost.
const HELD: Sum = 0.01;

/// Square of the velocity that it may leave of a cloth in any case, relative to the square of the goal's velocity.
const SLOWLY: Sum = 1e-3;

/// When a solve stops.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Goal {
    /// At the preconditioned residual of the start times this.
    Reduce(Sum),
    /// At this square of a velocity, m^2/s^2, and at a [rough](ROUGHLY) relative residual. The kinetic energy of the error
    /// of the velocities is at most half of the preconditioned residual.
    Within(Sum),
    /// At the squared residual of the solve before times this, by its preconditioner. It goes on with that solve.
    Reach(Sum),
    /// After so many iterations, by the preconditioner of the solve before.
    Iterations(u32),
}

impl Goal {
    /// Whether the solve has a preconditioner and targets of its own, not those of the solve before.
    pub(super) fn is_new(self) -> bool {
        matches!(self, Self::Reduce(_) | Self::Within(_))
    }

    /// Limit of iterations.
    pub(super) fn most_iterations(self, has_contacts: bool) -> u32 {
        match self {
            Self::Iterations(most) => most,
            Self::Reduce(_) | Self::Within(_) | Self::Reach(_) if has_contacts => MOST_WITH_CONTACTS,
            Self::Reduce(_) | Self::Within(_) | Self::Reach(_) => MOST_ITERATIONS,
        }
    }
}

impl Iterate<'_, '_> {
    /// The product of the residual with the preconditioned residual over a cloth.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn norm(&self, index: usize) -> Sum {
        let cloth = per_cloth::range(self.cloths, index);
        per_cloth::product(self.residual.part(cloth.clone()), self.preconditioned.part(cloth))
    }

    /// Notes the residual without contacts as the reference for where a solve stops.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(super) fn set_references(&mut self) {
        for index in 0..self.cloths.len() {
            let norm = self.norm(index);
            if let Some(cloth) = self.cloths.element_mut(index) {
                cloth.target = norm;
            }
        }
    }

    /// Writes where the solve stops.
    #[cfg_attr(small, optimize(size))]
    #[inline(never)]
    pub(super) fn set_targets(&mut self, goal: Goal, method: Method) {
        let least = match method {
            _ if self.preconditioner.coarse.is_none() => WITHOUT_PATCHES,
            Method::ImplicitMidpoint => UNDAMPED,
            _ => ROUGHLY,
        };
        if goal.is_new() {
            for index in 0..self.cloths.len() {
                let norm = self.norm(index);
                if let Some(cloth) = self.cloths.element_mut(index) {
                    cloth.target = cloth.target.max(norm);
                }
            }
            per_cloth::raise_quiet(self.cloths);
        }
        for cloth in &mut *self.cloths {
            cloth.target = match goal {
                Goal::Reduce(tolerance) => cloth.target * tolerance * tolerance,
                Goal::Within(square) => (cloth.body.mass * square).min(cloth.target * least * least),
                Goal::Reach(part) => cloth.target * part,
                Goal::Iterations(_) => 0.0,
            };
        }
    }

    /// Whether the preconditioned residual of every cloth is below a multiple of its target; `rho` is that of all.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(super) fn is_within(&self, rho: Sum, factor: Sum) -> bool {
        let target: Sum = self.cloths.iter().map(|cloth| cloth.target).sum();
        let mut all = self.cloths.iter().enumerate();
        rho <= factor * target && (all.len() == 1 || all.all(|(k, cloth)| self.norm(k) <= factor * cloth.target))
    }

    /// Whether the residual leaves little momentum of every cloth, and little angular momentum of every free one.
    #[cfg_attr(small, optimize(size))]
    #[inline(never)]
    pub(super) fn is_balanced(&self, unbalanced: Sum) -> bool {
        (0..self.cloths.len()).all(|index| self.leaves_little(index, unbalanced))
    }

    /// The same of one cloth.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(super) fn leaves_little(&self, index: usize, unbalanced: Sum) -> bool {
        let Some(cloth) = self.cloths.element(index) else { return true };
        let range = per_cloth::range(self.cloths, index);
        let [left, elastic] = [&*self.residual, &*self.elastic]
            .map(|column| cloth.wrench(self.positions.part(range.clone()), column.part(range.clone())));
        let impulses = [0, 1].map(|k| (left.at(k) - elastic.at(k)).length_squared());
        // Moments that cancel are as inexact as their forces.
        let impulses = [impulses[0], impulses[0] + impulses[1]];
        let is_little = |k: usize, part: Sum| {
            left.at(k).length_squared() <= part * part * impulses.at(k) + SLOWLY * cloth.target * cloth.body.mass
        };
        if cloth.is_free() { is_little(0, unbalanced) && is_little(1, unbalanced) } else { is_little(0, HELD) }
    }
}
