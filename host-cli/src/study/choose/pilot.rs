//! Pilot runs of the scene, weighed against a reference no better than the tolerance asks.

use std::time::Duration;

use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::study::Study;
use crate::study::reference::{self, BLOWN_UP, Reference, Rule};
use crate::study::trajectory::{Ending, Limits, Trajectory, fly_of};
use crate::study::variant::{SAMPLES, Variant};
use crate::units::time;

use super::no_reference;
use super::row::{Row, Verdict};

/// Times the time of the cheapest that meets the tolerance, at which a run is given up: what is nearer
/// is told as the next.
const DEAR: f64 = 2.0;

/// No run is given up before, s: the machine may have been busy with something else for so long.
const GRACE: f64 = 0.1;

/// Times the time of the last run of the reference, kept for that of half its step and the check.
const KEPT: f64 = 3.0;

/// What was run so far.
pub struct Pilot<'a> {
    /// The study.
    pub study: &'a Study<'a>,
    /// RMS, m.
    pub tolerance: f64,
    /// What errors are measured against.
    pub reference: Reference,
    /// kg.
    pub masses: Vec<f64>,
    /// All runs, in their order.
    pub considered: Vec<Row>,
}

impl<'a> Pilot<'a> {
    /// Finds the reference of a cloth of some size, m.
    pub fn begin(study: &'a Study<'a>, masses: Vec<f64>, tolerance: f64, size: f64) -> Result<Self, Failure> {
        let mut nearest: Option<Reference> = None;
        for rule in Rule::within(study.scene.desc.contact.is_some(), tolerance) {
            let Some(reference) = reference::find(study, rule, &masses)? else { continue };
            if reference.is_enough() {
                return Ok(Self { study, tolerance, reference, masses, considered: Vec::new() });
            }
            if nearest.as_ref().is_none_or(|nearest| reference.self_error < nearest.self_error) {
                nearest = Some(reference);
            }
        }
        Err(no_reference(study, tolerance, size, nearest.as_ref()))
    }

    /// Steps from sample to sample of the longest step: a run takes one a frame at least.
    pub fn fewest_steps(&self) -> u64 {
        let desc = &self.study.scene.desc;
        let frames = desc.duration * desc.frame_rate / SAMPLES as f64;
        (frames - 1e-9).ceil().max(1.0) as u64
    }

    /// Whether a run is to be had: it meets the tolerance, and none of its method does by less work.
    pub fn is_candidate(&self, row: &Row) -> bool {
        row.meets() && !self.considered.iter().any(|other| row.is_outdone(other))
    }

    /// The cheapest that meets the tolerance of the runs that are wanted.
    pub fn cheapest_of(&self, is_wanted: impl Fn(&Row) -> bool) -> Option<&Row> {
        let rows = self.considered.iter().filter(|row| is_wanted(row) && self.is_candidate(row));
        rows.min_by(|a, b| a.wall_s.total_cmp(&b.wall_s))
    }

    /// The cheapest of all that meets the tolerance.
    pub fn cheapest(&self) -> Option<&Row> {
        self.cheapest_of(|_| true)
    }

    /// Seconds that are left before the check.
    pub fn left(&self) -> f64 {
        (self.study.left().as_secs_f64() - KEPT * self.reference.best().1.wall).max(0.0)
    }

    /// Runs a variant of a scene and keeps what came of it, given up after `longest` seconds or when it
    /// costs too much.
    pub fn weigh(
        &mut self,
        scene: &SceneFile,
        variant: Variant,
        terms: &[String],
        longest: f64,
    ) -> Result<Row, Failure> {
        self.study.say(&variant.name(scene));
        let grace = if self.study.is_clocked() { GRACE } else { 0.0 };
        let dear = self.cheapest().map_or(f64::INFINITY, |best| (DEAR * best.wall_s).max(grace));
        let run = self.fly(scene, &variant, longest.min(dear))?;
        Ok(self.keep(scene, variant, terms, &run, dear <= longest))
    }

    /// The same of a variant that is run to its end, however long that takes.
    pub fn weigh_whole(&mut self, scene: &SceneFile, variant: Variant, terms: &[String]) -> Result<Row, Failure> {
        self.study.say(&variant.name(scene));
        let run = fly_of(self.study, scene, &variant, Limits { wall: Duration::MAX, energy: self.most_energy() })?;
        Ok(self.keep(scene, variant, terms, &run, false))
    }

    fn keep(&mut self, scene: &SceneFile, variant: Variant, terms: &[String], run: &Trajectory, dear: bool) -> Row {
        let mut row = Row::new(scene, variant, terms, &run.report, run.wall);
        (row.verdict, row.error, row.why) = self.judge(run, dear);
        self.considered.push(row.clone());
        row
    }

    /// What has more has blown up, J.
    fn most_energy(&self) -> f64 {
        BLOWN_UP * self.reference.liveliest(self.masses.iter().sum())
    }

    /// Runs a variant of a scene for some seconds at most.
    pub fn fly(&self, scene: &SceneFile, variant: &Variant, longest: f64) -> Result<Trajectory, Failure> {
        let wall = Duration::from_secs_f64(longest.min(self.left()));
        fly_of(self.study, scene, variant, Limits { wall, energy: self.most_energy() })
    }

    /// How far a run is from the reference, m; RMS.
    pub fn error(&self, run: &Trajectory, reference: &Trajectory) -> f64 {
        self.reference.rule.measure.between(run, reference, &self.masses).rms
    }

    fn judge(&self, run: &Trajectory, dear: bool) -> (Verdict, Option<f64>, Option<String>) {
        let failed = |why: String| (Verdict::Failed, None, Some(why));
        match &run.ending {
            Ending::Complete => {
                let error = self.error(run, &self.reference.best().1);
                let verdict = if error <= self.tolerance { Verdict::Meets } else { Verdict::Misses };
                (verdict, Some(error), None)
            }
            Ending::Diverged(what) => failed(what.clone()),
            Ending::Grown => failed(format!("its energy grew to {BLOWN_UP} times the most of the reference")),
            Ending::OutOfTime if dear => {
                let why =
                    format!("given up after {}: the cheapest until then took less than half as long", time(run.wall));
                (Verdict::Dear, None, Some(why))
            }
            Ending::OutOfTime => (Verdict::Dear, None, Some("given up: its part of the budget was used up".into())),
        }
    }
}
