//! The distances between the features of each candidate at the start of a step [Ericson 2005].

use super::{Pairing, gather};
use crate::broad_phase::Surface;
use crate::contact::Pairs;
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3, sqrt};

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
        for (&candidate, distance) in candidates[first..].iter().zip(part) {
            let vertices = P::vertices(surface, candidate);
            let (x, radius) = (&gather(vertices, x), P::radius(gather(vertices, radii)));
            let bound = P::box_distance(x) - radius;
            *distance = if bound > reach { bound } else { sqrt(P::nearest(x).between.length_squared()) - radius };
        }
    });
}

/// Drops those of the first `count` candidates that are farther apart than `reach`, m. Returns how many are left.
pub fn drop_far(pairs: &mut Pairs<'_>, count: usize, reach: Real) -> usize {
    let mut left = 0;
    for k in 0..count {
        if pairs.distances[k] <= reach {
            pairs.candidates[left] = pairs.candidates[k];
            pairs.distances[left] = pairs.distances[k];
            left += 1;
        }
    }
    left
}
