//! Substeps: a step that fails, or whose error is too large, is divided into halves, and each half again if it fails.
//!
//! With a largest error ([`Scheme::error`](crate::integrate::Scheme::error)) the length of the substeps follows the
//! estimated error: it is doubled where the error is below a quarter of the largest, because the error of backward
//! Euler grows with the square of the length. The next step starts with the length of the last substep. Without a
//! largest error, each step is first tried whole.

use alloc::vec::Vec;

use super::{Simulation, State, StepError, Substep};
use crate::contact::ContactScratchColumns;
use crate::dispatch::Dispatch;
use crate::implicit_contact::multiplier::Multiplier;
use crate::particles::ParticleColumns;
use crate::reactions::ReactionColumns;
use crate::real::{Real, Sum, Vec3};
use crate::refusal::{Cause, Obstacle};
use crate::step::History;
use crate::work_done::WorkDone;

/// Largest number of halvings. In the shortest substeps vertices that still collide are held back, and every error is
/// accepted.
pub(super) const MOST_HALVINGS: u32 = 6;

/// The error below which substeps get twice as long, relative to the largest one.
const SMALL_ERROR: Real = 0.25;

/// Copy of the [`State`] before a step that is divided. The columns are allocated once.
#[derive(Clone, Debug, Default)]
pub(super) struct Kept {
    columns: [Vec<Vec3>; 6],
    multipliers: Vec<Multiplier>,
    history: History,
    work_done: WorkDone,
    pub(super) reactions: ReactionColumns,
}

impl Kept {
    /// Allocates columns with the lengths of the given ones and room for so many multipliers.
    pub fn build(positions: &[Vec3], previous: &[Vec3], multipliers: usize) -> Self {
        let multipliers = Vec::with_capacity(multipliers);
        Self {
            multipliers,
            columns: [positions, positions, positions, positions, previous, previous].map(<[Vec3]>::to_vec),
            ..Self::default()
        }
    }

    /// Size of the columns, bytes.
    pub fn bytes(&self) -> usize {
        let multipliers = self.multipliers.capacity() * size_of::<Multiplier>();
        let columns = self.columns.iter().map(|column| size_of_val(&column[..])).sum::<usize>();
        columns + multipliers + self.reactions.bytes()
    }
}

impl Simulation {
    /// Takes a step, in as many substeps as necessary.
    pub(super) async fn take_substeps<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), StepError> {
        let begun = self.halvings;
        let taken = self.advance(dispatch).await;
        if taken.is_err() {
            self.halvings = begun;
        }
        taken.map_err(|obstacle| self.diverged(obstacle, dispatch))
    }

    /// Takes the substeps. Restores the state if one fails.
    async fn advance<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), Obstacle> {
        let whole = 1u32 << MOST_HALVINGS;
        let mut done = 0;
        self.estimate = None;
        while done < whole {
            let length = whole >> self.halvings;
            // A step that is tried whole does not change the state until it succeeds.
            if done == 0 && self.halvings > 0 {
                self.keep();
            }
            let substep = Substep { from: done as Sum / whole as Sum, length: length as Sum / whole as Sum };
            match self.try_substep(substep, self.halvings == MOST_HALVINGS, dispatch).await {
                Ok(error) => {
                    done += length;
                    self.estimate = self.estimate.into_iter().chain(error).reduce(Real::max);
                    let limited = error.zip(self.scheme.error);
                    self.statistics.exceeding += u64::from(limited.is_some_and(|(error, most)| error > most));
                    let may_grow = limited.is_none_or(|(error, most)| error < SMALL_ERROR * most);
                    self.halvings -= u32::from(may_grow && self.halvings > 0 && done % (2 * length) == 0);
                }
                Err(obstacle) if self.halvings < MOST_HALVINGS && obstacle.cause.asks_for_shorter_step() => {
                    self.halve(obstacle.cause);
                }
                Err(obstacle) => {
                    if done > 0 {
                        self.put_back();
                    }
                    return Err(obstacle);
                }
            }
        }
        if self.scheme.error.is_none() {
            self.halvings = 0;
        }
        Ok(())
    }

    /// Makes substeps half as long.
    fn halve(&mut self, cause: Cause) {
        self.contact_statistics.rejected += u64::from(cause != Cause::Inaccurate);
        self.halvings += 1;
        self.statistics.most_halvings = self.statistics.most_halvings.max(self.halvings.into());
    }

    fn keep(&mut self) {
        let Self { built, scratch, contact, kept, reactions, .. } = self;
        let ParticleColumns { positions, velocities, low_positions, low_velocities, .. } = &built.particles;
        let previous = [&scratch.previous_displacements, &scratch.previous_velocity_changes];
        let own = [positions, velocities, low_positions, low_velocities, previous[0], previous[1]];
        for (kept, own) in kept.columns.iter_mut().zip(own) {
            kept.copy_from_slice(own);
        }
        kept.multipliers.clear();
        kept.multipliers.extend_from_slice(contact.as_ref().map_or(&[], ContactScratchColumns::multipliers));
        (kept.history, kept.work_done) = (self.history, self.work_done);
        if let Some(reactions) = reactions {
            kept.reactions.copy_from(reactions);
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn put_back(&mut self) {
        let kept = core::mem::take(&mut self.kept);
        let [positions, velocities, low_positions, low_velocities, previous @ ..] =
            kept.columns.each_ref().map(|column| &column[..]);
        let (multipliers, low) = (&kept.multipliers[..], [low_positions, low_velocities]);
        let state = State { positions, velocities, low, previous, multipliers, anchors: &[], ..self.state() };
        self.restore(&state, self.statistics, self.contact_statistics);
        (self.history, self.work_done) = (kept.history, kept.work_done);
        if let Some(reactions) = &mut self.reactions {
            reactions.copy_from(&kept.reactions);
        }
        self.kept = kept;
        // Those that began at the start of this step.
        self.change_pins();
    }
}
