//! Studies: a scene run many times under other settings, and what the runs say together.

mod bending_spring;
mod choose;
mod distance;
mod draw;
mod median;
mod needs;
mod page;
mod reference;
mod stability;
mod terms;
mod trajectory;
mod variant;
mod work_precision;

pub use choose::choose;
pub use needs::needs;
pub use stability::stability;
pub use work_precision::chart;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use crate::args::StudyArguments;
use crate::export::whole;
use crate::failure::{Failure, print_data, print_note};
use crate::interrupt;
use crate::pool::Pool;
use crate::scene_file::{self, SceneFile};

/// More than a life.
const MOST_SECONDS: f64 = 1e10;

/// A study under way: the scene, the time that is left, and where the results go.
pub struct Study<'a> {
    /// What was asked for.
    pub arguments: &'a StudyArguments,
    /// The scene as it was given.
    pub scene: SceneFile,
    /// Where to write.
    pub out: PathBuf,
    /// Runs kernels on one thread: costs are compared.
    pub pool: Pool,
    /// Raised by an interrupt.
    pub stop: Arc<AtomicBool>,
    /// Folders that were not there, the innermost first.
    made: Vec<PathBuf>,
    bar: ProgressBar,
    started: Instant,
}

impl Drop for Study<'_> {
    /// A study without results leaves no folder: only empty ones can be removed.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        self.made.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

/// Makes a folder before the time is spent that ends in it; returns what was not there, the innermost
/// first.
fn make_folder(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let missing = folder.ancestors().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    let missing = missing.map(Path::to_path_buf).collect();
    fs::create_dir_all(folder)
        .map_err(|error| Failure::Tool(format!("cannot make the folder {}: {error}", folder.display())))?;
    Ok(missing)
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
        let made = make_folder(&out)?;
        let stop = interrupt::watch()?;
        // Draws on a terminal only.
        let target = if arguments.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(arguments.budget.ceil() as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{elapsed_precise} of {len} s {wide_bar} {msg}") {
            bar.set_style(style);
        }
        Ok(Self { arguments, scene, out, made, pool, stop, bar, started: Instant::now() })
    }

    /// Says what is being run.
    pub fn say(&self, what: &str) {
        self.bar.set_position(self.started.elapsed().as_secs());
        self.bar.set_message(what.to_owned());
    }

    /// What is left of the budget.
    pub fn left(&self) -> Duration {
        Duration::from_secs_f64(self.arguments.budget.min(MOST_SECONDS)).saturating_sub(self.started.elapsed())
    }

    /// Seconds since it began.
    pub fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Writes the picture, the numbers and the page, and prints the numbers or `lines`.
    pub fn finish(&self, name: &str, svg: &str, numbers: &impl Serialize, lines: &str) -> Result<(), Failure> {
        self.bar.finish_and_clear();
        let json = serde_json::to_string_pretty(numbers).map_err(|error| Failure::Tool(error.to_string()))?;
        let write = |file: &str, text: &str| {
            use std::io::Write;
            whole::write(self.out.join(file), |out| writeln!(out, "{text}"))
                .map_err(|error| Failure::Tool(error.to_string()))
        };
        let mut written = vec![write(&format!("{name}.svg"), svg)?, write(&format!("{name}.json"), &json)?];
        written.push(write(&format!("{name}.txt"), lines)?);
        written.push(write(page::NAME, &page::of(&self.out, &self.scene.desc.name))?);
        if self.arguments.json {
            print_data(&json)?;
        } else if !self.arguments.quiet {
            print_data(lines)?;
        }
        if !self.arguments.quiet {
            let names: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
            print_note(&format!("wrote {}", names.join(", ")));
        }
        Ok(())
    }
}
