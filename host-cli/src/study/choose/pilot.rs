//! Pilot runs of the scene, compared with a reference that is just exact enough for the tolerance.

use std::time::Duration;

use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::study::Study;
use crate::study::reference::{self, BLOWN_UP, Reference, Rule};
use crate::study::trajectory::{Ending, Limits, Trajectory, fly_of};
use crate::study::variant::{SAMPLES, Variant};
use crate::units::time;

use super::refusal;
use super::row::{Row, Verdict};

/// A run is given up when it takes this many times as long as the cheapest run that meets the tolerance. The report
/// names the next best method if it is nearer than this.
const DEAR: f64 = 2.0;

/// A run is never given up earlier than this, s: another process may have delayed it for that long.
const GRACE: f64 = 0.1;

/// Time kept for the reference of the check and the check itself, as a multiple of the time of the last run of the
/// reference.
const KEPT: f64 = 3.0;

/// The pilot runs of a study.
pub struct Pilot<'a> {
    /// The study.
    pub study: &'a Study<'a>,
    /// RMS error that is allowed, m.
    pub tolerance: f64,
    /// The reference that errors are measured against.
    pub reference: Reference,
    /// Masses of the vertices, kg.
    pub masses: Vec<f64>,
    /// All runs, in the order in which they were made.
    pub considered: Vec<Row>,
}

impl<'a> Pilot<'a> {
    /// Finds the reference; `size` is the diagonal of the cloth, m. An error means that no reference is exact
    /// enough.
    pub fn begin(study: &'a Study<'a>, masses: Vec<f64>, tolerance: f64, size: f64) -> Result<Self, Failure> {
        let mut tried = Vec::new();
        for rule in Rule::within(study.scene.desc.contact.is_some(), tolerance) {
            let reference = reference::refine(study, rule, &masses)?;
            if reference.is_found() && reference.is_enough() {
                return Ok(Self { study, tolerance, reference, masses, considered: Vec::new() });
            }
            tried.push(reference);
        }
        Err(refusal::no_reference(study, tolerance, size, &tried))
    }

    /// Number of steps from sample to sample with the longest allowed step: a run takes at least one step per
    /// frame.
    pub fn fewest_steps(&self) -> u64 {
        let desc = &self.study.scene.desc;
        let frames = desc.duration * desc.frame_rate / SAMPLES as f64;
        (frames - 1e-9).ceil().max(1.0) as u64
    }

    /// Whether a run may be chosen: it meets the tolerance, and no run of the same method meets it with less work.
    pub fn is_candidate(&self, row: &Row) -> bool {
        let mut allowed = self.considered.iter().filter(|other| other.is_allowed(self.tolerance));
        row.meets() && row.is_allowed(self.tolerance) && !allowed.any(|other| row.is_outdone(other))
    }

    /// The cheapest run that meets the tolerance, among those for which `is_wanted` holds.
    pub fn cheapest_of(&self, is_wanted: impl Fn(&Row) -> bool) -> Option<&Row> {
        let rows = self.considered.iter().filter(|row| is_wanted(row) && self.is_candidate(row));
        rows.min_by(|a, b| a.wall_s.total_cmp(&b.wall_s))
    }

    /// The cheapest of all runs that meet the tolerance.
    pub fn cheapest(&self) -> Option<&Row> {
        self.cheapest_of(|_| true)
    }

    /// Time left for pilot runs, s, without the time that is kept for the check.
    pub fn left(&self) -> f64 {
        (self.study.left().as_secs_f64() - KEPT * self.reference.best().1.wall).max(0.0)
    }

    /// Runs a variant of a scene and records the result. The run is given up after `longest` seconds or when it
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

    /// Runs the scene as it is written for at most `longest` seconds, and records the result.
    pub fn weigh_as_written(&mut self, longest: f64) -> Result<(), Failure> {
        let scene = &self.study.scene;
        self.weigh(scene, Variant::as_written(scene), &[], longest)?;
        self.considered.last_mut().into_iter().for_each(|row| row.as_written = true);
        Ok(())
    }

    /// Runs a variant to its end without a time limit, and records the result.
    pub fn weigh_whole(&mut self, scene: &SceneFile, variant: Variant, terms: &[String]) -> Result<Row, Failure> {
        self.study.say(&variant.name(scene));
        let run = fly_of(self.study, scene, &variant, Limits { wall: Duration::MAX, energy: self.most_energy() })?;
        Ok(self.keep(scene, variant, terms, &run, false))
    }

    fn keep(&mut self, scene: &SceneFile, variant: Variant, terms: &[String], run: &Trajectory, dear: bool) -> Row {
        let mut row = Row::new(scene, variant, terms, &run.report, run.wall);
        (row.verdict, row.error, row.why) = self.judge(run, dear);
        row.stretch = row.error.map(|_| run.stretch);
        self.considered.push(row.clone());
        row
    }

    /// Energy above which a run counts as blown up, J.
    fn most_energy(&self) -> f64 {
        BLOWN_UP * self.reference.liveliest(self.masses.iter().sum())
    }

    /// Runs a variant of a scene for at most `longest` seconds.
    pub fn fly(&self, scene: &SceneFile, variant: &Variant, longest: f64) -> Result<Trajectory, Failure> {
        let wall = Duration::from_secs_f64(longest.min(self.left()));
        fly_of(self.study, scene, variant, Limits { wall, energy: self.most_energy() })
    }

    /// RMS distance of a run from the reference, m.
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
            Ending::Grown => failed(format!("its energy grew to {BLOWN_UP} times the largest energy of the reference")),
            Ending::OutOfTime if dear => {
                let why =
                    format!("stopped after {}: the cheapest run so far took less than half as long", time(run.wall));
                (Verdict::Dear, None, Some(why))
            }
            Ending::OutOfTime => (Verdict::Dear, None, Some("stopped: its share of the budget was used up".into())),
        }
    }
}
