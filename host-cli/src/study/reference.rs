//! The reference that errors are measured against: a run in double precision whose step is halved until a further
//! halving no longer matters.

use std::time::Duration;

use muslin_core::integrate::Method;

use crate::args::Precision;
use crate::failure::Failure;

use super::Study;
use super::distance::Measure;
use super::trajectory::{Ending, Limits, Trajectory, fly};
use super::variant::{self, SAMPLES, Variant};

/// How a reference is found, and which errors it can resolve.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// Method of the reference.
    pub method: Method,
    /// The quantity that is compared.
    pub measure: Measure,
    /// Errors smaller than `trusted` times the reference's own error are not charted.
    pub trusted: f64,
    /// Own error at which halving ends, m.
    pub enough: f64,
    /// Required ratio of the previous halving's change to the last halving's change, unless the previous change is
    /// at most `enough`. `None`: no ratio is required.
    pub fall: Option<f64>,
}

impl Rule {
    /// The rule for the most exact reference, for a cloth with the given diagonal, m.
    ///
    /// Without contact by RK4, which is the most accurate method where forces are smooth. With contact velocities
    /// jump: no method converges by more than first order, so the reference's own error cannot be a thousandth of
    /// the errors that are charted.
    pub fn of(contact: bool, diagonal: f64) -> Self {
        let (enough, fall) = (ENOUGH * diagonal, None);
        match contact {
            false => Self { method: Method::Rk4, measure: Measure::Positions, trusted: 1e3, enough, fall },
            true => Self { method: Method::BackwardEuler, measure: Measure::Outline, trusted: 1.0, enough, fall },
        }
    }

    /// Rules for a reference that is just exact enough for a tolerance, m, in the order in which they are tried.
    /// Without contact BDF2, which is stable with long steps, then RK4, which reaches fine tolerances; they must
    /// converge nearly by their order, and the last halving must change at most a sixteenth of the tolerance. With
    /// contact backward Euler and a fourth.
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

/// Own error at which halving ends for the most exact reference, as a part of the diagonal.
const ENOUGH: f64 = 1e-12;

/// Smallest own error that is assumed, as a part of `enough`: smaller distances are rounding.
const ROUNDING: f64 = 1e-3;

/// By how much the measured order of convergence may be below the order of the method.
const SHORT_OF_ORDER: f64 = 0.5;

/// A run has blown up when its energy exceeds this many times the largest energy of the reference.
pub const BLOWN_UP: f64 = 10.0;

/// Smallest energy that counts as motion, J/kg: less is rounding.
const REST: f64 = 1e-6;

/// The part of the budget that the reference may take.
pub const SHARE: f64 = 0.4;

/// The runs of a refinement. All are complete, and each takes twice the steps of the run before.
pub struct Reference {
    /// The rule by which it was found.
    pub rule: Rule,
    /// The variants and their runs; the last one is the reference.
    pub runs: Vec<(Variant, Trajectory)>,
    /// The last variant that failed before these runs.
    pub failed: Option<(Variant, Trajectory)>,
    /// The variant after these runs that ran out of time.
    pub cut: Option<(Variant, Trajectory)>,
    /// Distance between the last two runs, m.
    pub self_error: f64,
    /// Change by the halving before the last one, m, if there was one.
    pub before: Option<f64>,
}

impl Reference {
    /// The smallest error that it can resolve, m.
    pub fn least(&self) -> f64 {
        self.rule.trusted * self.self_error
    }

    /// The smallest error that an order of convergence may be computed from, m: smaller errors contain too much of
    /// the reference's own error.
    pub fn least_in_order(&self) -> f64 {
        self.least().max(8.0 * self.self_error)
    }

    /// Whether it is as exact as its rule requires.
    pub fn is_enough(&self) -> bool {
        let falls = |fall| self.before.is_some_and(|d| d >= fall * self.self_error || d <= self.rule.enough);
        self.self_error <= self.rule.enough && self.rule.fall.is_none_or(falls)
    }

    /// The largest kinetic and elastic energy of the reference, J; `mass` is the mass of the cloth, kg.
    pub fn liveliest(&self, mass: f64) -> f64 {
        self.best().1.liveliest().max(REST * mass)
    }

    /// The reference itself.
    pub fn best(&self) -> &(Variant, Trajectory) {
        // A reference that was found has at least two runs.
        &self.runs[self.runs.len() - 1]
    }

    /// The order of convergence in the last two halvings, if there were two.
    pub fn order(&self) -> Option<f64> {
        self.before.map(|before| (before / self.self_error).log2())
    }

    /// Whether there are two runs to compare.
    pub fn is_found(&self) -> bool {
        self.runs.len() > 1
    }

    /// The cost of the last run that works, s, if it were complete; `None` if no run shows it.
    fn last_cost(&self) -> Option<f64> {
        match (self.runs.as_slice(), &self.cut) {
            ([], Some((variant, run))) => {
                Some(run.wall * (SAMPLES * variant.steps) as f64 / run.report.steps.max(1) as f64)
            }
            ([.., (_, run)], _) => Some(run.wall),
            ([], None) => None,
        }
    }

    /// The smallest budget that would allow two runs to compare, s, if there are not two and some run shows the cost of
    /// a step.
    pub fn least_budget(&self) -> Option<f64> {
        // This run, and one with half the step for twice the cost.
        self.last_cost().filter(|_| !self.is_found()).map(|cost| 3.0 * cost / SHARE)
    }

    /// The cost of all runs until it is as exact as its rule requires, s, if each halving costs twice as much and
    /// changes it as much less as the rule asks. `None` if the rule asks for no convergence, or the last halving shows
    /// none.
    pub fn whole_cost(&self) -> Option<f64> {
        let fall = self.rule.fall.filter(|&fall| fall > 1.0)?;
        if self.before.is_some_and(|before| before < fall * self.self_error) {
            return None;
        }
        let halvings = match self.is_found() {
            // Three runs are the fewest that show convergence.
            false => 2,
            true => ((self.self_error / self.rule.enough).ln() / fall.ln()).ceil().max(1.0) as i32,
        };
        let known: f64 = self.runs.iter().rev().skip(1).map(|(_, run)| run.wall).sum();
        // A geometric series: the last run, and the next ones, each for twice the cost of the one before.
        Some(known + self.last_cost()? * (2f64.powi(halvings + 1) - 1.0))
    }
}

/// Halves the step until the error is small enough or the share of the budget is used up.
pub fn refine(study: &Study<'_>, rule: Rule, masses: &[f64]) -> Result<Reference, Failure> {
    let share = study.left().mul_f64(SHARE).as_secs_f64();
    let end = study.seconds() + share;
    let mut reference =
        Reference { rule, runs: Vec::new(), failed: None, cut: None, self_error: f64::INFINITY, before: None };
    let mut variant = Variant::fixed(rule.method, Precision::F64, 1);
    while variant.is_tried() {
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
            // A run that fails with half the step shows that the runs with longer steps worked only by chance: they
            // are dropped.
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
        variant = variant.finer();
    }
    Ok(reference)
}
