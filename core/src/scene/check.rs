//! Numbers that a scene may and may not give.

use super::SceneDesc;
use crate::error::SceneError;
use crate::real::Real;

/// Most vertices of a scene: slots of hinges (four each) must fit into 32 bits.
const MOST_VERTICES: u64 = 1 << 28;

/// A number of vertices that indices can name: generators ask before they allocate.
pub(super) fn nameable(vertices: u64) -> Result<(), SceneError> {
    if vertices > MOST_VERTICES { Err(SceneError::TooLarge { vertices }) } else { Ok(()) }
}

/// A value that must be positive and finite, also once it is rounded to the crate's precision.
pub(super) fn positive(key: &'static str, value: f64) -> Result<f64, SceneError> {
    let rounded = value as Real;
    if rounded > 0.0 && rounded.is_finite() { Ok(value) } else { Err(SceneError::NotPositive { key, value }) }
}

/// A value that must be zero or more and finite.
pub(super) fn not_negative(key: &'static str, value: f64) -> Result<f64, SceneError> {
    if value >= 0.0 && (value as Real).is_finite() { Ok(value) } else { Err(SceneError::Negative { key, value }) }
}

/// Counts that must be at least `least`.
pub(super) fn at_least(key: &'static str, counts: [u32; 2], least: u32) -> Result<(), SceneError> {
    if counts.iter().all(|&n| n >= least) { Ok(()) } else { Err(SceneError::TooFewCells { key, least }) }
}

/// Values that must be finite.
pub(super) fn finite(key: &'static str, values: &[f64]) -> Result<(), SceneError> {
    if values.iter().all(|&v| (v as Real).is_finite()) { Ok(()) } else { Err(SceneError::NotFinite { key }) }
}

/// The numbers outside of cloths.
pub(super) fn check_numbers(scene: &SceneDesc) -> Result<(), SceneError> {
    if scene.cloth.is_empty() {
        return Err(SceneError::NoCloth);
    }
    not_negative("duration", scene.duration)?;
    positive("frame_rate", scene.frame_rate)?;
    positive("integrator.step", scene.integrator.step)?;
    if positive("integrator.tolerance", scene.integrator.tolerance)? >= 1.0 {
        return Err(SceneError::NotBelowOne { key: "integrator.tolerance", value: scene.integrator.tolerance });
    }
    positive("integrator.newton", f64::from(scene.integrator.newton))?;
    finite("gravity", &scene.gravity.unwrap_or_default())?;
    if let Some(drag) = &scene.drag {
        not_negative("drag.linear", drag.linear)?;
        if let Some(wind) = &drag.wind {
            finite("drag.wind.velocity", &wind.velocity)?;
            not_negative("drag.wind.normal", wind.normal)?;
            not_negative("drag.wind.tangential", wind.tangential)?;
        }
    }
    Ok(())
}
