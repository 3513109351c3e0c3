//! Prescribed motion of pins and colliders: an offset through keys, and a steady turn.

use crate::real::{Real, Sum, Vec3, cos, sin};

/// From which side a moment is looked at: a velocity jumps at a key and where a turn stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JumpSide {
    /// As it was until then.
    Before,
    /// As it is from then on.
    After,
}

impl JumpSide {
    /// Whether a change is over at a time. A time is so many times a step that was rounded: what is as near
    /// as that is met.
    fn has_passed(self, change: Sum, time: Sum) -> bool {
        let rounding = Sum::from(Real::EPSILON) * time.abs();
        match self {
            Self::Before => change < time - rounding,
            Self::After => change <= time + rounding,
        }
    }
}

/// A key of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// s.
    pub time: Sum,
    /// m.
    pub offset: Vec3,
}

/// A steady turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Unit vector along the axis.
    pub axis: Vec3,
    /// A point on the axis, m.
    pub centre: Vec3,
    /// rad/s.
    pub rate: Sum,
    /// The turn stops then, s.
    pub until: Sum,
}

/// How a point moves: keys and a turn, the turn first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// First of the motion's keys, and how many there are.
    pub keys: [u32; 2],
    /// Absent: no turn.
    pub turn: Option<Turn>,
}

impl Motion {
    /// Where a point is at a time, m, and how fast it moves on a side of it, m/s. `keys` holds those
    /// of all motions.
    pub fn at(&self, keys: &[Key], point: Vec3, time: Sum, side: JumpSide) -> (Vec3, Vec3) {
        let (turned, spin) = self.turn.map_or((point, Vec3::ZERO), |turn| turned(&turn, point, time, side));
        let [first, count] = self.keys;
        let (offset, slope) = offset(&keys[first as usize..(first + count) as usize], time, side);
        (turned + offset, spin + slope)
    }
}

/// Rotation of a point about the axis, and its velocity [Rodrigues].
fn turned(turn: &Turn, point: Vec3, time: Sum, side: JumpSide) -> (Vec3, Vec3) {
    let angle = (turn.rate * time.min(turn.until)) as Real;
    let arm = point - turn.centre;
    let along = turn.axis * arm.dot(turn.axis);
    let across = arm - along;
    let rotated = across * cos(angle) + turn.axis.cross(across) * sin(angle);
    let stopped = side.has_passed(turn.until, time);
    let spin = if stopped { Vec3::ZERO } else { turn.axis.cross(rotated) * turn.rate as Real };
    (turn.centre + along + rotated, spin)
}

/// Offset and its rate, linear between keys and resting outside them.
fn offset(keys: &[Key], time: Sum, side: JumpSide) -> (Vec3, Vec3) {
    let after = keys.partition_point(|key| side.has_passed(key.time, time));
    match (after.checked_sub(1).map(|i| keys[i]), keys.get(after)) {
        (Some(a), Some(b)) => {
            let span = b.time - a.time;
            let slope = (b.offset - a.offset) / span as Real;
            let part = ((time - a.time) / span).clamp(0.0, 1.0);
            (a.offset + (b.offset - a.offset) * part as Real, slope)
        }
        (Some(only), None) | (None, Some(&only)) => (only.offset, Vec3::ZERO),
        (None, None) => (Vec3::ZERO, Vec3::ZERO),
    }
}
