//! One run of a sweep, from its scene to its line.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use serde::Serialize;
use toml::Value;

use crate::engine::{self, Engine};
use crate::failure::Failure;
use crate::interrupt;
use crate::pool::Pool;
use crate::run::course::{Course, Ending};
use crate::run::start;
use crate::scene_file::SceneFile;
use crate::stopwatch::Stopwatch;
use crate::summary::Summary;

use super::file::Sweep;
use super::{Task, refused};

/// A line of the file: the run and its summary.
#[derive(Serialize)]
struct Line<'a> {
    key: &'a str,
    index: usize,
    overrides: BTreeMap<&'a str, &'a Value>,
    #[serde(flatten)]
    summary: Summary,
}

/// The changed scene of a run and its engine.
pub fn build(sweep: &Sweep, task: &Task) -> Result<(SceneFile, Box<dyn Engine>), Failure> {
    let scene = sweep.scene.with(&task.point.changes)?;
    let built = engine::build(&scene, task.point.precision);
    let (engine, _) = built.map_err(|why| refused(sweep, &task.point, &why))?;
    Ok((scene, engine))
}

/// Runs a scene until its end or until it diverges, and returns its line.
pub fn of(sweep: &Sweep, task: &Task, pool: &Pool, stop: &AtomicBool) -> Result<String, Failure> {
    let (of, own) = (sweep.clone(), task.clone());
    let built = interrupt::until(stop, move || build(&of, &own))?.ok_or_else(|| interrupted(task))?;
    let (scene, mut engine) = built?;
    if task.point.key(&scene) != task.key {
        return Err(Failure::Tool(format!(
            "{}: a file that the scene names has changed since the sweep began; start the same command again",
            sweep.label
        )));
    }
    let summary = pool.install(|| {
        let stopwatch = Stopwatch::new(pool).until(stop);
        let mut warnings = start::warnings(engine.as_ref(), &scene, task.point.precision, &stopwatch);
        let Some((start, warning)) = start::untangle(engine.as_mut(), false, pool, stop) else {
            return Err(interrupted(task));
        };
        let mut course = Course::begin(engine, &scene.desc, task.point.precision, [false; 2], start, None);
        warnings.extend(warning);
        course.warnings = warnings;
        course.frame(pool, stop, &mut ())?;
        let started = Instant::now();
        match course.advance(pool, stop, &mut ())? {
            Ending::Interrupted => Err(interrupted(task)),
            ending => Ok(course.summary(&scene, &ending, pool, started.elapsed())),
        }
    })?;
    let Task { point, key } = task;
    let overrides = point.changes.iter().map(|change| (change.key.as_str(), &change.value)).collect();
    let line = Line { key, index: point.index, overrides, summary };
    serde_json::to_string(&line).map_err(|error| Failure::Tool(error.to_string()))
}

fn interrupted(task: &Task) -> Failure {
    Failure::Interrupted(format!(
        "interrupted in the run with {}, which leaves no line; go on with the same command",
        task.point.name()
    ))
}
