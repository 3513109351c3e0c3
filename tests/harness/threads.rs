//! Threads that divide the output of every kernel unevenly and differently at every call: the bits of a
//! simulation must not depend on the division.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::rng::Rng;

/// A dispatcher with `threads` threads.
#[derive(Debug)]
pub struct Uneven {
    threads: usize,
    calls: AtomicU64,
}

impl Uneven {
    /// With one thread, a kernel runs as a whole.
    pub fn new(threads: usize) -> Self {
        Self { threads, calls: AtomicU64::new(0) }
    }

    /// Start indices of the parts after the first, in ascending order.
    fn cuts(&self, length: usize) -> Vec<usize> {
        let mut rng = Rng::new(self.calls.fetch_add(1, Ordering::Relaxed));
        let mut cuts: Vec<_> = (1..self.threads).map(|_| (rng.bits() % (length as u64 + 1)) as usize).collect();
        cuts.sort_unstable();
        cuts
    }
}

macro_rules! dispatch {
    ($muslin:ident) => {
        impl $muslin::dispatch::Dispatch for Uneven {
            fn run<S: $muslin::dispatch::Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
                let cuts = self.cuts(out.len());
                rayon::scope(|scope| {
                    let (mut rest, mut start, kernel) = (out, 0, &kernel);
                    for cut in cuts {
                        let (part, after) = rest.split_at(cut - start);
                        scope.spawn(move |_| kernel(start, part));
                        (rest, start) = (after, cut);
                    }
                    kernel(start, rest);
                });
            }
        }
    };
}

dispatch!(muslin_core);
dispatch!(muslin_core_f64);
