//! Writes the scene with the choice to a file.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use toml::Value;

use crate::args::{Precision, SceneArguments};
use crate::export::whole;
use crate::failure::{Failure, print_note};
use crate::scene_file::{self, SceneFile};
use crate::study::Study;
use crate::units::length;

use super::report::is_cut;
use super::saving::Candidate;

/// Refuses to overwrite the scene itself or a device, or to write into a folder in which the scene would not find the
/// files that it names.
pub fn allow(study: &Study<'_>, path: &Path) -> Result<(), Failure> {
    target(path)?;
    let scene = Path::new(&study.arguments.of.scene);
    let own = if scene.is_file() { folder(scene) } else { PathBuf::from(".") };
    let there = |folder: &Path| fs::canonicalize(folder).ok();
    if scene.is_file() && fs::canonicalize(scene).ok() == fs::canonicalize(path).ok() {
        return Err(Failure::Usage(format!(
            "--write {}: this is the scene file itself, which is not overwritten; give another name",
            path.display()
        )));
    }
    let relative = study.scene.resources.iter().find(|(name, _)| Path::new(name).is_relative());
    match relative {
        Some((name, _)) if there(&folder(path)).is_none_or(|folder| Some(folder) != there(&own)) => {
            Err(Failure::Usage(format!(
                "--write {}: the scene names {name}, relative to its own folder; write into {}",
                path.display(),
                own.display()
            )))
        }
        _ => Ok(()),
    }
}

/// The file to write: if `path` is a link, the file that it leads to, so that the link stays.
fn target(path: &Path) -> Result<PathBuf, Failure> {
    let refused = |why: &str| Failure::Usage(format!("--write {}: {why}; give another name", path.display()));
    let target = match path.is_symlink() {
        true => fs::canonicalize(path).map_err(|_| refused("this link leads to no file"))?,
        false => path.into(),
    };
    match target.exists() && !target.is_file() {
        true => Err(refused("this is a folder, a device or a pipe, not a file")),
        false => Ok(target),
    }
}

/// The folder of a file.
fn folder(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new(".")).into()
}

/// Writes the scene with its comments; `tolerance`, m, stands at its top.
pub fn write(study: &Study<'_>, tolerance: f64, found: &Candidate, path: &Path) -> Result<(), Failure> {
    let chosen = found.row.variant.chosen(&found.scene)?;
    // The study may have run a shorter duration than the scene has.
    let scene = chosen.changed(&[("duration", Some(Value::Float(own_duration(study)?)))])?;
    let text = scene_file::commented(&study.arguments.of.scene, &scene)?;
    whole::write(target(path)?, |out| {
        out.write_all((head(study, tolerance, found, scene.desc.duration) + &text).as_bytes())
    })?;
    if !study.arguments.quiet {
        print_note(&note(&scene, found, path));
        if scene.desc.duration > study.scene.desc.duration {
            print_note(&beyond(study.scene.desc.duration, scene.desc.duration));
        }
    }
    Ok(())
}

/// Comment at the top of the file: how the choice was made, which terms it leaves out or simplifies, and which values
/// `--set` changed. `duration` is that of the written scene, s.
fn head(study: &Study<'_>, tolerance: f64, found: &Candidate, duration: f64) -> String {
    let studied = study.scene.desc.duration;
    let chosen = format!("Chosen by muslin choose for the first {studied} s, to within {}.", length(tolerance));
    let beyond = (duration > studied).then(|| beyond(studied, duration));
    let terms =
        found.row.terms.iter().map(|term| format!("Changed, because it is faster within the tolerance: {term}."));
    let sets = study.arguments.of.set.iter().map(|set| format!("--set {}", set.replace(['\n', '\r'], " ")));
    let lines = [chosen].into_iter().chain(beyond).chain(terms);
    let lines = lines.chain(["The comments are those of the original scene.".into()]).chain(sets);
    lines.map(|line| format!("# {line}\n")).collect()
}

/// Words for a scene that goes on longer than it was studied, s.
fn beyond(studied: f64, duration: f64) -> String {
    format!("From {studied} s to its end at {duration} s nothing is checked: the error may grow, or the run diverge.")
}

/// The duration of the scene, s, without `--duration`.
fn own_duration(study: &Study<'_>) -> Result<f64, Failure> {
    let own = SceneArguments { duration: None, ..study.arguments.of.clone() };
    Ok(scene_file::asked(&own)?.desc.duration)
}

/// Message with the written file and the command that runs it. It names the step if the frames require a shorter
/// one.
fn note(scene: &SceneFile, found: &Candidate, path: &Path) -> String {
    let precision = if found.row.variant.precision == Precision::F64 { " --precision f64" } else { "" };
    let timing = scene.desc.timing();
    let is_fixed = scene.desc.integrator.error().is_none();
    let steps = match is_fixed && is_cut(timing.step, scene.desc.integrator.step()) {
        true => format!("; that takes {} steps of {:.4} ms a frame", timing.steps_per_frame, 1e3 * timing.step),
        false => String::new(),
    };
    let path = path.display();
    format!("wrote {path}: muslin run {path}{precision}{steps}")
}
