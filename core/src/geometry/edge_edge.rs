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
use crate::lanes::{Vec3x4, clamp_to_unit, first};
use crate::real::{Lanes, Real, Vec3};

/// The parameters of the nearest points, from 0 at the first end of each edge to 1 at its second end. For parallel
/// edges that overlap, this is one of many nearest pairs.
pub fn closest_parameters(a0: Vec3, a1: Vec3, b0: Vec3, b1: Vec3) -> [Real; 2] {
    let [a0, a1, b0, b1] = Vec3x4::splats(&[a0, a1, b0, b1]);
    closest_parameters_x4(a0, a1, b0, b1).map(first)
}

/// The [parameters](closest_parameters) of four pairs of edges.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline(always))]
pub fn closest_parameters_x4(a0: Vec3x4, a1: Vec3x4, b0: Vec3x4, b1: Vec3x4) -> [Lanes; 2] {
    let (a, b, r) = (a1 - a0, b1 - b0, a0 - b0);
    let (a_squared, b_squared) = (a.length_squared(), b.length_squared());
    let (along_a, along_r) = (a.dot(b) / b_squared, r.dot(b) / b_squared);
    let (a_across, r_across) = (a - b * along_a, r - b * along_r);
    let across_squared = a_across.length_squared();
    let s = clamp_to_unit(-r_across.dot(a_across) / across_squared);
    let s = across_squared.simd_gt(Lanes::splat(FLAT * FLAT) * a_squared).bitselect(s, Lanes::ZERO);
    let t = along_r + s * along_a;
    let within = t.simd_ge(Lanes::ZERO) & t.simd_le(Lanes::ONE);
    let t = clamp_to_unit(t);
    let s = within.bitselect(s, clamp_to_unit((b * t - r).dot(a) / a_squared));
    let are_long = a_squared.simd_gt(Lanes::ZERO) & b_squared.simd_gt(Lanes::ZERO);
    if are_long.all() {
        return [s, t];
    }
    let (on_a, on_b) = (point_edge::closest_parameters(b0, a0, a1), point_edge::closest_parameters(a0, b0, b1));
    [are_long.bitselect(s, on_a), are_long.bitselect(t, on_b)]
}
