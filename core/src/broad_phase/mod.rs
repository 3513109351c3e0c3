//! Boxes in, pairs out: which features can touch at all. Knows nothing of cloth.
//!
//! A *candidate* is a pair of features, a vertex and a triangle or two edges, that share no
//! vertex, are not sewn together, and whose boxes overlap: exactly this set, by every method.
//!
//! The [`grid`] goes from boxes to candidates in the order of the modules; [`reference_cell`] and
//! [`brute_force`] do the same by simpler rules and are what it is tested against. Where a box has
//! a NaN, or a corner on the wrong side, it overlaps nothing, nor does what it is part of.

pub mod bounds;
pub mod levels;

pub mod quantized_boxes;

pub mod spheres;

pub mod byte_boxes;

pub mod cells;
pub mod control_bits;
pub mod entries;

pub mod sort;

pub mod brute_force_level;
pub mod pairs;

pub mod features;

pub mod grid;

#[cfg(feature = "alloc")]
pub mod brute_force;
#[cfg(feature = "alloc")]
pub mod reference_cell;

#[cfg(feature = "alloc")]
pub use grid::GridColumns;
pub use grid::{Grid, candidates};

use crate::mesh::Incidence;

/// In [`Surface::owned`]: bit k, the triangle stands for its vertex k.
pub const OWNS_VERTEX: u8 = 1;
/// In [`Surface::owned`]: shifted by k, the triangle stands for its edge k.
pub const OWNS_EDGE: u8 = 1 << 3;
/// In [`Surface::owned`]: the triangle is a face that vertices can touch. Colliders that are
/// points or lines with a radius come as triangles with repeated vertices and without this bit.
pub const IS_FACE: u8 = 1 << 6;

/// What can touch: triangles, and the vertices and edges that each stands for.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Vertices of each triangle.
    pub triangles: &'a [[u32; 3]],
    /// Edges of each triangle: k joins vertices k and k + 1.
    pub triangle_edges: &'a [[u32; 3]],
    /// Which features each triangle stands for, so that every feature pair comes from exactly one
    /// pair of triangles (R-triangles) [Curtis 2008].
    pub owned: &'a [u8],
    /// Ends of each edge.
    pub edges: &'a [[u32; 2]],
    /// Which corners of triangles meet at each vertex: slot `3 t + k` is corner k of triangle t.
    pub incidence: Incidence<'a>,
    /// What is sewn to what.
    pub sewn: Sewn<'a>,
    /// Triangles from here on are passive: they never pair with one another. They share no vertex
    /// with those before.
    pub first_passive: u32,
    /// Whether the triangles before pair with one another.
    pub own_contact: bool,
}

impl Surface<'_> {
    /// Whether features of two triangles may touch at all.
    #[inline]
    pub fn may_pair(&self, a: u32, b: u32) -> bool {
        match [a, b].map(|triangle| triangle >= self.first_passive) {
            [false, false] => self.own_contact,
            [true, true] => false,
            _ => true,
        }
    }
}

/// The vertices that each vertex is sewn to, as rows. Without rows nothing is sewn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sewn<'a> {
    /// Start of each vertex's row; one more than there are vertices, or empty.
    pub offsets: &'a [u32],
    /// The vertices sewn to it.
    pub others: &'a [u32],
}

impl Sewn<'_> {
    /// Whether two vertices are sewn together.
    #[inline]
    pub fn joins(&self, a: u32, b: u32) -> bool {
        if self.offsets.is_empty() {
            return false;
        }
        match self.offsets.get(a as usize..=a as usize + 1) {
            Some(&[start, end]) => self.others[start as usize..end as usize].contains(&b),
            _ => false,
        }
    }
}

/// The candidates: `[vertex, triangle]` and `[edge, edge]`, the lesser edge first. A slice's
/// length is its capacity.
#[derive(Debug, Default)]
pub struct Candidates<'a> {
    /// Pairs of a vertex and a triangle.
    pub vertex_triangle: &'a mut [[u32; 2]],
    /// Pairs of edges.
    pub edge_edge: &'a mut [[u32; 2]],
}

/// How many candidates there are. Where a count is above its capacity, only as many as fit were
/// written and the caller must come again with more room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Pairs of a vertex and a triangle.
    pub vertex_triangle: usize,
    /// Pairs of edges.
    pub edge_edge: usize,
}

impl Candidates<'_> {
    /// Counts a vertex and a triangle, and writes them where there is room.
    #[inline(always)]
    pub fn add_vertex_triangle(&mut self, counts: &mut Counts, vertex: u32, triangle: u32) {
        if let Some(slot) = self.vertex_triangle.get_mut(counts.vertex_triangle) {
            *slot = [vertex, triangle];
        }
        counts.vertex_triangle += 1;
    }

    /// Counts two edges, and writes them where there is room.
    #[inline(always)]
    pub fn add_edge_edge(&mut self, counts: &mut Counts, a: u32, b: u32) {
        if let Some(slot) = self.edge_edge.get_mut(counts.edge_edge) {
            *slot = [a.min(b), a.max(b)];
        }
        counts.edge_edge += 1;
    }
}
