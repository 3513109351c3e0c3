//! Tools for checks: scenes of the core in double precision, on one thread, with a stop at an interrupt.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use muslin_core_f64::dispatch::{Dispatch, Serial, Split};
use muslin_core_f64::error::{MeshError, SceneError};
use muslin_core_f64::forces;
use muslin_core_f64::integrate::{Method, Scheme, Tolerance};
use muslin_core_f64::scene::{self, BuiltScene, Resource, SceneDesc};
use muslin_core_f64::simulation::{Cause, Simulation, StepError};

/// Why a check measured nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum Miss {
    /// An interrupt.
    Stopped,
    /// The reason.
    Why(String),
}

impl From<StepError> for Miss {
    fn from(diverged: StepError) -> Self {
        match diverged.cause {
            Cause::Stopped => Self::Stopped,
            _ => Self::Why(diverged.to_string()),
        }
    }
}

impl From<MeshError> for Miss {
    fn from(error: MeshError) -> Self {
        Self::Why(error.to_string())
    }
}

impl From<SceneError> for Miss {
    fn from(error: SceneError) -> Self {
        Self::Why(error.to_string())
    }
}

/// Runs kernels on the calling thread.
pub struct Lab {
    stop: Arc<AtomicBool>,
}

impl Dispatch for Lab {
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        kernel(0, out);
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl Lab {
    /// A lab that stops when the flag is set.
    pub fn new(stop: Arc<AtomicBool>) -> Self {
        Self { stop }
    }

    /// Takes `count` steps.
    pub fn steps(&self, sim: &mut Simulation, count: u32) -> Result<(), Miss> {
        for _ in 0..count {
            if self.stopped() {
                return Err(Miss::Stopped);
            }
            sim.step(self)?;
        }
        Ok(())
    }

    /// Takes steps for a time, s.
    pub fn run(&self, sim: &mut Simulation, seconds: f64) -> Result<(), Miss> {
        self.steps(sim, (seconds / sim.step_length()).round() as u32)
    }

    /// Takes steps until no vertex is faster than `speed`, m/s. An error means that `most` steps were not enough.
    pub fn settle(&self, sim: &mut Simulation, speed: f64, most: u32) -> Result<(), Miss> {
        for _ in 0..most {
            self.steps(sim, 1)?;
            if fastest(sim) <= speed {
                return Ok(());
            }
        }
        Err(Miss::Why(format!("not at rest after {most} steps: {:.1e} m/s", fastest(sim))))
    }
}

/// The largest speed, m/s.
fn fastest(sim: &Simulation) -> f64 {
    sim.velocities().iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// The velocity of the centre of mass, m/s.
pub fn drift(sim: &Simulation) -> DVec3 {
    DVec3::from(sim.momentum()) / sim.scene().particles.masses.iter().sum::<f64>()
}

/// The centre of mass, m.
pub fn centre(sim: &Simulation) -> DVec3 {
    let masses = &sim.scene().particles.masses;
    let sum: DVec3 = sim.positions().iter().zip(masses).map(|(&x, &mass)| x * mass).sum();
    sum / masses.iter().sum::<f64>()
}

fn describe(text: &str) -> Result<SceneDesc, Miss> {
    toml::from_str(text).map_err(|error: toml::de::Error| Miss::Why(error.to_string()))
}

/// The columns of the scene in a text.
pub fn columns(text: &str, resources: &[Resource]) -> Result<BuiltScene, Miss> {
    Ok(scene::build(&describe(text)?, resources)?)
}

/// A simulation of the scene in a text.
pub fn simulation(text: &str, resources: &[Resource]) -> Result<Simulation, Miss> {
    Ok(Simulation::new(&describe(text)?, resources)?)
}

/// All forces at positions `x` and zero velocities, N.
pub fn forces(built: &BuiltScene, x: &[DVec3]) -> Vec<DVec3> {
    let (model, still) = (built.model.view(), vec![DVec3::ZERO; x.len()]);
    let (mut scratch, mut f) = (vec![DVec3::ZERO; model.force_scratch()], still.clone());
    forces::evaluate(&model, &built.particles.masses, x.into(), &still, &mut scratch, &mut f, &Serial);
    f
}

/// One linear solve per step, down to rounding.
pub fn linearised(method: Method) -> Scheme {
    Scheme::fixed(method, 1e-14)
}

/// Newton's method, until the residual is at most `tolerance` times its initial value.
pub fn converged(method: Method, tolerance: f64) -> Scheme {
    Scheme { newton: 100, tolerance: Tolerance::Residual(tolerance), ..linearised(method) }
}

/// A number in -1..1 for each index, distributed by the golden ratio: the same on every machine.
pub fn scatter(place: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    2.0 * (GOLDEN * (place + 1) as f64).fract() - 1.0
}

/// A vector of three numbers of `scatter`.
pub fn scatter3(place: usize) -> DVec3 {
    DVec3::new(scatter(3 * place), scatter(3 * place + 1), scatter(3 * place + 2))
}
