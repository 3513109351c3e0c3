//! One way to run the scene of a study: method, precision, and either a step or an allowed error of a step.

use muslin_core::integrate::Method;
use muslin_core::integrate::stability::{Mode, longest_step};
use muslin_core::scene::{IntegratorDesc, SceneDesc};
use toml::Value;

use crate::args::Precision;
use crate::failure::Failure;
use crate::scene_file::SceneFile;
use crate::units::{length, time};

/// Number of samples at which runs are compared, at equal time intervals.
pub const SAMPLES: u64 = 20;

/// A method, a precision and a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// The method.
    pub method: Method,
    /// The precision.
    pub precision: Precision,
    /// Steps from sample to sample; with an allowed error these are the longest steps.
    pub steps: u64,
    /// The allowed error of a step, m; `None`: all steps have the same length.
    pub error: Option<f64>,
    /// How many times the solver is as loose as the scene's; with an allowed error the solver follows that.
    pub looser: f64,
}

/// A step, s, and an allowed error, m, in words: `steps of 5.00 ms`, or `an error of 0.1 mm a step, the longest 16.67
/// ms`.
pub fn in_words(step: f64, error: Option<f64>) -> String {
    match error {
        None => format!("steps of {}", time(step)),
        Some(error) => format!("an error of {} a step, the longest {}", length(error), time(step)),
    }
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

/// The largest number of steps from sample to sample, and the smallest allowed error of a step, m, that a study tries.
const MOST_STEPS: u64 = 1 << 24;
const LEAST_ERROR: f64 = 1e-12;

/// The loosest solver tolerance that a study takes of its own accord.
const LOOSEST: f64 = 0.1;

impl Variant {
    /// All steps have the same length.
    pub const fn fixed(method: Method, precision: Precision, steps: u64) -> Self {
        Self { method, precision, steps, error: None, looser: 1.0 }
    }

    /// An implicit method under error control with an allowed error of a step, m. The longest step is that of the
    /// scene if the scene has error control too, else the default; no step is longer than a frame.
    pub fn controlled(scene: &SceneFile, method: Method, precision: Precision, error: f64) -> Self {
        let own = &scene.desc.integrator;
        let step = own.step.filter(|_| own.error.is_some());
        let longest = IntegratorDesc { method, step, error: Some(error), ..IntegratorDesc::default() }.step();
        let longest = longest.min(1.0 / scene.desc.frame_rate);
        let sample = scene.desc.duration / SAMPLES as f64;
        let steps = (sample / longest - 1e-9).ceil().max(1.0) as u64;
        Self { error: Some(error), ..Self::fixed(method, precision, steps) }
    }

    /// The variant that `muslin run` takes, but for the samples: each is a whole number of steps.
    pub fn as_written(scene: &SceneFile) -> Self {
        let desc = &scene.desc;
        let method = desc.integrator.method;
        if let Some(error) = desc.integrator.error() {
            return Self::controlled(scene, method, Precision::F32, error);
        }
        let sampled = SceneDesc { frame_rate: SAMPLES as f64 / desc.duration, ..desc.clone() };
        Self::fixed(method, Precision::F32, sampled.timing().steps_per_frame)
    }

    /// Whether a study tries variants as fine as this one.
    pub fn is_tried(&self) -> bool {
        self.steps <= MOST_STEPS && self.error.is_none_or(|error| error >= LEAST_ERROR)
    }

    /// The next finer variant: half the step, or the allowed error that halves the step where forces are smooth.
    pub fn finer(self) -> Self {
        match self.error {
            None => Self { steps: 2 * self.steps, ..self },
            Some(error) => Self { error: Some(error / 2f64.powi(order(self.method) + 1)), ..self },
        }
    }

    /// A variant whose steps are shorter for certain: with an allowed error, [`Variant::finer`] with half the longest
    /// step.
    pub fn with_shorter_steps(self) -> Self {
        match self.error {
            None => self.finer(),
            Some(_) => Self { steps: 2 * self.steps, ..self.finer() },
        }
    }

    /// The change that [`Variant::with_shorter_steps`] makes, in words.
    pub const fn shorter_steps_in_words(&self) -> &'static str {
        match (self.error, order(self.method)) {
            (None, _) => "half the step",
            (Some(_), 1) => "half the longest step with a quarter of the allowed error",
            (Some(_), _) => "half the longest step with an eighth of the allowed error",
        }
    }

    /// Whether error control divided a step in a run that kept this many steps.
    pub fn is_divided(&self, steps: u64) -> bool {
        self.error.is_some() && steps > SAMPLES * self.steps
    }

    /// How fine it is: steps from sample to sample, or the inverse of the allowed error, 1/m.
    pub fn fineness(&self) -> f64 {
        self.error.map_or(self.steps as f64, f64::recip)
    }

    /// The same variant with another fineness; a number of steps is rounded up.
    pub fn with_fineness(self, fineness: f64) -> Self {
        match self.error {
            None => Self { steps: fineness.ceil().max(1.0) as u64, ..self },
            Some(_) => Self { error: Some(fineness.recip()), ..self },
        }
    }

    /// Length of a step, s; with an allowed error of the longest one.
    pub fn step(&self, scene: &SceneFile) -> f64 {
        scene.desc.duration / (SAMPLES * self.steps) as f64
    }

    /// The solver's tolerance; `None` for explicit methods, and with an allowed error, which the solver follows unless
    /// the scene has both. For steps shorter than the scene's it is reduced by the order of the method, so that the
    /// solver never dominates the error.
    pub fn tolerance(&self, scene: &SceneFile) -> Option<f64> {
        let integrator = &scene.desc.integrator;
        if !self.method.is_implicit() {
            return None;
        }
        if self.error.is_some() {
            return integrator.tolerance.filter(|_| integrator.error().is_some());
        }
        let finer = (self.step(scene) / integrator.step()).min(1.0).powi(order(self.method));
        let least = LEAST_TOLERANCE[usize::from(self.precision == Precision::F64)];
        let most = self.looser * integrator.residual();
        Some((most * finer).max(least).min(most))
    }

    /// Whether its solver is as many times as loose as it should be: no study takes one beyond [`LOOSEST`].
    pub fn is_as_loose_as_asked(&self, scene: &SceneFile) -> bool {
        self.looser * scene.desc.integrator.residual() <= LOOSEST
    }

    /// The scene to run, with one frame per sample.
    pub fn scene(&self, scene: &SceneFile) -> Result<SceneFile, Failure> {
        let sampled = [("frame_rate", Some(Value::Float(SAMPLES as f64 / scene.desc.duration)))];
        self.chosen(scene)?.changed(&sampled)
    }

    /// The scene with this method, step, allowed error and tolerance.
    pub fn chosen(&self, scene: &SceneFile) -> Result<SceneFile, Failure> {
        let mut own = vec![
            ("integrator.method", Some(Value::String(self.method.name().into()))),
            ("integrator.step", Some(Value::Float(self.step(scene)))),
            ("integrator.error", self.error.map(Value::Float)),
        ];
        // The scene may keep a tolerance with an explicit method, which ignores it.
        if self.method.is_implicit() {
            own.push(("integrator.tolerance", self.tolerance(scene).map(Value::Float)));
        }
        scene.changed(&own)
    }

    /// Its step in words: `5.00 ms`, or `an error of 0.1 mm a step`.
    pub fn stride(&self, scene: &SceneFile) -> String {
        match self.error {
            None => time(self.step(scene)),
            Some(error) => format!("an error of {} a step", length(error)),
        }
    }

    /// Name in the progress bar.
    pub fn name(&self, scene: &SceneFile) -> String {
        format!("{} {} by {}", self.method.name(), self.precision.name(), self.stride(scene))
    }
}
