//! Copy bandwidth of the machine, with which the bench compares the stages.

use std::hint::black_box;
use std::time::Instant;

/// Size of a copy, bytes: larger than the caches.
const SIZE: usize = 256 << 20;

/// Number of copies; the fastest one counts.
const REPEATS: usize = 7;

/// Bytes read plus bytes written per second, one thread.
pub fn bandwidth() -> f64 {
    let from = vec![1_u64; SIZE / 8];
    let mut to = vec![0_u64; SIZE / 8];
    let copy = |_| {
        let started = Instant::now();
        to.copy_from_slice(black_box(&from));
        black_box(&mut to);
        started.elapsed().as_secs_f64()
    };
    let fastest = (0..REPEATS).map(copy).fold(f64::INFINITY, f64::min);
    2.0 * SIZE as f64 / fastest
}
