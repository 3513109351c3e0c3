//! Candidates -> contacts: those that are near.

use crate::real::Real;

/// Writes the candidates nearer than `least`, m, in their order; returns how many there are. Where that
/// is above the room in `out` only the first were written.
pub fn contacts(candidates: &[[u32; 2]], distances: &[Real], least: Real, out: &mut [[u32; 2]]) -> usize {
    let mut count = 0;
    for (&candidate, _) in candidates.iter().zip(distances).filter(|&(_, &distance)| distance < least) {
        if let Some(slot) = out.get_mut(count) {
            *slot = candidate;
        }
        count += 1;
    }
    count
}
