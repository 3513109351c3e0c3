//! Studies: each runs a scene many times with different settings and compares the runs.

mod bending_spring;
mod choose;
mod cost;
mod distance;
mod draw;
mod kept;
mod median;
mod needs;
mod page;
mod partial;
mod reference;
mod results;
mod stability;
pub mod sweep;
mod terms;
mod trajectory;
mod validate;
mod variant;
mod work_precision;

pub use choose::choose;
pub use needs::needs;
pub use stability::stability;
pub use sweep::sweep;
pub use validate::validate;
pub use work_precision::chart;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use serde::Serialize;

use crate::args::{Cost, Precision, StudyArguments};
use crate::bench::cpu_name;
use crate::engine::{self, Engine};
use crate::failure::Failure;
use crate::folder::Folder;
use crate::interrupt;
use crate::pool::Pool;
use crate::progress;
use crate::scene_file::{self, SceneFile};
use crate::stopwatch::Stopwatch;
use kept::Kept;
use partial::{Finished, Numbers, SoFar};

/// Upper bound of a budget, s: about 300 years.
const MOST_SECONDS: f64 = 1e10;

/// A study in progress: the scene, the remaining time and the output folder.
pub struct Study<'a> {
    /// Name of the study, the stem of its files.
    name: &'static str,
    /// The command-line arguments.
    pub arguments: &'a StudyArguments,
    /// The scene as it was given.
    pub scene: SceneFile,
    /// Output folder.
    pub folder: Folder,
    /// Runs kernels on one thread, so that costs can be compared.
    pub pool: Pool,
    /// The runs of an interrupted call of this study.
    pub kept: Kept,
    /// Set by an interrupt.
    stop: Arc<AtomicBool>,
    bar: ProgressBar,
    started: Instant,
    /// Cost by counts of all runs, or time by the clock of the known runs, ns.
    spent: AtomicU64,
    /// The finished runs.
    finished: Mutex<Vec<Finished>>,
}

impl Drop for Study<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl<'a> Study<'a> {
    /// Loads the scene, starts to measure the time and acts. If the study is interrupted, it writes what is known and
    /// keeps its runs; otherwise it forgets them.
    pub fn run(
        name: &'static str,
        arguments: &'a StudyArguments,
        act: impl FnOnce(&Self) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let study = Self::begin(name, arguments)?;
        let ended = match act(&study) {
            // Without the runs that the interrupt prevented, there is no result.
            Err(Failure::Diverged(_)) if study.is_interrupted() => Err(study.suspend(None)),
            ended => ended,
        };
        if !matches!(ended, Err(Failure::Interrupted(_))) {
            study.kept.forget();
            partial::remove(&study.folder, name);
        }
        ended
    }

    fn begin(name: &'static str, arguments: &'a StudyArguments) -> Result<Self, Failure> {
        // The handler is installed before anything is written that an interrupt would leave behind.
        let stop = interrupt::watch()?;
        let of = arguments.of.clone();
        let Some(scene) = interrupt::until(&stop, move || scene_file::asked(&of))? else {
            return Err(Failure::Interrupted("interrupted while the scene was loaded; nothing is written".into()));
        };
        let scene = scene?;
        if scene.desc.duration <= 0.0 {
            return Err(Failure::Usage("a study needs a duration above 0".into()));
        }
        let out = scene_file::folder(&arguments.of, &scene)?;
        let pool = Pool::new(Some(1)).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
        let folder = Folder::take(out)?;
        let template = "{elapsed_precise} of {len} s {wide_bar} {msg}";
        let bar = progress::bar(arguments.budget.ceil() as u64, template, arguments.quiet);
        Ok(Self {
            name,
            arguments,
            scene,
            kept: Kept::of(folder.path(), name),
            folder,
            pool,
            stop,
            bar,
            started: Instant::now(),
            spent: AtomicU64::new(0),
            finished: Mutex::default(),
        })
    }

    /// Builds the engine of a scene of this study; `None` after an interrupt.
    fn build(&self, scene: &SceneFile, precision: Precision) -> Result<Option<Box<dyn Engine>>, Failure> {
        let scene = scene.clone();
        let built = interrupt::until(&self.stop, move || engine::build(&scene, precision))?;
        let wrong = |why| Failure::Usage(format!("{}: {why}", self.arguments.of.scene));
        built.transpose().map(|built| built.map(|(engine, _)| engine)).map_err(wrong)
    }

