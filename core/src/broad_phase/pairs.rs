//! Pairs of objects whose boxes overlap, each from exactly one of its common cells.
//!
//! In a cell, own homes meet everything after them, smaller homes only own phantoms. The spheres
//! of overlapping boxes overlap, so the box test stands for the sphere test that the uniqueness
//! rests on; and for the comparison of cells, since cells that wrapped onto one are far apart.

use super::cells::{Home, Lattice};
use super::control_bits::skips;
use super::entries::{Entry, IS_HOME, IS_OWN};
use crate::geometry::aabb::Aabb;
use crate::real::{Lanes, Real};

/// Entries that are compared with one another entry at once: bits of a word.
const BLOCK: usize = 64;
const WIDTH: usize = 4;

/// Boxes of a block by coordinate: the three minima, then the three maxima.
type Columns = [[Real; BLOCK]; 6];

/// Calls `add` with every pair of overlapping objects.
pub fn for_each_pair(
    entries: &[Entry],
    homes: &[Home],
    boxes: &[Aabb],
    lattice: &Lattice,
    mut add: impl FnMut(u32, u32),
) {
    let mut columns = [[0.0; BLOCK]; 6];
    for run in entries.chunk_by(|a, b| a.key == b.key) {
        let count = |flags| run.partition_point(|entry| entry.object >= flags);
        let (own_homes, all_homes) = (count(IS_HOME | IS_OWN), count(IS_HOME));
        let own_end = all_homes + run[all_homes..].partition_point(|entry| entry.object >= IS_OWN);
        let from = if own_homes > 0 { 0 } else { all_homes };
        let to = if own_homes > 0 { run.len() } else { own_end };
        if all_homes == 0 || to < 2 || from == to {
            continue;
        }
        let cell = lattice.cell_type(run[0].key);
        for start in (from..to).step_by(BLOCK) {
            let block = &run[start..(start + BLOCK).min(to)];
            gather(block, boxes, &mut columns);
            for i in 0..all_homes.min(start + block.len()) {
                let (first, last) = if i < own_homes { (i + 1, to) } else { (all_homes, own_end) };
                let (first, last) = (first.max(start), last.min(start + block.len()));
                if first >= last {
                    continue;
                }
                let a = run[i].id();
                let mut hits = overlaps(&boxes[a as usize], &columns, block.len());
                hits = hits >> (first - start) << (first - start) & (u64::MAX >> (start + BLOCK - last));
                while hits != 0 {
                    let b = block[hits.trailing_zeros() as usize].id();
                    hits &= hits - 1;
                    if !skips(homes[a as usize].control, homes[b as usize].control, cell) {
                        add(a, b);
                    }
                }
            }
        }
    }
}

fn gather(block: &[Entry], boxes: &[Aabb], columns: &mut Columns) {
    for (k, entry) in block.iter().enumerate() {
        let b = &boxes[entry.id() as usize];
        for (column, value) in columns.iter_mut().zip([b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z]) {
            column[k] = value;
        }
    }
}

/// A bit for each of the first `count` boxes that overlaps; the bits beyond mean nothing.
#[inline]
fn overlaps(b: &Aabb, columns: &Columns, count: usize) -> u64 {
    let [min, max] = [b.min, b.max].map(|v| v.to_array().map(Lanes::splat));
    let mut hits = 0;
    for at in (0..count).step_by(WIDTH) {
        let load = |k: usize| Lanes::new(core::array::from_fn(|lane| columns[k][at + lane]));
        let x = load(0).simd_le(max[0]) & min[0].simd_le(load(3));
        let y = load(1).simd_le(max[1]) & min[1].simd_le(load(4));
        let z = load(2).simd_le(max[2]) & min[2].simd_le(load(5));
        hits |= u64::from((x & y & z).to_bitmask()) << at;
    }
    hits
}
