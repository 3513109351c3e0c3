//! `muslin choose`: the cheapest method, step or allowed error, solver and terms that meet a tolerance.

mod check;
mod pilot;
mod report;
mod row;
mod saving;
mod search;
mod write;

use muslin_core::integrate::Method;

use crate::args::{ChooseArguments, Precision};
use crate::engine::Engine;
use crate::failure::Failure;
use crate::units::{apart, length, time};

use super::Study;
use super::distance::{self, Measure};
use super::draw;
use super::reference::Reference;
use check::Checked;
use pilot::Pilot;
pub use report::Choice;
pub use row::Row;
use saving::Candidate;

/// Runs the command.
pub fn choose(arguments: &ChooseArguments) -> Result<(), Failure> {
    Study::run("choose", &arguments.study, |study| run(study, arguments))
}

fn run(study: &Study<'_>, arguments: &ChooseArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.write {
        write::allow(study, path)?;
    }
    let engine = study.engine(&study.scene, Precision::F32)?;
    let size = distance::diagonal(engine.as_ref());
    if arguments.tolerance >= size {
        return Err(Failure::Usage(format!(
            "--tolerance {}: the cloth's diagonal is {}; take a smaller tolerance",
            length(arguments.tolerance),
            length(size)
        )));
    }
    let mut pilot = Pilot::begin(study, engine.masses(), arguments.tolerance, size)?;
    let checked = decide(&mut pilot, engine.as_ref());
    if study.is_interrupted() {
        return Err(study.suspend(Some(report::so_far(&pilot)?)));
    }
    let checked = checked?;
    if let Some(path) = &arguments.write {
        write::write(study, &checked.found, path)?;
    }
    let choice = report::of(&pilot, &checked)?;
    study.finish(&draw::choose(&choice), &choice, &choice.lines())
}

/// Searches, leaves out terms that are not needed, and checks the choice.
fn decide(pilot: &mut Pilot<'_>, engine: &dyn Engine) -> Result<Checked, Failure> {
    let best = search::search(pilot, engine)?.ok_or_else(|| nothing_meets(pilot))?;
    let found = saving::leave_out(pilot, Candidate::new(pilot.study, best), &engine.mean_edges())?;
    check::check(pilot, found)
}

/// The error if no method meets the tolerance; it names the best result.
fn nothing_meets(pilot: &Pilot<'_>) -> Failure {
    let rows = pilot.considered.iter().filter_map(|row| Some((row.error?, row)));
    let best = rows.min_by(|a, b| a.0.total_cmp(&b.0));
    let (asked, reached) = best.map_or_else(
        || (length(pilot.tolerance), "no method came to the end of the scene".into()),
        |(error, row)| {
            let [asked, error] = apart(pilot.tolerance, error);
            (asked, format!("the best reached is {error}, by {}", row.name()))
        },
    );
    Failure::Diverged(format!(
        "no method meets {asked} on {} within {} s: {reached}; allow this error, take a shorter --duration or a \
         larger --budget",
        pilot.study.scene.desc.name, pilot.study.arguments.budget
    ))
}

/// The error if no reference was found that resolves the tolerance; `size` is the diagonal of the cloth, m.
fn no_reference(study: &Study<'_>, tolerance: f64, size: f64, reference: Option<&Reference>) -> Failure {
    let what = reference.map_or_else(
        || "its longest steps already take too long, or fail".into(),
        |reference| {
            let step = time(reference.best().0.step(&study.scene));
            match reference.self_error <= reference.rule.enough {
                true => unsteady(reference, &step),
                false => too_coarse(reference, &step, tolerance, size),
            }
        },
    );
    Failure::Diverged(format!(
        "no reference for {} within {} s that is exact enough for {}: {what}; take a larger --tolerance, a shorter \
         --duration, a coarser or softer cloth by --set, or a larger --budget",
        study.scene.desc.name,
        study.arguments.budget,
        length(tolerance)
    ))
}

/// Words for a reference whose own error is small enough, but which does not converge regularly.
fn unsteady(reference: &Reference, step: &str) -> String {
    let before = reference.before.map_or_else(
        || "and longer steps fail, so its convergence cannot be seen".into(),
        |before| format!("the halving before by {}: it does not converge", length(before)),
    );
    format!("halving the step to {step} moves it by {}, {before}", length(reference.self_error))
}

/// Words for a reference whose own error is too large. They name the tolerance that this error would allow, unless
/// the cloth itself is smaller.
fn too_coarse(reference: &Reference, step: &str, tolerance: f64, size: f64) -> String {
    let reachable = reference.self_error * tolerance / reference.rule.enough;
    let best = match reachable < size {
        true => format!("the smallest tolerance that it can judge is {}", length(reachable)),
        false => format!(
            "it can judge no tolerance below the cloth's diagonal of {}: any small change moves this scene far",
            length(size)
        ),
    };
    format!("halving the step to {step} still moves it by {}; {best}", length(reference.self_error))
}

/// The methods, those that are likely to be cheap first: the first one to meet the tolerance limits the time of the
/// others.
const fn methods(measure: Measure) -> [Method; 7] {
    let [first, second, third] = match measure {
        Measure::Positions => [Method::Bdf2, Method::ImplicitMidpoint, Method::BackwardEuler],
        Measure::Outline => [Method::BackwardEuler, Method::Bdf2, Method::ImplicitMidpoint],
    };
    let [fourth, fifth] = [Method::SymplecticEuler, Method::Rk4];
    [first, second, third, fourth, fifth, Method::Midpoint, Method::ExplicitEuler]
}