    /// The engine of a scene of this study. An interrupt ends the study.
    pub fn engine(&self, scene: &SceneFile, precision: Precision) -> Result<Box<dyn Engine>, Failure> {
        self.build(scene, precision)?.ok_or_else(|| self.suspend(None))
    }

    /// Whether the user has interrupted the study. No run is made then, as if the budget were used up.
    pub fn is_interrupted(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// A stopwatch that an interrupt stops.
    pub fn stopwatch(&self) -> Stopwatch<'_> {
        Stopwatch::new(&self.pool).until(&self.stop)
    }

    /// Adds a finished run, of which [`say`](Self::say) has told the name, to the report of an interrupted study.
    pub fn note(&self, wall_s: f64, ending: &str) {
        let run = Finished { run: self.bar.message(), wall_s, ending: ending.into() };
        self.finished.lock().unwrap_or_else(PoisonError::into_inner).push(run);
    }

    /// Shows the name of the current run in the progress bar.
    pub fn say(&self, what: &str) {
        self.bar.set_position(self.seconds() as u64);
        self.bar.set_message(what.to_owned());
    }

    /// The remaining budget; nothing after an interrupt.
    pub fn left(&self) -> Duration {
        if self.is_interrupted() {
            return Duration::ZERO;
        }
        Duration::from_secs_f64((self.arguments.budget.min(MOST_SECONDS) - self.seconds()).max(0.0))
    }

    /// Time used, s: since the start of the study and by runs that are known from an interrupted call, or with costs by
    /// counts the cost of all runs.
    pub fn seconds(&self) -> f64 {
        let spent = 1e-9 * self.spent.load(Ordering::Relaxed) as f64;
        if self.is_clocked() { self.started.elapsed().as_secs_f64() + spent } else { spent }
    }

    /// Adds the cost of a run, s. The clock measures it itself.
    pub fn spend(&self, seconds: f64) {
        if !self.is_clocked() {
            self.spend_known(seconds);
        }
    }

    /// Adds the cost of a run that was made before an interrupt, s.
    pub fn spend_known(&self, seconds: f64) {
        self.spent.fetch_add((1e9 * seconds) as u64, Ordering::Relaxed);
    }

    /// Whether costs are measured by the clock, so that the same run takes a different time each time.
    pub fn is_clocked(&self) -> bool {
        self.arguments.cost == Cost::Clock
    }

    /// Number of times to run something that is timed `times` times by the clock: once if costs are counted, since
    /// each repeat would cost the same.
    pub fn repeats(&self, times: usize) -> usize {
        if self.is_clocked() { times } else { 1 }
    }

    /// The processor on which costs were measured; a note if costs are counted.
    pub fn machine(&self) -> String {
        if self.is_clocked() { cpu_name() } else { "none: by counts".into() }
    }

    /// Writes the picture, the numbers and the page, and prints the numbers or `lines`. An interrupted study writes
    /// them as a partial report, which ends it.
    pub fn finish(&self, svg: &str, numbers: &impl Serialize, lines: &str) -> Result<(), Failure> {
        if self.is_interrupted() {
            return Err(self.suspend(Some(SoFar::new(Some(svg.into()), numbers, lines.into())?)));
        }
        self.bar.finish_and_clear();
        let all = self.finished.lock().unwrap_or_else(PoisonError::into_inner).len();
        let results = Numbers::results(Some(svg.into()), numbers, lines, self.kept.known(), all)?;
        let mut written = results.write(&self.folder, self.name)?;
        let page = page::of(self.folder.path(), &self.scene.desc.name);
        written.push(self.folder.write(page::NAME, &page)?);
        results.print(self.arguments.json, self.arguments.quiet, &written)
    }

    /// Writes the report of an interrupted study and returns the failure with which it ends.
    pub fn suspend(&self, so_far: Option<SoFar>) -> Failure {
        self.bar.finish_and_clear();
        let runs = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
        let StudyArguments { json, quiet, .. } = *self.arguments;
        partial::report(&self.folder, self.name, runs.len(), &runs, so_far.as_ref(), json, quiet)
    }
}
