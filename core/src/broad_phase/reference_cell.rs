//! The candidates by a simpler grid, for tests. Every box is stored in all cells that it touches. A pair is tested
//! only in the cell whose index along each axis is the greater of the two boxes' lowest indices. This finds every
//! pair exactly once, for cells of any size. Only the bounds and the expansion into features are shared with the
//! [grid](super::grid).

use alloc::vec;
use alloc::vec::Vec;

use super::bounds::write_bounds;
use super::features::add_features;
use super::{Candidates, Counts, Surface};
use crate::dispatch::Serial;
use crate::geometry::aabb::Aabb;
use crate::real::{Real, Vec3};

/// Number of cells along each axis.
const ACROSS: Real = 32.0;

/// Writes the candidates, and returns their numbers.
pub fn candidates(boxes: &[Aabb], surface: &Surface<'_>, out: &mut Candidates<'_>) -> Counts {
    let mut triangle_boxes = vec![Aabb::EMPTY; surface.triangles.len()];
    let mut owned = vec![0; surface.triangles.len()];
    write_bounds(boxes, surface, &mut triangle_boxes, &mut owned, &Serial);
    let is_finite = |b: &&Aabb| b.min.is_finite() && b.max.is_finite();
    let scene = triangle_boxes.iter().filter(is_finite).fold(Aabb::EMPTY, |scene, b| scene.union(b));
    let size = (scene.max - scene.min) / ACROSS;
    let cell = |corner: Vec3| -> [i32; 3] {
        let v = (corner - scene.min) / size.max(Vec3::splat(Real::MIN_POSITIVE));
        v.to_array().map(|v| v.clamp(0.0, ACROSS) as i32)
    };
    let mut entries: Vec<([i32; 3], usize)> = Vec::new();
    for (triangle, b) in triangle_boxes.iter().enumerate().filter(|(_, b)| !b.min.is_nan()) {
        let (low, high) = (cell(b.min), cell(b.max));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    entries.push(([x, y, z], triangle));
                }
            }
        }
    }
    entries.sort_unstable();
    let mut counts = Counts::default();
    for run in entries.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(here, a)) in run.iter().enumerate() {
            for &(_, b) in &run[i + 1..] {
                let (low_a, low_b) = (cell(triangle_boxes[a].min), cell(triangle_boxes[b].min));
                let reference = core::array::from_fn(|k| low_a[k].max(low_b[k]));
                let may_pair = surface.may_pair(a as u32, b as u32);
                if may_pair && here == reference && triangle_boxes[a].overlaps(&triangle_boxes[b]) {
                    let pair = [[a as u32, b as u32]];
                    add_features(boxes, surface, &triangle_boxes, &owned, None, &pair, None, out, &mut counts);
                }
            }
        }
    }
    counts
}
