//! A dispatcher that measures the time of each stage and can stop a step.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch};
use muslin_core::dispatch as single;
use muslin_core::stage::{Stage, Term};
use muslin_core_f64::dispatch as double;
use muslin_core_f64::stage as double_stage;

use crate::pool::Pool;

/// Runs kernels on a pool, and adds up the time of each stage.
pub struct Stopwatch<'a> {
    pool: &'a Pool,
    stop: Option<&'a AtomicBool>,
    deadline: Option<Instant>,
    clock: Mutex<Clock>,
}

struct Clock {
    since: Option<(Stage, Instant)>,
    times: Vec<(Stage, Duration)>,
}

impl Clock {
    fn stop(&mut self, now: Instant) {
        let Some((stage, since)) = self.since.take() else { return };
        let passed = now - since;
        match self.times.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, time)) => *time += passed,
            None => self.times.push((stage, passed)),
        }
    }

    fn enter(&mut self, stage: Stage) {
        if self.since.is_none_or(|(current, _)| current != stage) {
            let now = Instant::now();
            self.stop(now);
            self.since = Some((stage, now));
        }
    }
}

impl<'a> Stopwatch<'a> {
    /// A stopped watch.
    pub fn new(pool: &'a Pool) -> Self {
        Self { pool, stop: None, deadline: None, clock: Mutex::new(Clock { since: None, times: Vec::new() }) }
    }

    /// The same stopwatch, which stops a step when the flag is raised.
    pub fn until(self, stop: &'a AtomicBool) -> Self {
        Self { stop: Some(stop), ..self }
    }

    /// The same stopwatch, which stops a step once the time `left` has passed from now. There is no deadline if
    /// the clock cannot represent it.
    pub fn within(self, left: Duration) -> Self {
        Self { deadline: Instant::now().checked_add(left), ..self }
    }

    fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
            || self.deadline.is_some_and(|deadline| Instant::now() > deadline)
    }

    /// Forgets all times.
    pub fn reset(&self) {
        self.with(|clock| (clock.since, clock.times) = (None, Vec::new()));
    }

    /// Stops the clock until the next stage is entered.
    pub fn pause(&self) {
        self.with(|clock| clock.stop(Instant::now()));
    }

    /// Time in each stage, in the order in which they were first entered.
    pub fn times(&self) -> Vec<(Stage, Duration)> {
        self.with(|clock| clock.times.clone())
    }

    /// Time in one stage.
    pub fn time(&self, stage: Stage) -> Duration {
        self.with(|clock| clock.times.iter().find(|(known, _)| *known == stage).map_or(Duration::ZERO, |&(_, t)| t))
    }

    fn with<R>(&self, act: impl FnOnce(&mut Clock) -> R) -> R {
        act(&mut self.clock.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}

impl single::Dispatch for Stopwatch<'_> {
    fn run<S: single::Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        single::Dispatch::run(self.pool, out, kernel);
    }

    async fn detect(&self, model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<Counts> {
        self.pool.detector()?.detect(model, contact).await
    }

    fn enter(&self, stage: Stage) {
        self.with(|clock| clock.enter(stage));
    }

    fn stopped(&self) -> bool {
        self.is_stopped()
    }
}

impl double::Dispatch for Stopwatch<'_> {
    fn run<S: double::Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        double::Dispatch::run(self.pool, out, kernel);
    }

    fn enter(&self, stage: double_stage::Stage) {
        self.with(|clock| clock.enter(same(stage)));
    }

    fn stopped(&self) -> bool {
        self.is_stopped()
    }
}

/// The single-precision stage of the same name: both cores compile the same sources.
fn same(stage: double_stage::Stage) -> Stage {
    use double_stage::Stage as Double;
    match stage {
        Double::Force(term) => Stage::Force(Term::ALL[term as usize]),
        Double::Jacobian(term) => Stage::Jacobian(Term::ALL[term as usize]),
        Double::Solve => Stage::Solve,
        Double::BroadPhase => Stage::BroadPhase,
        Double::NarrowPhase => Stage::NarrowPhase,
        Double::Response => Stage::Response,
        Double::Integrate => Stage::Integrate,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_watch_stops_at_its_flag_and_at_its_deadline() {
        let pool = Pool::new(Some(1)).unwrap();
        let flag = AtomicBool::new(false);
        let watch = || Stopwatch::new(&pool).until(&flag);
        assert!(!watch().is_stopped() && !watch().within(Duration::MAX).is_stopped());
        assert!(watch().within(Duration::ZERO).is_stopped());
        flag.store(true, Ordering::Relaxed);
        assert!(watch().is_stopped());
    }

    #[test]
    fn terms_are_the_same_in_both_precisions() {
        for (term, double) in Term::ALL.into_iter().zip(double_stage::Term::ALL) {
            assert_eq!(same(double_stage::Stage::Force(double)), Stage::Force(term));
            assert_eq!(term.name(), double.name());
        }
    }
}
