//! The steps of a scene from its start to its end, and the observations made on the way: a run without its files.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use muslin_core::diagnostics::extent;
use muslin_core::integrate::stability::Mode;
use muslin_core::scene::{SceneDesc, Timing};
use muslin_core::stage::Stage;

use super::start::fastest_modes;
use crate::args::Precision;
use crate::checkpoint::Resumed;
use crate::divergence::Divergence;
use crate::engine::{Engine, Halt};
use crate::failure::Failure;
use crate::pool::Pool;
use crate::record::{Record, Start};
use crate::stopwatch::Stopwatch;
use crate::units::without_noise;
use crate::warning::Warning;

/// Steps of an explicit method between two checks of the edge lengths: a check takes nearly as long as a step.
const LOOKS: u64 = 32;

/// How the steps ended.
pub enum Ending {
    /// At the end of the scene's duration, or at rest.
    Complete,
    /// A step could not be taken, or the cloth flew apart.
    Diverged(Divergence),
    /// The user interrupted the run.
    Interrupted,
}

/// Observer of a run.
pub trait Witness {
    /// Called at the start, and at the end of each frame.
    fn frame(&mut self, course: &Course) -> Result<(), Failure>;
    /// Called at the end of each step, after `frame`.
    fn step(&mut self, course: &Course) -> Result<(), Failure>;
}

/// An observer that does nothing.
impl Witness for () {
    fn frame(&mut self, _: &Course) -> Result<(), Failure> {
        Ok(())
    }

    fn step(&mut self, _: &Course) -> Result<(), Failure> {
        Ok(())
    }
}

/// Number of steps of the whole run.
pub fn total_steps(timing: &Timing) -> u64 {
    timing.frames * timing.steps_per_frame
}

/// A run in progress.
pub struct Course {
    /// The simulation.
    pub engine: Box<dyn Engine>,
    /// Numbers of frames and steps, and the length of a step.
    pub timing: Timing,
    /// Time of the last change that the scene schedules, s: it does not end at rest before.
    last_change: f64,
    /// Precision of the engine.
    pub precision: Precision,
    /// The hash chain over the first state and all steps.
    pub chain: u64,
    /// Steps taken.
    pub steps: u64,
    /// Frames observed, including those before a checkpoint.
    pub frames: u64,
    /// Positions of the last frame, m.
    pub positions: Vec<[f64; 3]>,
    /// Observations of the frames up to now.
    record: Record,
    /// Whether the warning on masses needs the fastest modes at the end, and these, once they are measured.
    pub(super) needs_modes: bool,
    pub(super) modes: Option<[Mode; 2]>,
    /// Warnings from before the first step.
    pub warnings: Vec<Warning>,
    /// Whether frames are tested for crossings.
    audit: bool,
    /// The step at which this process began; above 0 when resumed.
    pub(super) begun: u64,
    pub(super) stepping: Duration,
    /// Time in the broad phase, the narrow phase and the response.
    pub(super) contact: [Duration; 3],
    pub(super) output: Duration,
}

impl Course {
    /// Begins a run at the start of the scene, or at a checkpoint. `measures` reactions and all work if asked to.
    pub fn begin(
        mut engine: Box<dyn Engine>,
        scene: &SceneDesc,
        precision: Precision,
        [audit, measures]: [bool; 2],
        start: Start,
        resumed: Option<Resumed>,
    ) -> Self {
        let timing = scene.timing();
        let steps = engine.report().steps;
        let chain = resumed.as_ref().map_or_else(|| engine.chain(None), |resumed| resumed.chain);
        let frames = if resumed.is_some() { steps / timing.steps_per_frame + 1 } else { 0 };
        let mut positions = Vec::new();
        engine.write_state(&mut positions);
        let fresh = || Record {
            start,
            size: extent(positions.iter().copied()),
            first_stretch: engine.largest_stretch(),
            ..Record::default()
        };
        let mut record = resumed.as_ref().map_or_else(fresh, |resumed| resumed.record);
        record.measures_reactions = measures;
        // Without an audit, a frame whose audit was interrupted is not tested.
        record.awaits_audit &= audit;
        let needs_modes = precision == Precision::F32 && engine.is_implicit() && scene.integrator.error().is_some();
        engine.measure_work(record.balance.work);
        if measures {
            engine.measure_reactions();
            engine.set_impulses(&resumed.map(|resumed| resumed.impulses).unwrap_or_default());
        }
        let last_change = scene.last_change().max(engine.last_frame());
        Self {
            record,
            needs_modes,
            modes: None,
            warnings: Vec::new(),
            engine,
            timing,
            last_change,
            precision,
            chain,
            steps,
            frames,
            positions,
            audit,
            begun: steps,
            stepping: Duration::ZERO,
            contact: [Duration::ZERO; 3],
            output: Duration::ZERO,
        }
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        without_noise(self.steps as f64 * self.timing.step)
    }

