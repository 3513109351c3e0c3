//! The report of `muslin stability` in numbers.

use std::f64::consts::TAU;

use muslin_core::integrate::stability::Mode;
use serde::Serialize;

use crate::engine::Report;
use crate::study::Study;

use super::cell::{Subject, Verdict};
use super::map::Ground;

/// One run.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name as in a scene file.
    pub method: &'static str,
    /// Largest number of Newton iterations in a step.
    pub newton: u32,
    /// The method, and its Newton iterations if there is more than one.
    #[serde(skip)]
    pub name: String,
    /// Step, s; with error control the longest one.
    pub step: f64,
    /// Factor of the scene's stiffness.
    pub stiffness_scale: f64,
    /// Factor of the scene's damping.
    pub damping_scale: f64,
    /// The longest step that theory allows here, s: 0 if every step gains energy, `None` if every step is stable.
    pub theory: Option<f64>,
    /// Steps taken.
    pub steps: u64,
    /// Simulated time, s.
    #[serde(rename = "watched_s")]
    pub watched: f64,
    /// Cost of its steps, s.
    #[serde(rename = "wall_s")]
    pub wall: f64,
    /// The class of the run.
    pub verdict: Verdict,
    /// What went wrong.
    pub why: Option<String>,
    /// Its substeps with error control; `None` with steps of one length.
    #[serde(flatten)]
    pub control: Option<Control>,
}

/// The substeps of a run with error control.
#[derive(Clone, Debug, Serialize)]
pub struct Control {
    /// The largest error of a substep, m.
    #[serde(rename = "error_m")]
    pub error: f64,
    /// Number of substeps that were kept.
    pub substeps: u64,
    /// Number of substeps that were taken back because of their error.
    pub taken_back: u64,
    /// Mean length of the substeps that were kept, s; 0 without substeps.
    #[serde(rename = "mean_s")]
    pub mean: f64,
    /// Length of the shortest substep, s; 0 if none was tried.
    #[serde(rename = "shortest_s")]
    pub shortest: f64,
}

impl Control {
    /// No substeps yet; `error` is the largest one, m.
    pub const fn not_run(error: f64) -> Self {
        Self { error, substeps: 0, taken_back: 0, mean: 0.0, shortest: 0.0 }
    }

    /// The substeps of a run whose steps have `step` seconds.
    pub fn of(error: f64, step: f64, report: &Report) -> Self {
        let [substeps, taken_back, _, halvings] = report.substeps;
        let shortest = step / 2f64.powi(halvings as i32);
        Self { error, substeps, taken_back, mean: report.time / substeps.max(1) as f64, shortest }
    }
}

impl Row {
    /// Whether all its steps have the same length.
    pub const fn is_fixed(&self) -> bool {
        self.control.is_none()
    }

    /// Mean length of its substeps, s, if it is fine under error control.
    pub fn mean_substep(&self) -> Option<f64> {
        self.control.as_ref().filter(|_| self.verdict == Verdict::Fine).map(|control| control.mean)
    }

    /// Whether the run is of a subject.
    pub fn is_of(&self, subject: Subject) -> bool {
        self.method == subject.method.name() && self.newton == subject.newton
    }

    /// Whether theory predicted the result; `None` if theory gives no limit or the cell was not run.
    fn is_foretold(&self) -> Option<bool> {
        let theory = self.theory.filter(|&theory| theory > 0.0 && self.verdict != Verdict::NotRun)?;
        Some((self.step <= theory) == (self.verdict == Verdict::Fine))
    }
}

/// The result of a method's longest step over the whole scene.
#[derive(Clone, Debug, Serialize)]
pub struct Whole {
    /// Number of steps of this length in the scene.
    pub steps: u64,
    /// Simulated time until it failed, s; the scene's duration if it did not fail, 0 if it would have taken too
    /// long.
    #[serde(rename = "held_s")]
    pub held: f64,
    /// The class of the run.
    pub verdict: Verdict,
    /// The longest step that was fine until the scene's end, s. At most ten steps are tried, each 5 % shorter than
    /// the one before.
    pub lasting: Option<f64>,
}

