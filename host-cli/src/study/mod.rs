//! Studies: a scene run many times under other settings, and what the runs say together.

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

/// More than a life.
const MOST_SECONDS: f64 = 1e10;

/// A study under way: the scene, the time that is left, and where the results go.
pub struct Study<'a> {
    /// What was asked for.
    pub arguments: &'a StudyArguments,
    /// The scene as it was given.
    pub scene: SceneFile,
    /// Where to write.
    pub folder: Folder,
    /// Runs kernels on one thread: costs are compared.
    pub pool: Pool,
    /// Raised by an interrupt.
    pub stop: Arc<AtomicBool>,
    bar: ProgressBar,
    started: Instant,
    /// By counts, ns.
    spent: AtomicU64,
}

impl Drop for Study<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl<'a> Study<'a> {
    /// Loads the scene and begins to count the time.
    pub fn begin(arguments: &'a StudyArguments) -> Result<Self, Failure> {
        let scene = scene_file::asked(&arguments.of)?;
        if scene.desc.duration <= 0.0 {
            return Err(Failure::Usage("a study needs a duration above 0".into()));
        }
        let out = scene_file::folder(&arguments.of, &scene)?;
        let pool = Pool::new(Some(1)).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
        // Before there is anything that an interrupt would leave behind.
        let stop = interrupt::watch()?;
        let folder = Folder::make(out)?;
        let template = "{elapsed_precise} of {len} s {wide_bar} {msg}";
        let bar = progress::bar(arguments.budget.ceil() as u64, template, arguments.quiet);
        Ok(Self { arguments, scene, folder, pool, stop, bar, started: Instant::now(), spent: AtomicU64::new(0) })
    }

    /// Says what is being run.
    pub fn say(&self, what: &str) {
        self.bar.set_position(self.seconds() as u64);
        self.bar.set_message(what.to_owned());
    }

    /// What is left of the budget.
    pub fn left(&self) -> Duration {
        Duration::from_secs_f64((self.arguments.budget.min(MOST_SECONDS) - self.seconds()).max(0.0))
    }

    /// Seconds since it began, or by counts those of its runs.
    pub fn seconds(&self) -> f64 {
        match self.arguments.cost {
            Cost::Clock => self.started.elapsed().as_secs_f64(),
            Cost::Counts => 1e-9 * self.spent.load(Ordering::Relaxed) as f64,
        }
    }

    /// Adds what a run took, s.
    pub fn spend(&self, seconds: f64) {
        self.spent.fetch_add((1e9 * seconds) as u64, Ordering::Relaxed);
    }

    /// Whether costs are told by the clock, so that the same run takes another time each time.
    pub fn is_clocked(&self) -> bool {
        self.arguments.cost == Cost::Clock
    }

    /// How often what is to be timed so many times is run: by counts it costs the same each time.
    pub fn repeats(&self, times: usize) -> usize {
        if self.is_clocked() { times } else { 1 }
    }

    /// On what costs were told: the processor, or none.
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
