//! Spheres and capsules: all within a radius of a point or a line.

use crate::real::{Real, Vec3, sqrt};

/// A sphere as a triangle.
pub const SPHERE: [[u32; 3]; 1] = [[0, 0, 0]];
/// A capsule's axis as a triangle.
pub const CAPSULE: [[u32; 3]; 1] = [[0, 1, 1]];

/// How deep a point lies in it, m.
pub fn depth(a: Vec3, b: Vec3, radius: Real, point: Vec3) -> Real {
    let (axis, arm) = (b - a, point - a);
    let along = arm.dot(axis) / axis.length_squared().max(Real::MIN_POSITIVE);
    (radius - sqrt((arm - axis * along.clamp(0.0, 1.0)).length_squared())).max(0.0)
}
