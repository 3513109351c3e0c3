//! Substeps: a step that fails is divided into halves, and each half again if it fails.

use alloc::vec::Vec;

use super::{Simulation, State, StepError, Substep};
use crate::contact::ContactScratchColumns;
use crate::dispatch::Dispatch;
use crate::implicit_contact::multiplier::Multiplier;
use crate::real::{Sum, Vec3};
use crate::step::History;

/// Largest number of halvings. In the shortest substeps vertices that still collide are held back.
const MOST_HALVINGS: u32 = 6;

/// Copy of the [`State`] before a step that is taken in halves. The columns are allocated once.
#[derive(Clone, Debug, Default)]
pub(super) struct Kept {
    columns: [Vec<Vec3>; 4],
    multipliers: Vec<Multiplier>,
    history: History,
}

impl Kept {
    /// Allocates columns with the lengths of the given ones and room for so many multipliers.
    pub fn build(positions: &[Vec3], previous: &[Vec3], multipliers: usize) -> Self {
        let multipliers = Vec::with_capacity(multipliers);
        Self {
            multipliers,
            columns: [positions, positions, previous, previous].map(<[Vec3]>::to_vec),
            ..Self::default()
        }
    }

    /// Size of the columns, bytes.
    pub fn bytes(&self) -> usize {
        let multipliers = self.multipliers.capacity() * size_of::<Multiplier>();
        self.columns.iter().map(|column| size_of_val(&column[..])).sum::<usize>() + multipliers
    }
}

impl Simulation {
    /// Takes a step in substeps, each halved as often as necessary. Restores the state if that fails.
    pub(super) async fn step_in_halves<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), StepError> {
        self.keep();
        let taken = self.halves(dispatch).await;
        if taken.is_err() {
            self.put_back();
        }
        taken
    }

    async fn halves<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), StepError> {
        self.contact_statistics.rejected += 1;
        let whole = 1u32 << MOST_HALVINGS;
        let (mut done, mut halvings) = (0, 1);
        if self.history == History::Start {
            self.history = History::Cut;
        }
        while done < whole {
            let length = whole >> halvings;
            let part = Substep { from: done as Sum / whole as Sum, length: length as Sum / whole as Sum };
            self.history.cut();
            match self.try_part(part, halvings == MOST_HALVINGS, dispatch).await {
                Ok(()) => {
                    done += length;
                    halvings -= u32::from(done % (2 * length) == 0);
                }
                Err(cannot) if halvings < MOST_HALVINGS && cannot.cause.asks_for_shorter_step() => {
                    self.contact_statistics.rejected += 1;
                    halvings += 1;
                }
                Err(cannot) => return Err(cannot),
            }
        }
        self.history.cut();
        Ok(())
    }

    fn keep(&mut self) {
        let Self { built, scratch, contact, kept, .. } = self;
        let particles = &built.particles;
        let own =
            [&particles.positions, &particles.velocities, &scratch.previous_positions, &scratch.previous_velocities];
        for (kept, own) in kept.columns.iter_mut().zip(own) {
            kept.copy_from_slice(own);
        }
        kept.multipliers.clear();
        kept.multipliers.extend_from_slice(contact.as_ref().map_or(&[], ContactScratchColumns::multipliers));
        kept.history = self.history;
    }

    fn put_back(&mut self) {
        let kept = core::mem::take(&mut self.kept);
        let [positions, velocities, previous @ ..] = kept.columns.each_ref().map(|column| &column[..]);
        let (after_contact, multipliers) = (false, &kept.multipliers[..]);
        let state = State { steps: self.steps, positions, velocities, previous, after_contact, multipliers };
        self.restore(&state, self.statistics, self.contact_statistics);
        self.history = kept.history;
        self.kept = kept;
    }
}
