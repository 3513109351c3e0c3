//! The distances between the features of each candidate at the start of a step [Ericson 2005].

use super::{Pairing, gather, gather_x4, vertices_x4};
use crate::broad_phase::Surface;
use crate::column::Column;
use crate::contact::Pairs;
use crate::dispatch::Dispatch;
use crate::real::{Lanes, Real, Vec3};

/// Writes the distance of each candidate minus the radii. If the lower bound from the bounding boxes already
/// exceeds `reach`, writes this bound instead.
pub fn distances<P: Pairing>(
    candidates: &[[u32; 2]],
    surface: &Surface<'_>,
    x: &[Vec3],
    radii: &[Real],
    reach: Real,
    distances: &mut [Real],
    dispatch: &impl Dispatch,
) {
    dispatch.run(distances, |first, part| {
        let candidates = candidates.part(first..first + part.len());
        for (candidates, distances) in candidates.chunks(4).zip(part.chunks_mut(4)) {
            let vertices = &vertices_x4::<P>(surface, candidates);
            let [a, b, c, d] = *vertices;
            let of = |vertices| Lanes::new(gather(vertices, radii));
            let (x, radius) = (&gather_x4(vertices, x), P::radius_sums([of(a), of(b), of(c), of(d)]));
            let bound = P::box_distances(x) - radius;
            let far = bound.simd_gt(Lanes::splat(reach));
            let four = far.bitselect(bound, P::squared_distances(x).sqrt() - radius).to_array();
            distances.copy_from(four.part(..distances.len()));
        }
    });
}

/// Drops those of the first `count` candidates that are farther apart than `reach`, m. Returns how many are left.
pub fn drop_far(pairs: &mut Pairs<'_>, count: usize, reach: Real) -> usize {
    let mut left = 0;
    for k in 0..count {
        let (candidate, distance) = (pairs.candidates.at(k), pairs.distances.at(k));
        if distance <= reach {
            pairs.candidates.set(left, candidate);
            pairs.distances.set(left, distance);
            left += 1;
        }
    }
    left
}
