//! The runs of one method in one precision. The step is halved, or the allowed error of a step reduced, from just
//! beyond the stability limit until rounding, the reference or the time ends the series.

use std::time::Duration;

use muslin_core::integrate::Method;

use crate::args::Precision;
use crate::failure::Failure;
use crate::study::Study;
use crate::study::variant::{self, Variant};

use super::report::{Agreement, Row, is_of_order};
use super::weigh::{Yardstick, weigh};

/// Largest error of an implicit method that confirms the reference, as a part of the diagonal.
const NEAR: f64 = 1e-2;

/// An error larger than this many times the error in double precision is rounding.
const ROUNDING: f64 = 2.0;

/// Why there are no shorter steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Their errors are not far enough above the reference's own error.
    Reference,
    /// Their errors are rounding.
    Rounding,
    /// They would take too long, or are below the requested shortest step.
    Time,
    /// Error control divides no step further.
    Shortest,
}

/// The series of runs of a method in a precision, with fixed steps or under error control.
pub struct Ladder {
    /// The coarsest run that is tried.
    pub first: Variant,
    /// From coarse to fine: the last run that failed before the first stable one, and all later runs.
    pub rows: Vec<Row>,
    /// Why there are no more rows.
    pub end: End,
    /// Whether a run was started.
    pub tried: bool,
}

impl Ladder {
    /// Whether its steps have a fixed length.
    pub fn is_fixed(&self) -> bool {
        self.first.error.is_none()
    }

    /// The method.
    pub fn method(&self) -> Method {
        self.first.method
    }

    /// The precision.
    pub fn precision(&self) -> Precision {
        self.first.precision
    }

    /// Why no step works.
    pub fn why_nothing(&self) -> String {
        let Some(last) = self.rows.last() else {
            let why = if self.tried { "even its longest step takes too long" } else { "no time was left for it" };
            return why.into();
        };
        let why = last.why.as_deref().unwrap_or_default();
        let tried = match last.allowed_error_m {
            None => format!("no step down to {:.1e} s", last.step),
            Some(error) => format!("no allowed error down to {error:.1e} m"),
        };
        format!("{tried} works, finer runs take too long or are excluded by --finest: {why}")
    }

    /// Errors of the last consecutive runs whose errors are at least `least`.
    fn errors(&self, least: f64) -> Vec<f64> {
        let errors = self.rows.iter().map(|row| row.error_rms.filter(|&error| error >= least));
        let kept: Vec<_> = errors.rev().skip_while(Option::is_none).map_while(|error| error).collect();
        kept.into_iter().rev().collect()
    }

    /// The order of convergence over the last three of these errors, if there are three.
    pub fn order(&self, least: f64) -> Option<f64> {
        let errors = self.errors(least);
        let [.., first, _, last] = errors.as_slice() else { return None };
        Some(0.5 * (first / last).log2())
    }
}

/// The implicit method that converges to the reference by its own order and comes nearest to it. Without one, a
/// reference by explicit steps alone could have converged to an error that all explicit methods share.
pub fn agreement(ladders: &[Ladder], least: f64) -> Option<Agreement> {
    let is_witness = |l: &&Ladder| l.is_fixed() && l.method().is_implicit() && l.precision() == Precision::F64;
    let implicit = ladders.iter().filter(is_witness);
    let agreements = implicit.filter_map(|ladder| {
        let (order, error_rms) = (ladder.order(least)?, *ladder.errors(least).last()?);
        let agrees = error_rms < NEAR && is_of_order(order, variant::order(ladder.method()).into());
        agrees.then_some(Agreement { method: ladder.method().name(), order, error_rms })
    });
    agreements.min_by(|a, b| a.error_rms.total_cmp(&b.error_rms))
}

/// Runs finer and finer variants, from `first` on, for about the time `share`; `twin` is the same series in double
/// precision.
pub fn climb(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    first: Variant,
    share: Duration,
    twin: Option<&Ladder>,
) -> Result<Ladder, Failure> {
    let end = study.seconds() + share.as_secs_f64();
    let mut ladder = Ladder { first, rows: Vec::new(), end: End::Time, tried: false };
    let mut variant = first;
    // The reference is not compared with itself.
    let is_wanted = |variant: &Variant, last: Option<&Row>| {
        variant.is_tried() && next_step(study, variant, last) >= yardstick.finest
    };
    while is_wanted(&variant, ladder.rows.last()) && variant != yardstick.reference.best().0 {
        let left = end - study.seconds();
        ladder.tried |= left > 0.0;
        let last_wall = ladder.rows.last().filter(|row| row.stable).map_or(0.0, |row| row.wall_s);
        let Some(row) = weigh(study, yardstick, &variant, left, 2.0 * last_wall)? else { break };
        ladder.end = ended(&row, ladder.rows.last(), twin);
        // Of the runs that fail before the first stable one, only the last is kept.
        if !row.stable && !ladder.rows.iter().any(|row| row.stable) {
            ladder.rows.clear();
        }
        ladder.rows.push(row);
        if ladder.end != End::Time {
            break;
        }
        variant = variant.finer();
    }
    Ok(ladder)
}

/// The step of a variant, s; under error control about half the mean step of the last run, if its steps were divided.
fn next_step(study: &Study<'_>, variant: &Variant, last: Option<&Row>) -> f64 {
    match last.filter(|last| last.is_divided()) {
        Some(last) => 0.5 * last.step,
        None => variant.step(&study.scene),
    }
}

/// Why no run after this one is of use; `End::Time` if one is.
fn ended(row: &Row, before: Option<&Row>, twin: Option<&Ladder>) -> End {
    let is_undivided = |before: &Row| row.stable && before.stable && row.is_divided() && row.steps <= before.steps;
    match twin {
        _ if row.is_nearest() => End::Reference,
        Some(twin) if is_rounding(row, twin) => End::Rounding,
        _ if before.is_some_and(is_undivided) => End::Shortest,
        _ => End::Time,
    }
}

/// Whether the error of a row is rounding: larger than the error of the same variant in double precision.
fn is_rounding(row: &Row, twin: &Ladder) -> bool {
    let same = Variant { precision: Precision::F64, ..row.variant };
    let same = twin.rows.iter().find(|other| other.variant == same).and_then(|other| other.error_rms);
    match (row.error_rms, same) {
        (Some(single), Some(double)) => single > ROUNDING * double,
        // In double precision the error is too small for the reference to resolve.
        (Some(_), None) => twin.end == End::Reference,
        _ => false,
    }
}
