//! The files of a run besides its frames: the preview and the summary.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use super::CHECKPOINT;
use crate::args::{PreviewKind, RunArguments};
use crate::export::whole::partial_name;
use crate::failure::{Failure, print_note};
use crate::folder::Folder;
use crate::limits;
use crate::preview::{Preview, PreviewError};
use crate::summary::Summary;
use crate::warning::Warning;

/// The warning that there is no memory to draw the preview; `None` if there is enough.
pub fn undrawn(preview: &Preview) -> Option<Warning> {
    let needed = preview.memory_to_draw();
    (!limits::has_memory(needed)).then(|| {
        let text = format!(
            "the preview is left out: with {} threads it needs about {} MB of memory, more than is left{}",
            rayon::current_num_threads(),
            needed.div_ceil(1_000_000),
            limits::memory_in_words()
        );
        Warning::new("preview", text)
    })
}

/// Draws and writes the requested preview; it is left out after an interrupt.
pub fn write_preview(
    arguments: &RunArguments,
    preview: Option<&Preview>,
    out: &Path,
    stop: &AtomicBool,
) -> Result<Option<PathBuf>, Failure> {
    let Some(preview) = preview else { return Ok(None) };
    let (kind, quiet) = (arguments.preview, arguments.quiet);
    let path = match kind {
        PreviewKind::Gif => out.join(GIF),
        PreviewKind::Png => out.join(PNG),
        PreviewKind::None => return Ok(None),
    };
    if !quiet {
        print_note(&format!("drawing {}", path.display()));
    }
    let drawn = match kind {
        PreviewKind::Gif => preview.write_gif(&path, stop),
        _ => preview.write_png(&path, stop),
    };
    match drawn {
        Err(PreviewError::Interrupted) => Ok(None),
        drawn => Ok(drawn.map(|()| Some(path))?),
    }
}

/// Name of the summary.
pub const SUMMARY: &str = "summary.json";

/// Name of the plot of the substeps.
pub const STEP_PLOT: &str = "steps.svg";

/// Name of the plot of the series.
pub const SERIES_PLOT: &str = "series.svg";

/// Names of the previews.
const GIF: &str = "preview.gif";
const PNG: &str = "preview.png";

/// The files of a run in a folder besides its frames, complete or partial; they may be absent.
pub fn besides_frames(out: &Path) -> impl Iterator<Item = PathBuf> {
    let paths = [SUMMARY, STEP_PLOT, SERIES_PLOT, GIF, PNG, CHECKPOINT].map(|name| out.join(name));
    paths.into_iter().flat_map(|path| [partial_name(&path), path])
}

/// The summary as JSON text.
pub fn to_json(summary: &Summary) -> Result<String, Failure> {
    serde_json::to_string_pretty(summary).map_err(|error| Failure::Tool(error.to_string()))
}

/// Writes `summary.json`.
pub fn write_summary(summary: &Summary, folder: &Folder) -> Result<PathBuf, Failure> {
    folder.write(SUMMARY, &to_json(summary)?)
}

/// Writes a plot.
pub fn write_plot(name: &str, svg: &str, folder: &Folder) -> Result<PathBuf, Failure> {
    folder.write(name, svg)
}
