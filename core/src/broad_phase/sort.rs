//! Stable radix sort of the entries by cell key.

use super::entries::Entry;

/// The greatest number of key bits that one pass sorts by.
const DIGIT: u32 = 11;

/// Sorts by the lowest `bits` bits of the keys, and returns whether the result is in `spare`.
pub fn sort(entries: &mut [Entry], spare: &mut [Entry], bits: u32) -> bool {
    let passes = bits.div_ceil(DIGIT);
    let (mut from, mut to) = (entries, spare);
    for pass in 0..passes {
        let (start, end) = (bits * pass / passes, bits * (pass + 1) / passes);
        let digit = |entry: &Entry| (entry.key >> start & ((1 << (end - start)) - 1)) as usize;
        let mut next = [0u32; 1 << DIGIT];
        for entry in &*from {
            next[digit(entry)] += 1;
        }
        let mut sum = 0;
        for count in &mut next {
            (sum, *count) = (sum + *count, sum);
        }
        for entry in &*from {
            let slot = &mut next[digit(entry)];
            to[*slot as usize] = *entry;
            *slot += 1;
        }
        (from, to) = (to, from);
    }
    passes % 2 == 1
}