    /// Observations of the run up to now.
    pub fn record(&self) -> Record {
        let mut record = self.record;
        record.balance.work = self.engine.work_done();
        record
    }

    /// Observes the state as a frame. The caller does this once at the start of a run that is not resumed.
    pub fn frame(&mut self, pool: &Pool, stop: &AtomicBool, witness: &mut impl Witness) -> Result<(), Failure> {
        let started = Instant::now();
        self.engine.write_state(&mut self.positions);
        let record = &mut self.record;
        record.stretch = record.stretch.max(self.engine.largest_stretch());
        record.balance.see(&self.engine.report().energy, self.engine.work_done());
        let [rotation, power] = self.engine.rotation();
        record.balance.see_rotation(rotation, power * self.timing.step * self.timing.steps_per_frame as f64);
        record.rounding = record.rounding.max(self.engine.rounding());
        record.penetration = self.engine.penetration().map(|now| now.max(record.penetration.unwrap_or(0.0)));
        record.awaits_audit = self.audit;
        self.audit(pool, stop);
        self.frames += 1;
        witness.frame(self)?;
        self.engine.set_impulses(&[]);
        self.output += started.elapsed();
        Ok(())
    }

    /// Audits the last frame, if that is still to be done. After an interrupt it still is.
    fn audit(&mut self, pool: &Pool, stop: &AtomicBool) {
        if !self.record.awaits_audit {
            return;
        }
        let count = self.engine.crossings(&Stopwatch::new(pool).until(stop)) as u64;
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let record = &mut self.record;
        record.awaits_audit = false;
        record.audited += 1;
        if record.crossings.is_none_or(|(worst, _)| count > worst) {
            record.crossings = Some((count, self.steps / self.timing.steps_per_frame));
        }
    }

    /// Whether the cloth came to rest in the frame that ends now; `None` if the run does not end there.
    pub fn is_at_rest(&self) -> Option<bool> {
        let Timing { steps_per_frame, step, until_rest, .. } = self.timing;
        let (frames, rest) = (self.steps / steps_per_frame, self.steps % steps_per_frame);
        let frame = step * steps_per_frame as f64;
        let ends_calm = frames > 0 && rest == 0 && (frames - 1) as f64 * frame >= self.last_change;
        until_rest.map(|speed| ends_calm && self.record.fastest < speed)
    }

    /// Observes the speed of the step just taken.
    fn see_speed(&mut self) {
        if self.timing.until_rest.is_some() {
            let frame_begins = (self.steps - 1).is_multiple_of(self.timing.steps_per_frame);
            let before = if frame_begins { 0.0 } else { self.record.fastest };
            self.record.fastest = self.engine.fastest().max(before);
        }
    }

