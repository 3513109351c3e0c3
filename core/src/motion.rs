//! Prescribed motion of pins and colliders: an offset by keys, and a steady rotation. It is computed in double in both
//! precisions, because a step moves a point by a small part of its position.

use glam::DVec3;

use crate::keys::interpolate;
pub use crate::keys::{JumpSide, Key};
use crate::real::{Sum, Vec3, to_f64, vec3};

/// A steady rotation about an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Unit vector along the axis.
    pub axis: DVec3,
    /// A point on the axis, m.
    pub centre: DVec3,
    /// Angular velocity, rad/s.
    pub rate: Sum,
    /// Time at which the rotation stops, s.
    pub until: Sum,
}

/// The motion of a point: the rotation is applied first, then the offset by keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Index of the first key of this motion, and number of keys.
    pub keys: [u32; 2],
    /// Rotation; absent: no rotation.
    pub turn: Option<Turn>,
}

impl Turn {
    /// Angle at `time`, rad.
    pub fn angle(&self, time: Sum) -> Sum {
        self.rate * time.min(self.until)
    }
}

impl Motion {
    /// Position of a point at `time`, m, and its velocity on the given side of that time, m/s. `keys`
    /// are the keys of all motions.
    pub fn at(&self, keys: &[Key], point: Vec3, time: Sum, side: JumpSide) -> (DVec3, Vec3) {
        let point = to_f64(point).into();
        let (turned, spin) = self.turn.map_or((point, DVec3::ZERO), |turn| turned(&turn, point, time, side));
        let [first, count] = self.keys;
        let (offset, slope) = interpolate(&keys[first as usize..(first + count) as usize], time, side);
        (turned + offset, vec3((spin + slope).into()))
    }

    /// The point that the motion brings to `place` at `time`.
    pub fn undo(&self, keys: &[Key], place: DVec3, time: Sum) -> DVec3 {
        let [first, count] = self.keys;
        let (offset, _) = interpolate(&keys[first as usize..(first + count) as usize], time, JumpSide::After);
        let back = self.turn.map(|turn| Turn { rate: -turn.rate, ..turn });
        back.map_or(place - offset, |back| turned(&back, place - offset, time, JumpSide::After).0)
    }
}

/// Position of a point that rotates about the axis, m, and its velocity, m/s [Rodrigues].
fn turned(turn: &Turn, point: DVec3, time: Sum, side: JumpSide) -> (DVec3, DVec3) {
    let angle = turn.angle(time);
    let arm = point - turn.centre;
    let along = turn.axis * arm.dot(turn.axis);
    let across = arm - along;
    let rotated = across * libm::cos(angle) + turn.axis.cross(across) * libm::sin(angle);
    let stopped = side.has_passed(turn.until, time);
    let spin = if stopped { DVec3::ZERO } else { turn.axis.cross(rotated) * turn.rate };
    (turn.centre + along + rotated, spin)
}
