//! What errors are measured against: a run in double precision, by steps halved until they no
//! longer matter.

use std::time::Duration;

use muslin_core::integrate::Method;

use crate::args::Precision;
use crate::failure::Failure;

use super::Study;
use super::distance::Measure;
use super::trajectory::{Ending, Limits, Trajectory, fly};
use super::variant::{self, SAMPLES, Variant};

/// How a reference is found and how far it is believed.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// Its method.
    pub method: Method,
    /// What counts as its error.
    pub measure: Measure,
    /// Errors below this many times its own are not charted.
    pub trusted: f64,
    /// Its own error at which halving ends, m.
    pub enough: f64,
    /// How many times as far as the last halving the one before must have moved it, unless neither
    /// moved it by more than is enough; none where that is not asked.
    pub fall: Option<f64>,
}

impl Rule {
    /// Without contact RK4, which is nearest where forces are smooth. With it steps jump, none is
    /// better than of first order, and what the reference leaves cannot be a thousandth.
    ///
    /// As exact as a cloth of some diagonal, m, can be had.
    pub fn of(contact: bool, diagonal: f64) -> Self {
        let (enough, fall) = (ENOUGH * diagonal, None);
        match contact {
            false => Self { method: Method::Rk4, measure: Measure::Positions, trusted: 1e3, enough, fall },
            true => Self { method: Method::BackwardEuler, measure: Measure::Outline, trusted: 1.0, enough, fall },
        }
    }

    /// As exact as a tolerance asks, m, the first that is found: by BDF2, which bears long steps, or RK4,
    /// which bears fine tolerances, converging nearly by its order, so that what is left is less than a
    /// sixteenth. With contact a fourth, by backward Euler.
    pub fn within(contact: bool, tolerance: f64) -> Vec<Self> {
        let by = |method| {
            let fall = 2f64.powf(f64::from(variant::order(method)) - SHORT_OF_ORDER);
            Self { method, enough: tolerance / 16.0, fall: Some(fall), ..Self::of(false, 0.0) }
        };
        match contact {
            false => vec![by(Method::Bdf2), by(Method::Rk4)],
            true => vec![Self { enough: tolerance / 4.0, fall: Some(1.0), ..Self::of(true, 0.0) }],
        }
    }
}

/// Steps from sample to sample beyond which nothing is tried.
pub const MOST_STEPS: u64 = 1 << 24;

/// Its own error at which halving ends where it must be as exact as can be, of the diagonal.
const ENOUGH: f64 = 1e-12;

/// What rounding leaves at least, of what is enough.
const ROUNDING: f64 = 1e-3;

/// By how much less than its order a method may converge.
const SHORT_OF_ORDER: f64 = 0.5;

/// Times the most energy of the reference: beyond that a run has blown up.
pub const BLOWN_UP: f64 = 10.0;

/// J/kg; less is rounding where nothing moves.
const REST: f64 = 1e-6;

/// The part of the budget that it may take.
pub const SHARE: f64 = 0.4;

/// The runs of a refinement, each of twice the steps of the one before, all complete.
pub struct Reference {
    /// How it was found.
    pub rule: Rule,
    /// The variants and what came of them; the last is the reference.
    pub runs: Vec<(Variant, Trajectory)>,
    /// The last variant before them, which failed.
    pub failed: Option<(Variant, Trajectory)>,
    /// The variant after them, where the time ended it.
    pub cut: Option<(Variant, Trajectory)>,
    /// Distance between the last two, m.
    pub self_error: f64,
    /// Distance that the halving before moved it, m, if there was one.
    pub before: Option<f64>,
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

    /// Whether it is as exact as it was to be.
    pub fn is_enough(&self) -> bool {
        let falls = |fall| self.before.is_some_and(|d| d >= fall * self.self_error || d <= self.rule.enough);
        self.self_error <= self.rule.enough && self.rule.fall.is_none_or(falls)
    }

    /// The most kinetic and elastic energy that it has, J; of a cloth of some mass, kg.
    pub fn liveliest(&self, mass: f64) -> f64 {
        self.best().1.liveliest().max(REST * mass)
    }

    /// The reference itself.
    pub fn best(&self) -> &(Variant, Trajectory) {
        // Never empty where it is found.
        &self.runs[self.runs.len() - 1]
    }

    /// By which power of the step it converged in its last two halvings, if there were so many.
    pub fn order(&self) -> Option<f64> {
        self.before.map(|before| (before / self.self_error).log2())
    }

    /// Whether there are two runs to compare.
    pub fn is_found(&self) -> bool {
        self.runs.len() > 1
    }

    /// The budget that two runs to compare would take at least, s, where a run that was ended by the
    /// time tells what its step costs.
    pub fn least_budget(&self) -> Option<f64> {
        let whole = match (self.runs.as_slice(), &self.cut) {
            ([], Some((variant, run))) => run.wall * (SAMPLES * variant.steps) as f64 / run.report.steps.max(1) as f64,
            ([(_, run)], _) => run.wall,
            _ => return None,
        };
        // It and one of half its step.
        Some(3.0 * whole / SHARE)
    }
}

/// A reference, or none where no two steps could be found that work.
pub fn find(study: &Study<'_>, rule: Rule, masses: &[f64]) -> Result<Option<Reference>, Failure> {
    Ok(Some(refine(study, rule, masses)?).filter(Reference::is_found))
}

/// Refines until the error is enough or the share of the budget is used up.
pub fn refine(study: &Study<'_>, rule: Rule, masses: &[f64]) -> Result<Reference, Failure> {
    let share = study.left().mul_f64(SHARE).as_secs_f64();
    let end = study.seconds() + share;
    let mut reference =
        Reference { rule, runs: Vec::new(), failed: None, cut: None, self_error: f64::INFINITY, before: None };
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
            Ending::OutOfTime => {
                reference.cut = Some((variant, run));
                break;
            }
            // Half the step of one that worked fails: that one only seemed to.
            Ending::Diverged(_) | Ending::Grown => {
                reference.runs.clear();
                reference.self_error = f64::INFINITY;
                reference.failed = Some((variant, run));
            }
        }
        if let [.., (_, coarse), (_, fine)] = reference.runs.as_slice() {
            reference.before = Some(reference.self_error).filter(|before| before.is_finite());
            reference.self_error = rule.measure.between(coarse, fine, masses).rms.max(ROUNDING * rule.enough);
            if reference.is_enough() {
                break;
            }
        }
        variant.steps *= 2;
    }
    Ok(reference)
}
