//! Substeps: a step that fails, or whose error is too large, is divided into halves, and each half again if it fails.
//!
//! With a largest error ([`Scheme::error`](crate::integrate::Scheme::error)) the length of the substeps follows the
//! estimated error: it is doubled where the error is below a quarter of the largest, because the error of backward
//! Euler grows with the square of the length. The next step starts with the length of the last substep. Without a
//! largest error, each step is first tried whole.

use crate::dispatch::Dispatch;
use crate::integrate::IntegratorStatistics;
use crate::real::{Real, Sum};
use crate::refusal::{Cause, Obstacle};
use crate::response::ContactStatistics;

/// Largest number of halvings. In the shortest substeps vertices that still collide are held back, and every error is
/// accepted.
pub(crate) const MOST_HALVINGS: u32 = 6;

/// The error below which substeps get twice as long, relative to the largest one.
const SMALL_ERROR: Real = 0.25;

/// A part of a step. A step is divided into halves if it cannot be made free of intersections or its error is too
/// large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substep {
    /// Start, as a fraction of the step, 0..1.
    pub from: Sum,
    /// Length, as a fraction of the step, 0..1.
    pub length: Sum,
}

/// The values that the division of steps reads and writes.
pub(crate) struct Progress<'a> {
    /// How often the substeps are halved.
    pub halvings: &'a mut u32,
    /// The largest estimated error of a substep of this step, m.
    pub estimate: &'a mut Option<Real>,
    /// The largest error of a substep, m.
    pub limit: Option<Real>,
    pub statistics: &'a mut IntegratorStatistics,
    pub contact_statistics: &'a mut ContactStatistics,
}

/// An owner of a state that takes substeps.
pub(crate) trait Divided {
    fn progress(&mut self) -> Progress<'_>;

    /// Takes a substep and returns its estimated error, m, if there is a largest one. `last_resort` accepts every error
    /// and allows the response to hold vertices back.
    async fn try_substep<D: Dispatch>(
        &mut self,
        substep: Substep,
        last_resort: bool,
        dispatch: &D,
    ) -> Result<Option<Real>, Obstacle>;

    /// Keeps a copy of the state.
    fn keep(&mut self);

    /// Goes back to the copy.
    fn put_back(&mut self);
}

/// Takes a step, in as many substeps as necessary. A step that fails does not change the state.
pub(crate) async fn take_substeps<S: Divided, D: Dispatch>(owner: &mut S, dispatch: &D) -> Result<(), Obstacle> {
    let Progress { halvings, estimate, .. } = owner.progress();
    let before = (*halvings, *estimate);
    let taken = advance(owner, dispatch).await;
    if taken.is_err() {
        let Progress { halvings, estimate, .. } = owner.progress();
        (*halvings, *estimate) = before;
    }
    taken
}

async fn advance<S: Divided, D: Dispatch>(owner: &mut S, dispatch: &D) -> Result<(), Obstacle> {
    let whole = 1u32 << MOST_HALVINGS;
    let mut done = 0;
    *owner.progress().estimate = None;
    while done < whole {
        let halvings = *owner.progress().halvings;
        let length = whole >> halvings;
        // A step that is tried whole does not change the state until it succeeds.
        if done == 0 && halvings > 0 {
            owner.keep();
        }
        let substep = Substep { from: done as Sum / whole as Sum, length: length as Sum / whole as Sum };
        let taken = owner.try_substep(substep, halvings == MOST_HALVINGS, dispatch).await;
        let mut progress = owner.progress();
        match taken {
            Ok(error) => {
                done += length;
                progress.accept(error, done % (2 * length) == 0);
            }
            Err(obstacle) if halvings < MOST_HALVINGS && obstacle.cause.asks_for_shorter_step() => {
                progress.halve(obstacle.cause);
            }
            Err(obstacle) => {
                if done > 0 {
                    owner.put_back();
                }
                return Err(obstacle);
            }
        }
    }
    let progress = owner.progress();
    if progress.limit.is_none() {
        *progress.halvings = 0;
    }
    Ok(())
}

impl Progress<'_> {
    /// Notes the error of a substep. The next one may be twice as long if this one was the second half.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn accept(&mut self, error: Option<Real>, was_second: bool) {
        let most = *self.estimate;
        *self.estimate = most.into_iter().chain(error).reduce(Real::max);
        let limited = error.zip(self.limit);
        self.statistics.exceeding += u64::from(limited.is_some_and(|(error, most)| error > most));
        let may_grow = limited.is_none_or(|(error, most)| error < SMALL_ERROR * most);
        *self.halvings -= u32::from(may_grow && *self.halvings > 0 && was_second);
    }

    /// Makes substeps half as long.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn halve(&mut self, cause: Cause) {
        self.contact_statistics.rejected += u64::from(cause != Cause::Inaccurate);
        *self.halvings += 1;
        self.statistics.most_halvings = self.statistics.most_halvings.max((*self.halvings).into());
    }
}
