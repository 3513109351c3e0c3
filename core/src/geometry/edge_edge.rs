//! The nearest points of two edges: `min |r + s a - t b|`, r = a0 - b0, over s and t in [0, 1]
//! [Ericson 2005, section 5.1.9].
//!
//! Ericson solves for s with the determinant `a.a b.b - (a.b)^2`, which in f32 is noise at angles below 1e-3. With
//! the components a' and r' of a and r perpendicular to b, the error of the distance stays within a few roundings
//! of the coordinates at every angle:
//! ```text
//! s = clamp(-r' . a' / a' . a'),  t = (r + s a) . b / b . b;  if t is outside: clamp t, s = (t b - r) . a / a . a
//! ```
//! If a' is too short, the edges are parallel and s = 0.

use super::{FLAT, point_edge};
use crate::real::{Real, Vec3};

/// The parameters of the nearest points, from 0 at the first end of each edge to 1 at its second end. For parallel
/// edges that overlap, this is one of many nearest pairs.
#[inline]
pub fn closest_parameters(a0: Vec3, a1: Vec3, b0: Vec3, b1: Vec3) -> [Real; 2] {
    let (a, b, r) = (a1 - a0, b1 - b0, a0 - b0);
    let (a_squared, b_squared) = (a.length_squared(), b.length_squared());
    if !(a_squared > 0.0 && b_squared > 0.0) {
        return [point_edge::closest_parameter(b0, a0, a1), point_edge::closest_parameter(a0, b0, b1)];
    }
    let (along_a, along_r) = (a.dot(b) / b_squared, r.dot(b) / b_squared);
    let (a_across, r_across) = (a - along_a * b, r - along_r * b);
    let across_squared = a_across.length_squared();
    let s = if across_squared > FLAT * FLAT * a_squared {
        (-r_across.dot(a_across) / across_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let t = along_r + s * along_a;
    if (0.0..=1.0).contains(&t) {
        [s, t]
    } else {
        let t = t.clamp(0.0, 1.0);
        [((t * b - r).dot(a) / a_squared).clamp(0.0, 1.0), t]
    }
}
