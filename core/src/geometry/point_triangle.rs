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
use crate::real::{Real, Vec3};

/// Weights of the three corners. A triangle without area is treated as its three edges.
#[inline]
pub fn closest_weights(p: Vec3, t0: Vec3, t1: Vec3, t2: Vec3) -> [Real; 3] {
    let (edge, side, reach) = (t1 - t0, t2 - t0, p - t0);
    let squared = edge.length_squared();
    let (foot_side, foot_reach) = (side.dot(edge) / squared, reach.dot(edge) / squared);
    let (height, rise) = (side - foot_side * edge, reach - foot_reach * edge);
    let height_squared = height.length_squared();
    if height_squared > FLAT * FLAT * squared {
        let w2 = rise.dot(height) / height_squared;
        let w1 = foot_reach - w2 * foot_side;
        let w0 = 1.0 - w1 - w2;
        if w0 >= 0.0 && w1 >= 0.0 && w2 >= 0.0 {
            return [w0, w1, w2];
        }
        on_edges(p, [t0, t1, t2], [w2 < 0.0, w0 < 0.0, w1 < 0.0])
    } else {
        on_edges(p, [t0, t1, t2], [true; 3])
    }
}

/// The nearest point on the edges marked in `seen`, which are those that face the point; edge k joins corners k and
/// k + 1.
#[inline]
fn on_edges(p: Vec3, corners: [Vec3; 3], seen: [bool; 3]) -> [Real; 3] {
    let (mut weights, mut nearest) = ([1.0, 0.0, 0.0], Real::INFINITY);
    for k in 0..3 {
        if !seen[k] {
            continue;
        }
        let next = (k + 1) % 3;
        let (from, to) = (corners[k], corners[next]);
        let s = point_edge::closest_parameter(p, from, to);
        let distance = (p - from - s * (to - from)).length_squared();
        if distance < nearest {
            nearest = distance;
            weights = [0.0; 3];
            weights[k] = 1.0 - s;
            weights[next] = s;
        }
    }
    weights
}
