//! The cells of the maps: which there are, and all of them run.

use muslin_core::integrate::Method;
use muslin_core::integrate::stability::Mode;

use crate::args::Precision;
use crate::engine;
use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::study::Study;
use crate::study::variant::{self, SAMPLES};
use crate::units::time;

use super::cell::{self, Subject, Verdict, judge};
use super::report::Row;
use super::share::Share;

/// Where a scene says how stiff it is.
const STIFFNESS: [&str; 6] = [
    "cloth.stretch.stiffness",
    "cloth.stretch.weft",
    "cloth.shear.stiffness",
    "cloth.bend.rigidity",
    "cloth.bend.stiffness",
    "cloth.seam.stiffness",
];

/// Where a scene says how much of its stiffness damps it.
const DAMPING: [&str; 4] = ["cloth.stretch.damping", "cloth.shear.damping", "cloth.bend.damping", "cloth.seam.damping"];

/// Times its stiffness or damping, from the scene itself outwards.
const SCALES: [f64; 5] = [1.0, 0.25, 4.0, 0.0625, 16.0];

/// Steps of explicit methods by factors of the root of two, from half the shortest limit on any ground
/// to twice the longest; of implicit ones by factors of two, from a quarter of the scene's step on.
const BEYOND: f64 = 2.0;
const FINER: i32 = 2;
const COARSER: i32 = 6;

/// Times the most energy of the witness: beyond that a run has blown up.
const BLOWN_UP: f64 = 10.0;

/// J/kg; less is rounding where nothing moves.
const REST: f64 = 1e-6;

/// How steady the fastest mode must be, and iterations at most.
const STEADY: f64 = 1e-7;
const ITERATIONS: u32 = 20_000;

/// A scene of some stiffness and damping.
pub struct Ground {
    /// Times the stiffness of the scene that was given.
    pub stiffness: f64,
    /// Times its damping, as a part of the stiffness.
    pub damping: f64,
    /// The scene.
    pub scene: SceneFile,
    /// kg.
    pub mass: f64,
    /// The stiffest and the most damped at its start.
    pub modes: [Mode; 2],
    /// The most kinetic and elastic energy that a run can have without having blown up, J.
    pub energy: f64,
}

/// The scene itself first; then stiffer and softer ones, and where it is damped more and less damped
/// ones.
pub fn grounds(study: &Study<'_>) -> Result<Vec<Ground>, Failure> {
    let stiffnesses = SCALES.map(|stiffness| (stiffness, 1.0));
    let scales: Vec<_> = stiffnesses.into_iter().chain(SCALES[1..].iter().map(|&damping| (1.0, damping))).collect();
    let mut grounds: Vec<Ground> = Vec::new();
    for (place, &(stiffness, damping)) in scales.iter().enumerate() {
        let is_damped = grounds.first().is_none_or(|ground| ground.modes[0].damping > 0.0);
        if damping == 1.0 || is_damped {
            let mut ground = ground(study, stiffness, damping)?;
            // Half is for the map. The scene itself is seen to its end, livelier likenesses for some time.
            let own = match grounds.first() {
                None => liveliest(&Share::one_of(2, study), &ground, true)?,
                Some(_) if stiffness < 1.0 || damping < 1.0 => {
                    liveliest(&Share::one_of(2 * (scales.len() - place), study), &ground, false)?
                }
                Some(_) => 0.0,
            };
            ground.energy = (BLOWN_UP * own).max(grounds.first().map_or(0.0, |scene| scene.energy));
            grounds.push(ground);
        }
    }
    Ok(grounds)
}

fn ground(study: &Study<'_>, stiffness: f64, damping: f64) -> Result<Ground, Failure> {
    study.say(&format!("stiffness x {stiffness}, damping x {damping}: its fastest mode"));
    let scene = study.scene.scaled(&STIFFNESS, stiffness)?.scaled(&DAMPING, damping)?;
    let (engine, _) = engine::build(&scene, Precision::F64)
        .map_err(|why| Failure::Usage(format!("{}: {why}", study.arguments.of.scene)))?;
    let modes = engine.fastest_modes(STEADY, ITERATIONS);
    Ok(Ground { stiffness, damping, scene, modes, mass: engine.mass(), energy: f64::INFINITY })
}

