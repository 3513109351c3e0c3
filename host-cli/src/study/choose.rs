//! `muslin choose`: the cheapest method, step and terms that meet a tolerance.

mod check;
mod pilot;
mod report;
mod row;
mod saving;
mod search;
mod write;

use muslin_core::integrate::Method;

use crate::args::{ChooseArguments, Precision};
use crate::engine;
use crate::failure::Failure;
use crate::units::length;

use super::Study;
use super::distance::Measure;
use super::draw;
use super::reference::Reference;
use pilot::Pilot;
pub use report::Choice;
pub use row::Row;
use saving::Found;

/// Chooses for a scene.
pub fn choose(arguments: &ChooseArguments) -> Result<(), Failure> {
    let study = Study::begin(&arguments.study)?;
    if let Some(path) = &arguments.write {
        write::allow(&study, path)?;
    }
    let (engine, _) = engine::build(&study.scene, Precision::F32)
        .map_err(|why| Failure::Usage(format!("{}: {why}", arguments.study.of.scene)))?;
    let mut pilot = Pilot::begin(&study, engine.masses(), arguments.tolerance)?;
    let best = search::search(&mut pilot, engine.as_ref())?.ok_or_else(|| nothing_meets(&pilot))?;
    let found = saving::leave_out(&mut pilot, Found::new(&study, best), &engine.mean_edges())?;
    let checked = check::check(&mut pilot, found)?;
    if let Some(path) = &arguments.write {
        write::write(&study, &checked.found, path)?;
    }
    let choice = report::of(&pilot, &checked);
    study.finish("choose", &draw::choose(&choice), &choice, &choice.lines())
}

/// The best that there is, for who asked for more.
fn nothing_meets(pilot: &Pilot<'_>) -> Failure {
    let told = pilot.considered.iter().filter_map(|row| Some((row.error?, row)));
    let best = told.min_by(|a, b| a.0.total_cmp(&b.0));
    let reached = best.map_or_else(
        || "no method came to the end of the scene".into(),
        |(error, row)| format!("the best reached is {}, by {}", length(error), row.name()),
    );
    Failure::Diverged(format!(
        "nothing meets {} on {} within {} s: {reached}; allow that much, take a shorter --duration or a \
         larger --budget",
        length(pilot.tolerance),
        pilot.study.scene.desc.name,
        pilot.study.arguments.budget
    ))
}

/// What can be told, for who asked for more.
fn no_reference(study: &Study<'_>, tolerance: f64, reference: Option<&Reference>) -> Failure {
    let name = &study.scene.desc.name;
    let what = match reference {
        None => "its longest steps already take too long, or fail".into(),
        Some(reference) => {
            let step = crate::units::time(reference.best().0.step(&study.scene));
            let own = reference.self_error;
            match own <= reference.rule.enough {
                true => {
                    let before = reference.before.map_or_else(
                        || "and longer steps fail, so that nothing shows how it converges".into(),
                        |before| {
                            format!(
                                "halving it before by {}, which is not how a converging method does",
                                length(before)
                            )
                        },
                    );
                    format!("halving the step to {step} moves it by {}, {before}", length(own))
                }
                false => {
                    // The tolerance of which its own error is the part that it may be.
                    let reachable = own * tolerance / reference.rule.enough;
                    format!(
                        "halving the step to {step} still moves it by {}; the best tolerance that this can judge is {}",
                        length(own),
                        length(reachable)
                    )
                }
            }
        }
    };
    Failure::Diverged(format!(
        "no reference for {name} within {} s that could tell {}: {what}; allow more, take a shorter --duration, a \
         coarser or softer cloth by --set, or a larger --budget",
        study.arguments.budget,
        length(tolerance)
    ))
}

/// In the order of what is likely to be cheap: the first to meet the tolerance shortens the others.
const fn methods(measure: Measure) -> [Method; 7] {
    let [first, second, third] = match measure {
        Measure::Positions => [Method::Bdf2, Method::ImplicitMidpoint, Method::BackwardEuler],
        Measure::Outline => [Method::BackwardEuler, Method::Bdf2, Method::ImplicitMidpoint],
    };
    let [fourth, fifth] = [Method::SymplecticEuler, Method::Rk4];
    [first, second, third, fourth, fifth, Method::Midpoint, Method::ExplicitEuler]
}
