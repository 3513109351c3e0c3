//! Search for the cheapest method and step. For each method the step is halved, or the allowed error of a step reduced,
//! until a run meets the tolerance; then the search goes on between the last two runs.

use muslin_core::integrate::Method;
use muslin_core::integrate::stability::Mode;

use crate::args::Precision;
use crate::engine::Engine;
use crate::failure::Failure;
use crate::study::trajectory::Ending;
use crate::study::variant::{self, SAMPLES, Variant};

use super::methods;
use super::pilot::Pilot;
use super::row::{Row, Verdict};

/// First step of an explicit method, as a fraction of the theoretical limit.
const BELOW_LIMIT: f64 = 0.95;

/// Relative accuracy of the fastest mode, and the largest number of iterations.
const STEADY: f64 = 1e-4;
const ITERATIONS: u32 = 2000;

/// A method is given up at its n-th run that is too expensive. The values are n for explicit and n for implicit
/// methods. The solves of an implicit method take longer with longer steps, so a shorter step may be cheaper. Therefore
/// an implicit method gets a second try.
const PATIENCE: [u32; 2] = [1, 2];

/// If halving the step leaves more than this fraction of the error, the error may be due to rounding.
const STALLED: f64 = 0.7;

/// Fractions of the tolerance: the error to aim for, and the error at which the search no longer tries longer steps.
const AIM: f64 = 0.9;
const NEAR: f64 = 0.8;

/// To try a longer step, the number of steps is reduced by the fraction 1 / `FEWER`; to try a larger allowed error, it
/// is multiplied by `LARGER`.
const FEWER: u64 = 20;
const LARGER: f64 = 1.5;

/// How many times a loose solver is as loose as the scene's.
const LOOSE: f64 = 100.0;

/// Number of runs between one that misses the tolerance and one that meets it, and the smallest ratio of allowed errors
/// that is tried.
const BETWEEN: u32 = 3;
const CLOSE: f64 = 1.03;

/// If the cheapest run takes less than `SHORT` seconds, all runs that take up to `RIVAL` times as long are measured
/// `ROUNDS` more times.
const RIVAL: f64 = 1.5;
const ROUNDS: usize = 4;
const SHORT: f64 = 2.0;

/// The cheapest run of all methods; `None` if no run meets the tolerance.
pub fn search(pilot: &mut Pilot<'_>, engine: &dyn Engine) -> Result<Option<Row>, Failure> {
    let modes = engine.fastest_modes(STEADY, ITERATIONS, &pilot.study.stopwatch());
    let methods = methods(pilot.reference.rule.measure);
    let firsts: Vec<_> = methods.into_iter().flat_map(|method| firsts(pilot, &modes, method)).collect();
    pilot.weigh_as_written(pilot.left() / (firsts.len() + 1) as f64)?;
    for (place, &first) in firsts.iter().enumerate() {
        let share = pilot.left() / (firsts.len() - place) as f64;
        climb(pilot, first, pilot.study.seconds() + share)?;
    }
    if pilot.study.is_clocked() {
        time_rivals(pilot)?;
    }
    Ok(pilot.cheapest().cloned())
}

/// The coarsest runs of a method: with fixed steps and, if it is implicit, with a loose solver and under error control,
/// where a step may have as large an error as the tolerance.
fn firsts(pilot: &Pilot<'_>, modes: &[Mode], method: Method) -> Vec<Variant> {
    let fixed = Variant::fixed(method, Precision::F32, first(pilot, modes, method));
    if !method.is_implicit() {
        return vec![fixed];
    }
    let controlled = Variant::controlled(&pilot.study.scene, method, Precision::F32, pilot.tolerance);
    let loose = Some(Variant { looser: LOOSE, ..fixed });
    let loose = loose.filter(|loose| loose.is_as_loose_as_asked(&pilot.study.scene));
    loose.into_iter().chain([fixed, controlled]).collect()
}

/// Initial number of steps between two samples. An explicit method starts with a step slightly shorter than its own
/// limit or that of symplectic Euler, whichever is longer. The limit of symplectic Euler is there for methods that gain
/// energy in every step. They have no useful limit of their own, but may still meet the tolerance if they gain little
/// by the end of the scene.
fn first(pilot: &Pilot<'_>, modes: &[Mode], method: Method) -> u64 {
    let [own, other] = [method, Method::SymplecticEuler].map(|method| variant::limit(modes, method));
    let limit = own.zip(other).map(|(own, other)| own.max(other));
    let sample = pilot.study.scene.desc.duration / SAMPLES as f64;
    let steps = limit.map_or(1, |limit| (sample / (BELOW_LIMIT * limit)).ceil() as u64);
    steps.max(pilot.fewest_steps())
}

