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

use super::advance::{ROUNDING, fastest_x4, largest};
use super::time_of_impact::{StoredTime, TimeOfImpact};
use super::{Pairing, first_four, gather, gather_x4, vertices_x4};
use crate::broad_phase::Surface;
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::lanes::{Vec3x4, min};
use crate::real::{Lanes, Real, Vec3};

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
    /// Radius of each vertex, m.
    pub radii: &'a [Real],
    /// The round in which each vertex was last moved.
    pub rounds: &'a [u32],
    /// Only candidates with a vertex that moved in this round are tested; with 0, all are tested.
    pub round: u32,
}

impl LinearMotion<'_> {
    /// Whether a candidate is tested.
    #[inline(always)]
    fn tests(&self, vertices: [u32; 4]) -> bool {
        self.round == 0 || gather(vertices, self.rounds).contains(&self.round)
    }
}

/// Which of four candidates do not move far enough to collide, as one bit for each.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline(always))]
fn stay_apart(
    first: usize,
    vertices: &[[u32; 4]; 4],
    distances: Lanes,
    motion: &LinearMotion<'_>,
    separation: Real,
) -> u32 {
    let start = gather_x4(vertices, motion.start);
    let end = gather_x4(vertices, motion.end);
    let [a, b, c, d] = start;
    let reserve = Lanes::splat(RESERVE) * largest(&[Vec3x4::default(), b - a, c - a, d - a]);
    let separation = min(Lanes::splat(separation), Lanes::splat(0.5) * distances);
    let displacements = core::array::from_fn(|k| end.at(k) - start.at(k));
    let approach = farthest(first, &displacements);
    (approach + reserve).simd_lt(distances - separation).to_bitmask()
}

/// Upper bounds of the distances by which the features of four candidates approach each other, m. They include the
/// rounding error of two displacements, which is less than 2 sqrt(3) u times the largest, so they are valid even if
/// both features share a large motion.
#[inline(always)]
fn farthest(first: usize, displacements: &[Vec3x4; 4]) -> Lanes {
    let largest = displacements.iter().fold(Vec3x4::default(), |most, x| most.max(x.abs())).max_element();
    fastest_x4(first, displacements) * Lanes::splat(1.0 + 1e-5) + Lanes::splat(4.0 * Real::EPSILON) * largest
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
        let range = first..first + part.len();
        let measured = candidates.part(range.clone()).chunks(4).zip(distances.part(range).chunks(4));
        for ((candidates, distances), times) in measured.zip(part.chunks_mut(4)) {
            let is_tested = |&candidate: &[u32; 2]| motion.tests(P::vertices(surface, candidate));
            if !candidates.iter().any(is_tested) {
                times.fill(TimeOfImpact::Never.into());
                continue;
            }
            let vertices = &vertices_x4::<P>(surface, candidates);
            let apart = stay_apart(P::FIRST, vertices, Lanes::new(first_four(distances)), &motion, separation);
            for (k, ((time, candidate), &distance)) in times.iter_mut().zip(candidates).zip(distances).enumerate() {
                *time = if !is_tested(candidate) {
                    TimeOfImpact::Never
                } else if distance <= TOUCH * separation {
                    TimeOfImpact::Touching
                } else if apart >> k & 1 == 1 {
                    TimeOfImpact::Never
                } else {
                    time_of::<P>(P::vertices(surface, *candidate), distance, &motion, separation)
                }
                .into();
            }
        }
    });
}

/// The time of impact of a candidate that may collide.
#[inline(never)]
#[cfg_attr(small, optimize(size))]
fn time_of<P: Pairing>(
    vertices: [u32; 4],
    distance: Real,
    motion: &LinearMotion<'_>,
    separation: Real,
) -> TimeOfImpact {
    let separation = separation.min(0.5 * distance);
    let start = gather(vertices, motion.start);
    let end = gather(vertices, motion.end);
    let radius = P::radius(gather(vertices, motion.radii));
    match P::time_of_impact(&start, &end, separation + radius, 0.5 * separation) {
        None => TimeOfImpact::Never,
        Some(time) if time > 0.0 => TimeOfImpact::At(time),
        // The time is 0 although the features are apart, because rounding hides their motion.
        Some(_) => TimeOfImpact::Touching,
    }
}
