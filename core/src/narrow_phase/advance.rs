//! Conservative advancement: two convex features move on for as long as they cannot meet, again
//! and again, until the step is over or they are close [Mirtich 1996, Li 2021].
//!
//! With n the unit vector between the nearest points at distance d, i over the vertices of the
//! first and j over those of the second feature, `x_ij = x_i - x_j`, the features cannot come
//! within the target distance before the later of
//! ```text
//! t + (d - target) / max |v_ij|                            the farthest that any pair moves
//! t + (1 - t) (g(t) - target) / (g(t) - g(1))              where the slab between them closes
//! ```
//! with `g = min n . x_ij`, a minimum of linear functions and so above its chord.
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

/// The time in [0, 1] at which two features come within `separation + tolerance`, m, the first
/// being the first `FIRST` of the four vertices; `apart` gives the vector between the nearest
/// points.
///
/// `None` says that they stay farther apart than `separation`. A time is never late: until then
/// they were farther apart than `separation`, except that it is 0 where they start within it. A
/// tolerance below [`ROUNDING`] is raised to it. What is not finite, or too large to square, is hit at
/// once.
#[inline]
pub fn advance<const FIRST: usize>(
    start: &[Vec3; 4],
    end: &[Vec3; 4],
    separation: Real,
    tolerance: Real,
    apart: impl Fn(&[Vec3; 4]) -> Vec3,
) -> Option<Real> {
    let (start, end) = (start.map(|x| x - start[0]), end.map(|x| x - end[0]));
    let size = largest(&start, &end);
    if !size.is_finite() {
        return Some(0.0);
    }
    let (mut time, mut hit, mut target, mut speed) = (0.0, Real::INFINITY, Real::INFINITY, Real::NAN);
    let mut now = start;
    for advances in 0..MOST_ADVANCES {
        let normal = apart(&now);
        let distance = sqrt(normal.length_squared());
        if advances == 0 {
            let gap = (CLOSE * (distance - separation)).min(tolerance).max(ROUNDING * size);
            (hit, target) = (separation + gap, separation + TARGET * gap);
        }
        // What is not a number is not farther.
        let farther = distance > hit;
        if !farther {
            return Some(time);
        }
        let normal = normal / distance;
        let (gap, last) = (slab::<FIRST>(normal, &now), slab::<FIRST>(normal, &end));
        if gap >= target && last >= target {
            return None;
        }
        if advances == 0 {
            speed = fastest::<FIRST>(&start, &end);
        }
        let mut next = time + (distance - target) / speed;
        if gap > target {
            next = next.max(time + (1.0 - time) * ((gap - target) / (gap - last)));
        }
        if next >= 1.0 {
            return None;
        }
        time = next;
        now = core::array::from_fn(|i| start[i] + time * (end[i] - start[i]));
    }
    Some(time)
}

/// The largest coordinate; infinite where one is not finite or lengths could overflow.
#[inline]
fn largest(start: &[Vec3; 4], end: &[Vec3; 4]) -> Real {
    let (mut size, mut sum) = (Vec3::ZERO, Vec3::ZERO);
    for i in 1..4 {
        size = size.max(start[i].abs()).max(end[i].abs());
        sum += start[i] + end[i];
    }
    let size = size.max_element();
    if sum.is_finite() && (64.0 * size * size).is_finite() { size } else { Real::INFINITY }
}

/// How far apart two parallel planes between the features can be: the width of the slab.
#[inline]
fn slab<const FIRST: usize>(normal: Vec3, x: &[Vec3; 4]) -> Real {
    let heights = x.map(|x| normal.dot(x));
    let (first, second) = heights.split_at(FIRST);
    first.iter().fold(Real::INFINITY, |a, &b| a.min(b)) - second.iter().fold(Real::NEG_INFINITY, |a, &b| a.max(b))
}

/// The farthest that a vertex of one feature moves relative to one of the other.
#[inline]
fn fastest<const FIRST: usize>(start: &[Vec3; 4], end: &[Vec3; 4]) -> Real {
    let motion: [Vec3; 4] = core::array::from_fn(|i| end[i] - start[i]);
    let (first, second) = motion.split_at(FIRST);
    let pairs = first.iter().flat_map(|&a| second.iter().map(move |&b| (a - b).length_squared()));
    sqrt(pairs.fold(0.0, Real::max))
}
