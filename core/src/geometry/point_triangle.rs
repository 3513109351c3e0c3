//! The point of a triangle nearest to a given point: `min |p - w0 t0 - w1 t1 - w2 t2|` over nonnegative weights
//! with sum 1 [Ericson 2005, section 5.1.5].
//!
//! The seven regions are Ericson's. The weights are computed from the edge e = t1 - t0 and the height h above it,
//! because his Gram determinants lose twice as many digits of a sliver's height in f32:
//! ```text
//! p - t0 = s e + rise,  t2 - t0 = s' e + h,  rise and h perpendicular to e
//! w2 = rise . h / h . h,  w1 = s - w2 s',  w0 = 1 - w1 - w2
//! ```
//! The error of the distance is a few roundings of the coordinates for every shape of the triangle.

use super::{FLAT, point_edge};
use crate::column::Column;
use crate::lanes::{Vec3x4, first};
use crate::real::{Lanes, Real, Vec3};

/// Weights of the three corners. A triangle without area is treated as its three edges.
pub fn closest_weights(p: Vec3, t0: Vec3, t1: Vec3, t2: Vec3) -> [Real; 3] {
    let [p, t0, t1, t2] = Vec3x4::splats(&[p, t0, t1, t2]);
    closest_weights_x4(p, [t0, t1, t2]).map(first)
}

/// The [weights](closest_weights) of four points in their triangles.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline(always))]
pub fn closest_weights_x4(p: Vec3x4, corners: [Vec3x4; 3]) -> [Lanes; 3] {
    let [t0, t1, t2] = corners;
    let (edge, side, reach) = (t1 - t0, t2 - t0, p - t0);
    let squared = edge.length_squared();
    let (foot_side, foot_reach) = (side.dot(edge) / squared, reach.dot(edge) / squared);
    let (height, rise) = (side - edge * foot_side, reach - edge * foot_reach);
    let height_squared = height.length_squared();
    let has_area = height_squared.simd_gt(Lanes::splat(FLAT * FLAT) * squared);
    let w2 = rise.dot(height) / height_squared;
    let w1 = foot_reach - w2 * foot_side;
    let w0 = Lanes::ONE - w1 - w2;
    let is_within = w0.simd_ge(Lanes::ZERO) & w1.simd_ge(Lanes::ZERO) & w2.simd_ge(Lanes::ZERO) & has_area;
    if is_within.all() {
        return [w0, w1, w2];
    }
    let seen = [w2, w0, w1].map(|w| w.simd_lt(Lanes::ZERO) | !has_area);
    let [e0, e1, e2] = on_edges(p, corners, seen);
    [is_within.bitselect(w0, e0), is_within.bitselect(w1, e1), is_within.bitselect(w2, e2)]
}

/// The nearest points on the edges marked in `seen`, which are those that face the point; edge k joins corners k and
/// k + 1.
#[inline(always)]
fn on_edges(p: Vec3x4, corners: [Vec3x4; 3], seen: [Lanes; 3]) -> [Lanes; 3] {
    let (mut weights, mut nearest) = ([Lanes::ONE, Lanes::ZERO, Lanes::ZERO], Lanes::splat(Real::INFINITY));
    for k in 0..3 {
        let (from, to) = (corners.at(k), corners.at((k + 1) % 3));
        let s = point_edge::closest_parameters(p, from, to);
        let distance = (p - from - (to - from) * s).length_squared();
        let nearer = seen.at(k) & distance.simd_lt(nearest);
        nearest = nearer.bitselect(distance, nearest);
        let from_here = [Lanes::ONE - s, s, Lanes::ZERO];
        weights =
            core::array::from_fn(|corner| nearer.bitselect(from_here.at((corner + 3 - k) % 3), weights.at(corner)));
    }
    weights
}
