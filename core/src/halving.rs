//! Substeps: a step that fails, or whose error is too large, is divided into halves, and each half again if it fails.
//!
//! With a largest error ([`Scheme::error`](crate::integrate::Scheme::error)) the length of the substeps follows the
//! estimated error: it is doubled where the error is below a quarter of the largest, because the error of backward
//! Euler grows with the square of the length. The next step starts with the length of the last substep. Without a
//! largest error, each step is first tried whole. A scene may forbid that its steps are divided
//! ([`ContactDesc::halving`](crate::scene::ContactDesc::halving)): then the whole step is the shortest substep.

use crate::integrate::IntegratorStatistics;
use crate::real::{Real, Sum};
use crate::refusal::{Cause, Obstacle};
use crate::response::ContactStatistics;

/// Largest number of halvings. In the shortest substeps vertices that still collide are held back, and every error is
/// accepted.
pub(crate) const MOST_HALVINGS: u32 = 6;

/// How often steps may be halved, if at all.
pub(crate) fn most_halvings(divides: bool) -> u32 {
    if divides { MOST_HALVINGS } else { 0 }
}

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
    /// Whether every error is accepted and the response may hold vertices back.
    pub is_last_resort: bool,
}

/// The values that the division of steps reads and writes.
pub(crate) struct Progress<'a> {
    /// How often the substeps are halved.
    pub halvings: &'a mut u32,
    /// How often they may be: [`MOST_HALVINGS`], or 0 in a scene whose steps are not divided.
    pub most: u32,
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

    /// Keeps a copy of the state.
    fn keep(&mut self);

    /// Goes back to the copy.
    fn put_back(&mut self);
}

/// A step, taken in as many substeps as necessary. A step that fails does not change the state.
pub(crate) struct Division {
    /// Sum of the lengths of the substeps taken, in the shortest ones.
    done: u32,
    /// Before the step.
    halvings: u32,
    estimate: Option<Real>,
}

impl Division {
    /// Length of the step, in the shortest substeps.
    const WHOLE: u32 = 1 << MOST_HALVINGS;

    pub fn begin(owner: &mut impl Divided) -> Self {
        let Progress { halvings, estimate, .. } = owner.progress();
        Self { done: 0, halvings: *halvings, estimate: estimate.take() }
    }

    /// The next substep, if any is left.
    pub fn next(&self, owner: &mut impl Divided) -> Option<Substep> {
        let Progress { halvings, most, limit, .. } = owner.progress();
        if self.done >= Self::WHOLE {
            if limit.is_none() {
                *halvings = 0;
            }
            return None;
        }
        let (halvings, length) = (*halvings, Self::WHOLE >> *halvings);
        // A step that is tried whole does not change the state until it succeeds.
        if self.done == 0 && halvings > 0 {
            owner.keep();
        }
        let [from, length] = [self.done, length].map(|part| Sum::from(part) / Sum::from(Self::WHOLE));
        Some(Substep { from, length, is_last_resort: halvings == most })
    }

    /// Notes the result of the substep: its estimated error, m, if there is a largest one.
    pub fn note(&mut self, owner: &mut impl Divided, taken: Result<Option<Real>, Obstacle>) -> Result<(), Obstacle> {
        let mut progress = owner.progress();
        match taken {
            Ok(error) => {
                let length = Self::WHOLE >> *progress.halvings;
                self.done += length;
                progress.accept(error, self.done.is_multiple_of(2 * length));
            }
            Err(obstacle) if *progress.halvings < progress.most && obstacle.cause.asks_for_shorter_step() => {
                progress.halve(obstacle.cause);
            }
            Err(obstacle) => {
                if self.done > 0 {
                    owner.put_back();
                }
                let Progress { halvings, estimate, .. } = owner.progress();
                (*halvings, *estimate) = (self.halvings, self.estimate);
                return Err(obstacle);
            }
        }
        Ok(())
    }
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
