//! A run of a variant from start to end, recorded at samples.

use std::time::{Duration, Instant};

use crate::args::Precision;
use crate::checkpoint;
use crate::divergence::flown_apart;
use crate::engine::{Engine, Halt, Report};
use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::stopwatch::Stopwatch;

use serde::{Deserialize, Serialize};

use super::variant::{SAMPLES, Variant};
use super::{Study, cost};

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Ending {
    /// It reached its end.
    Complete,
    /// A step failed, or an edge was stretched too far; the reason.
    Diverged(String),
    /// Its energy exceeded the limit.
    Grown,
    /// It would have taken longer than its time limit, or the study was interrupted.
    OutOfTime,
}

impl Ending {
    /// The ending in words.
    fn in_words(&self) -> &str {
        match self {
            Self::Complete => "complete",
            Self::Diverged(what) => what,
            Self::Grown => "its energy grew too far",
            Self::OutOfTime => "given up: it takes too long",
        }
    }
}

/// The record of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Trajectory {
    /// Positions at each sample, m; empty if they are not wanted.
    pub samples: Vec<Vec<[f64; 3]>>,
    /// Kinetic, stretch, shear, bend, seam and gravity energy at each sample, J.
    pub energies: Vec<[f64; 6]>,
    /// The largest ratio of length to rest length of any edge at any sample.
    pub stretch: f64,
    /// The largest depth of a vertex inside a collider at any sample, m; `None` without colliders.
    pub penetration: Option<f64>,
    /// State and work at the end.
    pub report: Report,
    /// Cost of its steps, s.
    pub wall: f64,
    /// How it ended.
    pub ending: Ending,
}

impl Trajectory {
    /// A run that has not begun.
    fn new() -> Self {
        Self {
            samples: Vec::new(),
            energies: Vec::new(),
            stretch: 0.0,
            penetration: None,
            report: Report::default(),
            wall: 0.0,
            ending: Ending::OutOfTime,
        }
    }

    /// Whether it tells how a run with these limits ends. One that was given up does not tell of much longer limits.
    fn serves(&self, limits: Limits) -> bool {
        self.ending != Ending::OutOfTime || limits.wall.as_secs_f64() <= NOISE * self.wall
    }

    /// Kinetic and elastic energy at a sample, J.
    pub fn lively(&self, sample: usize) -> f64 {
        self.energies[sample][..5].iter().sum()
    }

    /// The largest kinetic and elastic energy at any sample, J.
    pub fn liveliest(&self) -> f64 {
        (0..self.energies.len()).map(|sample| self.lively(sample)).fold(0.0, f64::max)
    }

    /// Total energy at a sample, J.
    pub fn energy(&self, sample: usize) -> f64 {
        self.energies[sample].iter().sum()
    }
}

/// A time limit that the clock sets is reproduced up to this factor.
const NOISE: f64 = 1.1;

/// Limits that end a run early.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Time for steps.
    pub wall: Duration,
    /// Kinetic and elastic energy, J.
    pub energy: f64,
}

impl Limits {
    /// Applies the energy limit to a complete run that was made without it.
    pub fn judge(&self, mut run: Trajectory) -> Trajectory {
        if run.ending == Ending::Complete && run.liveliest() > self.energy {
            run.ending = Ending::Grown;
        }
        run
    }
}

/// Runs a variant of the study's scene.
pub fn fly(study: &Study<'_>, variant: &Variant, limits: Limits) -> Result<Trajectory, Failure> {
    study.say(&variant.name(&study.scene));
    fly_of(study, &study.scene, variant, limits)
}

/// Runs a variant of a scene, usually of the study's scene with some changes.
pub fn fly_of(study: &Study<'_>, scene: &SceneFile, variant: &Variant, limits: Limits) -> Result<Trajectory, Failure> {
    fly_scene(study, &variant.scene(scene)?, variant.precision, variant.steps, limits, Samples::WithPositions)
}

/// The record of a run at its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Samples {
    /// Energies.
    Energies,
    /// Energies and positions.
    WithPositions,
}

