//! The nearest points of two edges: `min |r + s a - t b|`, r = a0 - b0, over s and t in [0, 1]
//! [Ericson 2005, section 5.1.9].
//!
//! He solves for s by the determinant `a.a b.b - (a.b)^2`, which in f32 is noise below an angle of
//! a thousandth. Taking the parts perpendicular to b keeps the distance right to a few roundings
//! of the coordinates at every angle:
//! ```text
//! s = clamp(-r' . a' / a' . a'),  t = (r + s a) . b / b . b;  t outside: clamp t, s = (t b - r) . a / a . a
//! ```
//! Where a' is flat the edges are parallel, every s is as good, and s = 0.

use super::{FLAT, point_edge};
use crate::real::{Real, Vec3};

/// Where on each edge, from 0 at its first end to 1 at its second. Of parallel edges that
/// overlap, one of many nearest pairs.
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
