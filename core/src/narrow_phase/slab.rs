//! Lower bounds of the distance between the features of each candidate during a motion. The slab between two features
//! is perpendicular to the line between their centres. Most candidates are neighbours on the same cloth, whose boxes
//! overlap although they are far apart; a slab separates them.
//!
//! Its thickness is a minimum of linear functions of time, so it is least at one end of the motion.

use super::advance::{LEAST_SQUARED, slabs};
use super::{Pairing, gather, vertices_x4};
use crate::broad_phase::Surface;
use crate::broad_phase::comoving::Motion;
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::lanes::{Vec3x4, greater, min};
use crate::real::{Lanes, Real};

/// Writes the bound of each candidate less the radii, m. The motion ends in the middle of the end boxes. Their width
/// above the margin and the radius counts as uncertainty of the end.
pub fn bounds<P: Pairing>(
    candidates: &[[u32; 2]],
    surface: &Surface<'_>,
    motion: &Motion<'_>,
    bounds: &mut [Real],
    dispatch: &impl Dispatch,
) {
    dispatch.run(bounds, |first, part| {
        let candidates = candidates.part(first..first + part.len());
        for (candidates, bounds) in candidates.chunks(4).zip(part.chunks_mut(4)) {
            let four = bound(P::FIRST, &vertices_x4::<P>(surface, candidates), motion).to_array();
            bounds.copy_from(four.part(..bounds.len()));
        }
    });
}

/// The bounds of four candidates.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline(always))]
fn bound(first: usize, vertices: &[[u32; 4]; 4], motion: &Motion<'_>) -> Lanes {
    let splat = Lanes::splat;
    let (mut x, mut y, mut towards) = ([Vec3x4::default(); 4], [Vec3x4::default(); 4], Vec3x4::default());
    let (mut half, mut radius) = ([Lanes::ZERO; 2], [Lanes::ZERO; 2]);
    let (mut from, mut to) = (Vec3x4::default(), Vec3x4::default());
    let weights = if first == 1 { [3.0, -1.0, -1.0, -1.0] } else { [1.0, 1.0, -1.0, -1.0] };
    for (k, (&v, weight)) in vertices.iter().zip(weights).enumerate() {
        let second = usize::from(k >= first);
        let [a, b, c, d] = gather(v, motion.ends);
        let (min, max) = (Vec3x4::new([a.min, b.min, c.min, d.min]), Vec3x4::new([a.max, b.max, c.max, d.max]));
        let widest = greater((max - min).max_element(), half.at(second));
        half.set(second, widest);
        let largest = greater(Lanes::new(gather(v, motion.radii)), radius.at(second));
        radius.set(second, largest);
        let (start, end) = (Vec3x4::new(gather(v, motion.start)), (min + max) * splat(0.5));
        if k == 0 {
            (from, to) = (start, end);
        }
        let (start, end) = (start - from, end - to);
        towards = towards + (start + end) * splat(weight);
        x.set(k, start);
        y.set(k, end);
    }
    let radius = radius[0] + radius[1];
    let uncertain = greater(splat(0.5) * (half[0] + half[1]) - splat(2.0 * motion.margin) - radius, Lanes::ZERO);
    let squared = towards.length_squared();
    let (start, end) = (slabs(first, towards, &x), slabs(first, towards, &y));
    let least = min(start, end - uncertain * towards.abs().element_sum()) / squared.sqrt() - radius;
    // A position that is not finite separates nothing.
    let least = greater(least, splat(Real::NEG_INFINITY));
    squared.simd_lt(splat(LEAST_SQUARED)).bitselect(splat(Real::NEG_INFINITY), least)
}
