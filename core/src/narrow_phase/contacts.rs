//! Selects the contacts: the candidates whose features are near each other.

use crate::real::Real;

/// Writes the candidates nearer than `least`, m, in their order, and returns their number. If the number exceeds
/// the length of `out`, only the first ones were written.
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
