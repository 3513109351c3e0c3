//! One run of a map and its class.

use std::time::Duration;

use muslin_core::integrate::Method;
use serde::Serialize;
use toml::Value;

use crate::args::Precision;
use crate::failure::Failure;
use crate::study::trajectory::{Ending, Limits, Samples, Trajectory, fly_scene};
use crate::study::variant::SAMPLES;

use super::map::Ground;
use super::share::Share;

/// A method with a number of Newton iterations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subject {
    /// The method.
    pub method: Method,
    /// Newton iterations: 1 is a single linear solve, and always the value for explicit methods.
    pub newton: u32,
}

impl Subject {
    /// Name in pictures and tables.
    pub fn name(&self) -> String {
        match self.newton {
            1 => self.method.name().into(),
            newton => format!("{}, newton = {newton}", self.method.name()),
        }
    }
}

/// The class of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// Its energy stayed within the limit.
    #[serde(rename = "fine")]
    Fine,
    /// Its energy reached ten times the energy that the scene can have.
    #[serde(rename = "energy growth")]
    Growth,
    /// A step failed, or an edge was stretched too far.
    #[serde(rename = "diverged")]
    Diverged,
    /// A solve ended before its tolerance.
    #[serde(rename = "solver gave up")]
    GaveUp,
    /// It was not run, or took longer than the time left.
    #[serde(rename = "not run")]
    NotRun,
}

impl Verdict {
    /// Name in pictures and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::Growth => "energy growth",
            Self::Diverged => "diverged",
            Self::GaveUp => "solver gave up",
            Self::NotRun => "not run",
        }
    }
}

/// Number of steps of a run. Explicit methods take 1000 steps however long the scene is: an instability that exists
/// at the start grows from rounding within them. Implicit methods take at most 200, and not beyond the end of the
/// scene.
pub const EXPLICIT_STEPS: u64 = 1000;
pub const IMPLICIT_STEPS: u64 = 200;

/// Number of steps of `step` seconds in a scene of some duration, rounded up to a multiple of the samples.
pub fn whole(duration: f64, step: f64) -> u64 {
    // The small number prevents an additional step that only rounding would cause.
    (duration / step / SAMPLES as f64 - 1e-9).ceil().max(1.0) as u64 * SAMPLES
}

/// Number of steps of a cell of the map.
pub fn watched(duration: f64, step: f64, method: Method) -> u64 {
    if method.is_implicit() { whole(duration, step).min(IMPLICIT_STEPS) } else { EXPLICIT_STEPS }
}

/// Runs a subject from the start of a scene with `steps` steps of `step` seconds. With a largest `error`, m, these
/// steps are divided where they need it.
pub fn fly(
    share: &Share<'_, '_>,
    subject: Subject,
    ground: &Ground,
    (step, steps): (f64, u64),
    error: Option<f64>,
    energy: f64,
) -> Result<Trajectory, Failure> {
    let duration = steps as f64 * step;
    let scene = ground.scene.changed(&[
        ("duration", Some(Value::Float(duration))),
        ("frame_rate", Some(Value::Float(SAMPLES as f64 / duration))),
        ("integrator.method", Some(Value::String(subject.method.name().into()))),
        ("integrator.newton", Some(Value::Integer(subject.newton.into()))),
        ("integrator.step", Some(Value::Float(step))),
        ("integrator.error", error.map(Value::Float)),
    ])?;
    let limits = Limits { wall: share.left().max(Duration::from_millis(1)), energy };
    fly_scene(share.study, &scene, Precision::F32, steps / SAMPLES, limits, Samples::Energies)
}

/// The class of a run, and the reason for it.
pub fn judge(run: &Trajectory) -> (Verdict, Option<String>) {
    let solves = run.report.unconverged;
    match &run.ending {
        Ending::Diverged(what) => (Verdict::Diverged, Some(what.clone())),
        Ending::Grown => (Verdict::Growth, Some("its energy grew to 10 times the energy of backward Euler".into())),
        Ending::OutOfTime => (Verdict::NotRun, Some("it took longer than its share of the budget".into())),
        Ending::Complete if solves > 0 => (Verdict::GaveUp, Some(format!("{solves} solves did not converge"))),
        Ending::Complete => (Verdict::Fine, None),
    }
}
