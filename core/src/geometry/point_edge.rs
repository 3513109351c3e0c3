//! The point of an edge nearest to a given point: `min |p - e0 - s (e1 - e0)|` over s in [0, 1].

use crate::real::{Real, Vec3};

/// The parameter of the nearest point, from 0 at `e0` to 1 at `e1`; 0 for an edge without length.
#[inline]
pub fn closest_parameter(p: Vec3, e0: Vec3, e1: Vec3) -> Real {
    let (reach, edge) = (p - e0, e1 - e0);
    let squared = edge.length_squared();
    if squared > 0.0 { (reach.dot(edge) / squared).clamp(0.0, 1.0) } else { 0.0 }
}
