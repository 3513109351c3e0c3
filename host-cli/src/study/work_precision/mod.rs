//! `muslin chart`: error against cost of every method in both precisions, with fixed steps and under error control.

mod causes;
mod ladder;
mod refusal;
mod report;
mod variations;
mod weigh;
mod winners;

use muslin_core::integrate::Method;

use crate::args::{ChartArguments, Precision};
use crate::failure::Failure;

use super::Study;
use super::distance::{self, Measure};
use super::draw;
use super::reference::{self, Rule};
use super::variant::{self, Variant};
pub use causes::{Cause, Causes};
use ladder::Ladder;
pub use report::{Chart, Row};
use report::{Omitted, Order, ReferenceReport};
use weigh::Yardstick;
pub use winners::front;

/// Runs the command.
pub fn chart(arguments: &ChartArguments) -> Result<(), Failure> {
    Study::run("chart", &arguments.study, |study| run(study, arguments))
}

fn run(study: &Study<'_>, arguments: &ChartArguments) -> Result<(), Failure> {
    let engine = study.engine(&study.scene, Precision::F64)?;
    let masses = engine.masses();
    let diagonal = distance::diagonal(engine.as_ref());
    let rule = Rule::of(study.scene.desc.contact.is_some(), diagonal);
    let reference = reference::refine(study, rule, &masses)?;
    if !reference.is_found() {
        return Err(Failure::Diverged(refusal::no_reference(study, &reference)));
    }
    let finest = arguments.finest.unwrap_or(0.0);
    let yardstick = Yardstick { reference: &reference, masses: &masses, diagonal, finest };
    let ladders = climb(study, &yardstick, &methods(&arguments.methods, rule.measure))?;
    let chart = complete(study, &yardstick, &ladders)?;
    if !chart.rows.iter().any(|row| row.stable) {
        return Err(Failure::Diverged(refusal::nothing_charted(&chart)));
    }
    let svg = draw::work_precision(&chart);
    study.finish(&svg, &chart, &chart.lines())?;
    match rule.measure == Measure::Positions && chart.reference.agreement.is_none() {
        true => Err(Failure::Diverged(refusal::unconfirmed(&chart))),
        false => Ok(()),
    }
}

/// The methods to run: the requested ones, each once, and where positions are compared at least one implicit method
/// that can confirm the reference. With contact implicit methods come first: the steps of explicit methods are so
/// short there that they could use up all the time.
fn methods(asked: &[Method], measure: Measure) -> Vec<Method> {
    let confirms = Method::ImplicitMidpoint;
    let added = measure == Measure::Positions && !asked.iter().any(|method| method.is_implicit());
    let wanted = |method: &Method| asked.is_empty() || asked.contains(method) || added && *method == confirms;
    let mut methods: Vec<_> = Method::ALL.into_iter().filter(wanted).collect();
    if measure == Measure::Outline {
        methods.sort_by_key(|method| !method.is_implicit());
    }
    methods
}

/// The part of the budget that is left for each of the variations of the cheapest runs and the causes of the error.
const KEPT: f64 = 0.1;

/// The largest allowed error of a step that is tried, as a part of the diagonal.
const COARSEST: f64 = 1e-2;

/// Runs every method in both precisions, with fixed steps and, if it is implicit, under error control. Double
/// precision comes first, since its errors show where single precision ends in rounding.
fn climb(study: &Study<'_>, yardstick: &Yardstick<'_>, methods: &[Method]) -> Result<Vec<Ladder>, Failure> {
    let firsts: Vec<_> = methods.iter().flat_map(|&method| firsts(study, method, yardstick.diagonal)).collect();
    let kept = study.left().mul_f64(2.0 * KEPT);
    let mut ladders: Vec<Ladder> = Vec::new();
    for (place, &first) in firsts.iter().enumerate() {
        let share = study.left().saturating_sub(kept) / (firsts.len() - place) as u32;
        let twin = ladders.last().filter(|_| first.precision == Precision::F32);
        let ladder = ladder::climb(study, yardstick, first, share, twin)?;
        ladders.push(ladder);
    }
    Ok(ladders)
}

/// The coarsest runs of a method.
fn firsts(study: &Study<'_>, method: Method, diagonal: f64) -> Vec<Variant> {
    let fixed = |precision| Variant::fixed(method, precision, 1);
    let controlled = |precision| Variant::controlled(&study.scene, method, precision, COARSEST * diagonal);
    let precisions = [Precision::F64, Precision::F32];
    let controlled = precisions.map(controlled).into_iter().filter(|_| method.is_implicit());
    precisions.map(fixed).into_iter().chain(controlled).collect()
}

/// Varies the solver of the cheapest runs, separates the causes of the error, and makes the report.
fn complete(study: &Study<'_>, yardstick: &Yardstick<'_>, ladders: &[Ladder]) -> Result<Chart, Failure> {
    let mut rows: Vec<_> = ladders.iter().flat_map(|ladder| ladder.rows.iter().cloned()).collect();
    let end = study.seconds() + 0.5 * study.left().as_secs_f64();
    rows.extend(variations::of(study, yardstick, &rows, end)?);
    let end = study.seconds() + study.left().as_secs_f64();
    let causes = causes::of(study, yardstick, &rows, end)?;
    Ok(summarise(study, yardstick, ladders, rows, causes))
}

fn summarise(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    ladders: &[Ladder],
    rows: Vec<Row>,
    causes: Option<Causes>,
) -> Chart {
    let (variant, best) = yardstick.reference.best();
    let measure = yardstick.reference.rule.measure;
    let omitted = ladders.iter().filter(|ladder| !ladder.rows.iter().any(|row| row.stable)).map(|ladder| Omitted {
        method: ladder.method().name(),
        precision: ladder.precision().name(),
        error_control: !ladder.is_fixed(),
        why: ladder.why_nothing(),
    });
    let is_ordered = |ladder: &&Ladder| ladder.is_fixed() && ladder.precision() == Precision::F64;
    let orders = ladders.iter().filter(is_ordered).filter_map(|ladder| {
        let measured = ladder.order(yardstick.reference.least_in_order() / yardstick.diagonal)?;
        Some(Order { method: ladder.method().name(), measured, theory: variant::order(ladder.method()).into() })
    });
    let least = yardstick.least();
    Chart {
        scene: study.scene.desc.name.clone(),
        duration_s: study.scene.desc.duration,
        vertices: best.samples.first().map_or(0, Vec::len),
        diagonal_m: yardstick.diagonal,
        measure,
        reference: ReferenceReport {
            method: variant.method.name(),
            step: variant.step(&study.scene),
            self_error: yardstick.reference.self_error / yardstick.diagonal,
            order: yardstick.reference.order(),
            least_charted: least,
            agreement: (measure == Measure::Positions).then(|| ladder::agreement(ladders, least)).flatten(),
        },
        machine: study.machine(),
        winners: winners::of(&rows, least),
        no_causes: causes.is_none().then(|| causes::why_none(study.scene.desc.integrator.method, &rows)),
        rows,
        causes,
        orders: orders.collect(),
        omitted: omitted.collect(),
        study_s: study.seconds(),
    }
}
