//! One method in one precision by steps in factors of two: from just beyond its limit to where
//! rounding, the reference or the time ends it.

use std::time::Duration;

use muslin_core::integrate::Method;

use crate::args::Precision;
use crate::failure::Failure;
use crate::study::Study;
use crate::study::distance;
use crate::study::median::median;
use crate::study::reference::{BLOWN_UP, MOST_STEPS, Reference};
use crate::study::trajectory::{Ending, Limits, Trajectory, fly};
use crate::study::variant::{self, Variant};

use super::report::{Agreement, Row, is_of_order};

/// Runs shorter than this are repeated, and the median time counts, s.
const SHORT: f64 = 1.0;
const REPEATS: usize = 3;

/// Part of the diagonal: what is farther off, on an average, has nothing of the reference any more.
const LOST: f64 = 0.5;

/// How near an implicit method must come to confirm the reference, of the diagonal.
const NEAR: f64 = 1e-2;

/// Times the error in double precision: there it is rounding.
const ROUNDING: f64 = 2.0;

/// What runs are measured by.
pub struct Yardstick<'a> {
    /// The reference and the runs that led to it.
    pub reference: &'a Reference,
    /// kg.
    pub masses: &'a [f64],
    /// m.
    pub diagonal: f64,
    /// The shortest step that is run, s.
    pub finest: f64,
}

impl Yardstick<'_> {
    /// The most kinetic and elastic energy of the reference, J.
    fn liveliest(&self) -> f64 {
        self.reference.liveliest(self.masses.iter().sum())
    }
}

/// Why there are no smaller steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Their error is not far enough above the reference's own.
    Reference,
    /// Their error is rounding.
    Rounding,
    /// They would take too long, or are not asked for.
    Time,
}

/// The runs of a method in a precision.
pub struct Ladder {
    /// The method.
    pub method: Method,
    /// The precision.
    pub precision: Precision,
    /// From large steps to small: the last that failed before the first that did not, and all after.
    pub rows: Vec<Row>,
    /// Why there are no more.
    pub end: End,
    /// Whether a run was begun.
    pub tried: bool,
}

impl Ladder {
    /// Why no step works.
    pub fn why_nothing(&self) -> String {
        let Some(last) = self.rows.last() else {
            let why = if self.tried { "even its longest step takes too long" } else { "no time was left for it" };
            return why.into();
        };
        let why = last.why.as_deref().unwrap_or_default();
        format!("no step down to {:.1e} s works, shorter ones take too long or are not asked for: {why}", last.step)
    }

    /// Errors above `least` of the last runs one after the other.
    fn errors(&self, least: f64) -> Vec<f64> {
        let errors = self.rows.iter().map(|row| row.error_rms.filter(|&error| error >= least));
        let kept: Vec<_> = errors.rev().skip_while(Option::is_none).map_while(|error| error).collect();
        kept.into_iter().rev().collect()
    }

    /// The slope of the error by the last three steps with errors above `least`, if there are so many.
    pub fn order(&self, least: f64) -> Option<f64> {
        let errors = self.errors(least);
        let [.., first, _, last] = errors.as_slice() else { return None };
        Some(0.5 * (first / last).log2())
    }
}

/// An implicit method that approaches the same motion by its own order, the one that comes nearest:
/// without any, a reference by explicit steps alone could be converged to what is common to all such.
pub fn agreement(ladders: &[Ladder], least: f64) -> Option<Agreement> {
    let implicit = ladders.iter().filter(|l| l.method.is_implicit() && l.precision == Precision::F64);
    let agreements = implicit.filter_map(|ladder| {
        let (order, error_rms) = (ladder.order(least)?, *ladder.errors(least).last()?);
        let agrees = error_rms < NEAR && is_of_order(order, variant::order(ladder.method).into());
        agrees.then_some(Agreement { method: ladder.method.name(), order, error_rms })
    });
    agreements.min_by(|a, b| a.error_rms.total_cmp(&b.error_rms))
}

