//! What errors are measured against: a run in double precision, by steps halved until they no
//! longer matter.

use std::time::Duration;

use muslin_core::integrate::Method;

use crate::args::Precision;
use crate::failure::Failure;

use super::Study;
use super::distance::Measure;
use super::trajectory::{Ending, Limits, Trajectory, fly};
use super::variant::Variant;

/// How a reference is found and how far it is believed.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// Its method.
    pub method: Method,
    /// What counts as its error.
    pub measure: Measure,
    /// Errors below this many times its own are not charted.
    pub trusted: f64,
}

impl Rule {
    /// Without contact RK4, which is nearest where forces are smooth. With it steps jump, none is
    /// better than of first order, and what the reference leaves cannot be a thousandth.
    pub fn of(contact: bool) -> Self {
        match contact {
            false => Self { method: Method::Rk4, measure: Measure::Positions, trusted: 1e3 },
            true => Self { method: Method::BackwardEuler, measure: Measure::Outline, trusted: 1.0 },
        }
    }
}

/// Steps from sample to sample beyond which nothing is tried.
pub const MOST_STEPS: u64 = 1 << 24;

/// Its own error at which halving ends, of the diagonal.
const ENOUGH: f64 = 1e-12;

/// What rounding leaves at least, of the diagonal.
const ROUNDING: f64 = 1e-15;

/// The part of the budget that it may take.
const SHARE: f64 = 0.4;

/// The runs of a refinement, each of twice the steps of the one before, all complete.
pub struct Reference {
    /// How it was found.
    pub rule: Rule,
    /// The variants and what came of them; the last is the reference.
    pub runs: Vec<(Variant, Trajectory)>,
    /// The last variant before them, which failed.
    pub failed: Option<(Variant, Trajectory)>,
    /// Distance between the last two, m.
    pub self_error: f64,
}

impl Reference {
    /// The least error that it can tell, m.
    pub fn least(&self) -> f64 {
        self.rule.trusted * self.self_error
    }

    /// The least error of which the order can be told, m: beside smaller ones its own counts.
    pub fn least_in_order(&self) -> f64 {
        self.least().max(8.0 * self.self_error)
    }

    /// The reference itself.
    pub fn best(&self) -> &(Variant, Trajectory) {
        // Never empty: `find` sees to it.
        &self.runs[self.runs.len() - 1]
    }
}

/// Refines until the error is `ENOUGH` or the share of the budget is used up; none where no step
/// could be found that works.
pub fn find(study: &Study<'_>, rule: Rule, masses: &[f64], diagonal: f64) -> Result<Option<Reference>, Failure> {
    let share = study.left().mul_f64(SHARE).as_secs_f64();
    let end = study.seconds() + share;
    let mut reference = Reference { rule, runs: Vec::new(), failed: None, self_error: f64::INFINITY };
    let mut variant = Variant { method: rule.method, precision: Precision::F64, steps: 1 };
    while variant.steps <= MOST_STEPS {
        let left = end - study.seconds();
        let next = reference.runs.last().map_or(0.0, |(_, run)| 2.0 * run.wall);
        if next > left || left <= 0.0 {
            break;
        }
        let wall = Duration::from_secs_f64(left);
        let run = fly(study, &variant, Limits { wall, energy: f64::INFINITY })?;
        match run.ending {
            Ending::Complete => reference.runs.push((variant, run)),
            Ending::OutOfTime => break,
            // Half the step of one that worked fails: that one only seemed to.
            Ending::Diverged(_) | Ending::Grown => {
                reference.runs.clear();
                reference.failed = Some((variant, run));
            }
        }
        if let [.., (_, coarse), (_, fine)] = reference.runs.as_slice() {
            reference.self_error = rule.measure.between(coarse, fine, masses).rms.max(ROUNDING * diagonal);
            if reference.self_error <= ENOUGH * diagonal {
                break;
            }
        }
        variant.steps *= 2;
    }
    Ok((reference.runs.len() > 1).then_some(reference))
}
