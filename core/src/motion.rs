//! Prescribed motion of pins and colliders: an offset by keys, and a steady rotation. It is computed in double in both
//! precisions, because a step moves a point by a small part of its position.

use core::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::column::Column;
use crate::keys::{self, interpolate};
pub use crate::keys::{JumpSide, Key};
use crate::kinematic::{Pose, Twist};
use crate::real::{Sum, Vec3, to_f64, vec3};

/// A steady rotation about an axis.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
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
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Motion {
    /// Index of the first key of this motion, and number of keys.
    pub keys: [u32; 2],
    /// Without an axis it is no rotation.
    turn: Turn,
}

impl Turn {
    /// No rotation.
    const NONE: Self = Self { axis: DVec3::ZERO, centre: DVec3::ZERO, rate: 0.0, until: 0.0 };

    /// Angle at `time`, rad.
    pub fn angle(&self, time: Sum) -> Sum {
        self.rate * time.min(self.until)
    }

    /// How far a point moves, `radius` from the axis, m, from its straight and even way between two times: the height of
    /// the arc over its chord. If the rotation stops between them, it would be farther by the rest of its way.
    fn deviation(&self, radius: Sum, [start, end]: [Sum; 2]) -> Sum {
        let angle = libm::fabs(self.angle(end) - self.angle(start));
        let rest = if self.until > start { libm::fabs(self.rate) * (end - self.until).max(0.0) } else { 0.0 };
        radius * (1.0 - libm::cos(0.5 * angle.min(TAU)) + rest)
    }
}

impl Motion {
    /// A motion with these keys, and a rotation about an axis.
    pub const fn new(keys: [u32; 2], turn: Option<Turn>) -> Self {
        let turn = match turn {
            Some(turn) => turn,
            None => Turn::NONE,
        };
        Self { keys, turn }
    }

    /// The rotation.
    pub fn turn(&self) -> Option<Turn> {
        (self.turn.axis != DVec3::ZERO).then_some(self.turn)
    }

    /// Replaces the axis and the centre of the rotation.
    pub fn set_axis(&mut self, axis: DVec3, centre: DVec3) {
        (self.turn.axis, self.turn.centre) = (axis, centre);
    }

    /// Position of a point at `time`, m, and its velocity on the given side of that time, m/s. `keys`
    /// are the keys of all motions.
    pub fn at(&self, keys: &[Key], point: Vec3, time: Sum, side: JumpSide) -> (DVec3, Vec3) {
        let point = to_f64(point).into();
        let (turned, spin) = self.turn().map_or((point, DVec3::ZERO), |turn| turned(&turn, point, time, side));
        let (offset, slope) = self.offset(keys, time, side);
        (turned + offset, vec3((spin + slope).into()))
    }

    /// How far a point moves, between two times, from the straight and even way that a step takes it, or from the way
    /// that cloth goes on where it leaves the point, m. The point is `radius` from the axis of the rotation, m; axes count
    /// that are 1 in the mask, not 0.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn deviation(&self, keys: &[Key], radius: Sum, mask: DVec3, times: [Sum; 2]) -> Sum {
        let of_turn = self.turn().map_or(0.0, |turn| turn.deviation(radius, times));
        of_turn + keys::deviation(self.own(keys), mask, times)
    }

    /// The largest distance of points from the axis of the rotation, which the keys have moved by `offset`, m; 0 without
    /// rotation.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn reach(&self, points: &[Vec3], offset: DVec3) -> Sum {
        let Some(turn) = self.turn() else { return 0.0 };
        let centre = turn.centre + offset;
        let radius = |&point: &Vec3| (DVec3::from(to_f64(point)) - centre).cross(turn.axis).length();
        points.iter().map(radius).fold(0.0, Sum::max)
    }

    /// The offset by keys, m, and its rate on the given side of a time, m/s.
    pub fn offset(&self, keys: &[Key], time: Sum, side: JumpSide) -> (DVec3, DVec3) {
        interpolate(self.own(keys), time, side)
    }

    /// The pose at `time` of a body whose centre was at `centre` before any motion, m, and its velocity on the given side
    /// of that time.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn pose(&self, keys: &[Key], centre: DVec3, time: Sum, side: JumpSide) -> (Pose, Twist) {
        let (offset, slope) = self.offset(keys, time, side);
        let Some(turn) = self.turn() else {
            return (Pose::at(centre + offset), Twist { linear: slope, ..Twist::default() });
        };
        let (position, spin) = turned(&turn, centre, time, side);
        let (sin, cos) = libm::sincos(0.5 * turn.angle(time));
        let [x, y, z] = (turn.axis * sin).to_array();
        let angular = if side.has_passed(turn.until, time) { DVec3::ZERO } else { turn.axis * turn.rate };
        let pose = Pose { position: position + offset, rotation: DQuat::from_xyzw(x, y, z, cos) };
        (pose, Twist { linear: slope + spin, angular })
    }

    /// Whether the motion has come to its end at `time`, s.
    pub fn has_ended(&self, keys: &[Key], time: Sum) -> bool {
        let passed = |end| JumpSide::After.has_passed(end, time);
        self.own(keys).last().is_none_or(|key| passed(key.time)) && self.turn().is_none_or(|turn| passed(turn.until))
    }

    /// The keys of this motion among those of all motions.
    pub(crate) fn own<'a>(&self, keys: &'a [Key]) -> &'a [Key] {
        let [first, count] = self.keys;
        keys.part(first as usize..(first + count) as usize)
    }

    /// Puts the axis of the rotation through the mean of points, m, if there are any.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(crate) fn set_centre(&mut self, points: impl Iterator<Item = DVec3>) {
        let (sum, count) = points.fold((DVec3::ZERO, 0.0), |(sum, count), point| (sum + point, count + 1.0));
        if count > 0.0 {
            self.turn.centre = sum / count;
        }
    }

    /// The point that the motion brings to `place` at `time`.
    pub fn undo(&self, keys: &[Key], place: DVec3, time: Sum) -> DVec3 {
        let (offset, _) = self.offset(keys, time, JumpSide::After);
        let back = self.turn().map(|turn| Turn { rate: -turn.rate, ..turn });
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
