//! The check of the choice: new runs against a reference with half the step.

use std::time::Duration;

use crate::failure::Failure;
use crate::study::median::median;
use crate::study::trajectory::{Ending, Limits, Trajectory, fly, fly_of};
use crate::study::variant::Variant;
use crate::units::apart;

use super::pilot::Pilot;
use super::row::Row;
use super::saving::Candidate;

/// A choice that misses the tolerance in the check gets 1 / `FINER` more steps, or `SMALLER` times the allowed error.
/// The choice is checked at most `ROUNDS` times.
const ROUNDS: u64 = 4;
const FINER: u64 = 16;
const SMALLER: f64 = 0.8;

/// The choice is run this often if a run takes less than `SHORT`, s.
const REPEATS: usize = 3;
const SHORT: f64 = 2.0;

/// The checked choice.
pub struct Checked {
    /// The choice.
    pub found: Candidate,
    /// RMS error, m.
    pub error: f64,
    /// Median computing time, s.
    pub wall: f64,
    /// Step of the reference of the check, s: the step of the pilot's reference if there was no time for a shorter
    /// one.
    pub step: f64,
}

/// Checks the choice, and makes it slightly finer if it misses the tolerance. An error means that finer runs do not
/// help.
pub fn check(pilot: &mut Pilot<'_>, mut found: Candidate) -> Result<Checked, Failure> {
    let (variant, finer) = finer_reference(pilot)?;
    let step = variant.step(&pilot.study.scene);
    let mut nearest = f64::INFINITY;
    for _ in 0..ROUNDS {
        let (error, wall) = measure(pilot, &found, finer.as_ref())?;
        if error <= pilot.tolerance {
            return Ok(Checked { found, error, wall, step });
        }
        nearest = nearest.min(error);
        found.row = slightly_finer(pilot, &found)?;
    }
    let [asked, nearest] = apart(pilot.tolerance, nearest);
    Err(Failure::Diverged(format!(
        "the choice for {}, {}, misses {asked} in its check: its error is {nearest}, and slightly finer runs do \
         not reduce it; allow this error or take a shorter --duration",
        pilot.study.scene.desc.name,
        found.row.name(),
    )))
}

/// The variant of the check's reference with its run, which has half the step of the pilot's reference. Without
/// time for this run, the variant of the pilot's reference and `None`.
fn finer_reference(pilot: &Pilot<'_>) -> Result<(Variant, Option<Trajectory>), Failure> {
    let coarse = pilot.reference.best().0;
    let variant = coarse.finer();
    let wall = pilot.study.left().max(Duration::from_millis(1));
    let run = fly(pilot.study, &variant, Limits { wall, energy: f64::INFINITY })?;
    Ok(match run.ending {
        Ending::Complete => (variant, Some(run)),
        _ => (coarse, None),
    })
}

/// Error, m, and computing time, s, of new runs of a choice.
fn measure(pilot: &Pilot<'_>, found: &Candidate, finer: Option<&Trajectory>) -> Result<(f64, f64), Failure> {
    let reference = finer.unwrap_or(&pilot.reference.best().1);
    // This run has been completed before, so it ends even without a time limit.
    let limits = Limits { wall: Duration::MAX, energy: f64::INFINITY };
    let scene = &found.scene;
    let fly = || fly_of(pilot.study, scene, &found.row.variant, limits);
    let run = fly()?;
    let mut walls = vec![run.wall];
    while run.wall < SHORT && walls.len() < pilot.study.repeats(REPEATS) {
        walls.push(fly()?.wall);
    }
    let complete = run.ending == Ending::Complete;
    Ok((if complete { pilot.error(&run, reference) } else { f64::INFINITY }, median(walls)))
}

/// Runs a slightly finer choice to its end. This gives the new prediction.
fn slightly_finer(pilot: &mut Pilot<'_>, found: &Candidate) -> Result<Row, Failure> {
    let variant = found.row.variant;
    let variant = match variant.error {
        None => Variant { steps: variant.steps + variant.steps.div_ceil(FINER), ..variant },
        Some(error) => Variant { error: Some(SMALLER * error), ..variant },
    };
    pilot.weigh_whole(&found.scene, variant, &found.row.terms)
}
