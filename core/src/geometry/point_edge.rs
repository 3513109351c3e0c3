//! The point of an edge nearest to a given point: `min |p - e0 - s (e1 - e0)|` over s in [0, 1].

use crate::lanes::{Vec3x4, clamp_to_unit};
use crate::real::Lanes;

/// The parameters of four nearest points, from 0 at `e0` to 1 at `e1`; 0 for an edge without length.
#[inline(always)]
pub fn closest_parameters(p: Vec3x4, e0: Vec3x4, e1: Vec3x4) -> Lanes {
    let (reach, edge) = (p - e0, e1 - e0);
    let squared = edge.length_squared();
    squared.simd_gt(Lanes::ZERO).bitselect(clamp_to_unit(reach.dot(edge) / squared), Lanes::ZERO)
}
