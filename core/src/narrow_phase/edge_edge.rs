//! Nearest points of two edges.

use super::Nearest;
use crate::geometry::edge_edge::{closest_parameters, closest_parameters_x4};
use crate::lanes::Vec3x4;
use crate::real::{Lanes, Vec3};

/// The nearest points; `x` has the ends of the first edge, then the ends of the second.
#[inline]
pub fn nearest(x: &[Vec3; 4]) -> Nearest {
    let [a, b, c] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
    let [s, t] = closest_parameters(Vec3::ZERO, a, b, c);
    Nearest { weights: [1.0 - s, s, t - 1.0, -t], between: a * s - (b + (c - b) * t) }
}

/// The squared distances of four pairs, m^2.
#[inline(always)]
pub fn squared_distances(x: &[Vec3x4; 4]) -> Lanes {
    let [a, b, c] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
    let [s, t] = closest_parameters_x4(Vec3x4::default(), a, b, c);
    (a * s - (b + (c - b) * t)).length_squared()
}

/// A unit normal for edges at distance zero: perpendicular to both.
pub fn direction(x: &[Vec3; 4]) -> Option<Vec3> {
    (x[1] - x[0]).cross(x[3] - x[2]).try_normalize()
}
