//! One method in one precision by steps in factors of two: from just beyond its limit to where
//! rounding, the reference or the time ends it.

use std::time::Duration;

use muslin_core::integrate::Method;

use crate::args::Precision;
use crate::failure::Failure;
use crate::study::Study;
use crate::study::distance;
use crate::study::reference::{MOST_STEPS, Reference};
use crate::study::trajectory::{Ending, Limits, Trajectory, fly};
use crate::study::variant::Variant;

use super::report::{Agreement, Row};

/// Runs shorter than this are repeated, and the median time counts, s.
const SHORT: f64 = 1.0;
const REPEATS: usize = 3;

/// Times the most energy of the reference: beyond that a run has blown up.
const BLOWN_UP: f64 = 10.0;

/// Part of the diagonal: what is farther off, on an average, has nothing of the reference any more.
const LOST: f64 = 0.5;

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
}

/// Why there are no smaller steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Their error is not far enough above the reference's own.
    Reference,
    /// Their error is rounding.
    Rounding,
    /// They would take too long.
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
}

impl Ladder {
    /// Why no step works.
    pub fn why_nothing(&self) -> String {
        let last = self.rows.last().and_then(|row| row.why.as_deref()).unwrap_or("not run");
        let step = self.rows.last().map_or(0.0, |row| row.step);
        match self.end {
            End::Time => format!("no step down to {step:.1e} s works, shorter ones take too long: {last}"),
            _ => last.into(),
        }
    }

    /// Errors of complete runs, steps falling by two, without those on the floor.
    fn errors(&self) -> Vec<f64> {
        self.rows.iter().filter_map(|row| row.error_rms).collect()
    }

    /// The slope of the error by the last three steps, if there are so many.
    pub fn order(&self) -> Option<f64> {
        let errors = self.errors();
        let [.., first, _, last] = errors.as_slice() else { return None };
        Some(0.5 * (first / last).log2())
    }
}

/// That an implicit method approaches the same motion: without this, a reference by explicit steps
/// alone could be converged to what is common to all such.
pub fn agreement(ladders: &[Ladder]) -> Option<Agreement> {
    let implicit = ladders.iter().filter(|l| l.method.is_implicit() && l.precision == Precision::F64);
    let agreements = implicit.filter_map(|ladder| {
        let (order, error_rms) = (ladder.order()?, *ladder.errors().last()?);
        Some(Agreement { method: ladder.method.name(), order, error_rms })
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
    let mut ladder = Ladder { method, precision, rows: Vec::new(), end: End::Time };
    let mut variant = Variant { method, precision, steps: 1 };
    let mut last_wall = 0.0;
    while variant.steps <= MOST_STEPS {
        let left = end - study.seconds();
        if left <= 2.0 * last_wall {
            break;
        }
        let Some((run, walls)) = fly_or_find(study, yardstick, &variant, left)? else { break };
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

/// Runs a variant, short ones several times, unless the reference was made by it; none where it
/// takes too long.
fn fly_or_find(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    variant: &Variant,
    left: f64,
) -> Result<Option<(Trajectory, Vec<f64>)>, Failure> {
    let known = yardstick.reference.runs.iter().chain(&yardstick.reference.failed).find(|(known, _)| known == variant);
    if let Some((_, run)) = known {
        return Ok(Some((run.clone(), vec![run.wall])));
    }
    let energy = BLOWN_UP * yardstick.reference.best().1.liveliest();
    let limits = Limits { wall: Duration::from_secs_f64(left), energy };
    let run = fly(study, variant, limits)?;
    if run.ending == Ending::OutOfTime {
        return Ok(None);
    }
    let mut walls = vec![run.wall];
    while run.ending == Ending::Complete && run.wall < SHORT && walls.len() < REPEATS {
        walls.push(fly(study, variant, limits)?.wall);
    }
    walls.sort_by(f64::total_cmp);
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
        energy_drift: stable.then(|| distance::energy_drift(run, reference) / reference.liveliest()),
        stretch: run.stretch,
        penetration_m: run.penetration,
        wall_s: walls[walls.len() / 2],
        repeats: walls.len(),
        force_evaluations: run.report.force_evaluations,
        cg_iterations: run.report.cg_iterations,
        matrix_products: run.report.matrix_products,
        stable,
        why,
    }
}
