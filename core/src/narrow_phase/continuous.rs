//! When the features of each candidate meet in the course of a step.
//!
//! They cannot where the way that they come nearer is less than what is between them: `way < distance -
//! separation`. All of it is rounded. With u = EPSILON / 2 and S the largest coordinate relative to the
//! first vertex, the right side is too large by less than 48 u S:
//! ```text
//!  4  coordinates relative to the first vertex
//! 24  weights that are not quite the nearest: 17 across the features; along them 42, which add to a
//!     distance of more than the reserve, 128, as squares: 42^2 / 256
//!  7  the vector between, by these weights
//!  5  its length
//!  7  the radii, what is less by them and by the separation, and the sum on the left
//! ```
//! and by less than 70 u S where a device measured, whose divisions may be wrong by 5 u and roots by 9 u.
//! A lower bound by boxes is better than any. The way has a reserve of its own.

use super::advance::{ROUNDING, largest};
use super::{Pairing, gather};
use crate::broad_phase::Surface;
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3};

/// In `times`: not in this step.
pub const NEVER: Real = 2.0;

/// Features nearer than this part of the separation touch: rounding hides what they do.
pub const TOUCH: Real = 1e-3;

/// In `times`: the features touch already, as far as rounding tells.
pub const TOUCHING: Real = 3.0;

/// Reserve against rounding of distances, in units of the largest coordinate relative to the first vertex:
/// 128 u.
const RESERVE: Real = 2.0 * ROUNDING;

/// The motion of all vertices, and which of them moved since they were last tested.
#[derive(Clone, Copy)]
pub struct LinearMotion<'a> {
    /// m.
    pub start: &'a [Vec3],
    /// m.
    pub end: &'a [Vec3],
    /// From start to end, m.
    pub moves: &'a [Vec3],
    /// m around each vertex.
    pub radii: &'a [Real],
    /// The round in which each was last moved.
    pub rounds: &'a [u32],
    /// Only candidates with a vertex moved in this round are tested; 0: all.
    pub round: u32,
}

/// Not less than the way that the features come towards one another, m, however far they move together:
/// each move is rounded, by less than 2 sqrt(3) u of the largest for two of them.
#[inline]
fn farthest<P: Pairing>(moves: &[Vec3; 4]) -> Real {
    let largest = moves.iter().fold(Vec3::ZERO, |most, x| most.max(x.abs())).max_element();
    P::approach(moves) * (1.0 + 1e-5) + 4.0 * Real::EPSILON * largest
}

/// Writes when each candidate's features come within `separation` of one another, or within half
/// of their distance where they are already nearer. For features that touch at the start there
/// is no such time: an exact test of the end has to follow.
pub fn times<P: Pairing>(
    candidates: &[[u32; 2]],
    distances: &[Real],
    surface: &Surface<'_>,
    motion: LinearMotion<'_>,
    separation: Real,
    times: &mut [Real],
    dispatch: &impl Dispatch,
) {
    let least = TOUCH * separation;
    dispatch.run(times, |first, part| {
        for ((&candidate, &distance), time) in candidates[first..].iter().zip(&distances[first..]).zip(part) {
            *time = NEVER;
            let vertices = P::vertices(surface, candidate);
            let untouched = motion.round > 0 && gather(vertices, motion.rounds).iter().all(|&r| r != motion.round);
            if untouched {
                continue;
            }
            if distance <= least {
                *time = TOUCHING;
                continue;
            }
            let separation = separation.min(0.5 * distance);
            let start = gather(vertices, motion.start);
            let reserve = RESERVE * largest([&start.map(|x| x - start[0])]);
            // Nearly all candidates cannot have come near enough.
            if farthest::<P>(&gather(vertices, motion.moves)) + reserve < distance - separation {
                continue;
            }
            let end = gather(vertices, motion.end);
            let radius = P::radius(gather(vertices, motion.radii));
            if let Some(at) = P::time_of_impact(&start, &end, separation + radius, 0.5 * separation) {
                // At once, although apart: rounding hides what they do.
                *time = if at > 0.0 { at } else { TOUCHING };
            }
        }
    });
}
