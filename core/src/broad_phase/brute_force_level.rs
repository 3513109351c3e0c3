//! The last level of the grid: each of its triangles is tested against all others, without cells.

use super::Surface;
use super::levels::NO_LEVEL;
use crate::column::Column;
use crate::geometry::aabb::Aabb;

/// Number of pairs that are passed to `add` at once.
const BATCH: usize = 256;

/// Calls `add` with all pairs of overlapping boxes in which at least one triangle is on the last level, `level`.
/// Returns false at once if it does.
pub fn for_each_brute_force_pair(
    triangle_boxes: &[Aabb],
    levels: &[u8],
    level: u8,
    surface: &Surface<'_>,
    mut add: impl FnMut(&[[u32; 2]]) -> bool,
) -> bool {
    let (mut batch, mut filled) = ([[0; 2]; BATCH], 0);
    let triangles = || (0..).zip(levels).zip(triangle_boxes);
    for ((a, _), first) in triangles().filter(|&((_, &own), _)| own == level) {
        for ((b, _), second) in triangles().filter(|&((b, &own), _)| own != NO_LEVEL && (own != level || b > a)) {
            if first.overlaps(second) && surface.may_pair(a, b) {
                batch.set(filled, [a, b]);
                filled += 1;
                if filled == BATCH {
                    if !add(&batch) {
                        return false;
                    }
                    filled = 0;
                }
            }
        }
    }
    add(batch.part(..filled))
}