    /// Steps until the end, a state at rest that ends the run, a divergence or an interrupt.
    pub fn advance(&mut self, pool: &Pool, stop: &AtomicBool, witness: &mut impl Witness) -> Result<Ending, Failure> {
        let stopwatch = Stopwatch::new(pool).until(stop);
        self.audit(pool, stop);
        // Before the steps, because nothing may fail between their end and the files.
        if self.needs_modes {
            let watch = Stopwatch::new(pool).until(stop);
            self.modes = fastest_modes(self.engine.as_ref(), self.positions.len(), self.precision, &watch);
            if stop.load(Ordering::Relaxed) {
                return Ok(Ending::Interrupted);
            }
        }
        while self.steps < total_steps(&self.timing) && self.is_at_rest() != Some(true) {
            if stop.load(Ordering::Relaxed) {
                return Ok(Ending::Interrupted);
            }
            let started = Instant::now();
            let stepped = self.engine.step(&stopwatch);
            stopwatch.pause();
            self.stepping += started.elapsed();
            self.contact = [Stage::BroadPhase, Stage::NarrowPhase, Stage::Response].map(|s| stopwatch.time(s));
            match stepped {
                Ok(()) => {}
                Err(Halt::Diverged(divergence)) => return Ok(Ending::Diverged(divergence)),
                Err(Halt::Stopped) => return Ok(Ending::Interrupted),
            }
            self.steps += 1;
            self.see_speed();
            self.chain = self.engine.chain(Some(self.chain));
            let frame_ends = self.steps.is_multiple_of(self.timing.steps_per_frame);
            let looks = frame_ends || self.engine.is_implicit() || self.steps.is_multiple_of(LOOKS);
            let flown_apart = || Divergence::of_stretch(self.engine.as_ref(), self.steps, self.record.first_stretch);
            if let Some(divergence) = looks.then(flown_apart).flatten() {
                return Ok(Ending::Diverged(divergence));
            }
            if frame_ends {
                self.frame(pool, stop, witness)?;
            }
            witness.step(self)?;
        }
        Ok(if self.record.awaits_audit { Ending::Interrupted } else { Ending::Complete })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{self, Snapshot};
    use crate::scene_file;

    /// A run of the start of `fold` that audits its frames, from the start or from a checkpoint.
    fn begin(audit: bool, resumed: Option<(Resumed, &Snapshot)>) -> Course {
        let scene = scene_file::load("fold", &["duration=0.1".into()]).unwrap();
        let (mut engine, _) = engine::build(&scene, Precision::F32).unwrap();
        let resumed = resumed.map(|(resumed, snapshot)| {
            assert!(engine.restore(snapshot));
            resumed
        });
        Course::begin(engine, &scene.desc, Precision::F32, [audit, false], Start::default(), resumed)
    }

    #[test]
    fn an_interrupted_audit_is_made_up_for_or_leaves_a_gap() {
        let pool = Pool::new(Some(1)).unwrap();
        let [go, stop] = [false, true].map(AtomicBool::new);
        for interrupts_the_last_frame in [false, true] {
            let mut course = begin(true, None);
            if interrupts_the_last_frame {
                course.frame(&pool, &go, &mut ()).unwrap();
                course.advance(&pool, &go, &mut ()).unwrap();
                // As if there was no audit of the last frame yet.
                course.record.audited -= 1;
                course.frames -= 1;
            }
            course.frame(&pool, &stop, &mut ()).unwrap();
            assert_eq!(course.record().audited, course.frames - 1, "an interrupted audit counts");
            assert!(matches!(course.advance(&pool, &stop, &mut ()), Ok(Ending::Interrupted)));
            let snapshot = course.engine.snapshot();
            for audit in [true, false] {
                let record = Record::decode(course.record().encode());
                let resumed = Resumed { chain: course.chain, record, impulses: Vec::new() };
                let mut course = begin(audit, Some((resumed, &snapshot)));
                assert!(matches!(course.advance(&pool, &go, &mut ()), Ok(Ending::Complete)));
                assert_eq!(course.record().audited == course.frames, audit, "frames that the resumed run audits");
            }
        }
    }

    #[test]
    fn an_interrupt_ends_the_measurement_of_modes() {
        let pool = Pool::new(Some(1)).unwrap();
        let [go, stop] = [false, true].map(AtomicBool::new);
        let mut course = begin(false, None);
        assert!(matches!(course.advance(&pool, &go, &mut ()), Ok(Ending::Complete)));
        // No step is left that could hear it.
        assert!(matches!(course.advance(&pool, &stop, &mut ()), Ok(Ending::Interrupted)));
    }
}
