//! When two moving edges come together; how, says [`advance`].

use super::advance::advance;
use crate::geometry::edge_edge;
use crate::real::{Real, Vec3};

/// The time in [0, 1], or `None` where the edges stay farther apart than `separation`, m.
/// Positions are `[a0, a1, b0, b1]` and move linearly; for the rest see [`advance`].
pub fn time_of_impact(start: &[Vec3; 4], end: &[Vec3; 4], separation: Real, tolerance: Real) -> Option<Real> {
    advance::<2>(start, end, separation, tolerance, apart)
}

/// From the nearest point of edge b to that of edge a.
#[inline]
pub fn apart(&[a0, a1, b0, b1]: &[Vec3; 4]) -> Vec3 {
    let [s, t] = edge_edge::closest_parameters(a0, a1, b0, b1);
    (a0 - b0) + s * (a1 - a0) - t * (b1 - b0)
}
