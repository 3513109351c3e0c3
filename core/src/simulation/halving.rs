//! A step that cannot be taken whole is taken in halves, and those in halves again.

use alloc::vec::Vec;

use super::{Diverged, Part, Simulation, State};
use crate::dispatch::Dispatch;
use crate::real::{Sum, Vec3};

/// How often a step is halved before what still meets is held back.
const MOST_HALVINGS: u32 = 6;

/// The state before a step that is taken in halves: as in [`State`].
struct Kept {
    columns: [Vec<Vec3>; 4],
    after_contact: bool,
}

impl Simulation {
    /// Takes a step in halves, as short as they must be; where that does not help the state is put
    /// back.
    pub(super) async fn step_in_halves<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), Diverged> {
        let kept = self.keep();
        let taken = self.halves(dispatch).await;
        if taken.is_err() {
            self.put_back(&kept);
        }
        taken
    }

    async fn halves<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), Diverged> {
        self.tally.rejected += 1;
        let whole = 1u32 << MOST_HALVINGS;
        let (mut done, mut halvings) = (0, 1);
        while done < whole {
            let length = whole >> halvings;
            let part = Part { from: done as Sum / whole as Sum, length: length as Sum / whole as Sum };
            match self.try_part(part, halvings == MOST_HALVINGS, dispatch).await {
                Ok(()) => {
                    done += length;
                    halvings -= u32::from(done % (2 * length) == 0);
                }
                Err(cannot) if halvings < MOST_HALVINGS && cannot.may_help() => {
                    self.tally.rejected += 1;
                    halvings += 1;
                }
                Err(cannot) => return Err(cannot),
            }
        }
        Ok(())
    }

    fn keep(&self) -> Kept {
        let State { positions, velocities, previous, after_contact, .. } = self.state();
        Kept { columns: [positions, velocities, previous[0], previous[1]].map(<[Vec3]>::to_vec), after_contact }
    }

    fn put_back(&mut self, kept: &Kept) {
        let [positions, velocities, before, rates] = kept.columns.each_ref().map(|column| &column[..]);
        let previous = [before, rates];
        let state = State { steps: self.steps, positions, velocities, previous, after_contact: kept.after_contact };
        self.restore(&state, self.work, self.tally);
    }
}
