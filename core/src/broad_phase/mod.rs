//! The broad phase finds the pairs of features that may touch, from their bounding boxes alone. It does not depend
//! on the physics of cloth.
//!
//! A *candidate* is a pair of features, either a vertex and a triangle or two edges, that share no vertex, are not
//! sewn together, and have overlapping boxes. Every method returns exactly this set.
//!
//! The [`grid`] computes the candidates from the boxes; its steps are the modules below, in order. Where much moves,
//! [`comoving`] leaves out pairs of triangles that move together. Where little moves, [`kept_pairs`] spares the grid
//! for many steps. [`reference_cell`] and [`brute_force`] compute the same set by simpler rules, and the tests compare
//! the grid with them. A box that has a NaN, or a low corner above its high corner, overlaps nothing, and neither does
//! any feature with a vertex that has such a box.

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

pub mod comoving;

pub mod features;

pub mod grid;
pub mod lean;

pub mod kept_pairs;

#[cfg(feature = "alloc")]
pub mod brute_force;
#[cfg(feature = "alloc")]
pub mod reference_cell;

#[cfg(feature = "alloc")]
pub use grid::GridColumns;
pub use grid::{Grid, candidates};
pub use kept_pairs::KeptPairs;

use crate::column::Column;
use crate::mesh::Incidence;

/// Bit in [`Surface::owned`]: shifted left by k, the triangle owns its vertex k.
pub const OWNS_VERTEX: u8 = 1;
/// Bit in [`Surface::owned`]: shifted left by k, the triangle owns its edge k.
pub const OWNS_EDGE: u8 = 1 << 3;
/// Bit in [`Surface::owned`]: the triangle is a face that vertices can touch. Colliders that are points or lines
/// with a radius are stored as triangles with repeated vertices and without this bit.
pub const IS_FACE: u8 = 1 << 6;

/// The triangles that can touch, and the vertices and edges that each of them owns.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Vertices of each triangle.
    pub triangles: &'a [[u32; 3]],
    /// Edges of each triangle: k joins vertices k and k + 1.
    pub triangle_edges: &'a [[u32; 3]],
    /// The features that each triangle owns. Each feature has one owner, so every pair of features comes from
    /// exactly one pair of triangles (R-triangles) [Curtis 2008].
    pub owned: &'a [u8],
    /// Ends of each edge.
    pub edges: &'a [[u32; 2]],
    /// The triangle corners at each vertex: slot `3 t + k` is corner k of triangle t.
    pub incidence: Incidence<'a>,
    /// The pairs of vertices that are sewn together.
    pub sewn: Sewn<'a>,
    /// Index of the first passive triangle. Passive triangles never pair with one another, and they share no vertex
    /// with the triangles before them.
    pub first_passive: u32,
    /// Whether the triangles before `first_passive` pair with one another.
    pub own_contact: bool,
}

impl Surface<'_> {
    /// Whether features of the two triangles are allowed to pair.
    #[inline]
    pub fn may_pair(&self, a: u32, b: u32) -> bool {
        match [a, b].map(|triangle| triangle >= self.first_passive) {
            [false, false] => self.own_contact,
            [true, true] => false,
            _ => true,
        }
    }
}

/// The vertices that each vertex is sewn to, one row per vertex. If `offsets` is empty, nothing is sewn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sewn<'a> {
    /// Start of each vertex's row, followed by the end of the last row; or empty.
    pub offsets: &'a [u32],
    /// The vertices of all rows.
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
            Some(&[start, end]) => self.others.part(start as usize..end as usize).contains(&b),
            _ => false,
        }
    }
}

/// The runs of consecutive elements with the same key, each with its key.
fn runs<T, K: PartialEq>(mut rest: &[T], key: impl Fn(&T) -> K) -> impl Iterator<Item = (K, &[T])> {
    core::iter::from_fn(move || {
        let first = key(rest.first()?);
        let length = rest.iter().take_while(|element| key(element) == first).count();
        let (run, others) = rest.cut(length);
        rest = others;
        Some((first, run))
    })
}

/// The candidates: `[vertex, triangle]` and `[edge, edge]`, the smaller edge index first. The length of each slice
/// is its capacity.
#[derive(Debug, Default)]
pub struct Candidates<'a> {
    /// Pairs of a vertex and a triangle.
    pub vertex_triangle: &'a mut [[u32; 2]],
    /// Pairs of edges.
    pub edge_edge: &'a mut [[u32; 2]],
}

/// The numbers of candidates. If a count exceeds its capacity, only the candidates that fit were written, and the
/// caller must repeat the call with larger slices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Counts {
    /// Pairs of a vertex and a triangle.
    pub vertex_triangle: usize,
    /// Pairs of edges.
    pub edge_edge: usize,
}

impl Counts {
    /// Stands for numbers that are not known.
    pub const UNKNOWN: Self = Self { vertex_triangle: usize::MAX, edge_edge: usize::MAX };
}

impl Candidates<'_> {
    /// Counts a pair of a vertex and a triangle, and writes it if it fits.
    #[inline(always)]
    pub fn add_vertex_triangle(&mut self, counts: &mut Counts, vertex: u32, triangle: u32) {
        if let Some(slot) = self.vertex_triangle.get_mut(counts.vertex_triangle) {
            *slot = [vertex, triangle];
        }
        counts.vertex_triangle += 1;
    }

    /// Counts a pair of edges, and writes it if it fits.
    #[inline(always)]
    pub fn add_edge_edge(&mut self, counts: &mut Counts, a: u32, b: u32) {
        if let Some(slot) = self.edge_edge.get_mut(counts.edge_edge) {
            *slot = [a.min(b), a.max(b)];
        }
        counts.edge_edge += 1;
    }
}
