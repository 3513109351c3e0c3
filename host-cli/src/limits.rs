//! Limits on the length of a run. A longer run is refused with a message before it starts.
//!
//! This module only refuses values that are too large; the core refuses invalid ones (NaN, negative).

use muslin_core::scene::SceneDesc;

/// Largest number of steps of a run, and of a frame. These steps take more than a week at a microsecond each,
/// and their number is exact in a double.
const MOST_STEPS: f64 = 1e12;

/// Largest number of frames: file formats count them in 31 bits.
const MOST_FRAMES: f64 = 2_147_483_647.0;

/// Checks the numbers of frames and steps of a scene; the message says which values to change.
pub fn check(scene: &SceneDesc) -> Result<(), String> {
    let (duration, rate, step) = (scene.duration, scene.frame_rate, scene.integrator.step());
    let frames = duration * rate;
    if frames > MOST_FRAMES {
        return Err(format!(
            "duration = {duration:?} and frame_rate = {rate:?} make too many frames; at most 2^31 are possible: \
             take a shorter duration or a lower frame_rate"
        ));
    }
    if step > 0.0 && rate > 0.0 && frames.max(1.0) * (1.0 / rate / step).max(1.0) > MOST_STEPS {
        return Err(format!(
            "duration = {duration:?}, frame_rate = {rate:?} and integrator.step = {step:?} make too many steps; \
             at most {MOST_STEPS:e} are possible: take a shorter duration or a longer step"
        ));
    }
    Ok(())
}
