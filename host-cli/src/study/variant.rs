//! One way to run the scene of a study.

use muslin_core::integrate::Method;
use muslin_core::integrate::stability::{Mode, longest_step};
use toml::Value;

use crate::args::Precision;
use crate::failure::Failure;
use crate::scene_file::SceneFile;

/// States of a run that are compared, at equal times.
pub const SAMPLES: u64 = 20;

/// A method, a step and a precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// The method.
    pub method: Method,
    /// In which precision.
    pub precision: Precision,
    /// Steps from sample to sample.
    pub steps: u64,
}

/// The order of a method's error in the step, where forces are smooth.
pub const fn order(method: Method) -> i32 {
    match method {
        Method::ExplicitEuler | Method::SymplecticEuler | Method::BackwardEuler => 1,
        Method::Midpoint | Method::ImplicitMidpoint | Method::Bdf2 => 2,
        Method::Rk4 => 4,
    }
}

/// The longest step of theory, s, of a method; where every step gains energy, of symplectic Euler. None
/// where nothing limits it.
pub fn limit(modes: &[Mode], method: Method) -> Option<f64> {
    let own = longest_step(modes, method);
    if own == Some(0.0) { longest_step(modes, Method::SymplecticEuler) } else { own }
}

/// Tolerances below which rounding ends the solver.
const LEAST_TOLERANCE: [f64; 2] = [1e-6, 1e-12];

impl Variant {
    /// s.
    pub fn step(&self, scene: &SceneFile) -> f64 {
        scene.desc.duration / (SAMPLES * self.steps) as f64
    }

    /// The solver's tolerance: the scene's, and below the scene's step smaller by the method's
    /// order, so that it is never what the error comes from.
    pub fn tolerance(&self, scene: &SceneFile) -> f64 {
        let integrator = &scene.desc.integrator;
        let finer = (self.step(scene) / integrator.step).min(1.0).powi(order(self.method));
        let least = LEAST_TOLERANCE[usize::from(self.precision == Precision::F64)];
        (integrator.tolerance * finer).max(least).min(integrator.tolerance)
    }

    /// The scene that is run.
    pub fn scene(&self, scene: &SceneFile) -> Result<SceneFile, Failure> {
        let sampled = [("frame_rate", Some(Value::Float(SAMPLES as f64 / scene.desc.duration)))];
        self.chosen(scene)?.changed(&sampled)
    }

    /// The scene with these settings as its own.
    pub fn chosen(&self, scene: &SceneFile) -> Result<SceneFile, Failure> {
        let mut own = vec![
            ("integrator.method", Some(Value::String(self.method.name().into()))),
            ("integrator.step", Some(Value::Float(self.step(scene)))),
        ];
        if self.method.is_implicit() {
            own.push(("integrator.tolerance", Some(Value::Float(self.tolerance(scene)))));
        }
        scene.changed(&own)
    }

    /// As a line of progress names it.
    pub fn name(&self, scene: &SceneFile) -> String {
        format!("{} {}, step {:.3e} s", self.method.name(), self.precision.name(), self.step(scene))
    }
}
