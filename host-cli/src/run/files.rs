//! What a run leaves beside its frames: a picture and the summary.

use std::path::{Path, PathBuf};

use crate::args::{PreviewKind, RunArguments};
use crate::export::whole;
use crate::failure::{Failure, print_note};
use crate::preview::Preview;
use crate::summary::Summary;

/// Draws and writes the picture that was asked for.
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

/// Everything that a run may leave in its folder.
const OUTPUTS: [&str; 8] =
    ["frames", "cloth.pc2", "cloth.obj", "cloth.usda", "vtp", "cloth.vtp.series", "preview.gif", "preview.png"];

/// Outputs that lie there and are not of this run.
pub fn older(out: &Path, written: &[PathBuf]) -> Vec<PathBuf> {
    // The frames of `vtp` are written with their series.
    let is_written = |name: &str| {
        let path = out.join(if name == "vtp" { "cloth.vtp.series" } else { name });
        written.iter().any(|written| written.starts_with(&path))
    };
    OUTPUTS.iter().filter(|name| !is_written(name)).map(|name| out.join(name)).filter(|path| path.exists()).collect()
}

/// As it is printed and written.
pub fn to_json(summary: &Summary) -> Result<String, Failure> {
    serde_json::to_string_pretty(summary).map_err(|error| Failure::Tool(error.to_string()))
}

/// Writes `summary.json`.
pub fn write_summary(summary: &Summary, out: &Path) -> Result<PathBuf, Failure> {
    use std::io::Write;
    let text = to_json(summary)?;
    whole::write(out.join("summary.json"), |file| writeln!(file, "{text}"))
        .map_err(|error| Failure::Tool(error.to_string()))
}
