//! The affine part of the motion of the cloth in a step. Cloth that flies, falls or turns moves little relative to it, so
//! boxes around the rest of the motion find far fewer pairs.
//!
//! A vertex at x moves linearly by d in the step. With any vectors b, c and any matrix A of norm a < 1, let
//! `d = b + A (x - c) + r`. The map `y = c + (I + t A)^-1 (x(t) - c - t b)` is affine at each time t, makes no distance
//! larger than `1 / (1 - a)` times what it was, and gives
//! ```text
//! y(t) = x + t (I + t A)^-1 r = x + t r - t^2 A r + e(t),    |e| <= a |A r| / (1 - a).
//! ```
//! Without e this is a Bezier curve with the control points x, x + r / 2 and x + r - A r, so it stays in the box around
//! them. Features that come within a distance D in the step have boxes that overlap if each is wider by half of
//! `D / (1 - a)` and by the bound of e.

use crate::geometry::aabb::Aabb;
use crate::real::{Mat3, Real, Vec3, outer, scaled_identity, sqrt};

/// Limit of a. A larger one would widen the boxes more than it saves.
const MOST_TURNING: Real = 0.25;

/// Smallest variance of the positions along an axis that the fit resolves, relative to their variance. Flat cloth has
/// none along its normal.
const LEAST_VARIANCE: Real = 1e-3;

/// An affine motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonMotion {
    /// c, m.
    center: Vec3,
    /// b, m.
    shift: Vec3,
    /// A.
    gradient: Mat3,
    /// a: the Frobenius norm of A.
    norm: Real,
}

impl CommonMotion {
    /// The affine motion nearest to that of the vertices, in the least squares of their distances. `None` without vertices,
    /// and where numbers are too large for it.
    #[cfg_attr(small, optimize(size))]
    pub fn fit(start: &[Vec3], end: &[Vec3]) -> Option<Self> {
        let &origin = start.first()?;
        let part = 1.0 / start.len() as Real;
        let pairs = || start.iter().zip(end).map(|(&start, &end)| (start - origin, end - start));
        let (center, shift) = pairs().fold((Vec3::ZERO, Vec3::ZERO), |(x, d), (at, moved)| (x + at, d + moved));
        let (center, shift) = (center * part, shift * part);
        let (mut moved, mut spread) = (scaled_identity(0.0), scaled_identity(0.0));
        for (at, displacement) in pairs() {
            moved += outer(displacement - shift, at - center);
            spread += outer(at - center, at - center);
        }
        let variance = spread.x_axis.x + spread.y_axis.y + spread.z_axis.z;
        let gradient = moved * (spread + scaled_identity(LEAST_VARIANCE * variance)).inverse();
        let columns = [gradient.x_axis, gradient.y_axis, gradient.z_axis];
        let norm = sqrt(columns.into_iter().map(Vec3::length_squared).sum());
        let part = (MOST_TURNING / norm).min(1.0);
        let fitted = Self { center: origin + center, shift, gradient: gradient * part, norm: norm * part };
        (fitted.norm.is_finite() && (fitted.center + fitted.shift).is_finite()).then_some(fitted)
    }

    /// The box around the motion of a vertex from `start` to `end` in the coordinates y, such that the boxes of features that
    /// come within twice `wide` overlap, m.
    #[inline(never)]
    pub fn surround(&self, start: Vec3, end: Vec3, wide: Real) -> Aabb {
        let from_center = start - self.center;
        let rest = end - start - self.shift - self.gradient * from_center;
        let bent = self.gradient * rest;
        let (middle, far) = (start + 0.5 * rest, start + (rest - bent));
        let sizes = start.abs().max(end.abs()) + self.shift.abs() + from_center.abs();
        let rounding = 16.0 * Real::EPSILON * sizes.max_element();
        let stretched = 1.0 / (1.0 - self.norm);
        let curved = self.norm * sqrt(bent.length_squared());
        let wide = stretched * (wide + curved) * (1.0 + 8.0 * Real::EPSILON) + rounding;
        Aabb { min: start.min(middle).min(far) - wide, max: start.max(middle).max(far) + wide }
    }
}
