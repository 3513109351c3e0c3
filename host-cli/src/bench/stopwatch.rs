//! A pool that keeps a clock for each stage.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use muslin_core::dispatch::{Dispatch, Split};
use muslin_core::stage::Stage;

use crate::pool::Pool;

/// Runs kernels on a pool and adds up the time between changes of stage.
pub struct Stopwatch<'a> {
    pool: &'a Pool,
    clock: Mutex<Clock>,
}

struct Clock {
    since: Option<(Stage, Instant)>,
    times: Vec<(Stage, Duration)>,
}

impl Clock {
    fn stop(&mut self) {
        let Some((stage, since)) = self.since.take() else { return };
        match self.times.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, time)) => *time += since.elapsed(),
            None => self.times.push((stage, since.elapsed())),
        }
    }
}

impl<'a> Stopwatch<'a> {
    /// A stopped watch.
    pub fn new(pool: &'a Pool) -> Self {
        Self { pool, clock: Mutex::new(Clock { since: None, times: Vec::new() }) }
    }

    /// Forgets all times.
    pub fn reset(&self) {
        self.with(|clock| (clock.since, clock.times) = (None, Vec::new()));
    }

    /// Stops until the next stage is entered.
    pub fn pause(&self) {
        self.with(Clock::stop);
    }

    /// Time in each stage, in the order in which they were first entered.
    pub fn times(&self) -> Vec<(Stage, Duration)> {
        self.with(|clock| clock.times.clone())
    }

    fn with<R>(&self, act: impl FnOnce(&mut Clock) -> R) -> R {
        act(&mut self.clock.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}

impl Dispatch for Stopwatch<'_> {
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        self.pool.run(out, kernel);
    }

    fn enter(&self, stage: Stage) {
        self.with(|clock| {
            clock.stop();
            clock.since = Some((stage, Instant::now()));
        });
    }
}
