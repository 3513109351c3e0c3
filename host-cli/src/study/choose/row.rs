//! One pilot run, as the report shows it.

use serde::Serialize;

use crate::engine::Report;
use crate::scene_file::SceneFile;
use crate::study::median::median;
use crate::study::variant::Variant;
use crate::units::{length, time};

/// The result of a run with respect to the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Its error is within the tolerance.
    Meets,
    /// Its error is larger than the tolerance.
    Misses,
    /// It did not reach its end.
    Failed,
    /// It was given up, because it costs much more than the cheapest run that meets the tolerance or used up its
    /// part of the budget.
    Dear,
}

/// A run. Errors are metres.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name as in a scene file.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// Step, s; with an allowed error the longest one.
    pub step: f64,
    /// Allowed error of a step, m; `None`: all steps have the same length.
    pub allowed_error: Option<f64>,
    /// Tolerance of the solver; `None` for explicit methods and where it follows the allowed error.
    pub solver_tolerance: Option<f64>,
    /// Terms that are left out or simplified, in words.
    pub terms: Vec<String>,
    /// Whether it is the scene as it is written.
    pub as_written: bool,
    /// RMS error over all samples; `None` if the run did not reach its end.
    pub error: Option<f64>,
    /// The largest ratio of length to rest length of any edge at any sample; `None` if the run did not reach its end.
    pub stretch: Option<f64>,
    /// Median computing time of the steps, s.
    pub wall_s: f64,
    /// Number of timed runs.
    pub repeats: usize,
    /// Steps; under error control the ones that were kept.
    pub steps: u64,
    /// Evaluations of all forces.
    pub force_evaluations: u64,
    /// Iterations of conjugate gradients.
    pub cg_iterations: u64,
    /// Products of the system matrix with a vector.
    pub matrix_products: u64,
    /// Whether the run meets the tolerance.
    pub verdict: Verdict,
    /// Why there is no error.
    pub why: Option<String>,
    /// The variant that was run.
    #[serde(skip)]
    pub variant: Variant,
    #[serde(skip)]
    walls: Vec<f64>,
}

impl Row {
    /// A run of a variant of a scene that took `wall` seconds; its verdict is not known yet.
    pub fn new(scene: &SceneFile, variant: Variant, terms: &[String], report: &Report, wall: f64) -> Self {
        let steps = report.substeps[0].max(1);
        Self {
            method: variant.method.name(),
            precision: variant.precision.name(),
            step: variant.step(scene),
            allowed_error: variant.error,
            steps,
            solver_tolerance: variant.tolerance(scene),
            terms: terms.to_vec(),
            as_written: false,
            error: None,
            stretch: None,
            wall_s: wall,
            repeats: 1,
            force_evaluations: report.force_evaluations,
            cg_iterations: report.cg_iterations,
            matrix_products: report.matrix_products,
            verdict: Verdict::Failed,
            why: None,
            variant,
            walls: vec![wall],
        }
    }

    /// Adds the time of a repeat of this run, s.
    pub fn timed(&mut self, wall: f64) {
        self.walls.push(wall);
        self.wall_s = median(self.walls.clone());
        self.repeats = self.walls.len();
    }

    /// Name in sentences.
    pub fn name(&self) -> String {
        format!("{} {} by {}", self.method, self.precision, self.stride())
    }

    /// Its step in words, or the allowed error of a step.
    pub fn stride(&self) -> String {
        self.allowed_error.map_or_else(|| time(self.step), |error| format!("error {}", length(error)))
    }

    /// Whether it misses the tolerance and error control divided no step further than in the run `before`.
    pub fn is_as_divided(&self, before: &Self) -> bool {
        self.verdict == Verdict::Misses && self.is_divided() && self.steps <= before.steps
    }

    /// Whether error control divided a step.
    pub fn is_divided(&self) -> bool {
        self.variant.is_divided(self.steps)
    }

    /// Whether it meets the tolerance.
    pub fn meets(&self) -> bool {
        self.verdict == Verdict::Meets
    }

    /// Whether it may be proposed: an allowed error of a step is not larger than the tolerance, m.
    pub fn is_allowed(&self, tolerance: f64) -> bool {
        self.allowed_error.is_none_or(|error| error <= tolerance)
    }

    /// Whether another run of the same method, precision, kind of step and terms meets the tolerance with less counted
    /// work. Then that run is cheaper, whatever the clock shows.
    pub fn is_outdone(&self, other: &Self) -> bool {
        let kind = |row: &Self| (row.method, row.precision, row.allowed_error.is_some(), row.terms.clone());
        let counts = |row: &Self| [row.force_evaluations, row.cg_iterations];
        let (own, fewer) = (counts(self), counts(other));
        other.meets() && kind(self) == kind(other) && own != fewer && own.iter().zip(fewer).all(|(a, b)| b <= *a)
    }
}