/// The longest step of a method on the scene itself.
#[derive(Clone, Debug, Serialize)]
pub struct Limit {
    /// Name as in a scene file.
    pub method: &'static str,
    /// Largest number of Newton iterations in a step.
    pub newton: u32,
    /// The method, and its Newton iterations if there is more than one.
    #[serde(skip)]
    pub name: String,
    /// Number of runs on the scene itself; 0 if nothing limits the method or the budget was used up.
    pub runs: usize,
    /// The longest step up to which every run was fine, s; `None` if no run was fine.
    pub measured: Option<f64>,
    /// Simulated time with that step, s.
    #[serde(rename = "watched_s")]
    pub watched: Option<f64>,
    /// The result of that step until the scene's end.
    pub whole: Option<Whole>,
    /// The shortest step of the map that was not fine, s.
    pub failed: Option<f64>,
    /// The class of that run.
    pub failed_by: Option<Verdict>,
    /// The shortest longer step of the map that was fine again, s.
    pub fine_again: Option<f64>,
    /// The longest step that theory allows, s: 0 if every step gains energy, `None` if every step is stable.
    pub theory: Option<f64>,
    /// Measured limit over theory; `None` if the budget did not suffice to measure it.
    pub ratio: Option<f64>,
}

/// The quantity that is scaled along a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// All stiffnesses.
    Stiffness,
    /// All dampings, which are parts of the stiffness.
    Damping,
}

impl Axis {
    /// The scale of a row along this axis, if the row is on this map.
    pub fn of(self, row: &Row) -> Option<f64> {
        let (own, other) = match self {
            Self::Stiffness => (row.stiffness_scale, row.damping_scale),
            Self::Damping => (row.damping_scale, row.stiffness_scale),
        };
        (other == 1.0).then_some(own)
    }

    /// Name in pictures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Damping => "damping",
        }
    }
}

/// The report, `stability --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Map {
    /// Name of the scene.
    pub scene: String,
    /// Duration of the scene, s.
    pub duration_s: f64,
    /// Frequency of the stiffest mode at the scene's start, Hz.
    pub fastest_mode_hz: f64,
    /// Damping ratio of this mode.
    pub damping_ratio: f64,
    /// All runs with steps of one length, in f32.
    pub rows: Vec<Row>,
    /// The runs with error control, in f32.
    pub controlled: Vec<Row>,
    /// The longest stable steps on the scene itself.
    pub limits: Vec<Limit>,
    /// Number of runs for which theory predicts a result, and number of correct predictions.
    pub foretold: [usize; 2],
    /// Cost of the study, s.
    pub study_s: f64,
}

/// Creates the report.
pub fn summarise(study: &Study<'_>, grounds: &[Ground], rows: Vec<Row>, limits: Vec<Limit>) -> Map {
    let Mode { stiffness, damping } = grounds[0].modes[0];
    let omega = stiffness.sqrt();
    let (rows, controlled): (Vec<_>, Vec<_>) = rows.into_iter().partition(Row::is_fixed);
    let foretold: Vec<_> = rows.iter().filter_map(Row::is_foretold).collect();
    Map {
        scene: study.scene.desc.name.clone(),
        duration_s: study.scene.desc.duration,
        fastest_mode_hz: omega / TAU,
        damping_ratio: if omega > 0.0 { 0.5 * damping / omega } else { 0.0 },
        foretold: [foretold.len(), foretold.iter().filter(|&&right| right).count()],
        rows,
        controlled,
        limits,
        study_s: study.seconds(),
    }
}

impl Map {
    /// The axes of the maps that were run.
    pub fn axes(&self) -> Vec<Axis> {
        let damped = self.rows.iter().any(|row| row.damping_scale != 1.0);
        [Axis::Stiffness].into_iter().chain(damped.then_some(Axis::Damping)).collect()
    }

    /// All runs.
    pub fn all(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().chain(&self.controlled)
    }

    /// Number of runs that the budget did not allow.
    pub fn missing(&self) -> usize {
        self.all().filter(|row| row.verdict == Verdict::NotRun).count()
    }
}
