//! Error messages for a choice that cannot be made.

use crate::failure::Failure;
use crate::study::Study;
use crate::study::reference::{Reference, SHARE};
use crate::units::{apart, length, significant, time};

use super::pilot::Pilot;

/// A budget that is advised is this many times as large as the one that finds the reference: the search needs time
/// too.
const ROOM: f64 = 1.5;

/// The error if no method meets the tolerance; it names the best result.
pub fn nothing_meets(pilot: &Pilot<'_>) -> Failure {
    let allowed = pilot.considered.iter().filter(|row| row.is_allowed(pilot.tolerance));
    let rows = allowed.filter_map(|row| Some((row.error?, row)));
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

/// The error if no reference resolves the tolerance. `tried` are the references in the order of their search, `size` is
/// the diagonal of the cloth, m.
pub fn no_reference(study: &Study<'_>, tolerance: f64, size: f64, tried: &[Reference]) -> Failure {
    let found = tried.iter().filter(|reference| reference.is_found());
    let nearest = found.min_by(|a, b| a.self_error.total_cmp(&b.self_error));
    let reached = match nearest {
        None => tried.first().map_or_else(String::new, |first| not_begun(study, first)),
        Some(reference) => {
            let step = time(reference.best().0.step(&study.scene));
            match reference.self_error <= reference.rule.enough {
                true => unsteady(reference, &step),
                false => too_coarse(reference, &step, tolerance, size),
            }
        }
    };
    Failure::Diverged(format!(
        "no reference for {} within {} s that is exact enough for {}: {reached}; take a larger --tolerance, a shorter \
         --duration, a coarser or softer cloth by --set, or {}",
        study.scene.desc.name,
        study.arguments.budget,
        length(tolerance),
        budget(tried)
    ))
}

/// The smallest budget in which the search for one of the references ends, in words. Every reference has its share of
/// the budget that the ones before leave. Where no two runs can be compared, nobody knows how many more are needed.
fn budget(tried: &[Reference]) -> String {
    let least = |is_found: bool| {
        let cost = |(before, reference): (usize, &Reference)| {
            let cost = reference.whole_cost().filter(|_| reference.is_found() == is_found)?;
            Some(ROOM * cost / (SHARE * (1.0 - SHARE).powi(before as i32)))
        };
        tried.iter().enumerate().filter_map(cost).min_by(f64::total_cmp).map(|seconds| significant(seconds, 2))
    };
    match (least(true), least(false)) {
        (Some(budget), _) => format!("a --budget of {budget}, which is enough if the steps go on to converge"),
        (None, Some(budget)) => format!("a --budget of {budget} or more"),
        (None, None) => "a larger --budget".into(),
    }
}

/// Words for a reference that has no two runs to compare.
fn not_begun(study: &Study<'_>, reference: &Reference) -> String {
    let told = reference.runs.last().or(reference.cut.as_ref()).or(reference.failed.as_ref());
    let Some((variant, run)) = told else { return "there was no time for a run".into() };
    let (step, wall) = (time(variant.step(&study.scene)), time(run.wall));
    match (reference.runs.last(), &reference.cut) {
        (Some(_), _) => format!("a run with steps of {step} takes {wall}, and one with half the step did not fit"),
        (None, Some(_)) => format!("a run with steps of {step} takes longer than {wall}"),
        (None, None) => format!("runs with steps of {step} and longer fail"),
    }
}

/// Words for a reference whose own error is small enough, but which does not converge regularly.
fn unsteady(reference: &Reference, step: &str) -> String {
    let before = match (reference.before, &reference.failed) {
        (Some(before), _) => format!("the halving before by {}: it does not converge", length(before)),
        (None, Some(_)) => "and longer steps fail, so its convergence cannot be seen".into(),
        (None, None) => "and there was no time for the next halving, which shows whether it converges".into(),
    };
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
