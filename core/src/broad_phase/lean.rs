//! A search that needs no columns: all triangles are compared with all, and their boxes are computed each time.

use super::bounds::{bounds_of, is_valid};
use super::features::{add_pair, named};
use super::{Candidates, Counts, Surface};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;

/// Writes the candidates and returns their numbers. `None` if `dispatch` [stopped](Dispatch::stopped) the search.
pub fn candidates(
    boxes: &[Aabb],
    surface: &Surface<'_>,
    out: &mut Candidates<'_>,
    dispatch: &impl Dispatch,
) -> Option<Counts> {
    let mut counts = Counts::default();
    let bounds = |triangle: usize| bounds_of(boxes, &surface.triangles.at(triangle), surface.owned.at(triangle));
    let passive = surface.first_passive as usize;
    for a in 0..passive.min(surface.triangles.len()) {
        if dispatch.stopped() {
            return None;
        }
        let (first, own) = bounds(a);
        if !is_valid(&first) {
            continue;
        }
        // Without contact of the cloth with itself, only with passive triangles.
        let from = if surface.own_contact { a + 1 } else { passive };
        for b in from..surface.triangles.len() {
            let (second, others) = bounds(b);
            if first.overlaps(&second) {
                let named = named(surface, [a, b], [own, others]);
                add_pair(boxes, surface, [a, b], [&first, &second], named, out, &mut counts);
            }
        }
    }
    Some(counts)
}