/// Runs a scene with `steps` steps from sample to sample, unless the outcome is known from an interrupted call. A run
/// that is interrupted ends as one that runs out of time.
pub fn fly_scene(
    study: &Study<'_>,
    scene: &SceneFile,
    precision: Precision,
    steps: u64,
    limits: Limits,
    samples: Samples,
) -> Result<Trajectory, Failure> {
    if study.is_interrupted() {
        return Ok(Trajectory::new());
    }
    let entry = study.kept.entry(&question(study, scene, precision, steps, limits, samples));
    if let Some(known) = study.kept.find(&entry, |run: &Trajectory| run.serves(limits)) {
        study.spend_known(known.wall);
        study.note(known.wall, known.ending.in_words());
        return Ok(known);
    }
    let flight = take_off(study, scene, precision, steps, limits, samples)?;
    study.spend(flight.wall);
    if !study.is_interrupted() {
        study.kept.keep(&entry, &flight);
        study.note(flight.wall, flight.ending.in_words());
    }
    Ok(flight)
}

/// Everything that the outcome of a run depends on, except the time limit.
fn question(
    study: &Study<'_>,
    scene: &SceneFile,
    precision: Precision,
    steps: u64,
    limits: Limits,
    samples: Samples,
) -> String {
    format!(
        "run {:08x} in {} by {steps} steps, energy {:?}, {samples:?}, {:?}:\n{}",
        checkpoint::scene_crc(scene),
        precision.name(),
        limits.energy,
        study.arguments.cost,
        scene.text
    )
}

fn take_off(
    study: &Study<'_>,
    scene: &SceneFile,
    precision: Precision,
    steps: u64,
    limits: Limits,
    samples: Samples,
) -> Result<Trajectory, Failure> {
    let mut flight = Trajectory::new();
    let Some(mut engine) = study.build(scene, precision)? else { return Ok(flight) };
    let first_stretch = engine.largest_stretch();
    for _ in 0..SAMPLES {
        let see = || sample(study, engine.as_mut(), steps, limits, first_stretch, samples, &mut flight);
        flight.ending = study.pool.install(see);
        if flight.ending != Ending::Complete {
            break;
        }
    }
    flight.report = engine.report();
    Ok(flight)
}

/// Takes the steps to the next sample and records it.
fn sample(
    study: &Study<'_>,
    engine: &mut dyn Engine,
    steps: u64,
    limits: Limits,
    first_stretch: f64,
    samples: Samples,
    flight: &mut Trajectory,
) -> Ending {
    let before = flight.wall;
    let left = limits.wall.saturating_sub(Duration::from_secs_f64(before));
    let stopwatch = Stopwatch::new(&study.pool).until(&study.stop);
    let stopwatch = if study.is_clocked() { stopwatch.within(left) } else { stopwatch };
    let started = Instant::now();
    for _ in 0..steps {
        let stepped = engine.step(&stopwatch);
        flight.wall = match study.is_clocked() {
            true => before + started.elapsed().as_secs_f64(),
            false => cost::seconds(engine.counted()),
        };
        match stepped {
            _ if study.is_interrupted() => return Ending::OutOfTime,
            Ok(()) if flight.wall > limits.wall.as_secs_f64() => return Ending::OutOfTime,
            Ok(()) => {}
            Err(Halt::Diverged(divergence)) => return Ending::Diverged(divergence.what),
            // There is no interrupt, so the deadline caused the stop.
            Err(Halt::Stopped) => return Ending::OutOfTime,
        }
    }
    if samples == Samples::WithPositions {
        let mut positions = Vec::new();
        engine.write_state(&mut positions);
        flight.samples.push(positions);
    }
    flight.energies.push(engine.report().energy);
    let stretch = engine.largest_stretch();
    flight.stretch = flight.stretch.max(stretch);
    if let Some(how) = flown_apart(stretch, first_stretch) {
        return Ending::Diverged(how);
    }
    flight.penetration = engine.penetration().map(|now| now.max(flight.penetration.unwrap_or(0.0)));
    let lively = flight.lively(flight.energies.len() - 1);
    if lively > limits.energy || lively.is_nan() { Ending::Grown } else { Ending::Complete }
}
