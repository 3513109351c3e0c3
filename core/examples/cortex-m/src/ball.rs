//! A program that drives the cloth: it pushes the ball up, and lifts a corner of the sheet for a while. The machine that
//! cooks makes the same calls as the firmware, so both reach the same states.

use muslin_core::error::LiveError;
use muslin_core::kinematic::Pose;
use muslin_core::live::Live;

/// The collider, by its place in the scene.
const BALL: u32 = 0;
/// A corner of the sheet that no pin of the scene holds, and the place to which it is lifted, m.
const CORNER: u32 = 10;
const LIFTED: [f64; 3] = [0.12, 0.1, -0.12];
/// Steps after which the corner is held, and let go.
const HELD: core::ops::Range<usize> = 10..25;

/// The ball, which a motor drives.
pub struct Ball {
    /// Height of its centre, m.
    height: f64,
    /// Upwards, m/s.
    pub speed: f64,
}

impl Ball {
    pub fn new() -> Self {
        Self { height: -0.12, speed: 0.3 }
    }

    /// Makes the calls before a step of `seconds`.
    pub fn lead(&mut self, cloth: &mut impl Live, step: usize, seconds: f64) -> Result<(), LiveError> {
        cloth.move_collider(BALL, Pose::at([0.0, self.height + self.speed * seconds, 0.0]), seconds)?;
        if step == HELD.start {
            let duration = HELD.len() as f64 * seconds;
            cloth.move_to(CORNER, LIFTED, duration)?;
        }
        if step == HELD.end {
            cloth.release(CORNER);
        }
        Ok(())
    }

    /// The step was taken: the ball is where it was sent.
    pub fn go_on(&mut self, seconds: f64) {
        self.height += self.speed * seconds;
    }
}
