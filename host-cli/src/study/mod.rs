//! Studies: each runs a scene many times with different settings and compares the runs.

mod bending_spring;
mod choose;
mod cost;
mod distance;
mod draw;
mod folder;
mod median;
mod needs;
mod page;
mod reference;
mod stability;
mod sweep;
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

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use serde::Serialize;

use crate::args::{Cost, StudyArguments};
use crate::bench::cpu_name;
use crate::failure::Failure;
use crate::interrupt;
use crate::pool::Pool;
use crate::progress;
use crate::scene_file::{self, SceneFile};
use folder::{Folder, Results};

/// Upper bound of a budget, s: about 300 years.
const MOST_SECONDS: f64 = 1e10;

/// A study in progress: the scene, the remaining time and the output folder.
pub struct Study<'a> {
    /// The command-line arguments.
    pub arguments: &'a StudyArguments,
    /// The scene as it was given.
    pub scene: SceneFile,
    /// Output folder.
    pub folder: Folder,
    /// Runs kernels on one thread, so that costs can be compared.
    pub pool: Pool,
    /// Set by an interrupt.
    pub stop: Arc<AtomicBool>,
    bar: ProgressBar,
    started: Instant,
    /// Cost of all runs by counts, ns.
    spent: AtomicU64,
}

impl Drop for Study<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl<'a> Study<'a> {
    /// Loads the scene and starts to measure the time.
    pub fn begin(arguments: &'a StudyArguments) -> Result<Self, Failure> {
        let scene = scene_file::asked(&arguments.of)?;
        if scene.desc.duration <= 0.0 {
            return Err(Failure::Usage("a study needs a duration above 0".into()));
        }
        let out = scene_file::folder(&arguments.of, &scene)?;
        let pool = Pool::new(Some(1)).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
        // The handler is installed before anything is written that an interrupt would leave behind.
        let stop = interrupt::watch()?;
        let folder = Folder::make(out)?;
        let template = "{elapsed_precise} of {len} s {wide_bar} {msg}";
        let bar = progress::bar(arguments.budget.ceil() as u64, template, arguments.quiet);
        Ok(Self { arguments, scene, folder, pool, stop, bar, started: Instant::now(), spent: AtomicU64::new(0) })
    }

    /// Shows the name of the current run in the progress bar.
    pub fn say(&self, what: &str) {
        self.bar.set_position(self.seconds() as u64);
        self.bar.set_message(what.to_owned());
    }

    /// The remaining budget.
    pub fn left(&self) -> Duration {
        Duration::from_secs_f64((self.arguments.budget.min(MOST_SECONDS) - self.seconds()).max(0.0))
    }

    /// Time used, s: since the start of the study, or with costs by counts the cost of its runs.
    pub fn seconds(&self) -> f64 {
        match self.arguments.cost {
            Cost::Clock => self.started.elapsed().as_secs_f64(),
            Cost::Counts => 1e-9 * self.spent.load(Ordering::Relaxed) as f64,
        }
    }

    /// Adds the cost of a run, s.
    pub fn spend(&self, seconds: f64) {
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

    /// Writes the picture, the numbers and the page, and prints the numbers or `lines`.
    pub fn finish(&self, name: &str, svg: &str, numbers: &impl Serialize, lines: &str) -> Result<(), Failure> {
        self.bar.finish_and_clear();
        let results = Results::new(Some(svg.into()), numbers, lines.into())?;
        let mut written = self.folder.keep(name, &results)?;
        let page = page::of(self.folder.path(), &self.scene.desc.name);
        written.push(self.folder.write(page::NAME, &page)?);
        results.print(self.arguments.json, self.arguments.quiet, &written)
    }
}
