//! What runs cost: by the clock, or by what is counted, in seconds of a machine that nobody has and that is the
//! same everywhere.

use crate::engine::Counted;

/// What that machine streams, B/s, and its time for a candidate and for a contact, s: about those of the server
/// on which the bench was taken.
const BYTES: f64 = 1e10;
const CANDIDATE: f64 = 1e-7;
const CONTACT: f64 = 3e-6;

/// The time that it takes for what was counted, s.
pub fn seconds(counted: Counted) -> f64 {
    let Counted { streamed_bytes, candidates, contacts } = counted;
    streamed_bytes as f64 / BYTES + candidates as f64 * CANDIDATE + contacts as f64 * CONTACT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_is_counted_costs() {
        let counted = Counted { streamed_bytes: 10_000_000_000, candidates: 10_000_000, contacts: 1_000_000 };
        assert!((seconds(counted) - 5.0).abs() < 1e-9);
        assert_eq!(seconds(Counted::default()), 0.0);
    }
}