/// The most kinetic and elastic energy of the witness, J.
fn liveliest(share: &Share<'_, '_>, ground: &Ground, to_its_end: bool) -> Result<f64, Failure> {
    let desc = &share.study.scene.desc;
    let witness = Subject { method: Method::BackwardEuler, newton: 1 };
    let step = desc.integrator.step.min(desc.duration / SAMPLES as f64);
    let watched = cell::watched(desc.duration, step, witness.method);
    let steps = if to_its_end { cell::whole(desc.duration, step) } else { watched };
    let run = cell::fly(share, witness, ground, (step, steps), f64::INFINITY)?;
    Ok(run.liveliest().max(REST * ground.mass))
}

/// Steps at which a subject is run, s; the same on every ground.
fn steps(study: &Study<'_>, subject: Subject, grounds: &[Ground]) -> Vec<f64> {
    if subject.method.is_implicit() {
        let desc = &study.scene.desc;
        let longest = desc.duration / SAMPLES as f64;
        let steps = (-FINER..=COARSER).map(|k| desc.integrator.step.min(longest) * 2f64.powi(k));
        return steps.filter(|&step| step <= longest).collect();
    }
    let limit = |ground: &Ground| variant::limit(&ground.modes, subject.method);
    let limits = grounds.iter().filter_map(limit);
    let (low, high) = limits.fold((f64::INFINITY, 0.0_f64), |(low, high), limit| (low.min(limit), high.max(limit)));
    // On the limit of the scene itself, so that maps show both sides of it.
    let Some(own) = limit(&grounds[0]) else { return Vec::new() };
    let halves = |ratio: f64| (2.0 * ratio.log2()).round() as i32;
    let steps = halves(low / BEYOND / own)..=halves(high * BEYOND / own);
    steps.map(|half| own * 2f64.powf(0.5 * f64::from(half) - 0.25)).collect()
}

/// Runs every subject on some of all grounds, each for its share of the time.
pub fn run(study: &Study<'_>, subjects: &[Subject], all: &[Ground], some: &[Ground]) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let pairs: Vec<_> = some.iter().flat_map(|ground| subjects.iter().map(move |&subject| (ground, subject))).collect();
    for (place, &(ground, subject)) in pairs.iter().enumerate() {
        let share = Share::one_of(pairs.len() - place, study);
        for step in steps(study, subject, all) {
            rows.push(run_cell(&share, subject, ground, step)?);
        }
    }
    Ok(rows)
}

/// Runs what its share did not do for, with what others left of theirs.
pub fn run_rest(study: &Study<'_>, subjects: &[Subject], grounds: &[Ground], rows: &mut [Row]) -> Result<(), Failure> {
    let rest: Vec<_> = rows.iter_mut().filter(|row| row.verdict == Verdict::NotRun).collect();
    let count = rest.len();
    for (place, row) in rest.into_iter().enumerate() {
        let is_of = |ground: &&Ground| (ground.stiffness, ground.damping) == (row.stiffness_scale, row.damping_scale);
        let subject = subjects.iter().find(|&&subject| row.is_of(subject));
        if let (Some(&subject), Some(ground)) = (subject, grounds.iter().find(is_of)) {
            *row = run_cell(&Share::one_of(count - place, study), subject, ground, row.step)?;
        }
    }
    Ok(())
}

/// Runs a subject on a ground by steps of `step` seconds.
pub fn run_cell(share: &Share<'_, '_>, subject: Subject, ground: &Ground, step: f64) -> Result<Row, Failure> {
    let mut row = Row {
        method: subject.method.name(),
        newton: subject.newton,
        name: subject.name(),
        step,
        stiffness_scale: ground.stiffness,
        damping_scale: ground.damping,
        theory: ground.theory(subject.method),
        steps: 0,
        watched: 0.0,
        wall: 0.0,
        verdict: Verdict::NotRun,
        why: Some("its share of the budget was used up".into()),
    };
    if share.left().is_zero() {
        return Ok(row);
    }
    share.study.say(&format!("{}, step {}, stiffness x {}", row.name, time(step), ground.stiffness));
    let steps = cell::watched(share.study.scene.desc.duration, step, subject.method);
    let run = cell::fly(share, subject, ground, (step, steps), ground.energy)?;
    row.steps = run.report.steps;
    (row.watched, row.wall) = (row.steps as f64 * step, run.wall);
    (row.verdict, row.why) = judge(&run);
    Ok(row)
}
