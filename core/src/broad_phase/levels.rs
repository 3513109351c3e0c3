//! Triangles by size, so that a few large ones do not inflate every cell: each level has cells of
//! its own, in which its triangles meet one another and all smaller ones.
//!
//! A level starts at the sixteenth quantile of what is left and reaches to four times that size.
//! TrafficSizes are greatest extents in quarters of an octave. The last few, and boxes without bounds,
//! are a level of one cell.

use crate::geometry::aabb::Aabb;
use crate::real::{Vec3, to_f32};

/// In the column of levels: a box that overlaps nothing.
pub const NO_LEVEL: u8 = u8::MAX;

/// Levels with cells; triangles beyond them are in one cell.
pub const MOST: usize = 8;

/// So many triangles are better compared with all others than sorted into cells with them.
const FEW: u32 = 32;

/// Quarters of an octave from the smallest to the largest of a level.
const REACH: usize = 8;

const BINS: usize = 1024;

/// Infinite, or beyond f32.
const UNBOUNDED: usize = 255 << 2;

/// How the triangles were divided.
#[derive(Clone, Copy, Debug)]
pub struct Levels {
    /// Levels with cells.
    pub graded: u8,
    /// Triangles of the level of one cell, which is level `graded`.
    pub single: u32,
    /// The greatest extent in each level.
    pub extents: [f32; MOST],
    /// Around all boxes in levels with cells.
    pub scene: Aabb,
}

/// Writes the level of every triangle.
pub fn assign(triangle_boxes: &[Aabb], levels: &mut [u8]) -> Levels {
    let mut histogram = [0u32; BINS];
    let mut scene = Aabb::EMPTY;
    for b in triangle_boxes {
        if let Some(extent) = extent(b) {
            let bin = bin(extent);
            histogram[bin] += 1;
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
            *level = table[bin(extent)];
            if let Some(greatest) = extents.get_mut(*level as usize) {
                *greatest = extent.max(*greatest);
            }
        }
    }
    Levels { graded, single, extents, scene }
}

/// The level of each bin, how many levels there are with cells, and how many triangles without.
fn divide(histogram: &[u32; BINS]) -> ([u8; BINS], u8, u32) {
    let mut table = [0; BINS];
    let (mut left, mut next, mut level) = (histogram.iter().sum::<u32>(), 0, 0);
    while (level as usize) < MOST && left - histogram[UNBOUNDED] > FEW {
        let quantile = left / 16;
        let (mut passed, mut start) = (0, next);
        while start < UNBOUNDED && passed + histogram[start] <= quantile {
            passed += histogram[start];
            start += 1;
        }
        let end = (start + REACH).min(UNBOUNDED);
        for bin in next..end {
            table[bin] = level;
            left -= histogram[bin];
        }
        (next, level) = (end, level + 1);
    }
    table[next..].fill(level);
    (table, level, left)
}

/// `None` for a box that overlaps nothing.
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
