//! Sorting in place [Williams 1964]. The sort of the standard library can panic, and it is long.

use crate::column::Column;

/// Sorts by keys, in ascending order. Elements with the same key may change places.
pub(crate) fn sort_by_key<T, K: Ord>(list: &mut [T], key: impl Fn(&T) -> K) {
    let is_less = |list: &[T], a: usize, b: usize| list.element(a).map(&key) < list.element(b).map(&key);
    for root in (0..list.len() / 2).rev() {
        sift_down(list, root, &is_less);
    }
    for end in (1..list.len()).rev() {
        list.exchange(0, end);
        sift_down(list.part_mut(..end), 0, &is_less);
    }
}

/// Moves an element down to where neither of its two children is greater.
fn sift_down<T>(heap: &mut [T], mut root: usize, is_less: &impl Fn(&[T], usize, usize) -> bool) {
    loop {
        let [left, right] = [2 * root + 1, 2 * root + 2];
        if left >= heap.len() {
            return;
        }
        let greater = if right < heap.len() && is_less(heap, left, right) { right } else { left };
        if !is_less(heap, root, greater) {
            return;
        }
        heap.exchange(root, greater);
        root = greater;
    }
}

#[cfg(test)]
mod tests {
    use super::sort_by_key;

    #[test]
    fn as_the_standard_library() {
        let mut state = 1u32;
        for length in 0..200 {
            let mut list = [0; 200];
            list.iter_mut().for_each(|value| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *value = state >> 24;
            });
            let mut sorted = list;
            sort_by_key(&mut list[..length], |&value| value);
            sorted[..length].sort_unstable();
            assert_eq!(list, sorted);
        }
    }
}
