//! Nearest points of a vertex and a triangle.

use super::Nearest;
use crate::geometry::point_triangle::{closest_weights, closest_weights_x4};
use crate::lanes::Vec3x4;
use crate::real::{Lanes, Vec3};

/// The nearest points; `x` has the vertex, then the vertices of the triangle.
#[inline]
pub fn nearest(x: &[Vec3; 4]) -> Nearest {
    let [a, b, c] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
    let w = closest_weights(Vec3::ZERO, a, b, c);
    Nearest { weights: [1.0, -w[0], -w[1], -w[2]], between: -(a * w[0] + b * w[1] + c * w[2]) }
}

/// The squared distances of four pairs, m^2.
#[inline(always)]
pub fn squared_distances(x: &[Vec3x4; 4]) -> Lanes {
    let [a, b, c] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
    let w = closest_weights_x4(Vec3x4::default(), [a, b, c]);
    (a * w[0] + b * w[1] + c * w[2]).length_squared()
}

/// A unit normal for a vertex at distance zero: the normal of the triangle.
pub fn direction(x: &[Vec3; 4]) -> Option<Vec3> {
    (x[2] - x[1]).cross(x[3] - x[1]).try_normalize()
}
