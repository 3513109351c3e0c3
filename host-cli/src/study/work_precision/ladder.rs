//! The runs of one method in one precision. The step is halved from just beyond the stability limit until rounding,
//! the reference or the time ends the series.

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

/// Runs shorter than `SHORT`, s, are made `REPEATS` times, and the median time counts.
const SHORT: f64 = 1.0;
const REPEATS: usize = 3;

/// RMS error, as a part of the diagonal, from which on a run has lost the reference completely.
const LOST: f64 = 0.5;

/// Largest error of an implicit method that confirms the reference, as a part of the diagonal.
const NEAR: f64 = 1e-2;

/// An error larger than this many times the error in double precision is rounding.
const ROUNDING: f64 = 2.0;

/// The reference and the scales that runs are measured by.
pub struct Yardstick<'a> {
    /// The reference and the coarser runs before it.
    pub reference: &'a Reference,
    /// Masses of the vertices, kg.
    pub masses: &'a [f64],
    /// Diagonal of the cloth's bounding box, m.
    pub diagonal: f64,
    /// The shortest step that is run, s.
    pub finest: f64,
}

impl Yardstick<'_> {
    /// The largest kinetic and elastic energy of the reference, J.
    fn liveliest(&self) -> f64 {
        self.reference.liveliest(self.masses.iter().sum())
    }
}

/// Why there are no shorter steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Their errors are not far enough above the reference's own error.
    Reference,
    /// Their errors are rounding.
    Rounding,
    /// They would take too long, or are below the requested shortest step.
    Time,
}

/// The series of runs of a method in a precision.
pub struct Ladder {
    /// The method.
    pub method: Method,
    /// The precision.
    pub precision: Precision,
    /// From long steps to short ones: the last run that failed before the first stable one, and all later runs.
    pub rows: Vec<Row>,
    /// Why there are no more rows.
    pub end: End,
    /// Whether a run was started.
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
        format!(
            "no step down to {:.1e} s works, shorter steps take too long or are excluded by --finest: {why}",
            last.step
        )
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
    let implicit = ladders.iter().filter(|l| l.method.is_implicit() && l.precision == Precision::F64);
    let agreements = implicit.filter_map(|ladder| {
        let (order, error_rms) = (ladder.order(least)?, *ladder.errors(least).last()?);
        let agrees = error_rms < NEAR && is_of_order(order, variant::order(ladder.method).into());
        agrees.then_some(Agreement { method: ladder.method.name(), order, error_rms })
    });
    agreements.min_by(|a, b| a.error_rms.total_cmp(&b.error_rms))
}

/// Runs a method with shorter and shorter steps for about the time `share`; `twin` is the series of the same method
/// in double precision.
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
        // Of the runs that fail before the first stable one, only the last is kept.
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

/// Whether the error of a row is rounding: larger than the error of the same step in double precision.
fn is_rounding(row: &Row, twin: &Ladder) -> bool {
    let same = twin.rows.iter().find(|other| other.step == row.step).and_then(|other| other.error_rms);
    match (row.error_rms, same) {
        (Some(single), Some(double)) => single > ROUNDING * double,
        // In double precision the error is too small for the reference to resolve.
        (Some(_), None) => twin.end == End::Reference,
        _ => false,
    }
}

/// Runs a variant, several times if it is short; takes it from the reference if it was run there. `None` if it
/// takes, or is `expected` to take, more than the time left, s.
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
        // A repeat that ran out of time gives no time.
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
    let resolved = error.filter(|[rms, _]| stable && *rms >= least);
    let why = match &run.ending {
        Ending::Complete if resolved.is_some() => None,
        Ending::Complete if stable => Some(format!("below {least:.1e}, the resolution of the reference")),
        Ending::Complete => Some("lost: it no longer resembles the reference".into()),
        Ending::Diverged(what) => Some(what.clone()),
        Ending::Grown => Some(format!("its energy grew to {BLOWN_UP} times the largest energy of the reference")),
        Ending::OutOfTime => Some("it took too long".into()),
    };
    Row {
        method: variant.method.name(),
        precision: variant.precision.name(),
        step: variant.step(&study.scene),
        tolerance: variant.method.is_implicit().then(|| variant.tolerance(&study.scene)),
        error_rms: resolved.map(|[rms, _]| rms),
        error_max: resolved.map(|[_, max]| max),
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
