//! Lower bounds of the distance between the features of each candidate during a motion. The slab between two features is
//! perpendicular to the line between their centres. Most candidates are neighbours on the same cloth, whose boxes overlap
//! although they are far apart; a slab separates them.
//!
//! Its thickness is a minimum of linear functions of time, so it is least at one end of the motion.

use super::Pairing;
use super::advance::{LEAST_SQUARED, slab};
use crate::broad_phase::Surface;
use crate::broad_phase::comoving::Motion;
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3, sqrt};

/// Writes the bound of each candidate less the radii, m. The motion ends in the middle of the end boxes. Their width above
/// the margin and the radius counts as uncertainty of the end.
pub fn bounds<P: Pairing>(
    candidates: &[[u32; 2]],
    surface: &Surface<'_>,
    motion: &Motion<'_>,
    bounds: &mut [Real],
    dispatch: &impl Dispatch,
) {
    dispatch.run(bounds, |first, part| {
        for (&candidate, bound) in candidates[first..].iter().zip(part) {
            let vertices = P::vertices(surface, candidate);
            *bound = self::bound(P::FIRST, vertices, motion);
        }
    });
}

/// The bound of two features. The first one has the first `first` vertices.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline(always))]
fn bound(first: usize, vertices: [u32; 4], motion: &Motion<'_>) -> Real {
    let (mut x, mut y) = ([Vec3::ZERO; 4], [Vec3::ZERO; 4]);
    let (mut half, mut radius, mut towards) = ([0.0; 2], [0.0; 2], Vec3::ZERO);
    for k in 0..4 {
        let (v, second) = (vertices[k] as usize, usize::from(k >= first));
        let around = &motion.ends[v];
        (x[k], y[k]) = (motion.start[v], (around.min + around.max) * 0.5);
        half[second] = (around.max - around.min).max_element().max(half[second]);
        radius[second] = motion.radii[v].max(radius[second]);
    }
    let (from, to) = (x[0], y[0]);
    let weights = if first == 1 { [3.0, -1.0, -1.0, -1.0] } else { [1.0, 1.0, -1.0, -1.0] };
    for k in 0..4 {
        (x[k], y[k]) = (x[k] - from, y[k] - to);
        towards += (x[k] + y[k]) * weights[k];
    }
    let radius: Real = radius.iter().sum();
    let uncertain = (0.5 * (half[0] + half[1]) - 2.0 * motion.margin - radius).max(0.0);
    let squared = towards.length_squared();
    if squared < LEAST_SQUARED {
        return Real::NEG_INFINITY;
    }
    let (start, end) = (slab(first, towards, &x), slab(first, towards, &y));
    let least = start.min(end - uncertain * towards.abs().element_sum()) / sqrt(squared) - radius;
    // A position that is not finite separates nothing.
    least.max(Real::NEG_INFINITY)
}
