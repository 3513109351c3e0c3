//! One run that was weighed, as it is told.

use serde::Serialize;

use crate::engine::Report;
use crate::scene_file::SceneFile;
use crate::study::median::median;
use crate::study::variant::Variant;
use crate::units::time;

/// How a run stands to the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Its error is within it.
    Meets,
    /// Its error is beyond it.
    Misses,
    /// It did not come to its end.
    Failed,
    /// It took too long beside the cheapest that meets it, and was given up.
    Dear,
}

/// A run. Errors are metres.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// As scenes spell it.
    pub method: &'static str,
    /// f32 or f64.
    pub precision: &'static str,
    /// s.
    pub step: f64,
    /// Terms left out or put simpler, in words.
    pub terms: Vec<String>,
    /// RMS over all samples; none where it did not come to its end.
    pub error: Option<f64>,
    /// In steps, s; the median of the repeats.
    pub wall_s: f64,
    /// Runs that were timed.
    pub repeats: usize,
    /// Evaluations of all forces.
    pub force_evaluations: u64,
    /// Iterations of conjugate gradients.
    pub cg_iterations: u64,
    /// Products of the system matrix with a vector.
    pub matrix_products: u64,
    /// Whether it meets the tolerance.
    pub verdict: Verdict,
    /// Why there is no error.
    pub why: Option<String>,
    /// What was run.
    #[serde(skip)]
    pub variant: Variant,
    #[serde(skip)]
    walls: Vec<f64>,
}

impl Row {
    /// A run of a variant of a scene that took `wall`, s.
    pub fn new(scene: &SceneFile, variant: Variant, terms: &[String], report: &Report, wall: f64) -> Self {
        Self {
            method: variant.method.name(),
            precision: variant.precision.name(),
            step: variant.step(scene),
            terms: terms.to_vec(),
            error: None,
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

    /// Counts one more time of the same, s.
    pub fn timed(&mut self, wall: f64) {
        self.walls.push(wall);
        self.wall_s = median(self.walls.clone());
        self.repeats = self.walls.len();
    }

    /// As sentences call it.
    pub fn name(&self) -> String {
        format!("{} {} by {}", self.method, self.precision, time(self.step))
    }

    /// Whether it meets the tolerance.
    pub fn meets(&self) -> bool {
        self.verdict == Verdict::Meets
    }

    /// Whether another run of the same method meets the tolerance by less of all that is counted: that one
    /// is cheaper, whatever the clock said.
    pub fn is_outdone(&self, other: &Self) -> bool {
        let kind = |row: &Self| (row.method, row.precision, row.terms.clone());
        let counts = |row: &Self| [row.force_evaluations, row.cg_iterations];
        let (own, fewer) = (counts(self), counts(other));
        other.meets() && kind(self) == kind(other) && own != fewer && own.iter().zip(fewer).all(|(a, b)| b <= *a)
    }
}
