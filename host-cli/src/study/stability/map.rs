//! The cells of the maps: their choice and their runs.

use muslin_core::integrate::Method;
use muslin_core::integrate::stability::Mode;
use muslin_core::scene::IntegratorDesc;

use crate::args::Precision;
use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::study::Study;
use crate::study::variant::{self, SAMPLES};
use crate::units::time;

use super::cell::{self, Subject, Verdict, judge};
use super::report::{Control, Row};
use super::share::Share;

/// Keys of a scene with stiffnesses.
const STIFFNESS: [&str; 6] = [
    "cloth.stretch.stiffness",
    "cloth.stretch.weft",
    "cloth.shear.stiffness",
    "cloth.bend.rigidity",
    "cloth.bend.stiffness",
    "cloth.seam.stiffness",
];

/// Keys of a scene with dampings, as parts of the stiffness.
const DAMPING: [&str; 4] = ["cloth.stretch.damping", "cloth.shear.damping", "cloth.bend.damping", "cloth.seam.damping"];

/// Factors of stiffness or damping; the scene itself comes first.
const SCALES: [f64; 5] = [1.0, 0.25, 4.0, 0.0625, 16.0];

/// Range of steps. Explicit methods: by factors of the square root of two, from half the shortest limit on any
/// ground to twice the longest. Implicit methods: by factors of two, from a quarter of the scene's step on.
const BEYOND: f64 = 2.0;
const FINER: i32 = 2;
const COARSER: i32 = 6;

/// A run has blown up when its energy exceeds this many times the largest energy of backward Euler.
const BLOWN_UP: f64 = 10.0;

/// Smallest energy that counts as motion, J/kg: less is rounding.
const REST: f64 = 1e-6;

/// Relative accuracy of the fastest mode, and the largest number of iterations.
const STEADY: f64 = 1e-7;
const ITERATIONS: u32 = 20_000;

/// A scene with scaled stiffness and damping.
pub struct Ground {
    /// Factor of the stiffness of the given scene.
    pub stiffness: f64,
    /// Factor of its damping, which is a part of the stiffness.
    pub damping: f64,
    /// The scene.
    pub scene: SceneFile,
    /// Mass of the cloth, kg.
    pub mass: f64,
    /// The stiffest mode and the most damped mode at its start.
    pub modes: [Mode; 2],
    /// Kinetic and elastic energy above which a run counts as blown up, J.
    pub energy: f64,
}

