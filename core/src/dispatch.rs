//! How a kernel meets threads: the core describes disjoint work, the host owns the threads.
//!
//! A kernel writes only the columns that it is handed as `out`. Because each slot's value does
//! not depend on where the columns were split, the bits do not depend on the thread count.

use core::future::{Future, ready};
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use crate::broad_phase::Counts;
use crate::contact::{ContactModel, ContactScratch};
use crate::stage::Stage;

/// Output that can be handed out in disjoint parts.
pub trait Split: Sized + Send {
    /// Number of slots.
    fn len(&self) -> usize;
    /// Parts before and from slot `mid`.
    fn split_at(self, mid: usize) -> (Self, Self);
    /// Whether there is nothing to write.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<T: Send> Split for &mut [T] {
    fn len(&self) -> usize {
        <[T]>::len(self)
    }
    fn split_at(self, mid: usize) -> (Self, Self) {
        self.split_at_mut(mid)
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
    /// Calls `kernel(start, part)` until every slot of `out` has been handed out once, where
    /// `start` is the index of the part's first slot in `out`.
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K);

    /// Where a host has another place for it, a device say, which answers later: finds candidates and their
    /// distances, as [`step::detect`](crate::step::detect) does.
    #[inline]
    fn detect(&self, _: &ContactModel<'_>, _: &mut ContactScratch<'_>) -> impl Future<Output = Option<Counts>> {
        ready(None)
    }

    /// Told which stage the following kernels belong to.
    #[inline]
    fn enter(&self, _: Stage) {}

    /// Whether the step is to be given up. Asked where a step can become long.
    #[inline]
    fn stopped(&self) -> bool {
        false
    }
}

/// Another's threads, with candidates found on them whatever other place it has.
#[derive(Clone, Copy, Debug)]
pub struct Here<'a, D>(pub &'a D);

impl<D: Dispatch> Dispatch for Here<'_, D> {
    #[inline]
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        self.0.run(out, kernel);
    }

    #[inline]
    fn enter(&self, stage: Stage) {
        self.0.enter(stage);
    }

    #[inline]
    fn stopped(&self) -> bool {
        self.0.stopped()
    }
}

/// Waits for a future that is soon there; what needs no other place is so at once.
pub fn block_on<F: Future>(future: F) -> F::Output {
    let (mut future, mut context) = (pin!(future), Context::from_waker(Waker::noop()));
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
            return output;
        }
        core::hint::spin_loop();
    }
}

/// One thread: the whole output in one call.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Dispatch for Serial {
    #[inline]
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        kernel(0, out);
    }
}
