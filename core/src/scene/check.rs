//! Range checks of the numbers in a scene.

use super::{IntegratorDesc, SceneDesc};
use crate::error::SceneError;
use crate::real::Real;

/// Maximum number of vertices of a scene: the slots of all hinges (four per hinge) must fit into 32 bits.
const MOST_VERTICES: u64 = 1 << 28;

/// Checks that indices can address `vertices` vertices. Generators call it before they allocate.
pub(super) fn nameable(vertices: u64) -> Result<(), SceneError> {
    if vertices > MOST_VERTICES { Err(SceneError::TooLarge { vertices }) } else { Ok(()) }
}

/// Checks that a value is positive and finite, also after rounding to the crate's precision.
pub(super) fn positive(key: &'static str, value: f64) -> Result<f64, SceneError> {
    let rounded = value as Real;
    if rounded > 0.0 && rounded.is_finite() { Ok(value) } else { Err(SceneError::NotPositive { key, value }) }
}

/// Checks that a value is zero or more and finite.
pub(super) fn not_negative(key: &'static str, value: f64) -> Result<f64, SceneError> {
    if value >= 0.0 && (value as Real).is_finite() { Ok(value) } else { Err(SceneError::Negative { key, value }) }
}

/// Checks that both counts are at least `least`.
pub(super) fn at_least(key: &'static str, counts: [u32; 2], least: u32) -> Result<(), SceneError> {
    if counts.iter().all(|&n| n >= least) { Ok(()) } else { Err(SceneError::TooFewCells { key, least }) }
}

/// Checks that all values are finite.
pub(super) fn finite(key: &'static str, values: &[f64]) -> Result<(), SceneError> {
    if values.iter().all(|&v| (v as Real).is_finite()) { Ok(()) } else { Err(SceneError::NotFinite { key }) }
}

fn check_integrator(integrator: &IntegratorDesc) -> Result<(), SceneError> {
    if let Some(step) = integrator.step {
        positive("integrator.step", step)?;
    }
    if let Some(error) = integrator.error {
        not_negative("integrator.error", error)?;
    }
    if let Some(value) = integrator.tolerance
        && positive("integrator.tolerance", value)? >= 1.0
    {
        return Err(SceneError::NotBelowOne { key: "integrator.tolerance", value });
    }
    positive("integrator.newton", f64::from(integrator.newton)).map(|_| ())
}

/// Checks the numbers outside of cloths, colliders and contact, and that the scene has a cloth.
pub(super) fn check_numbers(scene: &SceneDesc) -> Result<(), SceneError> {
    if scene.cloth.is_empty() {
        return Err(SceneError::NoCloth);
    }
    not_negative("duration", scene.duration)?;
    positive("frame_rate", scene.frame_rate)?;
    if let Some(speed) = scene.until_rest {
        positive("until_rest", speed)?;
    }
    check_integrator(&scene.integrator)?;
    if let Some(gravity) = &scene.gravity {
        gravity.check("gravity")?;
    }
    if let Some(drag) = &scene.drag {
        not_negative("drag.linear", drag.linear)?;
        if let Some(wind) = &drag.wind {
            wind.velocity.check("drag.wind.velocity")?;
            not_negative("drag.wind.normal", wind.normal)?;
            not_negative("drag.wind.tangential", wind.tangential)?;
        }
    }
    Ok(())
}
