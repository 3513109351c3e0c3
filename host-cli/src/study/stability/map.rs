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
    /// The stiffest and the most damped at its start.
    pub modes: [Mode; 2],
    /// The most kinetic and elastic energy that a run can have without having blown up, J.
    pub energy: f64,
}

/// The scene itself first; then stiffer and softer ones, and where it is damped more and less damped
/// ones.
pub fn grounds(study: &Study<'_>) -> Result<Vec<Ground>, Failure> {
    let stiffnesses = SCALES.map(|stiffness| (stiffness, 1.0));
    let mut grounds = Vec::new();
    for (stiffness, damping) in stiffnesses.into_iter().chain(SCALES[1..].iter().map(|&damping| (1.0, damping))) {
        let is_damped = grounds.first().is_none_or(|ground: &Ground| ground.modes[0].damping > 0.0);
        if damping == 1.0 || is_damped {
            grounds.push(ground(study, stiffness, damping)?);
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
    let mut ground = Ground { stiffness, damping, scene, modes, energy: f64::INFINITY };
    let witness = Subject { method: Method::BackwardEuler, newton: 1 };
    let step = study.scene.desc.integrator.step.min(study.scene.desc.duration / SAMPLES as f64);
    let liveliest = cell::fly(study, witness, &ground, step, f64::INFINITY)?.liveliest();
    ground.energy = BLOWN_UP * liveliest.max(REST * engine.mass());
    Ok(ground)
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

/// Runs every subject on some of all grounds.
pub fn run(study: &Study<'_>, subjects: &[Subject], all: &[Ground], some: &[Ground]) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for ground in some {
        for &subject in subjects {
            for step in steps(study, subject, all) {
                rows.push(run_cell(study, subject, ground, step)?);
            }
        }
    }
    Ok(rows)
}

/// Runs a subject on a ground by steps of about `step`, s.
pub fn run_cell(study: &Study<'_>, subject: Subject, ground: &Ground, step: f64) -> Result<Row, Failure> {
    let mut row = Row {
        method: subject.method.name(),
        newton: subject.newton,
        name: subject.name(),
        step,
        stiffness_scale: ground.stiffness,
        damping_scale: ground.damping,
        theory: ground.theory(subject.method),
        steps: 0,
        verdict: Verdict::NotRun,
        why: Some("nothing was left of the budget".into()),
    };
    if study.left().is_zero() {
        return Ok(row);
    }
    study.say(&format!("{}, step {}, stiffness x {}", row.name, time(step), ground.stiffness));
    let run = cell::fly(study, subject, ground, step, ground.energy)?;
    row.steps = run.report.steps;
    (row.verdict, row.why) = judge(&run);
    Ok(row)
}
