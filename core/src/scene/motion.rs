//! Reads the motions of pins and colliders from a scene.

use alloc::vec::Vec;

use glam::DVec3;

use super::{MotionDesc, TurnDesc};
use crate::error::ColliderMotionError;
use crate::motion::{Key, Motion, Turn};
use crate::real::Real;

/// The part of a motion that is not usable. The caller adds the pin or the collider it belongs to.
pub(super) enum MotionError {
    Keys,
    Turn,
}

impl From<MotionError> for ColliderMotionError {
    fn from(error: MotionError) -> Self {
        match error {
            MotionError::Keys => Self::Keys,
            MotionError::Turn => Self::Turn,
        }
    }
}

/// Reads a motion and appends its keys to `keys`, the keys of all motions. Rotations are about `centre`.
pub(super) fn read_motion(motion: &MotionDesc, centre: DVec3, keys: &mut Vec<Key>) -> Result<Motion, MotionError> {
    let times_increase = motion.keys.windows(2).all(|k| k[0][0] < k[1][0]);
    if !times_increase || motion.keys.as_flattened().iter().any(|&x| !(x as Real).is_finite()) {
        return Err(MotionError::Keys);
    }
    let turn = motion.turn.as_ref().map(|turn| read_turn(turn, centre).ok_or(MotionError::Turn)).transpose()?;
    let first = keys.len() as u32;
    keys.extend(motion.keys.iter().map(|&[time, x, y, z]| Key { time, value: DVec3::new(x, y, z) }));
    Ok(Motion::new([first, motion.keys.len() as u32], turn))
}

/// Reads a rotation. `None` if the axis has no direction, the rate is not finite or `until` is NaN.
fn read_turn(turn: &TurnDesc, centre: DVec3) -> Option<Turn> {
    let until = turn.until.unwrap_or(f64::INFINITY);
    let axis = DVec3::from(turn.axis).try_normalize().filter(|_| turn.rate.is_finite() && !until.is_nan())?;
    Some(Turn { axis, centre, rate: turn.rate, until })
}
