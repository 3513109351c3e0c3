//! Threads: implements the core's `Dispatch` with rayon. Work is halved down to a smallest part, so small
//! scenes stay on one thread. The results are bitwise independent of the splits.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::device::StepDetector;

/// Smallest number of slots that is worth moving to another thread.
const GRAIN: usize = 2048;

/// Runs kernels on the threads of a pool; valid inside [`Pool::install`].
pub struct Pool {
    pool: ThreadPool,
    detector: Option<StepDetector>,
}

impl Pool {
    /// A pool of `threads` threads; `None` means one per core.
    pub fn new(threads: Option<usize>) -> Result<Self, ThreadPoolBuildError> {
        let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?;
        Ok(Self { pool, detector: None })
    }

    /// The same pool, which finds candidates on a device in single precision.
    pub fn with_detector(self, detector: StepDetector) -> Self {
        Self { detector: Some(detector), ..self }
    }

    /// The device that finds candidates; `None` if the threads do.
    pub fn detector(&self) -> Option<&StepDetector> {
        self.detector.as_ref()
    }

    /// Threads in the pool.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Runs `work` inside the pool, where dispatch is cheapest.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.pool.install(work)
    }
}

macro_rules! dispatch_by_rayon {
    ($halve:ident, $dispatch:path, $split:path) => {
        impl $dispatch for Pool {
            fn run<S: $split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
                if self.threads() == 1 {
                    kernel(0, out);
                } else {
                    let grain = GRAIN.max(out.len() / (4 * self.threads()));
                    $halve(0, out, grain, &kernel);
                }
            }
        }

        fn $halve<S: $split, K: Fn(usize, S) + Sync>(start: usize, out: S, grain: usize, kernel: &K) {
            if out.len() <= grain {
                return kernel(start, out);
            }
            let middle = out.len() / 2;
            let (low, high) = out.split_at(middle);
            rayon::join(|| $halve(start, low, grain, kernel), || $halve(start + middle, high, grain, kernel));
        }
    };
}

dispatch_by_rayon!(halve_f32, muslin_core::dispatch::Dispatch, muslin_core::dispatch::Split);
dispatch_by_rayon!(halve_f64, muslin_core_f64::dispatch::Dispatch, muslin_core_f64::dispatch::Split);
