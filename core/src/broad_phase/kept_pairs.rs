//! Pairs that last over many steps in which little moves [Verlet 1967]: all pairs that are near, or that come near as
//! long as no box of a vertex leaves a box that is a skin wider.

use super::{Candidates, Counts};
use crate::column::Column;
use crate::geometry::aabb::Aabb;
use crate::real::Real;

/// The pairs, borrowed. The lengths of the slices of pairs are their capacity.
#[derive(Debug)]
pub struct KeptPairs<'a> {
    /// Wide box of each vertex.
    pub boxes: &'a mut [Aabb],
    /// Pairs of a vertex and a triangle.
    pub vertex_triangle: &'a mut [[u32; 2]],
    /// Pairs of edges.
    pub edge_edge: &'a mut [[u32; 2]],
    /// Numbers of pairs; [`Counts::UNKNOWN`]: no pairs are kept. If one exceeds its capacity, the pairs are incomplete.
    pub counts: &'a mut Counts,
}

impl KeptPairs<'_> {
    /// The same columns for a shorter time.
    pub fn reborrow(&mut self) -> KeptPairs<'_> {
        let Self { boxes, vertex_triangle, edge_edge, counts } = self;
        KeptPairs { boxes, vertex_triangle, edge_edge, counts }
    }

    /// Whether the pairs contain all that are near while the vertices are in these boxes.
    pub fn cover(&self, boxes: &[Aabb]) -> bool {
        let Counts { vertex_triangle, edge_edge } = *self.counts;
        let is_complete = vertex_triangle <= self.vertex_triangle.len() && edge_edge <= self.edge_edge.len();
        let is_known = self.boxes.len() == boxes.len();
        is_complete && is_known && boxes.iter().zip(&*self.boxes).all(|(narrow, wide)| wide.contains(narrow))
    }

    /// Writes the boxes that are wider on each side by `skin`, m. No pairs are kept for them yet.
    pub fn widen(&mut self, boxes: &[Aabb], skin: Real) {
        for (wide, narrow) in self.boxes.iter_mut().zip(boxes) {
            *wide = Aabb { min: narrow.min - skin, max: narrow.max + skin };
        }
        self.forget();
    }

    /// Keeps no pairs any more.
    pub fn forget(&mut self) {
        *self.counts = Counts::UNKNOWN;
    }

    /// Keeps these pairs: of a vertex and a triangle, and of edges.
    pub fn put(&mut self, pairs: [&[[u32; 2]]; 2]) {
        *self.counts = Counts { vertex_triangle: pairs[0].len(), edge_edge: pairs[1].len() };
        for (kept, pairs) in [&mut *self.vertex_triangle, &mut *self.edge_edge].into_iter().zip(pairs) {
            if let Some(kept) = kept.get_mut(..pairs.len()) {
                kept.copy_from(pairs);
            }
        }
    }

    /// Writes the pairs as candidates, as many as fit, and returns their numbers.
    pub fn take(&self, out: &mut Candidates<'_>) -> Counts {
        let Counts { vertex_triangle, edge_edge } = *self.counts;
        for (kept, out) in [
            (self.vertex_triangle.part(..vertex_triangle), &mut *out.vertex_triangle),
            (self.edge_edge.part(..edge_edge), &mut *out.edge_edge),
        ] {
            if let Some(out) = out.get_mut(..kept.len()) {
                out.copy_from(kept);
            }
        }
        Counts { vertex_triangle, edge_edge }
    }
}

/// The owned columns of [`KeptPairs`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct KeptPairColumns {
    boxes: alloc::vec::Vec<Aabb>,
    vertex_triangle: alloc::vec::Vec<[u32; 2]>,
    edge_edge: alloc::vec::Vec<[u32; 2]>,
    counts: Counts,
}

#[cfg(feature = "alloc")]
impl KeptPairColumns {
    /// Columns for so many vertices and so many pairs of a vertex and a triangle, and of two edges. They hold no pairs
    /// yet.
    pub fn build(vertices: usize, [vertex_triangle, edge_edge]: [usize; 2]) -> Self {
        Self {
            boxes: alloc::vec![Aabb::EMPTY; vertices],
            vertex_triangle: alloc::vec![[0; 2]; vertex_triangle],
            edge_edge: alloc::vec![[0; 2]; edge_edge],
            counts: Counts::UNKNOWN,
        }
    }

    /// Makes room for the pairs if they lacked some and there is memory. No pairs are kept then, until they are put
    /// again.
    pub fn grow(&mut self) {
        if self.counts == Counts::UNKNOWN {
            return;
        }
        let Counts { vertex_triangle, edge_edge } = self.counts;
        for (pairs, needed) in [(&mut self.vertex_triangle, vertex_triangle), (&mut self.edge_edge, edge_edge)] {
            if needed > pairs.len() {
                crate::contact::grow(pairs, needed + needed / 4, [0; 2]);
                self.counts = Counts::UNKNOWN;
            }
        }
    }

    /// Keeps no pairs any more.
    pub fn forget(&mut self) {
        self.counts = Counts::UNKNOWN;
    }

    /// Borrows the columns.
    pub fn view(&mut self) -> KeptPairs<'_> {
        KeptPairs {
            boxes: &mut self.boxes,
            vertex_triangle: &mut self.vertex_triangle,
            edge_edge: &mut self.edge_edge,
            counts: &mut self.counts,
        }
    }

    /// Size of the columns in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.boxes[..]) + size_of_val(&self.vertex_triangle[..]) + size_of_val(&self.edge_edge[..])
    }
}
