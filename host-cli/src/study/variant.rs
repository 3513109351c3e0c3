//! One way to run the scene of a study: method, precision and step.

use muslin_core::integrate::Method;
use muslin_core::integrate::stability::{Mode, longest_step};
use toml::Value;

use crate::args::Precision;
use crate::failure::Failure;
use crate::scene_file::SceneFile;

/// Number of samples at which runs are compared, at equal time intervals.
pub const SAMPLES: u64 = 20;

/// A method, a step and a precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// The method.
    pub method: Method,
    /// The precision.
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

/// The longest stable step of a method by theory, s. For a method that gains energy with every step, the limit of
/// symplectic Euler. `None` if nothing limits the step.
pub fn limit(modes: &[Mode], method: Method) -> Option<f64> {
    let own = longest_step(modes, method);
    if own == Some(0.0) { longest_step(modes, Method::SymplecticEuler) } else { own }
}

/// Smallest useful solver tolerances in single and double precision: rounding prevents smaller residuals.
const LEAST_TOLERANCE: [f64; 2] = [1e-6, 1e-12];

impl Variant {
    /// Length of a step, s.
    pub fn step(&self, scene: &SceneFile) -> f64 {
        scene.desc.duration / (SAMPLES * self.steps) as f64
    }

    /// The solver's tolerance. For steps shorter than the scene's it is reduced by the order of the method, so that
    /// the solver never dominates the error.
    pub fn tolerance(&self, scene: &SceneFile) -> f64 {
        let integrator = &scene.desc.integrator;
        let finer = (self.step(scene) / integrator.step()).min(1.0).powi(order(self.method));
        let least = LEAST_TOLERANCE[usize::from(self.precision == Precision::F64)];
        (integrator.residual() * finer).max(least).min(integrator.residual())
    }

    /// The scene to run, with one frame per sample.
    pub fn scene(&self, scene: &SceneFile) -> Result<SceneFile, Failure> {
        let sampled = [("frame_rate", Some(Value::Float(SAMPLES as f64 / scene.desc.duration)))];
        self.chosen(scene)?.changed(&sampled)
    }

    /// The scene with this method, step and tolerance.
    pub fn chosen(&self, scene: &SceneFile) -> Result<SceneFile, Failure> {
        let mut own = vec![
            ("integrator.method", Some(Value::String(self.method.name().into()))),
            ("integrator.step", Some(Value::Float(self.step(scene)))),
            ("integrator.error", None),
        ];
        if self.method.is_implicit() {
            own.push(("integrator.tolerance", Some(Value::Float(self.tolerance(scene)))));
        }
        scene.changed(&own)
    }

    /// Name in the progress bar.
    pub fn name(&self, scene: &SceneFile) -> String {
        format!("{} {}, step {:.3e} s", self.method.name(), self.precision.name(), self.step(scene))
    }
}
