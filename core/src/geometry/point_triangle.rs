//! The point of a triangle nearest to a point: `min |p - w0 t0 - w1 t1 - w2 t2|` over weights that
//! are not negative and sum to 1 [Ericson 2005, section 5.1.5].
//!
//! The regions are his seven; the weights come from the longest edge e and the height h above it
//! instead of his Gram determinants, which lose a sliver's height twice over in f32:
//! ```text
//! p - a = s e + rise,  c - a = s' e + h,  rise and h perpendicular to e
//! w_c = rise . h / h . h,  w_b = s - w_c s',  w_a = 1 - w_b - w_c
//! ```
//! so that the distance is wrong by a few roundings of the coordinates, whatever the shape.

use super::{FLAT, point_edge};
use crate::real::{Real, Vec3};

/// Weights of the three corners. A triangle without area counts as its edges.
#[inline]
pub fn closest_weights(p: Vec3, t0: Vec3, t1: Vec3, t2: Vec3) -> [Real; 3] {
    let lengths = [t1 - t0, t2 - t1, t0 - t2].map(Vec3::length_squared);
    if lengths[0] >= lengths[1] && lengths[0] >= lengths[2] {
        from_longest(p, t0, t1, t2)
    } else if lengths[1] >= lengths[2] {
        let [w1, w2, w0] = from_longest(p, t1, t2, t0);
        [w0, w1, w2]
    } else {
        let [w2, w0, w1] = from_longest(p, t2, t0, t1);
        [w0, w1, w2]
    }
}

/// The weights of a, b and c, where no edge is longer than ab.
#[inline]
fn from_longest(p: Vec3, a: Vec3, b: Vec3, c: Vec3) -> [Real; 3] {
    let (edge, side, reach) = (b - a, c - a, p - a);
    let squared = edge.length_squared();
    let (foot_side, foot_reach) = (side.dot(edge) / squared, reach.dot(edge) / squared);
    let (height, rise) = (side - foot_side * edge, reach - foot_reach * edge);
    let height_squared = height.length_squared();
    if height_squared > FLAT * FLAT * squared {
        let w_c = rise.dot(height) / height_squared;
        let w_b = foot_reach - w_c * foot_side;
        let w_a = 1.0 - w_b - w_c;
        if w_a >= 0.0 && w_b >= 0.0 && w_c >= 0.0 {
            return [w_a, w_b, w_c];
        }
        on_edges(p, [a, b, c], [w_c < 0.0, w_a < 0.0, w_b < 0.0])
    } else {
        on_edges(p, [a, b, c], [true; 3])
    }
}

/// The nearest point on those of the edges ab, bc and ca that the point sees.
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
