//! Sphere and capsule colliders: all points within a radius of a point or a segment.

use crate::real::{Real, Vec3, sqrt};

/// The centre of a sphere as a triangle that repeats its vertex.
pub const SPHERE: [[u32; 3]; 1] = [[0, 0, 0]];
/// The axis of a capsule as a triangle that repeats a vertex.
pub const CAPSULE: [[u32; 3]; 1] = [[0, 1, 1]];

/// Depth of a point inside the capsule with axis `a b`, m; 0 outside. A sphere has `a == b`.
pub fn depth(a: Vec3, b: Vec3, radius: Real, point: Vec3) -> Real {
    let (axis, arm) = (b - a, point - a);
    let along = arm.dot(axis) / axis.length_squared().max(Real::MIN_POSITIVE);
    (radius - sqrt((arm - axis * along.clamp(0.0, 1.0)).length_squared())).max(0.0)
}
