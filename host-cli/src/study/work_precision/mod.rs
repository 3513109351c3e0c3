//! `muslin chart`: error against cost of every method in both precisions.

mod ladder;
mod refusal;
mod report;
mod winners;

use muslin_core::integrate::Method;

use crate::args::{ChartArguments, Precision};
use crate::engine;
use crate::failure::Failure;

use super::distance::{self, Measure};
use super::draw;
use super::reference::{self, Rule};
use super::{Study, variant};
use ladder::{Ladder, Yardstick};
pub use report::{Chart, Row};
use report::{Omitted, Order, ReferenceReport};

/// Runs the command.
pub fn chart(arguments: &ChartArguments) -> Result<(), Failure> {
    let study = Study::begin(&arguments.study)?;
    let (engine, _) = engine::build(&study.scene, Precision::F64)
        .map_err(|why| Failure::Usage(format!("{}: {why}", arguments.study.of.scene)))?;
    let masses = engine.masses();
    let diagonal = distance::diagonal(engine.as_ref());
    let rule = Rule::of(study.scene.desc.contact.is_some(), diagonal);
    let reference = reference::refine(&study, rule, &masses)?;
    if !reference.is_found() {
        return Err(Failure::Diverged(refusal::no_reference(&study, &reference)));
    }
    let finest = arguments.finest.unwrap_or(0.0);
    let yardstick = Yardstick { reference: &reference, masses: &masses, diagonal, finest };
    let ladders = climb(&study, &yardstick, &methods(&arguments.methods, rule.measure))?;
    let chart = summarise(&study, &yardstick, &ladders);
    if !chart.rows.iter().any(|row| row.stable) {
        return Err(Failure::Diverged(refusal::nothing_charted(&chart)));
    }
    let svg = draw::work_precision(&chart);
    study.finish("chart", &svg, &chart, &chart.lines())?;
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

/// Runs every method in both precisions. Double precision comes first, since its errors show where single precision
/// ends in rounding.
fn climb(study: &Study<'_>, yardstick: &Yardstick<'_>, methods: &[Method]) -> Result<Vec<Ladder>, Failure> {
    let mut ladders: Vec<Ladder> = Vec::new();
    for (place, &method) in methods.iter().enumerate() {
        for (half, precision) in [Precision::F64, Precision::F32].into_iter().enumerate() {
            let to_come = 2 * (methods.len() - place) - half;
            let share = study.left() / to_come as u32;
            let twin = ladders.last().filter(|_| precision == Precision::F32);
            let ladder = ladder::climb(study, yardstick, method, precision, share, twin)?;
            ladders.push(ladder);
        }
    }
    Ok(ladders)
}

fn summarise(study: &Study<'_>, yardstick: &Yardstick<'_>, ladders: &[Ladder]) -> Chart {
    let (variant, best) = yardstick.reference.best();
    let measure = yardstick.reference.rule.measure;
    let omitted = ladders.iter().filter(|ladder| !ladder.rows.iter().any(|row| row.stable)).map(|ladder| Omitted {
        method: ladder.method.name(),
        precision: ladder.precision.name(),
        why: ladder.why_nothing(),
    });
    let orders = ladders.iter().filter(|ladder| ladder.precision == Precision::F64).filter_map(|ladder| {
        let measured = ladder.order(yardstick.reference.least_in_order() / yardstick.diagonal)?;
        Some(Order { method: ladder.method.name(), measured, theory: variant::order(ladder.method).into() })
    });
    let rows: Vec<_> = ladders.iter().flat_map(|ladder| ladder.rows.iter().cloned()).collect();
    let least = yardstick.reference.least() / yardstick.diagonal;
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
        rows,
        orders: orders.collect(),
        omitted: omitted.collect(),
        study_s: study.seconds(),
    }
}
