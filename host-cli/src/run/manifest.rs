//! `run.json`: to which run the files in an output folder belong. Without it, a resumed run could continue the frames
//! of another run.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::CHECKPOINT;
use super::files::{self, SUMMARY};
use crate::args::series_name;
use crate::checkpoint;
use crate::disk;
use crate::export::whole::partial_name;
use crate::export::{Exporter, Format};
use crate::failure::Failure;
use crate::folder::Folder;
use crate::limits;
use crate::warning::Warning;

const NAME: &str = "run.json";

/// The contents of the file.
#[derive(Serialize, Deserialize)]
struct Manifest {
    /// [`crate::checkpoint::identity`] of the run.
    run: String,
    /// Formats of the frames, also those of earlier runs.
    export: Vec<Format>,
    /// Name of the series, also of an earlier run.
    #[serde(default)]
    series: Option<String>,
}

impl Manifest {
    /// The files of the series in a folder, complete or partial.
    fn series(&self, folder: &Path) -> impl Iterator<Item = PathBuf> {
        let name = self.series.as_deref().and_then(|name| series_name(name).ok());
        let path = name.map(|name| folder.join(name));
        path.into_iter().flat_map(|path| [partial_name(&path), path])
    }
}

/// Records that the files in a folder belong to `run` from now on. The files of an earlier run are removed, those with
/// the names of its formats and of the other outputs of a run; other files stay. A warning says that an interrupted run
/// was among them, or a finished run of another scene than `scene`.
pub fn begin(
    folder: &Folder,
    run: &str,
    formats: &[Format],
    series: Option<&str>,
    scene: &str,
) -> Result<Option<Warning>, Failure> {
    let earlier = read(folder);
    write(folder, run, formats, series, earlier.as_ref())?;
    let mut replaced = None;
    if let Some(earlier) = earlier {
        replaced = interrupted(folder.path(), earlier.run == run).or_else(|| finished(folder.path(), scene));
        let frames = earlier.export.iter().flat_map(|format| format.files(folder.path()));
        // A file that cannot be removed stays, until the run replaces it.
        let others = files::besides_frames(folder.path()).chain(earlier.series(folder.path()));
        frames.chain(others).for_each(|path| drop(disk::remove(&path)));
        // A folder with files of others is not empty, and stays.
        let folders = earlier.export.iter().filter_map(|format| format.folder());
        folders.for_each(|name| drop(disk::remove_folder(&folder.path().join(name))));
    }
    Ok(replaced.map(|text| Warning::new("replaced", text)))
}

/// The text that the outputs of a finished run of another scene are removed; `None` if the folder has none.
fn finished(folder: &Path, scene: &str) -> Option<String> {
    let summary = limits::read(&folder.join(SUMMARY), limits::TEXT).ok()?;
    let summary: serde_json::Value = serde_json::from_slice(&summary).ok()?;
    let earlier = summary["scene"].as_str().filter(|&earlier| earlier != scene)?;
    Some(format!("removed the outputs of {earlier} that were in {}", folder.display()))
}

/// The text that a new run takes the place of an interrupted one; `None` if the run in the folder came to its end, or
/// has no checkpoint that can be read.
fn interrupted(folder: &Path, is_the_same: bool) -> Option<String> {
    let checkpoint = folder.join(CHECKPOINT);
    let is_interrupted = checkpoint.exists() && !folder.join(SUMMARY).exists();
    let step = is_interrupted.then(|| checkpoint::step(&checkpoint)).flatten()?;
    let which = if is_the_same { "the interrupted run" } else { "an interrupted run of another scene or version" };
    let hint = match is_the_same {
        true => format!("; --resume {} would have gone on with it", checkpoint.display()),
        false => String::new(),
    };
    Some(format!("{}: {which}, at step {step}, is removed, and the scene begins anew{hint}", folder.display()))
}

/// Checks that a resumed run may continue the files in a folder: they are its own, or there are no frames.
pub fn resume(folder: &Folder, run: &str, formats: &[Format], series: Option<&str>) -> Result<(), Failure> {
    let earlier = read(folder);
    let has_series = series.is_some_and(|name| folder.path().join(name).exists());
    let is_free = || !has_series && Format::ALL.iter().all(|format| format.files(folder.path()).is_empty());
    let fits = earlier.as_ref().map_or_else(is_free, |earlier| earlier.run == run);
    if !fits {
        return Err(Failure::Usage(format!(
            "{} contains the frames of another run, which this run cannot continue; give another folder by --out",
            folder.path().display()
        )));
    }
    write(folder, run, formats, series, earlier.as_ref())
}

fn read(folder: &Folder) -> Option<Manifest> {
    let bytes = limits::read(&folder.path().join(NAME), limits::TEXT).ok()?;
    serde_json::from_slice(&bytes).ok()
}

fn write(
    folder: &Folder,
    run: &str,
    formats: &[Format],
    series: Option<&str>,
    earlier: Option<&Manifest>,
) -> Result<(), Failure> {
    let named =
        |format: &&Format| formats.contains(format) || earlier.is_some_and(|earlier| earlier.export.contains(format));
    let series = series.or_else(|| earlier.and_then(|earlier| earlier.series.as_deref())).map(str::to_owned);
    let manifest = Manifest { run: run.into(), export: Format::ALL.iter().filter(named).copied().collect(), series };
    let text = serde_json::to_string_pretty(&manifest).map_err(|error| Failure::Tool(error.to_string()))?;
    folder.write(NAME, &text).map(drop)
}

/// A warning for each format whose files lack the frames before a resumed run; `exporter` has just begun.
pub fn missing(exporter: &Exporter, folder: &Folder) -> Vec<Warning> {
    let warning = |(format, frame): (Format, u32)| {
        let text = format!(
            "--export {}: begins with frame {frame}; {} does not contain all frames before it",
            format.name(),
            folder.path().display()
        );
        Warning::new("frames-missing", text)
    };
    exporter.incomplete().into_iter().map(warning).collect()
}
