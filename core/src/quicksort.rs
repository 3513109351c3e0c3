//! Sorting in place: quicksort [Hoare 1962], and heap sort [Williams 1964] where it divides badly [Musser 1997]. The
//! sort of the standard library can panic, and it is long.

use crate::column::Column;

/// Lists up to this length are sorted by insertion.
const SHORT: usize = 16;

/// Sorts by keys, in ascending order. Elements with the same key may change places.
pub(crate) fn sort_by_key<T, K: Copy + Ord>(list: &mut [T], key: impl Fn(&T) -> K) {
    // Twice the depth of even halves.
    let depth = 2 * (usize::BITS - list.len().leading_zeros());
    sort(list, depth, &key);
}

fn sort<T, K: Copy + Ord>(mut list: &mut [T], mut depth: u32, key: &impl Fn(&T) -> K) {
    while list.len() > SHORT && depth > 0 {
        depth -= 1;
        let middle = divide(list, key);
        let (low, high) = list.cut_mut(middle);
        // The stack is as deep as the logarithm of the length.
        let (short, long) = if low.len() < high.len() { (low, high) } else { (high, low) };
        sort(short, depth, key);
        list = long;
    }
    if list.len() > SHORT {
        sort_heap(list, key);
    } else {
        insert_each(list, key);
    }
}

/// Moves the elements below a pivot to the front. Returns where the others begin: both parts have elements.
fn divide<T, K: Copy + Ord>(list: &mut [T], key: &impl Fn(&T) -> K) -> usize {
    let last = list.len() - 1;
    let [first, middle, end] = [0, last / 2, last].map(|k| list.element(k).map(key));
    let pivot = first.min(middle).max(first.max(middle).min(end));
    let is_below = |list: &[T], k: usize| list.get(k).is_some_and(|element| Some(key(element)) < pivot);
    let is_above = |list: &[T], k: usize| list.get(k).is_some_and(|element| pivot < Some(key(element)));
    let (mut low, mut high) = (0, last);
    loop {
        while is_below(list, low) {
            low += 1;
        }
        while is_above(list, high) {
            high -= 1;
        }
        if low >= high {
            return high + 1;
        }
        list.exchange(low, high);
        low += 1;
        high -= 1;
    }
}

fn insert_each<T, K: Copy + Ord>(list: &mut [T], key: &impl Fn(&T) -> K) {
    for end in 1..list.len() {
        let mut at = end;
        while at > 0 && is_less(list, at, at - 1, key) {
            list.exchange(at, at - 1);
            at -= 1;
        }
    }
}

fn sort_heap<T, K: Copy + Ord>(list: &mut [T], key: &impl Fn(&T) -> K) {
    for root in (0..list.len() / 2).rev() {
        sift_down(list, root, key);
    }
    for end in (1..list.len()).rev() {
        list.exchange(0, end);
        sift_down(list.part_mut(..end), 0, key);
    }
}

/// Moves an element down to where neither of its two children is greater.
fn sift_down<T, K: Copy + Ord>(heap: &mut [T], mut root: usize, key: &impl Fn(&T) -> K) {
    loop {
        let [left, right] = [2 * root + 1, 2 * root + 2];
        if left >= heap.len() {
            return;
        }
        let greater = if right < heap.len() && is_less(heap, left, right, key) { right } else { left };
        if !is_less(heap, root, greater, key) {
            return;
        }
        heap.exchange(root, greater);
        root = greater;
    }
}

#[inline(always)]
fn is_less<T, K: Copy + Ord>(list: &[T], a: usize, b: usize, key: &impl Fn(&T) -> K) -> bool {
    list.element(a).map(key) < list.element(b).map(key)
}

#[cfg(test)]
mod tests {
    use super::sort;

    #[test]
    fn as_the_standard_library() {
        let mut state = 1u32;
        for length in 0..200 {
            let mut list = [0; 200];
            list.iter_mut().for_each(|value| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *value = state >> 24;
            });
            // At depth 0 long lists are sorted as heaps.
            for depth in [0, 2, 16] {
                let (mut own, mut sorted) = (list, list);
                sort(&mut own[..length], depth, &|&value| value);
                sorted[..length].sort_unstable();
                assert_eq!(own, sorted, "depth {depth}");
                // A list that is sorted, and one that is sorted backwards.
                sort(&mut own[..length], depth, &|&value| value);
                assert_eq!(own, sorted, "depth {depth}, sorted");
                own[..length].reverse();
                sort(&mut own[..length], depth, &|&value| value);
                assert_eq!(own, sorted, "depth {depth}, backwards");
            }
        }
    }
}
