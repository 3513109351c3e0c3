//! The input and output of the [passes](super) of a response: constraints, and the motion that the passes correct.

use super::constraint::{self, Constraint};
use super::{ContactStatistics, PASSES};
use crate::column::Column;
use crate::contact::ContactModel;
use crate::detection;
use crate::geometry::aabb::Aabb;
use crate::quicksort;
use crate::real::{Real, Vec3};

/// The input and output of a pass.
pub(crate) struct Work<'a> {
    pub model: &'a ContactModel<'a>,
    pub list: List<'a>,
    /// Number of constraints of near pairs, the first in the list.
    pub near: usize,
    /// Index of the first impact of the last search, which are the last in the list.
    pub first: usize,
    pub motion: Motion<'a>,
    /// The part of the displacements that changes no velocity, m.
    pub corrections: &'a mut [Vec3],
    /// Work columns, one entry per vertex.
    pub zones: &'a mut [u32],
    pub wanted: &'a mut [u32],
    /// Work column, one entry per constraint.
    pub order: &'a mut [u32],
    pub statistics: ContactStatistics,
}

impl Work<'_> {
    /// Runs the passes of the next round. Pairs that collided are tested again after it, whether or not a vertex moved.
    pub fn run_passes(&mut self) {
        self.motion.round += 1;
        let impacts = self.list.all.part(self.first..self.list.count);
        self.statistics.impacts += impacts.len() as u64;
        impacts.iter().for_each(|impact| self.motion.mark(impact));
        for (rounds, pass) in &PASSES {
            if rounds.contains(&self.motion.round) {
                pass(self);
            }
        }
    }
}

/// The constraints so far.
pub(crate) struct List<'a> {
    pub all: &'a mut [Constraint],
    pub count: usize,
    /// Number of pairs that touch and have no time of impact.
    pub touching: u64,
}

impl List<'_> {
    /// Adds a constraint. Without room it is only counted.
    pub fn push(&mut self, constraint: Constraint) {
        if let Some(slot) = self.all.get_mut(self.count) {
            *slot = constraint;
        }
        self.count += 1;
    }

    /// Sorts those from `first` on by their vertices: bits must not depend on the order of the candidates.
    pub fn sort_from(&mut self, first: usize) {
        if let Some(added) = self.all.get_mut(first..self.count) {
            quicksort::sort_by_key(added, |constraint| constraint::as_number(constraint.contact.vertices));
        }
    }

    /// The number of constraints; if there is no room for them, as an error.
    pub fn count(&self) -> Result<usize, usize> {
        if self.count > self.all.len() { Err(self.count) } else { Ok(self.count) }
    }
}

/// The motion that passes correct.
pub(crate) struct Motion<'a> {
    pub start: &'a mut [Vec3],
    pub end: &'a mut [Vec3],
    pub displacements: &'a mut [Vec3],
    /// Rotation of each collider, rad.
    pub turns: &'a [Vec3],
    pub rounds: &'a mut [u32],
    /// The present round, with which vertices that move are marked; 0 before the first.
    pub round: u32,
    pub step: Real,
}

impl Motion<'_> {
    /// Marks the vertices of a constraint as moved. Not inlined: many call it.
    #[inline(never)]
    pub fn mark(&mut self, constraint: &Constraint) {
        for v in constraint.contact.vertices {
            self.rounds.set(v as usize, self.round);
        }
    }

    /// The round whose moved vertices a search for impacts tests; 0: all, because the predicted motion moved them.
    pub fn tested(&self) -> u32 {
        if self.round == 1 { 0 } else { self.round }
    }

    /// Writes the end positions, rounded, of the vertices moved in this round. Displacements are not rounded: in f32,
    /// with short steps, the rounding errors are as large as the effect of friction.
    pub fn round_ends(&mut self) {
        let starts = self.start.iter().zip(&*self.displacements);
        for ((end, &round), (&start, &displacement)) in self.end.iter_mut().zip(&*self.rounds).zip(starts) {
            if round == self.round {
                *end = start + displacement;
            }
        }
    }

    /// Whether a vertex moved in this round has left its box, less the margin of the box. In the first round the
    /// implicit solve may have moved any vertex.
    pub fn leaves_boxes(&self, ends: &[Aabb], model: &ContactModel<'_>) -> bool {
        self.end.iter().zip(&*self.rounds).enumerate().any(|(v, (&end, &round))| {
            (self.round == 1 || round == self.round) && !detection::may_end(model, ends, v, end)
        })
    }
}

/// Solves constraints in their order until no constraint is violated by more than `tolerance`, m, or until the limit of
/// sweeps. Constraints that the implicit solve leaves within the tolerance keep their friction. To stop the slip that
/// the solve left, vertex by vertex, would disturb the balance with the elastic forces: cloth that friction holds would
/// creep.
pub(crate) fn relax(
    model: &ContactModel<'_>,
    constraints: &mut [Constraint],
    chosen: Option<&[u32]>,
    motion: &mut Motion<'_>,
    sweeps: u32,
    tolerance: Real,
) {
    let count = chosen.map_or(constraints.len(), <[u32]>::len);
    for _ in 0..sweeps {
        let mut worst: Real = 0.0;
        for k in 0..count {
            let index = chosen.map_or(k, |chosen| chosen.at(k) as usize);
            let Some(constraint) = constraints.element_mut(index) else { continue };
            let is_solved = constraint.is_solved.is_set() && constraint.is_within(tolerance, motion.displacements);
            constraint.is_solved = is_solved.into();
            let (violation, moved) = constraint::solve(constraint, &model.inverse_masses, motion.displacements);
            worst = worst.max(violation.abs());
            if moved {
                motion.mark(constraint);
            }
        }
        if worst <= tolerance {
            break;
        }
    }
}
