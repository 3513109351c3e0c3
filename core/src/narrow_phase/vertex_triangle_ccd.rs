//! The time of impact of a moving vertex and a moving triangle, by [`advance`].

use super::advance::advance;
use crate::geometry::point_triangle;
use crate::real::{Real, Vec3};

/// The time of impact in [0, 1], or `None` if vertex and triangle stay farther apart than `separation`, m. The
/// positions are `[vertex, t0, t1, t2]` and move linearly. [`advance`] describes the other parameters.
pub fn time_of_impact(start: &[Vec3; 4], end: &[Vec3; 4], separation: Real, tolerance: Real) -> Option<Real> {
    advance(1, start, end, separation, tolerance, &apart)
}

/// The vector from the nearest point of the triangle to the vertex.
#[inline]
pub fn apart(&[p, t0, t1, t2]: &[Vec3; 4]) -> Vec3 {
    let [w0, w1, w2] = point_triangle::closest_weights(p, t0, t1, t2);
    w0 * (p - t0) + w1 * (p - t1) + w2 * (p - t2)
}
