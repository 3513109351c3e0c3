//! The error of the scene's method by cause: the step, the linear solver, and the linearisation, of which Newton's
//! method leaves what its iterations do not remove.

use muslin_core::integrate::Method;
use serde::Serialize;
use toml::Value;

use crate::args::Precision;
use crate::failure::Failure;
use crate::study::Study;
use crate::study::terms::CONVERGED;
use crate::study::trajectory::{Ending, Samples, Trajectory, fly_scene};
use crate::study::variant::Variant;

use super::report::Row;
use super::weigh::Yardstick;

/// The solver's tolerance at which its error no longer counts.
const SHARP: f64 = 1e-9;

/// The errors of one step, as parts of the cloth's diagonal.
#[derive(Clone, Debug, Serialize)]
pub struct Cause {
    /// Step, s.
    pub step: f64,
    /// Distance of the charted run from the run with a sharp solver.
    pub solver: f64,
    /// Distance of the run with a sharp solver from the run in which Newton's method converges.
    pub linearisation: f64,
    /// Distance of that run from the reference.
    pub of_step: f64,
}

impl Cause {
    /// The cause of the largest error, in a word.
    pub fn largest(&self) -> &'static str {
        let causes = [(self.of_step, "step"), (self.solver, "solver"), (self.linearisation, "linearisation")];
        causes.into_iter().fold((0.0, "-"), |most, cause| if cause.0 > most.0 { cause } else { most }).1
    }
}

/// The errors of a method by cause.
#[derive(Clone, Debug, Serialize)]
pub struct Causes {
    /// Name as in a scene file.
    pub method: &'static str,
    /// From long steps to short ones.
    pub steps: Vec<Cause>,
}

/// Separates the causes for the fixed steps in `rows` of the scene's method in double precision, until the study has
/// run for `end` seconds. `None` for an explicit method, or if there was no time.
pub fn of(study: &Study<'_>, yardstick: &Yardstick<'_>, rows: &[Row], end: f64) -> Result<Option<Causes>, Failure> {
    let integrator = &study.scene.desc.integrator;
    let mut causes = Causes { method: integrator.method.name(), steps: Vec::new() };
    for row in rows.iter().filter(|row| is_charted(row, integrator.method)) {
        causes.steps.extend(separate(study, yardstick, &row.variant, end)?);
    }
    Ok(Some(causes).filter(|causes| !causes.steps.is_empty()))
}

/// A sentence that explains why the errors of the scene's method are not separated, and how to separate them.
pub fn why_none(method: Method, rows: &[Row]) -> String {
    let name = method.name();
    let was_run = rows.iter().any(|row| row.method == name);
    let why = if !method.is_implicit() {
        format!("{name}, the scene's method, is explicit: it has no solver, so all of its error is that of the step")
    } else if rows.iter().any(|row| is_charted(row, method)) {
        format!("there was no time to repeat runs of {name} with an exact solver; take a larger --budget")
    } else if was_run {
        format!("no run of {name} in f64 with fixed steps is charted; take a larger --budget or a shorter --duration")
    } else {
        format!("{name}, the scene's method, was not run; name it in --methods")
    };
    format!("No error by cause: {why}")
}

fn is_charted(row: &Row, method: Method) -> bool {
    let Variant { method: own, precision, .. } = row.variant;
    method.is_implicit() && own == method && precision == Precision::F64 && row.is_fixed() && row.stable
}

/// The errors of one step by cause; `None` if a run fails or does not end in time.
fn separate(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    variant: &Variant,
    end: f64,
) -> Result<Option<Cause>, Failure> {
    let newton = study.scene.desc.integrator.newton;
    let run = |tolerance, newton| run(study, yardstick, variant, tolerance, newton, end);
    let Some(as_it_is) = run(None, newton)? else { return Ok(None) };
    let Some(sharp) = run(Some(SHARP), newton)? else { return Ok(None) };
    let Some(converged) = run(Some(SHARP), newton.max(CONVERGED))? else { return Ok(None) };
    let rms = |a, b| yardstick.parts(a, b)[0];
    Ok(Some(Cause {
        step: variant.step(&study.scene),
        solver: rms(&as_it_is, &sharp),
        linearisation: rms(&sharp, &converged),
        of_step: rms(&converged, &yardstick.reference.best().1),
    }))
}

/// Runs a variant with a number of Newton iterations and a tolerance, by default the variant's own; `None` if the run
/// fails or does not end in time.
fn run(
    study: &Study<'_>,
    yardstick: &Yardstick<'_>,
    variant: &Variant,
    tolerance: Option<f64>,
    newton: u32,
    end: f64,
) -> Result<Option<Trajectory>, Failure> {
    let left = end - study.seconds();
    if left <= 0.0 {
        return Ok(None);
    }
    let tolerance = tolerance.or_else(|| variant.tolerance(&study.scene));
    let solver = [
        ("integrator.tolerance", tolerance.map(Value::Float)),
        ("integrator.newton", Some(Value::Integer(newton.into()))),
    ];
    study.say(&format!("{}, newton = {newton}", variant.name(&study.scene)));
    let scene = variant.scene(&study.scene)?.changed(&solver)?;
    let limits = yardstick.limits(left);
    let run = fly_scene(study, &scene, variant.precision, variant.steps, limits, Samples::WithPositions)?;
    Ok(Some(run).filter(|run| run.ending == Ending::Complete))
}
