//! A tree of boxes that finds all boxes overlapping a given box. It uses no stage of collision detection.
//!
//! Each node covers a range of the boxes, which are ordered so that the children of the node are the two halves of
//! the range. The range is cut at the median of the centres, along the axis on which the node is widest. Ordering n
//! boxes takes about n log n steps. A query that finds few boxes takes about log n steps, for all distributions and
//! sizes of the boxes.

use crate::column::Column;
use crate::geometry::aabb::Aabb;
use crate::real::{Real, Vec3};

/// The greatest number of boxes of a node without children.
const LEAF: usize = 4;

/// The index of a feature, and its box.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Boxed {
    /// The index, and as many words as make it as wide as a scalar: the struct has no padding.
    number: [u32; size_of::<Real>() / size_of::<u32>()],
    /// The box.
    pub around: Aabb,
}

impl Boxed {
    /// A box of a feature.
    pub fn new(number: u32, around: Aabb) -> Self {
        let mut words = [0; _];
        words[0] = number;
        Self { number: words, around }
    }

    /// The index.
    pub fn number(&self) -> u32 {
        self.number[0]
    }
}

/// A tree over boxes.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    boxes: &'a [Boxed],
    /// Box around the boxes of each node. The root is node 1, and the children of node k are 2 k and 2 k + 1.
    bounds: &'a [Aabb],
}

/// Number of bounds that a tree over `boxes` boxes needs.
pub const fn nodes(boxes: usize) -> usize {
    2 * boxes.div_ceil(LEAF).next_power_of_two()
}

impl<'a> Tree<'a> {
    /// Builds a tree over boxes, which are reordered. `bounds` must have at least [`nodes`] slots.
    pub fn build(boxes: &'a mut [Boxed], bounds: &'a mut [Aabb]) -> Self {
        let bounds = bounds.part_mut(..nodes(boxes.len()));
        order(boxes, 1, bounds);
        Self { boxes, bounds }
    }

    /// The indices of the features, in the order of the tree: boxes that are near each other are mostly close in
    /// this order.
    pub fn numbers(&self) -> impl Iterator<Item = u32> + use<'a> {
        self.boxes.iter().map(Boxed::number)
    }

    /// Calls `found` with every box that overlaps `one`, in no particular order. Returns the number of boxes that
    /// were compared with `one`.
    pub fn overlapping(&self, one: &Aabb, found: &mut impl FnMut(&Boxed)) -> usize {
        self.visit(1, self.boxes, one, found)
    }

    fn visit(&self, node: usize, boxes: &[Boxed], one: &Aabb, found: &mut impl FnMut(&Boxed)) -> usize {
        if !self.bounds.element(node).is_some_and(|bounds| bounds.overlaps(one)) {
            return 1;
        }
        if 2 * node >= self.bounds.len() {
            boxes.iter().filter(|other| other.around.overlaps(one)).for_each(found);
            return 1 + boxes.len();
        }
        let (low, high) = boxes.cut(boxes.len() / 2);
        1 + self.visit(2 * node, low, one, found) + self.visit(2 * node + 1, high, one, found)
    }
}

/// Orders the boxes of a node and of its descendants, and writes their bounds.
fn order(boxes: &mut [Boxed], node: usize, bounds: &mut [Aabb]) {
    let all = boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(&one.around));
    bounds.set(node, all);
    let middle = boxes.len() / 2;
    if 2 * node < bounds.len() {
        let axis = (all.max - all.min).max_position();
        split(boxes, middle, axis);
        let (low, high) = boxes.cut_mut(middle);
        order(low, 2 * node, bounds);
        order(high, 2 * node + 1, bounds);
    }
}

/// Moves the boxes with the smallest centres along an axis to the positions before `middle` [Hoare 1961]. This is
/// shorter than the selection in the standard library, which browsers would have to download.
fn split(boxes: &mut [Boxed], middle: usize, axis: usize) {
    let centre = |boxes: &[Boxed], at: usize| {
        let [min, max] = boxes.element(at).map_or([Vec3::ZERO; 2], |one| [one.around.min, one.around.max]);
        0.5 * min.to_array().at(axis) + 0.5 * max.to_array().at(axis)
    };
    let (mut first, mut end) = (0, boxes.len());
    while end > first + 1 {
        let pivot = centre(boxes, middle);
        let (mut low, mut high) = (first, end);
        while low < high {
            if centre(boxes, low) < pivot {
                low += 1;
            } else if centre(boxes, high - 1) > pivot {
                high -= 1;
            } else {
                boxes.exchange(low, high - 1);
                (low, high) = (low + 1, high - 1);
            }
        }
        // Centres before `high` are not above the pivot, and centres from `low` on are not below it.
        if middle < high {
            end = high;
        } else if middle >= low {
            first = low;
        } else {
            return;
        }
    }
}
