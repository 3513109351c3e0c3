//! The last level: each of its triangles against all others, without cells.

use super::Surface;
use super::levels::NO_LEVEL;
use crate::geometry::aabb::Aabb;

/// Pairs that are handed on together.
const BATCH: usize = 256;

/// Calls `add` with all pairs of overlapping boxes of which one is of the last level.
pub fn for_each_brute_force_pair(
    triangle_boxes: &[Aabb],
    levels: &[u8],
    level: u8,
    surface: &Surface<'_>,
    mut add: impl FnMut(&[[u32; 2]]),
) {
    let (mut batch, mut filled) = ([[0; 2]; BATCH], 0);
    for a in (0..levels.len()).filter(|&a| levels[a] == level) {
        for b in (0..levels.len()).filter(|&b| levels[b] != NO_LEVEL && (levels[b] != level || b > a)) {
            if triangle_boxes[a].overlaps(&triangle_boxes[b]) && surface.may_pair(a as u32, b as u32) {
                batch[filled] = [a as u32, b as u32];
                filled += 1;
                if filled == BATCH {
                    add(&batch);
                    filled = 0;
                }
            }
        }
    }
    add(&batch[..filled]);
}