/// The scene itself first; then stiffer and softer ones, and if it is damped, ones with more and less damping.
pub fn grounds(study: &Study<'_>) -> Result<Vec<Ground>, Failure> {
    let stiffnesses = SCALES.map(|stiffness| (stiffness, 1.0));
    let scales: Vec<_> = stiffnesses.into_iter().chain(SCALES[1..].iter().map(|&damping| (1.0, damping))).collect();
    let mut grounds: Vec<Ground> = Vec::new();
    for (place, &(stiffness, damping)) in scales.iter().enumerate() {
        let is_damped = grounds.first().is_none_or(|ground| ground.modes[0].damping > 0.0);
        if damping == 1.0 || is_damped {
            let mut ground = ground(study, stiffness, damping)?;
            // Half of the budget is for the map. The energy is measured on the scene itself until its end, and on
            // softer and less damped scenes, which move more, for some time.
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
    let engine = study.engine(&scene, Precision::F64)?;
    let modes = engine.fastest_modes(STEADY, ITERATIONS, &study.stopwatch());
    if study.is_interrupted() {
        return Err(study.suspend(None));
    }
    Ok(Ground { stiffness, damping, scene, modes, mass: engine.mass(), energy: f64::INFINITY })
}

/// The largest kinetic and elastic energy of a run by backward Euler, J.
fn liveliest(share: &Share<'_, '_>, ground: &Ground, to_its_end: bool) -> Result<f64, Failure> {
    let desc = &share.study.scene.desc;
    let witness = Subject { method: Method::BackwardEuler, newton: 1 };
    let step = desc.integrator.step().min(desc.duration / SAMPLES as f64);
    let watched = cell::watched(desc.duration, step, witness.method);
    let steps = if to_its_end { cell::whole(desc.duration, step) } else { watched };
    let run = cell::fly(share, witness, ground, (step, steps), None, f64::INFINITY)?;
    Ok(run.liveliest().max(REST * ground.mass))
}

/// The steps of a subject, s; they are the same on every ground.
fn steps(study: &Study<'_>, subject: Subject, grounds: &[Ground]) -> Vec<f64> {
    if subject.method.is_implicit() {
        let desc = &study.scene.desc;
        let longest = desc.duration / SAMPLES as f64;
        let steps = (-FINER..=COARSER).map(|k| desc.integrator.step().min(longest) * 2f64.powi(k));
        return steps.filter(|&step| step <= longest).collect();
    }
    let limit = |ground: &Ground| variant::limit(&ground.modes, subject.method);
    let limits = grounds.iter().filter_map(limit);
    let (low, high) = limits.fold((f64::INFINITY, 0.0_f64), |(low, high), limit| (low.min(limit), high.max(limit)));
    // The steps next to the limit of the scene itself lie a quarter of an octave to either side, so that maps show
    // both sides of it.
    let Some(own) = limit(&grounds[0]) else { return Vec::new() };
    let halves = |ratio: f64| (2.0 * ratio.log2()).round() as i32;
    let steps = halves(low / BEYOND / own)..=halves(high * BEYOND / own);
    steps.map(|half| own * 2f64.powf(0.5 * f64::from(half) - 0.25)).collect()
}

/// The largest error of a step under error control, m: the scene's, or that of a scene without a step. `None` for
/// explicit methods.
fn error(study: &Study<'_>, method: Method) -> Option<f64> {
    let desc = IntegratorDesc { method, step: None, ..study.scene.desc.integrator.clone() };
    desc.error().filter(|_| method.is_implicit())
}

/// Runs every subject on some of all grounds, with all steps and then under error control within the longest of them.
/// Each pair has its share of the time.
pub fn run(study: &Study<'_>, subjects: &[Subject], all: &[Ground], some: &[Ground]) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let pairs: Vec<_> = some.iter().flat_map(|ground| subjects.iter().map(move |&subject| (ground, subject))).collect();
    for (place, &(ground, subject)) in pairs.iter().enumerate() {
        let share = Share::one_of(pairs.len() - place, study);
        let steps = steps(study, subject, all);
        let fixed = steps.iter().map(|&step| (step, None));
        let controlled = steps.last().zip(error(study, subject.method)).map(|(&step, error)| (step, Some(error)));
        for (step, error) in fixed.chain(controlled) {
            rows.push(run_cell(&share, subject, ground, step, error)?);
        }
    }
    Ok(rows)
}

/// Runs the cells that their share did not allow, with the time that other shares left over.
pub fn run_rest(study: &Study<'_>, subjects: &[Subject], grounds: &[Ground], rows: &mut [Row]) -> Result<(), Failure> {
    let rest: Vec<_> = rows.iter_mut().filter(|row| row.verdict == Verdict::NotRun).collect();
    let count = rest.len();
    for (place, row) in rest.into_iter().enumerate() {
        let is_of = |ground: &&Ground| (ground.stiffness, ground.damping) == (row.stiffness_scale, row.damping_scale);
        let subject = subjects.iter().find(|&&subject| row.is_of(subject));
        if let (Some(&subject), Some(ground)) = (subject, grounds.iter().find(is_of)) {
            let error = row.control.as_ref().map(|control| control.error);
            *row = run_cell(&Share::one_of(count - place, study), subject, ground, row.step, error)?;
        }
    }
    Ok(())
}

/// Runs a subject on a ground with steps of `step` seconds, or with shorter ones whose error is below `error`, m.
pub fn run_cell(
    share: &Share<'_, '_>,
    subject: Subject,
    ground: &Ground,
    step: f64,
    error: Option<f64>,
) -> Result<Row, Failure> {
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
        control: error.map(Control::not_run),
    };
    if share.left().is_zero() {
        return Ok(row);
    }
    let by = if error.is_some() { "error control within step" } else { "step" };
    share.study.say(&format!("{}, {by} {}, stiffness x {}", row.name, time(step), ground.stiffness));
    let steps = cell::watched(share.study.scene.desc.duration, step, subject.method);
    let run = cell::fly(share, subject, ground, (step, steps), error, ground.energy)?;
    row.steps = run.report.steps;
    (row.watched, row.wall) = (row.steps as f64 * step, run.wall);
    (row.verdict, row.why) = judge(&run);
    row.control = error.map(|error| Control::of(error, step, &run.report));
    Ok(row)
}
