//! Motion that a host gives a collider from step to step, for example that of a body in a rigid-body engine: evenly from
//! one pose to another. It is computed in double in both precisions.

use glam::{DQuat, DVec3};

use crate::motion::JumpSide;
use crate::real::{Sum, Vec3, vec3};

/// Place and orientation of a rigid collider.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Pose {
    /// Position of its centre, m.
    pub position: DVec3,
    /// Rotation from the orientation that the scene describes, a unit quaternion.
    pub rotation: DQuat,
}

impl Pose {
    /// No displacement and no rotation.
    pub const IDENTITY: Self = Self { position: DVec3::ZERO, rotation: DQuat::IDENTITY };

    /// A pose without rotation at a position, m.
    pub fn at(position: impl Into<DVec3>) -> Self {
        Self { position: position.into(), ..Self::IDENTITY }
    }

    /// Where the pose puts a point that is `arm` from the centre in the scene's orientation, m.
    pub fn place(&self, arm: DVec3) -> DVec3 {
        self.position + self.rotation * arm
    }

    /// The pose after a rigid motion: first this pose, then `by`.
    pub fn then(&self, by: &Self) -> Self {
        Self { position: by.place(self.position), rotation: (by.rotation * self.rotation).normalize() }
    }

    /// The pose with a rotation of unit length; `None` if a number is not finite or the rotation is zero.
    pub fn checked(self) -> Option<Self> {
        let length = self.rotation.length();
        let is_finite = vec3(self.position.into()).is_finite();
        let usable = is_finite && length.is_finite() && length > 0.0;
        usable.then(|| Self { rotation: self.rotation / length, ..self })
    }
}

/// The velocity of a rigid body.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Twist {
    /// Velocity of its centre, m/s.
    pub linear: DVec3,
    /// Angular velocity, rad/s.
    pub angular: DVec3,
}

impl Twist {
    /// Velocity of a point that is `arm` from the centre, m/s.
    fn at(&self, arm: DVec3) -> DVec3 {
        self.linear + self.angular.cross(arm)
    }
}

/// An even motion from one pose to another. Before and after it, the body rests.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Kinematic {
    /// The centre of the collider before any motion, m.
    pub centre: DVec3,
    /// The poses at its start and its end.
    pub poses: [Pose; 2],
    /// The times of its start and its end, s.
    pub times: [Sum; 2],
    /// The velocity in it.
    pub during: Twist,
    /// The velocity just before it, which tells two-step methods whether it jumps.
    pub before: Twist,
}

impl Kinematic {
    /// The motion between poses, by the shorter of the two ways around. Its velocity before was `before`.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn between(centre: DVec3, poses: [Pose; 2], times: [Sum; 2], before: Twist) -> Self {
        let [from, to] = poses;
        let seconds = times[1] - times[0];
        let during = Twist { linear: (to.position - from.position) / seconds, angular: rotation(&poses) / seconds };
        Self { centre, poses, times, during, before }
    }

    /// Rest in a pose from a time on, s.
    pub fn rest(centre: DVec3, pose: Pose, time: Sum) -> Self {
        let still = Twist::default();
        Self { centre, poses: [pose; 2], times: [time; 2], during: still, before: still }
    }

    /// The pose at a time, s.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn pose(&self, time: Sum) -> Pose {
        let [start, end] = self.times;
        let [from, to] = self.poses;
        let since = (time - start).max(0.0);
        if has_passed(JumpSide::After, end, time) {
            return to;
        }
        let turned = self.during.angular * since;
        let angle = turned.length();
        let (sin, cos) = libm::sincos(0.5 * angle);
        let axis = if angle > 0.0 { turned / angle } else { DVec3::ZERO };
        let rotation = DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos) * from.rotation;
        Pose { position: from.position + self.during.linear * since, rotation }
    }

    /// The velocity on the given side of a time.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn twist(&self, time: Sum, side: JumpSide) -> Twist {
        let [has_begun, has_ended] = self.times.map(|change| has_passed(side, change, time));
        match (has_begun, has_ended) {
            (false, _) => self.before,
            (true, false) => self.during,
            (true, true) => Twist::default(),
        }
    }

    /// Position of a point of the collider, m, and its velocity on the given side of a time, m/s. `point` is its position
    /// before any motion.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn at(&self, point: DVec3, time: Sum, side: JumpSide) -> (DVec3, Vec3) {
        let pose = self.pose(time);
        let arm = pose.rotation * (point - self.centre);
        (pose.position + arm, vec3(self.twist(time, side).at(arm).into()))
    }

    /// The point before any motion that is at `place` at a time.
    pub fn undo(&self, place: DVec3, time: Sum) -> DVec3 {
        let pose = self.pose(time);
        self.centre + pose.rotation.conjugate() * (place - pose.position)
    }

    /// Whether its numbers can be those of a motion.
    pub fn is_valid(&self) -> bool {
        let numbers: &[f64] = bytemuck::cast_slice(core::slice::from_ref(self));
        numbers.iter().all(|number| number.is_finite()) && self.times[0] <= self.times[1]
    }

    /// Whether it turns, by more than rounding does.
    pub fn turns(&self) -> bool {
        rotation(&self.poses).length() > 1e-9
    }

    /// The rotation between two times, rad.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn turned(&self, times: [Sum; 2]) -> DVec3 {
        let [from, to] = times.map(|time| time.max(self.times[0]).min(self.times[1]));
        self.during.angular * (to - from)
    }

    /// How far a point moves, between two times, from the straight and even way that a step takes it, or from the way
    /// that cloth goes on where it leaves the point, m: the height of the arc over its chord, and the way after the end of
    /// the motion. The point is `radius` from the centre, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn deviation(&self, radius: Sum, [start, end]: [Sum; 2]) -> Sum {
        if start > self.times[1] || end < self.times[0] {
            return 0.0;
        }
        let Twist { linear, angular } = self.during;
        let rest = if self.times[1] > start { (end - self.times[1]).max(0.0) } else { 0.0 };
        let half_angle = 0.5 * self.turned([start, end]).length();
        radius * (1.0 - libm::cos(half_angle)) + rest * (linear.length() + radius * angular.length())
    }
}

/// Whether a change lies in the past of a time. Both are sums of the host's times in doubles, so they differ by less
/// rounding than [keys](JumpSide::has_passed).
fn has_passed(side: JumpSide, change: Sum, time: Sum) -> bool {
    let rounding = 1e-14 * time.abs();
    match side {
        JumpSide::Before => change < time - rounding,
        JumpSide::After => change <= time + rounding,
    }
}

/// The rotation from the first pose to the second, rad, by at most half a turn.
fn rotation([from, to]: &[Pose; 2]) -> DVec3 {
    let mut by = to.rotation * from.rotation.conjugate();
    if by.w < 0.0 {
        by = -by;
    }
    let sin = by.xyz().length();
    // A rotation by less than the rounding of a double has no direction.
    if sin <= Sum::MIN_POSITIVE { DVec3::ZERO } else { by.xyz() * (2.0 * libm::atan2(sin, by.w) / sin) }
}
