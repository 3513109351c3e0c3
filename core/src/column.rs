//! Access to columns that cannot panic: a panic would end the engine that embeds Muslin.
//!
//! All indices are in range: scenes and cooked scenes are checked when they are opened. An index that is not is a defect
//! of Muslin, a *fault*. In a build with debug assertions, as in all tests, it panics. In other builds a read gives the
//! default, a write is dropped, and the fault is counted. [`step::take`](crate::step::take) gives up a step in which
//! faults were counted, and the state does not change. The module of the page stops at a fault, as at a panic.

use core::ops::AddAssign;
use core::slice::SliceIndex;
use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

static FAULTS: AtomicU32 = AtomicU32::new(0);

/// The number of faults since the program began, of all threads. It wraps.
pub(crate) fn faults() -> u32 {
    FAULTS.load(Relaxed)
}

/// Counts a fault. Not one atomic operation, which some processors lack: if two threads count at once, one of the two may
/// be lost, but the number still changes.
#[cfg(not(all(small, target_arch = "wasm32")))]
#[cold]
#[inline(never)]
#[cfg_attr(debug_assertions, track_caller)]
pub(crate) fn fault() {
    debug_assert!(false, "an index is out of range");
    FAULTS.store(faults().wrapping_add(1), Relaxed);
}

/// Stops the module of the page, which is smaller so.
#[cfg(all(small, target_arch = "wasm32"))]
#[inline(always)]
pub(crate) fn fault() {
    core::arch::wasm32::unreachable()
}

/// Access to the elements of a column, or of an array, by indices that are computed.
pub(crate) trait Column<T> {
    /// The element.
    fn at(&self, index: usize) -> T
    where
        T: Copy + Default;

    /// The elements with these indices.
    fn gather<const K: usize>(&self, indices: &[u32; K]) -> [T; K]
    where
        T: Copy + Default;

    /// The element by reference, where it is large or not `Copy`.
    fn element(&self, index: usize) -> Option<&T>;

    /// The element to be changed.
    fn element_mut(&mut self, index: usize) -> Option<&mut T>;

    /// Writes the element.
    fn set(&mut self, index: usize, value: T);

    /// Adds to the element.
    fn add<V>(&mut self, index: usize, value: V)
    where
        T: AddAssign<V>;

    /// Exchanges two elements.
    fn exchange(&mut self, a: usize, b: usize);

    /// The elements of a range.
    fn part<R: SliceIndex<[T], Output = [T]>>(&self, range: R) -> &[T];

    /// The elements of a range, to be changed.
    fn part_mut<R: SliceIndex<[T], Output = [T]>>(&mut self, range: R) -> &mut [T];

    /// The elements before an index and from there on.
    fn cut(&self, index: usize) -> (&[T], &[T]);

    /// The elements before an index and from there on, to be changed.
    fn cut_mut(&mut self, index: usize) -> (&mut [T], &mut [T]);

    /// Copies all elements of a column of the same length.
    fn copy_from(&mut self, other: &[T])
    where
        T: Copy;
}

impl<T> Column<T> for [T] {
    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn at(&self, index: usize) -> T
    where
        T: Copy + Default,
    {
        match self.get(index) {
            Some(element) => *element,
            None => {
                fault();
                T::default()
            }
        }
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn gather<const K: usize>(&self, indices: &[u32; K]) -> [T; K]
    where
        T: Copy + Default,
    {
        // The compiler keeps these in registers, but not the result of `map`.
        let mut elements = [T::default(); K];
        for (element, &index) in elements.iter_mut().zip(indices) {
            *element = self.at(index as usize);
        }
        elements
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn element(&self, index: usize) -> Option<&T> {
        let element = self.get(index);
        if element.is_none() {
            fault();
        }
        element
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn element_mut(&mut self, index: usize) -> Option<&mut T> {
        let element = self.get_mut(index);
        if element.is_none() {
            fault();
        }
        element
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn set(&mut self, index: usize, value: T) {
        match self.get_mut(index) {
            Some(element) => *element = value,
            None => fault(),
        }
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn add<V>(&mut self, index: usize, value: V)
    where
        T: AddAssign<V>,
    {
        match self.get_mut(index) {
            Some(element) => *element += value,
            None => fault(),
        }
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn exchange(&mut self, a: usize, b: usize) {
        match self.get_disjoint_mut([a, b]) {
            Ok([a, b]) => core::mem::swap(a, b),
            Err(_) if a == b => {}
            Err(_) => fault(),
        }
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn part<R: SliceIndex<[T], Output = [T]>>(&self, range: R) -> &[T] {
        match self.get(range) {
            Some(part) => part,
            None => {
                fault();
                &[]
            }
        }
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn part_mut<R: SliceIndex<[T], Output = [T]>>(&mut self, range: R) -> &mut [T] {
        match self.get_mut(range) {
            Some(part) => part,
            None => {
                fault();
                &mut []
            }
        }
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn cut(&self, index: usize) -> (&[T], &[T]) {
        match self.split_at_checked(index) {
            Some(parts) => parts,
            None => {
                fault();
                (&[], &[])
            }
        }
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn cut_mut(&mut self, index: usize) -> (&mut [T], &mut [T]) {
        match self.split_at_mut_checked(index) {
            Some(parts) => parts,
            None => {
                fault();
                (&mut [], &mut [])
            }
        }
    }

    #[inline(always)]
    #[cfg_attr(debug_assertions, track_caller)]
    fn copy_from(&mut self, other: &[T])
    where
        T: Copy,
    {
        if self.len() == other.len() {
            self.copy_from_slice(other);
        } else {
            fault();
        }
    }
}
