//! `muslin choose`: the cheapest method, step or allowed error, solver and terms that meet a tolerance.

mod check;
mod pilot;
mod refusal;
mod report;
mod row;
mod saving;
mod search;
mod write;

use muslin_core::integrate::Method;

use crate::args::{ChooseArguments, Precision};
use crate::engine::Engine;
use crate::failure::Failure;
use crate::units::length;

use super::Study;
use super::distance::{self, Measure};
use super::draw;
use check::Checked;
use pilot::Pilot;
pub use report::Choice;
pub use row::{Row, Verdict};
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
        write::write(study, arguments.tolerance, &checked.found, path)?;
    }
    let choice = report::of(&pilot, &checked)?;
    study.finish(&draw::choose(&choice), &choice, &choice.lines())
}

/// Searches, leaves out terms that are not needed, and checks the choice.
fn decide(pilot: &mut Pilot<'_>, engine: &dyn Engine) -> Result<Checked, Failure> {
    let best = search::search(pilot, engine)?.ok_or_else(|| refusal::nothing_meets(pilot))?;
    let found = saving::leave_out(pilot, Candidate::new(pilot.study, best), &engine.mean_edges())?;
    check::check(pilot, found)
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
