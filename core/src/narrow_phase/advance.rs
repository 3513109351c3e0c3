//! Conservative advancement: two convex features move on for as long as they cannot meet, again
//! and again, until the step is over or they are close [Mirtich 1996, Li 2021].
//!
//! At distance d, with i over the vertices of the first and j over those of the second feature and
//! `x_ij = x_i - x_j`, the features cannot come within the target distance before the latest of
//! ```text
//! t + (d - target) / max |v_ij|                   the farthest that any pair moves
//! t + (1 - t) (g(t) - target) / (g(t) - g(1))     g = min n . x_ij, the slab between them
//! ```
//! where g, a minimum of linear functions, is above its chord. Any unit vector n will do. That
//! between the nearest points lets most pairs go at once, but its direction is noise where d is
//! near rounding; that perpendicular to the features is not.
//!
//! All is computed relative to the first vertex. Distances are then wrong by less than
//! [`ROUNDING`] times the largest coordinate, which is kept in reserve.

use crate::real::{Real, Vec3, sqrt};

/// Reserve against rounding, in units of the largest coordinate relative to the first vertex.
pub const ROUNDING: Real = 32.0 * Real::EPSILON;

/// Advances before a query counts as a hit at the time it has reached.
pub const MOST_ADVANCES: u32 = 128;

/// A hit is declared at this fraction of the start's gap, where that is less than the tolerance:
/// features that start close may still move.
const CLOSE: Real = 0.1;

/// How far of the way to a hit's distance an advance goes down.
const TARGET: Real = 0.9;

/// Sums of squares below have lost digits to underflow.
const LEAST_SQUARED: Real = Real::MIN_POSITIVE / Real::EPSILON;

/// The time in [0, 1] at which two features come within `separation + tolerance`, m, the first
/// being the first `FIRST` of the four vertices; `apart` gives the vector between the nearest
/// points.
///
/// `None` says that they stay farther apart than `separation`. A time is never late: until then
/// they were farther apart than `separation`, except that it is 0 where they start within it. A
/// tolerance below [`ROUNDING`] is raised to it. What is not finite, or too large to square, is hit
/// at once.
#[inline]
pub fn advance<const FIRST: usize>(
    start: &[Vec3; 4],
    end: &[Vec3; 4],
    separation: Real,
    tolerance: Real,
    apart: impl Fn(&[Vec3; 4]) -> Vec3,
) -> Option<Real> {
    let (start, end) = (start.map(|x| x - start[0]), end.map(|x| x - end[0]));
    let size = largest([&start, &end]);
    if !size.is_finite() {
        return Some(0.0);
    }
    let (mut time, mut hit, mut target, mut speed) = (0.0, Real::INFINITY, Real::INFINITY, Real::NAN);
    let mut now = start;
    for advances in 0..MOST_ADVANCES {
        let between = apart(&now);
        let distance = sqrt(between.length_squared());
        if advances == 0 {
            let gap = (CLOSE * (distance - separation)).min(tolerance).max(ROUNDING * size);
            (hit, target) = (separation + gap, separation + TARGET * gap);
        }
        if distance <= hit {
            return Some(time);
        }
        let mut next = closing::<FIRST>(between, &now, &end, time, target);
        if next < 1.0 {
            if advances == 0 {
                speed = fastest::<FIRST>(&start, &end);
            }
            let upright = upright::<FIRST>(&now, between);
            next = next.max(closing::<FIRST>(upright, &now, &end, time, target));
            next = next.max(time + (distance - target) / speed);
        }
        if next >= 1.0 {
            return None;
        }
        time = next;
        now = core::array::from_fn(|i| start[i] + time * (end[i] - start[i]));
    }
    Some(time)
}

/// The largest coordinate of vertices relative to the first; infinite where one is not finite or lengths
/// could overflow.
#[inline]
pub fn largest<const N: usize>(local: [&[Vec3; 4]; N]) -> Real {
    let (mut size, mut sum) = (Vec3::ZERO, Vec3::ZERO);
    for i in 1..4 {
        for x in local {
            size = size.max(x[i].abs());
            sum += x[i];
        }
    }
    let size = size.max_element();
    if sum.is_finite() && (64.0 * size * size).is_finite() { size } else { Real::INFINITY }
}

/// When the slab between the features that is perpendicular to a direction is as thin as the
/// target, at the earliest: 1 if never, `time` if it already is or the direction is too short to tell.
#[inline]
fn closing<const FIRST: usize>(direction: Vec3, now: &[Vec3; 4], end: &[Vec3; 4], time: Real, target: Real) -> Real {
    let squared = direction.length_squared();
    if squared < LEAST_SQUARED {
        return time;
    }
    let length = sqrt(squared);
    let (gap, last) = (slab::<FIRST>(direction, now) / length, slab::<FIRST>(direction, end) / length);
    if gap > target && last >= target {
        1.0
    } else if gap > target {
        time + (1.0 - time) * ((gap - target) / (gap - last))
    } else {
        time
    }
}

/// The thickness of the slab times the length of the direction.
#[inline]
fn slab<const FIRST: usize>(direction: Vec3, x: &[Vec3; 4]) -> Real {
    let heights = x.map(|x| direction.dot(x));
    let (first, second) = heights.split_at(FIRST);
    first.iter().fold(Real::INFINITY, |a, &b| a.min(b)) - second.iter().fold(Real::NEG_INFINITY, |a, &b| a.max(b))
}

/// Perpendicular to the triangle, or to both edges, towards the first feature.
#[inline]
fn upright<const FIRST: usize>(&[a, b, c, d]: &[Vec3; 4], between: Vec3) -> Vec3 {
    let upright = if FIRST == 1 { (c - b).cross(d - b) } else { (b - a).cross(d - c) };
    if upright.dot(between) < 0.0 { -upright } else { upright }
}

/// The farthest that a vertex of one feature moves relative to one of the other.
#[inline]
fn fastest<const FIRST: usize>(start: &[Vec3; 4], end: &[Vec3; 4]) -> Real {
    let motion: [Vec3; 4] = core::array::from_fn(|i| end[i] - start[i]);
    let (first, second) = motion.split_at(FIRST);
    let pairs = first.iter().flat_map(|&a| second.iter().map(move |&b| (a - b).length_squared()));
    sqrt(pairs.fold(0.0, Real::max))
}
