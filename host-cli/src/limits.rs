//! How long a run can be: refused with a word before anything is written or counted.
//!
//! Only what is too much is judged here; wrong numbers (NaN, negative) are the core's to refuse.

use muslin_core::scene::SceneDesc;

/// Most steps of a run, and of a frame: more than a week at a microsecond each, and exact in a
/// double.
const MOST_STEPS: f64 = 1e12;

/// Most frames: file formats count them in 31 bits.
const MOST_FRAMES: f64 = 2_147_483_647.0;

/// Whether a scene's time can be run; the message says which numbers to change.
pub fn check(scene: &SceneDesc) -> Result<(), String> {
    let (duration, rate, step) = (scene.duration, scene.frame_rate, scene.integrator.step);
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
