//! Distribution of kernels over threads: the core splits work into disjoint parts, the host owns the
//! threads.
//!
//! A kernel writes only the columns that it gets as `out`. The value of each slot does not depend on
//! where the columns are split, so the bits do not depend on the number of threads.

use core::future::{Future, ready};
use core::pin::pin;
use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;
use core::task::{Context, Poll, Waker};

use crate::broad_phase::Counts;
use crate::column::Column;
use crate::contact::{ContactModel, ContactScratch};
use crate::stage::Stage;

/// Output that can be split into disjoint parts.
pub trait Split: Sized + Send {
    /// Number of slots.
    fn len(&self) -> usize;
    /// Splits into the slots before `mid` and the slots from `mid` on.
    fn split_at(self, mid: usize) -> (Self, Self);
    /// Whether there are no slots.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<T: Send> Split for &mut [T] {
    fn len(&self) -> usize {
        <[T]>::len(self)
    }
    fn split_at(self, mid: usize) -> (Self, Self) {
        self.cut_mut(mid)
    }
}

impl<A: Split, B: Split> Split for (A, B) {
    fn len(&self) -> usize {
        debug_assert_eq!(self.0.len(), self.1.len());
        self.0.len()
    }
    fn split_at(self, mid: usize) -> (Self, Self) {
        let (a, b) = (self.0.split_at(mid), self.1.split_at(mid));
        ((a.0, b.0), (a.1, b.1))
    }
}

impl<A: Split, B: Split, C: Split> Split for (A, B, C) {
    fn len(&self) -> usize {
        self.0.len()
    }
    fn split_at(self, mid: usize) -> (Self, Self) {
        let (a, b, c) = (self.0.split_at(mid), self.1.split_at(mid), self.2.split_at(mid));
        ((a.0, b.0, c.0), (a.1, b.1, c.1))
    }
}

/// Runs kernels over disjoint parts of their output.
pub trait Dispatch: Sync {
    /// Calls `kernel(start, part)` for parts that together cover every slot of `out` exactly once.
    /// `start` is the index of the part's first slot in `out`.
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K);

    /// Finds the candidates of [`ContactScratch::boxes`] as [`detection::detect`](crate::detection::detect) does, but
    /// elsewhere, for example on a GPU that answers later. The caller drops those that stay apart, and measures the
    /// others. `None`: the caller must call [`detection::detect`](crate::detection::detect).
    #[inline]
    fn detect(&self, _: &ContactModel<'_>, _: &mut ContactScratch<'_>) -> impl Future<Output = Option<Counts>> {
        ready(None)
    }

    /// Announces the stage that the following kernels belong to.
    #[inline]
    fn enter(&self, _: Stage) {}

    /// Counts iterations of a linear solve, rounds of the response after the first, and candidates when the step begins to
    /// work on them.
    #[inline]
    fn spend(&self, _iterations: u32, _candidates: u32) {}

    /// Whether to give up the step. Called where a step can take long, and before the state changes. Once it is true, it must
    /// stay so until the step returns.
    #[inline]
    fn stopped(&self) -> bool {
        false
    }
}

/// A dispatch that gives up a step once it has spent more than a budget. The work of a step does not depend on the machine,
/// so the same steps are given up everywhere.
#[derive(Debug)]
pub struct Limited<'a, D> {
    inner: &'a D,
    budget: [u32; 2],
    spent: [AtomicU32; 2],
}

impl<'a, D> Limited<'a, D> {
    /// A budget of [iterations and of candidates](Dispatch::spend), for one step.
    pub fn new(inner: &'a D, iterations: u32, candidates: u32) -> Self {
        Self { inner, budget: [iterations, candidates], spent: Default::default() }
    }

    /// The iterations and the candidates spent.
    pub fn spent(&self) -> [u32; 2] {
        self.spent.each_ref().map(|count| count.load(Relaxed))
    }
}

impl<D: Dispatch> Dispatch for Limited<'_, D> {
    #[inline]
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        self.inner.run(out, kernel);
    }

    #[inline]
    fn detect(
        &self,
        model: &ContactModel<'_>,
        contact: &mut ContactScratch<'_>,
    ) -> impl Future<Output = Option<Counts>> {
        self.inner.detect(model, contact)
    }

    #[inline]
    fn enter(&self, stage: Stage) {
        self.inner.enter(stage);
    }

    fn spend(&self, iterations: u32, candidates: u32) {
        for (spent, more) in self.spent.iter().zip([iterations, candidates]) {
            // One step spends by one thread; it must not wrap.
            spent.store(spent.load(Relaxed).saturating_add(more), Relaxed);
        }
        self.inner.spend(iterations, candidates);
    }

    fn stopped(&self) -> bool {
        self.spent().iter().zip(&self.budget).any(|(spent, most)| spent > most) || self.inner.stopped()
    }
}

/// Waits for a future by polling it in a loop. For futures that are ready soon, and whose work does not need this thread.
pub fn block_on<F: Future>(future: F) -> F::Output {
    let (mut future, mut context) = (pin!(future), Context::from_waker(Waker::noop()));
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
            return output;
        }
        core::hint::spin_loop();
    }
}

/// Runs each kernel on the calling thread, over its whole output in one call.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Dispatch for Serial {
    #[inline]
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        kernel(0, out);
    }
}
