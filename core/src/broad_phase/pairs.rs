//! Finds the pairs of objects whose boxes may overlap. A pair whose boxes do overlap is found exactly once, in one
//! of the common cells. A few other pairs are found too, some of them more than once, but they yield no candidates.
//!
//! In each cell, the home entries of the level's own objects are compared with all entries after them, and the home
//! entries of smaller objects only with the phantom entries of own objects. Spheres of overlapping boxes overlap,
//! so the box test can replace the sphere test in the proof that each pair is tested once. It also replaces a
//! comparison of the unwrapped cells, because cells that wrap to the same key are far apart.

use wide::i8x16;

use super::byte_boxes::{ByteBoxes, may_overlap};
use super::cells::{CellGrid, Home};
use super::control_bits::skips;
use super::entries::{Entry, IS_HOME, IS_OWN};
use super::{Surface, runs};
use crate::column::Column;

/// Number of entries that are compared with one other entry at once: the bits of a word.
const BLOCK: usize = 64;
const WIDTH: usize = 16;

/// Pairs are passed to `add` once at least this many have been found.
const BATCH: usize = 256;

/// The boxes of a block of entries, by coordinate, sixteen at a time.
type Columns = [[[i8; WIDTH]; 6]; BLOCK / WIDTH];

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
    for (key, run) in runs(entries, |entry| entry.key) {
        let count = |flags| run.partition_point(|entry| entry.object >= flags);
        let (own_homes, all_homes) = (count(IS_HOME | IS_OWN), count(IS_HOME));
        let own_end = all_homes + run.part(all_homes..).partition_point(|entry| entry.object >= IS_OWN);
        let (from, to) = if own_homes > 0 { (0, run.len()) } else { (all_homes, own_end) };
        if all_homes == 0 || to < 2 {
            continue;
        }
        let cell = grid.cell_type(key);
        for start in (from..to).step_by(BLOCK) {
            let block = run.part(start..(start + BLOCK).min(to));
            gather(block, byte_boxes, &mut columns);
            for (i, entry) in run.iter().enumerate().take(all_homes.min(start + block.len())) {
                let (first, last) = if i < own_homes { (i + 1, to) } else { (all_homes, own_end) };
                let (first, last) = (first.max(start), last.min(start + block.len()));
                if first >= last {
                    continue;
                }
                let a = entry.id();
                let control = homes.at(a as usize).control;
                let Some(own) = byte_boxes.element(a as usize) else { continue };
                let mut hits = overlaps(own, &columns, block.len());
                hits = hits >> (first - start) << (first - start) & (u64::MAX >> (start + BLOCK - last));
                while hits != 0 {
                    let b = block.at(hits.trailing_zeros() as usize).id();
                    hits &= hits - 1;
                    let is_here = !skips(control, homes.at(b as usize).control, cell);
                    batch.set(filled, [a, b]);
                    filled += usize::from(is_here & surface.may_pair(a, b));
                }
                if filled >= BATCH {
                    if !add(batch.part(..filled)) {
                        return false;
                    }
                    filled = 0;
                }
            }
        }
    }
    add(batch.part(..filled))
}

fn gather(block: &[Entry], byte_boxes: &[ByteBoxes], columns: &mut Columns) {
    for (columns, entries) in columns.iter_mut().zip(block.chunks(WIDTH)) {
        for (i, entry) in entries.iter().enumerate() {
            let Some(b) = byte_boxes.element(entry.id() as usize) else { continue };
            for (k, column) in columns.iter_mut().enumerate() {
                column.set(i, b.whole(k));
            }
        }
    }
}

/// Returns one bit for each of the first `count` boxes, set if it may overlap `b`. The bits beyond are meaningless.
#[inline(always)]
fn overlaps(b: &ByteBoxes, columns: &Columns, count: usize) -> u64 {
    let one = core::array::from_fn(|k| i8x16::splat(b.whole(k)));
    let mut hits = 0;
    for (group, columns) in columns.iter().enumerate().take(count.div_ceil(WIDTH)) {
        let lanes = core::array::from_fn(|k| i8x16::new(columns.at(k)));
        hits |= u64::from(may_overlap(&one, &lanes)) << (WIDTH * group);
    }
    hits
}