/// Runs finer and finer variants until one meets the tolerance or costs too much, or until the study has run for `end`
/// seconds.
fn climb(pilot: &mut Pilot<'_>, mut variant: Variant, end: f64) -> Result<(), Failure> {
    let scene = &pilot.study.scene;
    let mut patience = PATIENCE[usize::from(variant.method.is_implicit())];
    let mut before: Option<Row> = None;
    while variant.is_tried() {
        let left = end - pilot.study.seconds();
        if left <= 0.0 {
            break;
        }
        let mut row = pilot.weigh(scene, variant, &[], left)?;
        if variant.precision == Precision::F32 && is_stalled(before.as_ref(), &row) {
            let double = pilot.weigh(scene, Variant { precision: Precision::F64, ..variant }, &[], left)?;
            // Where double precision has a smaller error, the error is rounding.
            if double.error < row.error.map(|error| STALLED * error) && double.error.is_some() {
                (variant.precision, row) = (Precision::F64, double);
            }
        }
        match row.verdict {
            Verdict::Meets => {
                return match before {
                    Some(misses) => refine(pilot, misses, row, end),
                    None => lengthen(pilot, row, end),
                };
            }
            Verdict::Dear if patience == 1 => break,
            Verdict::Dear => patience -= 1,
            Verdict::Misses | Verdict::Failed => {}
        }
        if before.as_ref().is_some_and(|before| row.is_as_divided(before)) {
            break;
        }
        before = Some(row);
        variant = variant.finer();
    }
    Ok(())
}

/// Whether halving the step hardly reduced the error although it is still too large.
fn is_stalled(before: Option<&Row>, row: &Row) -> bool {
    let before = before.filter(|before| before.steps < row.steps).and_then(|before| before.error);
    row.verdict == Verdict::Misses && before.zip(row.error).is_some_and(|(before, now)| now > STALLED * before)
}

/// Looks for a coarser run than the first one if the first one already meets the tolerance. Explicit methods gain from
/// it too. Their first step can be too short: the theoretical limit holds for the start of the scene only, the first
/// step lies below it, and step counts are rounded up.
fn lengthen(pilot: &mut Pilot<'_>, mut meets: Row, end: f64) -> Result<(), Failure> {
    let scene = &pilot.study.scene;
    while let Some(coarser) = coarser(pilot, &meets) {
        let left = end - pilot.study.seconds();
        if left <= 0.0 {
            break;
        }
        let row = pilot.weigh(scene, coarser, &[], left)?;
        if !row.meets() {
            break;
        }
        meets = row;
    }
    Ok(())
}

/// The next coarser variant; `None` if its steps are as long as they may be.
fn coarser(pilot: &Pilot<'_>, row: &Row) -> Option<Variant> {
    let variant = row.variant;
    match variant.error {
        None => {
            let steps = variant.steps - variant.steps.div_ceil(FEWER);
            (steps >= pilot.fewest_steps()).then_some(Variant { steps, ..variant })
        }
        Some(error) => {
            let larger = LARGER * error;
            (row.is_divided() && larger <= pilot.tolerance).then_some(Variant { error: Some(larger), ..variant })
        }
    }
}

/// Looks for the coarsest run between one that misses the tolerance and one that meets it.
fn refine(pilot: &mut Pilot<'_>, mut misses: Row, mut meets: Row, end: f64) -> Result<(), Failure> {
    for _ in 0..BETWEEN {
        let left = end - pilot.study.seconds();
        let near = meets.error.is_some_and(|error| error >= NEAR * pilot.tolerance) && misses.error.is_some();
        if near || left <= 0.0 || are_neighbours(&misses.variant, &meets.variant) {
            break;
        }
        let variant = between(&misses, &meets, pilot.tolerance);
        let scene = &pilot.study.scene;
        let row = pilot.weigh(scene, variant, &[], left)?;
        match row.meets() {
            true => meets = row,
            false => misses = row,
        }
    }
    Ok(())
}

/// Whether no variant between them is of use.
fn are_neighbours(coarse: &Variant, fine: &Variant) -> bool {
    match coarse.error {
        None => fine.steps <= coarse.steps + 1,
        Some(_) => fine.fineness() <= CLOSE * CLOSE * coarse.fineness(),
    }
}

/// Estimates the variant that gives an error slightly below the tolerance. The estimate uses the order of convergence
/// between two runs. If the error of one run is unknown, the estimate is the geometric mean of their finenesses. Always
/// strictly between the two runs.
fn between(misses: &Row, meets: &Row, tolerance: f64) -> Variant {
    let [coarse, fine] = [misses, meets].map(|row| row.variant.fineness());
    let part = match misses.error.zip(meets.error) {
        Some((far, near)) if near > 0.0 => (far / (AIM * tolerance)).ln() / (far / near).ln(),
        _ => 0.5,
    };
    let estimate = coarse * (fine / coarse).powf(part);
    let [least, most] = match meets.variant.error {
        None => [coarse + 1.0, fine - 1.0],
        Some(_) => [CLOSE * coarse, fine / CLOSE],
    };
    meets.variant.with_fineness(estimate.clamp(least, most))
}

/// Repeats all runs that are nearly as cheap as the cheapest, in turn, `ROUNDS` times, because a single measurement of
/// time may mislead.
fn time_rivals(pilot: &mut Pilot<'_>) -> Result<(), Failure> {
    let Some(best) = pilot.cheapest().map(|row| row.wall_s).filter(|&wall| wall < SHORT) else { return Ok(()) };
    let is_rival = |row: &Row| pilot.is_candidate(row) && row.wall_s <= RIVAL * best;
    let rivals: Vec<usize> = (0..pilot.considered.len()).filter(|&at| is_rival(&pilot.considered[at])).collect();
    for _ in 0..ROUNDS {
        for &rival in &rivals {
            let variant = pilot.considered[rival].variant;
            let run = pilot.fly(&pilot.study.scene, &variant, f64::INFINITY)?;
            // A repeat that ran out of time gives no information.
            if run.ending == Ending::Complete {
                pilot.considered[rival].timed(run.wall);
            }
        }
    }
    Ok(())
}
