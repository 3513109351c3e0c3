//! Conversion of counted work into the seconds of a fixed, imaginary machine, so that costs by counts are the same
//! on every computer.

use crate::engine::Counted;

/// Speed of this machine: bytes streamed per second, and seconds per candidate and per contact. It is about as fast
/// as the server on which the benchmarks were run.
const BYTES: f64 = 1e10;
const CANDIDATE: f64 = 1e-7;
const CONTACT: f64 = 3e-6;

/// Computing time of the counted work, s.
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
