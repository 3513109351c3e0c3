//! Conservative advancement: two convex features are repeatedly moved forward in time as long as they cannot
//! collide, until the step ends or they are close [Mirtich 1996, Li 2021].
//!
//! Let d be the distance at time t, let i run over the vertices of the first feature and j over the vertices of the
//! second, and let `x_ij = x_i - x_j`. The features cannot come within the target distance before the later of
//! ```text
//! t + (d - target) / max |v_ij|                   from the largest relative velocity of a pair of vertices
//! t + (1 - t) (g(t) - target) / (g(t) - g(1))     g = min n . x_ij, the thickness of the slab between them
//! ```
//! The function g is a minimum of linear functions, so it lies above its chord. This holds for any unit vector n.
//! The direction between the nearest points excludes most pairs at once, but it is noise if d is near the rounding
//! error; the direction perpendicular to both features is not.
//!
//! All positions are relative to the first vertex. The error of a distance is then less than [`ROUNDING`] times the
//! largest coordinate, which is kept as a reserve.

use crate::column::Column;
use crate::lanes::{self, Vec3x4, greater, lesser};
use crate::real::{Lanes, Real, Vec3, sqrt};

/// Reserve for rounding errors, in units of the largest coordinate relative to the first vertex.
pub const ROUNDING: Real = 32.0 * Real::EPSILON;

/// After this many advances, the query returns the time reached as a hit.
pub const MOST_ADVANCES: u32 = 128;

/// A hit is declared at this fraction of the initial gap if that is less than the tolerance, so that features that
/// start close can still move.
const CLOSE: Real = 0.1;

/// Each advance aims at this fraction of the gap at which a hit is declared.
const TARGET: Real = 0.9;

/// Sums of squares below this have lost digits to underflow.
pub const LEAST_SQUARED: Real = Real::MIN_POSITIVE / Real::EPSILON;

/// The time in [0, 1] at which two features come within `separation + tolerance`, m. The first feature consists of the
/// first `first` of the four vertices: 1, a vertex and a triangle, or 2, two edges; `apart` returns the vector between
/// the nearest points.
///
/// `None` means that the features stay farther apart than `separation`. A time is never late: until then, the
/// features were farther apart than `separation`. The time is 0 if they start within `separation`. A tolerance
/// below [`ROUNDING`] times the largest coordinate is raised to that value. Positions that are not finite, or too
/// large to square, count as a hit at time 0.
pub fn advance(
    first: usize,
    start: &[Vec3; 4],
    end: &[Vec3; 4],
    separation: Real,
    tolerance: Real,
    apart: &dyn Fn(&[Vec3; 4]) -> Vec3,
) -> Option<Real> {
    let (start, end) = (start.map(|x| x - start[0]), end.map(|x| x - end[0]));
    let size = [&start, &end].map(|x| lanes::first(largest(&Vec3x4::splats(x))));
    let size = size[0].max(size[1]);
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
        let mut next = closing(first, between, &now, &end, time, target);
        if next < 1.0 {
            if advances == 0 {
                speed = fastest(first, &core::array::from_fn(|i| end.at(i) - start.at(i)));
            }
            let upright = upright(first, &now, between);
            next = next.max(closing(first, upright, &now, &end, time, target));
            next = next.max(time + (distance - target) / speed);
        }
        if next >= 1.0 {
            return None;
        }
        time = next;
        now = core::array::from_fn(|i| start.at(i) + time * (end.at(i) - start.at(i)));
    }
    Some(time)
}

/// The largest coordinates of vertices relative to the first, of four pairs; infinite if a coordinate is not finite or
/// if squared lengths could overflow.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline(always))]
pub fn largest(local: &[Vec3x4; 4]) -> Lanes {
    let (mut size, mut sum) = (Vec3x4::default(), Vec3x4::default());
    for &x in &local[1..] {
        size = size.max(x.abs());
        sum = sum + x;
    }
    let size = size.max_element();
    // The sum tells of NaN, which the maximum may not. Where the square is finite, the sum is too small to change it.
    let is_finite = (Lanes::splat(64.0) * size * size + sum.element_sum()).is_finite();
    is_finite.bitselect(size, Lanes::splat(Real::INFINITY))
}

/// The earliest time at which the slab between the features, perpendicular to `direction`, is as thin as `target`.
/// Returns 1 if this never happens, and `time` if the slab is already that thin or the direction is too short.
#[inline]
fn closing(first: usize, direction: Vec3, now: &[Vec3; 4], end: &[Vec3; 4], time: Real, target: Real) -> Real {
    let squared = direction.length_squared();
    if squared < LEAST_SQUARED {
        return time;
    }
    let length = sqrt(squared);
    let (gap, last) = (slab(first, direction, now) / length, slab(first, direction, end) / length);
    if gap > target && last >= target {
        1.0
    } else if gap > target {
        time + (1.0 - time) * ((gap - target) / (gap - last))
    } else {
        time
    }
}

/// The thickness of the slab between the features, times the length of `direction`.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline)]
pub fn slab(first: usize, direction: Vec3, x: &[Vec3; 4]) -> Real {
    lanes::first(slabs(first, Vec3x4::splat(direction), &Vec3x4::splats(x)))
}

/// The thicknesses of the [slabs](slab) of four pairs.
#[inline(always)]
pub fn slabs(first: usize, direction: Vec3x4, x: &[Vec3x4; 4]) -> Lanes {
    let (first, second) = x.cut(first);
    let low = first.iter().fold(Lanes::splat(Real::INFINITY), |low, &x| lesser(direction.dot(x), low));
    let high = second.iter().fold(Lanes::splat(Real::NEG_INFINITY), |high, &x| greater(direction.dot(x), high));
    low - high
}

/// A vector perpendicular to the triangle or to both edges that points towards the first feature.
#[inline]
fn upright(first: usize, &[a, b, c, d]: &[Vec3; 4], between: Vec3) -> Vec3 {
    let upright = if first == 1 { (c - b).cross(d - b) } else { (b - a).cross(d - c) };
    if upright.dot(between) < 0.0 { -upright } else { upright }
}

/// The largest displacement of a vertex of one feature relative to a vertex of the other.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline)]
pub fn fastest(first: usize, displacements: &[Vec3; 4]) -> Real {
    lanes::first(fastest_x4(first, &Vec3x4::splats(displacements)))
}

/// The [largest relative displacements](fastest) of four pairs.
#[inline(always)]
pub fn fastest_x4(first: usize, displacements: &[Vec3x4; 4]) -> Lanes {
    let (first, second) = displacements.cut(first);
    let pairs = first.iter().flat_map(|&a| second.iter().map(move |&b| (a - b).length_squared()));
    pairs.fold(Lanes::ZERO, |most, squared| greater(squared, most)).sqrt()
}
