//! Times of contact by bisection of (t, u, v) boxes, in f64 [Wang 2021]. The difference of two feature points
//! is multilinear, so a box can contain a contact only if the bounding box of its eight corner values, widened
//! by the rounding, comes within the separation of the origin.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use harness::query::{Pair, Query};

/// Number of boxes examined before giving up.
const MOST_BOXES: usize = 100_000;

/// The first time at which features come within a separation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    /// The features stay farther apart.
    Never,
    /// A contact at this time or later, if any.
    NotBefore(f64),
    /// The decision would take too many boxes.
    Unknown,
}

/// Boxes whose differences vary by less than `width` are not divided further but count as contacts.
pub fn first_contact(query: &Query, separation: f64, width: f64) -> Contact {
    let local = query.local();
    let reserve = 1e-15 * local.size() + separation;
    let mut boxes = BinaryHeap::from([Reverse(Ordered([[0.0, 1.0]; 3]))]);
    for _ in 0..MOST_BOXES {
        let Some(Reverse(Ordered(part))) = boxes.pop() else { return Contact::Never };
        let (low, high) = differences(&local, &part);
        let outside = low.max(-high).max(DVec3::ZERO);
        if outside.length() > reserve {
            continue;
        }
        if (high - low).max_element() < width {
            return Contact::NotBefore(part[0][0]);
        }
        let halves = (0..3).map(|axis| {
            let middle = 0.5 * (part[axis][0] + part[axis][1]);
            let (mut lower, mut upper) = (part, part);
            (lower[axis][1], upper[axis][0]) = (middle, middle);
            [lower, upper]
        });
        // Choose the division whose halves vary least.
        let extent = |part: &[[f64; 2]; 3]| {
            let (low, high) = differences(&local, part);
            (high - low).element_sum()
        };
        let best = halves.min_by(|a, b| (extent(&a[0]) + extent(&a[1])).total_cmp(&(extent(&b[0]) + extent(&b[1]))));
        for half in best.into_iter().flatten() {
            if query.pair == Pair::EdgeEdge || half[1][0] + half[2][0] <= 1.0 {
                boxes.push(Reverse(Ordered(half)));
            }
        }
    }
    Contact::Unknown
}

/// Lower and upper corner of the bounding box of the differences of feature points.
fn differences(query: &Query, part: &[[f64; 2]; 3]) -> (DVec3, DVec3) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for t in part[0] {
        let [a, b, c, d] = query.at(t);
        for u in part[1] {
            for v in part[2] {
                let difference = match query.pair {
                    Pair::VertexTriangle => a - b - (c - b) * u - (d - b) * v,
                    Pair::EdgeEdge => a + (b - a) * u - c - (d - c) * v,
                };
                (low, high) = (low.min(difference), high.max(difference));
            }
        }
    }
    (low, high)
}

/// Orders boxes by start, then by width: earlier boxes first.
#[derive(PartialEq)]
struct Ordered([[f64; 2]; 3]);

impl Eq for Ordered {}

impl PartialOrd for Ordered {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ordered {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let key = |part: &Self| (part.0[0][0], part.0[0][1] - part.0[0][0], part.0[1][1] - part.0[1][0]);
        let (a, b) = (key(self), key(other));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2))
    }
}
