//! Finds the pairs of objects whose boxes may overlap. A pair whose boxes do overlap is found exactly once, in one
//! of the common cells. A few other pairs are found too, some of them more than once, but they yield no candidates.
//!
//! In each cell, the home entries of the level's own objects are compared with all entries after them, and the home
//! entries of smaller objects only with the phantom entries of own objects. Spheres of overlapping boxes overlap,
//! so the box test can replace the sphere test in the proof that each pair is tested once. It also replaces a
//! comparison of the unwrapped cells, because cells that wrap to the same key are far apart.

use wide::i8x16;

use super::Surface;
use super::byte_boxes::{ByteBoxes, may_overlap};
use super::cells::{CellGrid, Home};
use super::control_bits::skips;
use super::entries::{Entry, IS_HOME, IS_OWN};

/// Number of entries that are compared with one other entry at once: the bits of a word.
const BLOCK: usize = 64;
const WIDTH: usize = 16;

/// Pairs are passed to `add` once at least this many have been found.
const BATCH: usize = 256;

/// The boxes of a block of entries, by coordinate.
type Columns = [[[i8; WIDTH]; BLOCK / WIDTH]; 6];

/// Calls `add` with all pairs that may touch, many pairs per call. Returns false at once if it does.
pub fn for_each_pair(
    entries: &[Entry],
    homes: &[Home],
    byte_boxes: &[ByteBoxes],
    grid: &CellGrid,
    surface: &Surface<'_>,
    mut add: impl FnMut(&[[u32; 2]]) -> bool,
) -> bool {
    let mut columns: Columns = Default::default();
    let (mut batch, mut filled) = ([[0; 2]; BATCH + BLOCK], 0);
    for run in entries.chunk_by(|a, b| a.key == b.key) {
        let count = |flags| run.partition_point(|entry| entry.object >= flags);
        let (own_homes, all_homes) = (count(IS_HOME | IS_OWN), count(IS_HOME));
        let own_end = all_homes + run[all_homes..].partition_point(|entry| entry.object >= IS_OWN);
        let (from, to) = if own_homes > 0 { (0, run.len()) } else { (all_homes, own_end) };
        if all_homes == 0 || to < 2 {
            continue;
        }
        let cell = grid.cell_type(run[0].key);
        for start in (from..to).step_by(BLOCK) {
            let block = &run[start..(start + BLOCK).min(to)];
            gather(block, byte_boxes, &mut columns);
            for i in 0..all_homes.min(start + block.len()) {
                let (first, last) = if i < own_homes { (i + 1, to) } else { (all_homes, own_end) };
                let (first, last) = (first.max(start), last.min(start + block.len()));
                if first >= last {
                    continue;
                }
                let a = run[i].id();
                let control = homes[a as usize].control;
                let mut hits = overlaps(&byte_boxes[a as usize], &columns, block.len());
                hits = hits >> (first - start) << (first - start) & (u64::MAX >> (start + BLOCK - last));
                while hits != 0 {
                    let b = block[hits.trailing_zeros() as usize].id();
                    hits &= hits - 1;
                    let is_here = !skips(control, homes[b as usize].control, cell);
                    batch[filled] = [a, b];
                    filled += usize::from(is_here & surface.may_pair(a, b));
                }
                if filled >= BATCH {
                    if !add(&batch[..filled]) {
                        return false;
                    }
                    filled = 0;
                }
            }
        }
    }
    add(&batch[..filled])
}

fn gather(block: &[Entry], byte_boxes: &[ByteBoxes], columns: &mut Columns) {
    for (i, entry) in block.iter().enumerate() {
        let b = &byte_boxes[entry.id() as usize];
        for k in 0..6 {
            columns[k].as_flattened_mut()[i] = b.whole(k);
        }
    }
}

/// Returns one bit for each of the first `count` boxes, set if it may overlap `b`. The bits beyond are meaningless.
#[inline(always)]
fn overlaps(b: &ByteBoxes, columns: &Columns, count: usize) -> u64 {
    let one = core::array::from_fn(|k| i8x16::splat(b.whole(k)));
    let mut hits = 0;
    for group in 0..count.div_ceil(WIDTH) {
        let lanes = core::array::from_fn(|k| i8x16::new(columns[k][group]));
        hits |= u64::from(may_overlap(&one, &lanes)) << (WIDTH * group);
    }
    hits
}
