//! Which boxes of many overlap a box: a tree, built without any of the stages of detection.
//!
//! A node is a run of the boxes, ordered so that its children are the halves of the run: it is cut at
//! the median of the centres along the axis on which it is widest. n boxes are ordered in about n log n;
//! a box that overlaps few is found them in log n, however the boxes are spread and whatever their sizes.

use crate::geometry::aabb::Aabb;

/// Most boxes of a node without children.
const LEAF: usize = 4;

/// A feature's number and its box.
pub type Boxed = (u32, Aabb);

/// A tree over boxes.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    boxes: &'a [Boxed],
    /// Around the boxes of each node. The root is 1, the children of k are 2 k and 2 k + 1.
    bounds: &'a [Aabb],
}

/// How many bounds a tree over so many boxes has.
pub const fn nodes(boxes: usize) -> usize {
    2 * boxes.div_ceil(LEAF).next_power_of_two()
}

impl<'a> Tree<'a> {
    /// A tree over some boxes, which it orders; `bounds` has room for all [`nodes`].
    pub fn build(boxes: &'a mut [Boxed], bounds: &'a mut [Aabb]) -> Self {
        let bounds = &mut bounds[..nodes(boxes.len())];
        order(boxes, 1, bounds);
        Self { boxes, bounds }
    }

    /// The numbers, those of near boxes near one another.
    pub fn numbers(&self) -> impl Iterator<Item = u32> + use<'a> {
        self.boxes.iter().map(|&(number, _)| number)
    }

    /// Calls `found` with every box that overlaps one, in no particular order; returns how many boxes were
    /// compared with it.
    pub fn overlapping(&self, one: &Aabb, found: &mut impl FnMut(&Boxed)) -> usize {
        self.visit(1, self.boxes, one, found)
    }

    fn visit(&self, node: usize, boxes: &[Boxed], one: &Aabb, found: &mut impl FnMut(&Boxed)) -> usize {
        if !self.bounds[node].overlaps(one) {
            return 1;
        }
        if 2 * node >= self.bounds.len() {
            boxes.iter().filter(|(_, other)| other.overlaps(one)).for_each(found);
            return 1 + boxes.len();
        }
        let (low, high) = boxes.split_at(boxes.len() / 2);
        1 + self.visit(2 * node, low, one, found) + self.visit(2 * node + 1, high, one, found)
    }
}

/// Orders the boxes of a node and of those below it, and bounds them.
fn order(boxes: &mut [Boxed], node: usize, bounds: &mut [Aabb]) {
    let all = boxes.iter().fold(Aabb::EMPTY, |all, (_, one)| all.union(one));
    bounds[node] = all;
    let middle = boxes.len() / 2;
    if 2 * node < bounds.len() {
        let axis = (all.max - all.min).max_position();
        split(boxes, middle, axis);
        let (low, high) = boxes.split_at_mut(middle);
        order(low, 2 * node, bounds);
        order(high, 2 * node + 1, bounds);
    }
}

/// Puts those boxes before `middle` whose centres are the least along an axis [Hoare 1961]. Shorter than the standard
/// library's, which browsers would have to load.
fn split(boxes: &mut [Boxed], middle: usize, axis: usize) {
    let centre = |(_, one): &Boxed| 0.5 * one.min[axis] + 0.5 * one.max[axis];
    let (mut first, mut end) = (0, boxes.len());
    while end > first + 1 {
        let pivot = centre(&boxes[middle]);
        let (mut low, mut high) = (first, end);
        while low < high {
            if centre(&boxes[low]) < pivot {
                low += 1;
            } else if centre(&boxes[high - 1]) > pivot {
                high -= 1;
            } else {
                boxes.swap(low, high - 1);
                (low, high) = (low + 1, high - 1);
            }
        }
        // Centres before `high` are not above the pivot, those from `low` on not below it.
        if middle < high {
            end = high;
        } else if middle >= low {
            first = low;
        } else {
            return;
        }
    }
}
