//! What the maps say in numbers and words.

use std::f64::consts::TAU;

use muslin_core::integrate::stability::Mode;
use serde::Serialize;

use crate::study::Study;

use super::cell::{Subject, Verdict};
use super::map::Ground;

/// One run.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// As scenes spell it.
    pub method: &'static str,
    /// Newton iterations in a step, at most.
    pub newton: u32,
    /// The method and, where there are several, its Newton iterations.
    #[serde(skip)]
    pub name: String,
    /// s.
    pub step: f64,
    /// Times the scene's stiffness.
    pub stiffness_scale: f64,
    /// Times the scene's damping.
    pub damping_scale: f64,
    /// The longest step that theory allows here, s: 0 where every step gains energy, none where every
    /// step is stable.
    pub theory: Option<f64>,
    /// Steps taken.
    pub steps: u64,
    /// Of the scene, s.
    #[serde(rename = "watched_s")]
    pub watched: f64,
    /// What its steps took, s.
    #[serde(rename = "wall_s")]
    pub wall: f64,
    /// How it went.
    pub verdict: Verdict,
    /// What went wrong.
    pub why: Option<String>,
}

impl Row {
    /// Whether it is of a subject.
    pub fn is_of(&self, subject: Subject) -> bool {
        self.method == subject.method.name() && self.newton == subject.newton
    }

    /// Whether theory foretold how it went; none where it says nothing.
    fn is_foretold(&self) -> Option<bool> {
        let theory = self.theory.filter(|&theory| theory > 0.0 && self.verdict != Verdict::NotRun)?;
        Some((self.step <= theory) == (self.verdict == Verdict::Fine))
    }
}

/// What came of a method's longest step over the whole scene.
#[derive(Clone, Debug, Serialize)]
pub struct Whole {
    /// Steps of that length in the scene.
    pub steps: u64,
    /// Until it failed, s; the scene's duration where it did not, nothing where it would have taken too long.
    #[serde(rename = "held_s")]
    pub held: f64,
    /// How it went.
    pub verdict: Verdict,
    /// The longest step that was fine to the scene's end, of it and of ten at most, each 5 % shorter than
    /// the one before, s.
    pub lasting: Option<f64>,
}

/// The longest step of a method on the scene itself.
#[derive(Clone, Debug, Serialize)]
pub struct Limit {
    /// As scenes spell it.
    pub method: &'static str,
    /// Newton iterations in a step, at most.
    pub newton: u32,
    /// The method and, where there are several, its Newton iterations.
    #[serde(skip)]
    pub name: String,
    /// Runs on the scene itself; none where nothing limits the method or nothing was left of the budget.
    pub runs: usize,
    /// The longest step below which every run was fine, s; none where none was.
    pub measured: Option<f64>,
    /// Of the scene with that step, s.
    #[serde(rename = "watched_s")]
    pub watched: Option<f64>,
    /// That step to the scene's end.
    pub whole: Option<Whole>,
    /// The shortest step of the map that was not, s.
    pub failed: Option<f64>,
    /// How that one went.
    pub failed_by: Option<Verdict>,
    /// The next longer step of the map that was fine again, s.
    pub fine_again: Option<f64>,
    /// What theory allows, s.
    pub theory: Option<f64>,
    /// Measured over theory; none where the budget did not do to measure it.
    pub ratio: Option<f64>,
}

/// What is scaled along a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// All stiffnesses.
    Stiffness,
    /// All dampings, as parts of the stiffness.
    Damping,
}

impl Axis {
    /// The scale of a row along it, if the row is on this map.
    pub fn of(self, row: &Row) -> Option<f64> {
        let (own, other) = match self {
            Self::Stiffness => (row.stiffness_scale, row.damping_scale),
            Self::Damping => (row.damping_scale, row.stiffness_scale),
        };
        (other == 1.0).then_some(own)
    }

    /// As pictures call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Damping => "damping",
        }
    }
}

/// `stability --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Map {
    /// Its name.
    pub scene: String,
    /// s.
    pub duration_s: f64,
    /// Frequency of the stiffest mode at the scene's start, Hz.
    pub fastest_mode_hz: f64,
    /// Its damping, of critical.
    pub damping_ratio: f64,
    /// All runs, in f32.
    pub rows: Vec<Row>,
    /// The longest steps on the scene itself.
    pub limits: Vec<Limit>,
    /// Runs of which theory says how they go, and of these how many went so.
    pub foretold: [usize; 2],
    /// What the study took, s.
    pub study_s: f64,
}

/// Puts it together.
pub fn summarise(study: &Study<'_>, grounds: &[Ground], rows: Vec<Row>, limits: Vec<Limit>) -> Map {
    let Mode { stiffness, damping } = grounds[0].modes[0];
    let omega = stiffness.sqrt();
    let foretold: Vec<_> = rows.iter().filter_map(Row::is_foretold).collect();
    Map {
        scene: study.scene.desc.name.clone(),
        duration_s: study.scene.desc.duration,
        fastest_mode_hz: omega / TAU,
        damping_ratio: if omega > 0.0 { 0.5 * damping / omega } else { 0.0 },
        foretold: [foretold.len(), foretold.iter().filter(|&&right| right).count()],
        rows,
        limits,
        study_s: study.seconds(),
    }
}

impl Map {
    /// The maps that there are.
    pub fn axes(&self) -> Vec<Axis> {
        let damped = self.rows.iter().any(|row| row.damping_scale != 1.0);
        [Axis::Stiffness].into_iter().chain(damped.then_some(Axis::Damping)).collect()
    }

    /// Runs for which nothing was left of the budget.
    pub fn missing(&self) -> usize {
        self.rows.iter().filter(|row| row.verdict == Verdict::NotRun).count()
    }
}
