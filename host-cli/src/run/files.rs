//! The files of a run besides its frames: the preview and the summary.

use std::path::{Path, PathBuf};

use crate::args::{PreviewKind, RunArguments};
use crate::export::whole;
use crate::failure::{Failure, print_note};
use crate::preview::Preview;
use crate::summary::Summary;

/// Draws and writes the requested preview.
pub fn write_preview(
    arguments: &RunArguments,
    preview: Option<&Preview>,
    out: &Path,
) -> Result<Option<PathBuf>, Failure> {
    let Some(preview) = preview else { return Ok(None) };
    let (kind, quiet) = (arguments.preview, arguments.quiet);
    let path = match kind {
        PreviewKind::Gif => out.join("preview.gif"),
        PreviewKind::Png => out.join("preview.png"),
        PreviewKind::None => return Ok(None),
    };
    if !quiet {
        print_note(&format!("drawing {}", path.display()));
    }
    match kind {
        PreviewKind::Gif => preview.write_gif(&path)?,
        _ => preview.write_png(&path)?,
    }
    Ok(Some(path))
}

/// Frames and pictures that a run may write in its folder.
const OUTPUTS: [&str; 9] = [
    "frames",
    "cloth.pc2",
    "cloth.obj",
    "cloth.usda",
    "vtp",
    "cloth.vtp.series",
    "preview.gif",
    "preview.png",
    STEP_PLOT,
];

/// Name of the plot of the substeps.
const STEP_PLOT: &str = "steps.svg";

/// Outputs in the folder `out` that this run did not write.
pub fn older(out: &Path, written: &[PathBuf]) -> Vec<PathBuf> {
    // The folder `vtp` belongs to this run if its series file does.
    let is_written = |name: &str| {
        let path = out.join(if name == "vtp" { "cloth.vtp.series" } else { name });
        written.iter().any(|written| written.starts_with(&path))
    };
    OUTPUTS.iter().filter(|name| !is_written(name)).map(|name| out.join(name)).filter(|path| path.exists()).collect()
}

/// The summary as JSON text.
pub fn to_json(summary: &Summary) -> Result<String, Failure> {
    serde_json::to_string_pretty(summary).map_err(|error| Failure::Tool(error.to_string()))
}

/// Writes `summary.json`.
pub fn write_summary(summary: &Summary, out: &Path) -> Result<PathBuf, Failure> {
    write_text(&to_json(summary)?, out.join("summary.json"))
}

/// Writes the plot of the substeps.
pub fn write_step_plot(svg: &str, out: &Path) -> Result<PathBuf, Failure> {
    write_text(svg, out.join(STEP_PLOT))
}

fn write_text(text: &str, path: PathBuf) -> Result<PathBuf, Failure> {
    use std::io::Write;
    whole::write(path, |file| writeln!(file, "{text}")).map_err(|error| Failure::Tool(error.to_string()))
}
