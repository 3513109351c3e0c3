//! Computes when the features of each candidate collide during a step.
//!
//! Features cannot collide if their approach is less than the distance between them:
//! `approach < distance - separation`. All of these are rounded. With u = EPSILON / 2 and S the largest coordinate
//! relative to the first vertex, the computed right side is too large by less than 48 u S:
//! ```text
//!  4  coordinates relative to the first vertex
//! 24  weights that are not exactly nearest: 17 across the features, and 42 along them, which enter a
//!     distance above the reserve of 128 only as squares: 42^2 / 256
//!  7  the vector between the points with these weights
//!  5  its length
//!  7  the radii, the subtraction of the radii and of the separation, and the sum on the left side
//! ```
//! The error is less than 70 u S if a GPU computed the distances, because its divisions may be wrong by 5 u and its
//! square roots by 9 u. A lower bound from bounding boxes has a smaller error than either. The approach has its own
//! reserve.

use super::advance::{ROUNDING, fastest, largest};
use super::time_of_impact::{StoredTime, TimeOfImpact};
use super::{Pairing, gather};
use crate::broad_phase::Surface;
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3};

/// Features nearer than this fraction of the separation count as touching, because rounding hides their motion.
pub const TOUCH: Real = 1e-3;

/// Reserve for rounding errors of distances, 128 u, in units of the largest coordinate relative to the first vertex.
const RESERVE: Real = 2.0 * ROUNDING;

/// The motion of all vertices, and the round in which each of them last moved.
#[derive(Clone, Copy)]
pub struct LinearMotion<'a> {
    /// Positions at the start of the step, m.
    pub start: &'a [Vec3],
    /// Positions at the end of the step, m.
    pub end: &'a [Vec3],
    /// Displacements from start to end, m.
    pub displacements: &'a [Vec3],
    /// Radius of each vertex, m.
    pub radii: &'a [Real],
    /// The round in which each vertex was last moved.
    pub rounds: &'a [u32],
    /// Only candidates with a vertex that moved in this round are tested; with 0, all are tested.
    pub round: u32,
}

/// An upper bound of the distance by which the features approach each other, m. It includes the rounding error of
/// two displacements, which is less than 2 sqrt(3) u times the largest, so it is valid even if both features share
/// a large motion.
#[inline]
fn farthest<P: Pairing>(displacements: &[Vec3; 4]) -> Real {
    let largest = displacements.iter().fold(Vec3::ZERO, |most, x| most.max(x.abs())).max_element();
    fastest(P::FIRST, displacements) * (1.0 + 1e-5) + 4.0 * Real::EPSILON * largest
}

/// Writes the time at which the features of each candidate come within `separation` of each other, or within half
/// of their initial distance if that is less. Features that touch at the start have no time of impact: an exact
/// test of the end positions must follow.
pub fn times<P: Pairing>(
    candidates: &[[u32; 2]],
    distances: &[Real],
    surface: &Surface<'_>,
    motion: LinearMotion<'_>,
    separation: Real,
    times: &mut [StoredTime],
    dispatch: &impl Dispatch,
) {
    dispatch.run(times, |first, part| {
        for ((&candidate, &distance), time) in candidates[first..].iter().zip(&distances[first..]).zip(part) {
            *time = time_of::<P>(P::vertices(surface, candidate), distance, &motion, separation).into();
        }
    });
}

#[inline]
fn time_of<P: Pairing>(
    vertices: [u32; 4],
    distance: Real,
    motion: &LinearMotion<'_>,
    separation: Real,
) -> TimeOfImpact {
    let untouched = motion.round > 0 && gather(vertices, motion.rounds).iter().all(|&r| r != motion.round);
    if untouched {
        return TimeOfImpact::Never;
    }
    if distance <= TOUCH * separation {
        return TimeOfImpact::Touching;
    }
    let separation = separation.min(0.5 * distance);
    let start = gather(vertices, motion.start);
    let reserve = RESERVE * largest([&start.map(|x| x - start[0])]);
    // Most candidates do not move far enough to collide.
    if farthest::<P>(&gather(vertices, motion.displacements)) + reserve < distance - separation {
        return TimeOfImpact::Never;
    }
    let end = gather(vertices, motion.end);
    let radius = P::radius(gather(vertices, motion.radii));
    match P::time_of_impact(&start, &end, separation + radius, 0.5 * separation) {
        None => TimeOfImpact::Never,
        Some(time) if time > 0.0 => TimeOfImpact::At(time),
        // The time is 0 although the features are apart, because rounding hides their motion.
        Some(_) => TimeOfImpact::Touching,
    }
}
