//! The time of impact of two moving edges, by [`advance`].

use super::advance::advance;
use crate::geometry::edge_edge;
use crate::real::{Real, Vec3};

/// The time of impact in [0, 1], or `None` if the edges stay farther apart than `separation`, m. The positions are
/// `[a0, a1, b0, b1]` and move linearly. [`advance`] describes the other parameters.
pub fn time_of_impact(start: &[Vec3; 4], end: &[Vec3; 4], separation: Real, tolerance: Real) -> Option<Real> {
    advance(2, start, end, separation, tolerance, &apart)
}

/// The vector from the nearest point of edge b to the nearest point of edge a.
#[inline]
pub fn apart(&[a0, a1, b0, b1]: &[Vec3; 4]) -> Vec3 {
    let [s, t] = edge_edge::closest_parameters(a0, a1, b0, b1);
    (a0 - b0) + s * (a1 - a0) - t * (b1 - b0)
}
