//! Stable radix sort of the entries by cell key.

use super::entries::Entry;
use crate::column::Column;

/// The greatest number of key bits that one pass sorts by. Its counts lie on the stack: 8 kB, or 1 kB for programs without a
/// heap, whose stacks are small.
const DIGIT: u32 = if cfg!(feature = "alloc") { 11 } else { 8 };

/// Sorts by the lowest `bits` bits of the keys, and returns whether the result is in `spare`.
pub fn sort(entries: &mut [Entry], spare: &mut [Entry], bits: u32) -> bool {
    let passes = bits.div_ceil(DIGIT);
    let (mut from, mut to) = (entries, spare);
    for pass in 0..passes {
        let bound = |pass: u32| (bits * pass).checked_div(passes).unwrap_or(0);
        let (start, end) = (bound(pass), bound(pass + 1));
        let mask = (1 << (end - start)) - 1;
        let digit = |entry: &Entry| (entry.key >> start & mask) as usize;
        let mut next = [0u32; 1 << DIGIT];
        for entry in &*from {
            next.add(digit(entry), 1);
        }
        let mut sum = 0;
        for count in &mut next {
            (sum, *count) = (sum + *count, sum);
        }
        for entry in &*from {
            let Some(slot) = next.element_mut(digit(entry)) else { continue };
            to.set(*slot as usize, *entry);
            *slot += 1;
        }
        (from, to) = (to, from);
    }
    passes % 2 == 1
}
