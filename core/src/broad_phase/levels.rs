//! Assigns triangles to the levels of the hierarchical grid by size, so that a few large triangles do not enlarge
//! every cell. Each level has its own cells, in which its triangles are compared with one another and with all
//! smaller triangles.
//!
//! The size of a triangle is the greatest extent of its box. Sizes are sorted into logarithmic bins, four per factor of
//! two. Take the 1/16 quantile of the sizes of the triangles that have no level yet. The next level takes all of these
//! triangles that are at most four times that large. The last few triangles, and those with unbounded boxes, form a
//! last level without cells.

use crate::column::Column;
use crate::geometry::aabb::Aabb;
use crate::real::{Vec3, to_f32};

/// The level of a triangle whose box is invalid, so that it overlaps nothing.
pub const NO_LEVEL: u8 = u8::MAX;

/// The greatest number of levels with cells. Triangles that are too large for them are on the last level.
pub const MOST: usize = 8;

/// If at most this many triangles remain, it is faster to compare them with all others than to sort them into cells.
const FEW: u32 = 32;

/// Number of size bins in a level, counted from the bin of its quantile. 8 bins span a factor of four.
const REACH: usize = 8;

const BINS: usize = 1024;

/// The first bin of extents that are infinite or too large for f32.
const UNBOUNDED: usize = 255 << 2;

/// The division of the triangles into levels.
#[derive(Clone, Copy, Debug)]
pub struct Levels {
    /// Number of levels with cells.
    pub graded: u8,
    /// Number of triangles on the last level, which has no cells and has the index `graded`.
    pub single: u32,
    /// The greatest extent in each level.
    pub extents: [f32; MOST],
    /// Box around all bounded boxes.
    pub scene: Aabb,
}

/// Writes the level of every triangle to `levels`, and returns the division.
pub fn assign(triangle_boxes: &[Aabb], levels: &mut [u8]) -> Levels {
    let mut histogram = [0u32; BINS];
    let mut scene = Aabb::EMPTY;
    for b in triangle_boxes {
        if let Some(extent) = extent(b) {
            let bin = bin(extent);
            histogram.add(bin, 1);
            if bin < UNBOUNDED {
                scene = scene.union(b);
            }
        }
    }
    let (table, graded, single) = divide(&histogram);
    let mut extents = [0.0; MOST];
    for (b, level) in triangle_boxes.iter().zip(levels) {
        *level = NO_LEVEL;
        if let Some(extent) = extent(b) {
            *level = table.at(bin(extent));
            if let Some(greatest) = extents.get_mut(*level as usize) {
                *greatest = extent.max(*greatest);
            }
        }
    }
    Levels { graded, single, extents, scene }
}

/// Returns the level of each bin, the number of levels with cells, and the number of triangles on the last level.
fn divide(histogram: &[u32; BINS]) -> ([u8; BINS], u8, u32) {
    let mut table = [0; BINS];
    let (mut left, mut next, mut level) = (histogram.iter().sum::<u32>(), 0, 0);
    while (level as usize) < MOST && left - histogram[UNBOUNDED] > FEW {
        let quantile = left / 16;
        let (mut passed, mut start) = (0, next);
        while start < UNBOUNDED && passed + histogram.at(start) <= quantile {
            passed += histogram.at(start);
            start += 1;
        }
        let end = (start + REACH).min(UNBOUNDED);
        for bin in next..end {
            table.set(bin, level);
            left -= histogram.at(bin);
        }
        (next, level) = (end, level + 1);
    }
    table.part_mut(next..).fill(level);
    (table, level, left)
}

/// The greatest extent of a box, or `None` if the box overlaps nothing.
#[inline]
fn extent(b: &Aabb) -> Option<f32> {
    let size: Vec3 = b.max - b.min;
    let largest = size.x.max(size.y).max(size.z);
    if b.min.x.is_nan() {
        None
    } else if size.is_nan() {
        Some(f32::INFINITY)
    } else {
        Some(to_f32(largest))
    }
}

#[inline]
fn bin(extent: f32) -> usize {
    (extent.to_bits() >> 21) as usize
}