/// Runs a method by ever smaller steps for about so long; `twin` is the same in double precision.
pub fn climb(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    method: Method,
    precision: Precision,
    share: Duration,
    twin: Option<&Ladder>,
) -> Result<Ladder, Failure> {
    let end = study.seconds() + share.as_secs_f64();
    let mut ladder = Ladder { method, precision, rows: Vec::new(), end: End::Time, tried: false };
    let mut variant = Variant { method, precision, steps: 1 };
    let mut last_wall = 0.0;
    // The reference is not compared with itself.
    let is_wanted = |variant: &Variant| variant.steps <= MOST_STEPS && variant.step(&study.scene) >= yardstick.finest;
    while is_wanted(&variant) && variant != yardstick.reference.best().0 {
        let left = end - study.seconds();
        ladder.tried |= left > 0.0;
        let Some((run, walls)) = fly_or_find(study, yardstick, &variant, left, 2.0 * last_wall)? else { break };
        last_wall = if run.ending == Ending::Complete { run.wall } else { 0.0 };
        let row = measure(study, yardstick, &variant, &run, walls);
        // Of those that fail before any works only the last is told.
        if !row.stable && !ladder.rows.iter().any(|row| row.stable) {
            ladder.rows.clear();
        }
        ladder.end = match twin {
            _ if row.is_nearest() => End::Reference,
            Some(twin) if is_rounding(&row, twin) => End::Rounding,
            _ => End::Time,
        };
        ladder.rows.push(row);
        if ladder.end != End::Time {
            break;
        }
        variant.steps *= 2;
    }
    Ok(ladder)
}

/// Whether a row is farther off than its twin in double precision.
fn is_rounding(row: &Row, twin: &Ladder) -> bool {
    let same = twin.rows.iter().find(|other| other.step == row.step).and_then(|other| other.error_rms);
    match (row.error_rms, same) {
        (Some(single), Some(double)) => single > ROUNDING * double,
        // Double precision is nearer than the reference can tell.
        (Some(_), None) => twin.end == End::Reference,
        _ => false,
    }
}

/// Runs a variant, short ones several times, unless it led to the reference; none where it takes
/// longer than what is left, as is `expected`, s.
fn fly_or_find(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    variant: &Variant,
    left: f64,
    expected: f64,
) -> Result<Option<(Trajectory, Vec<f64>)>, Failure> {
    let known = yardstick.reference.runs.iter().chain(&yardstick.reference.failed).find(|(known, _)| known == variant);
    if known.is_none() && left <= expected {
        return Ok(None);
    }
    let limits = Limits { wall: Duration::from_secs_f64(left.max(0.0)), energy: BLOWN_UP * yardstick.liveliest() };
    let run = match known {
        Some((_, run)) => limits.judge(run.clone()),
        None => fly(study, variant, limits)?,
    };
    if run.ending == Ending::OutOfTime {
        return Ok(None);
    }
    let mut walls = vec![run.wall];
    while run.ending == Ending::Complete && run.wall < SHORT && walls.len() < study.repeats(REPEATS) {
        let repeat = fly(study, variant, limits)?;
        // One that ran out of time took no time that could be told.
        if repeat.ending != Ending::Complete {
            break;
        }
        walls.push(repeat.wall);
    }
    Ok(Some((run, walls)))
}

fn measure(study: &Study<'_>, yardstick: &Yardstick<'_>, variant: &Variant, run: &Trajectory, walls: Vec<f64>) -> Row {
    let reference = &yardstick.reference.best().1;
    let complete = run.ending == Ending::Complete;
    let measure = yardstick.reference.rule.measure;
    let off = complete.then(|| measure.between(run, reference, yardstick.masses));
    let error = off.map(|off| [off.rms, off.max].map(|m| m / yardstick.diagonal));
    let stable = error.is_some_and(|[rms, _]| rms < LOST);
    let least = yardstick.reference.least() / yardstick.diagonal;
    let told = error.filter(|[rms, _]| stable && *rms >= least);
    let why = match &run.ending {
        Ending::Complete if told.is_some() => None,
        Ending::Complete if stable => Some(format!("nearer than {least:.1e}, the least that the reference can tell")),
        Ending::Complete => Some("lost: it has nothing of the reference any more".into()),
        Ending::Diverged(what) => Some(what.clone()),
        Ending::Grown => Some(format!("its energy grew to {BLOWN_UP} times the most of the reference")),
        Ending::OutOfTime => Some("it took too long".into()),
    };
    Row {
        method: variant.method.name(),
        precision: variant.precision.name(),
        step: variant.step(&study.scene),
        tolerance: variant.method.is_implicit().then(|| variant.tolerance(&study.scene)),
        error_rms: told.map(|[rms, _]| rms),
        error_max: told.map(|[_, max]| max),
        energy_drift: stable.then(|| distance::energy_drift(run, reference) / yardstick.liveliest()),
        stretch: run.stretch,
        penetration_m: run.penetration,
        repeats: walls.len(),
        wall_s: median(walls),
        force_evaluations: run.report.force_evaluations,
        cg_iterations: run.report.cg_iterations,
        matrix_products: run.report.matrix_products,
        stable,
        why,
    }
}
