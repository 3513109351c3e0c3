//! What is beside what in the faces of a surface, and pieces of it.

use alloc::vec;
use alloc::vec::Vec;

use crate::broad_phase::{IS_FACE, Surface};
use crate::mesh::IncidenceColumns;

/// No triangle.
pub const NONE: u32 = u32::MAX;

/// The faces around edges and vertices.
#[derive(Debug)]
pub struct Topology {
    /// The edges of faces.
    pub edges: Vec<u32>,
    /// The first two triangles on each edge.
    pub sides: Vec<[u32; 2]>,
    /// The edges at each vertex: slots of [`Surface::edges`].
    pub at: IncidenceColumns,
}

impl Topology {
    /// Of all faces.
    pub fn build(surface: &Surface<'_>, vertices: usize) -> Self {
        let mut sides = vec![[NONE; 2]; surface.edges.len()];
        for (triangle, edges) in (0..).zip(surface.triangle_edges) {
            if surface.owned[triangle as usize] & IS_FACE != 0 {
                for &edge in edges {
                    let free = sides[edge as usize].iter_mut().find(|side| **side == NONE);
                    if let Some(side) = free {
                        *side = triangle;
                    }
                }
            }
        }
        let edges = (0..surface.edges.len() as u32).filter(|&edge| sides[edge as usize][0] != NONE).collect();
        Self { edges, sides, at: IncidenceColumns::build(vertices, surface.edges) }
    }

    /// The other ends of the edges at a vertex.
    pub fn neighbours<'a>(&'a self, surface: &'a Surface<'_>, vertex: u32) -> impl Iterator<Item = u32> + 'a {
        let slots = self.at.view().at(vertex as usize);
        slots.iter().map(|&slot| surface.edges[slot as usize / 2][1 - slot as usize % 2])
    }
}

/// Union-find; the least member of a piece stands for it.
#[derive(Debug)]
pub struct Pieces(Vec<u32>);

impl Pieces {
    /// Each for itself.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// What stands for the piece.
    pub fn root(&mut self, member: u32) -> u32 {
        let (all, mut v) = (&mut self.0, member);
        while all[v as usize] != v {
            all[v as usize] = all[all[v as usize] as usize];
            v = all[v as usize];
        }
        v
    }

    /// Joins two pieces.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// What stands for each member's piece.
    pub fn roots(mut self) -> Vec<u32> {
        (0..self.0.len() as u32).map(|member| self.root(member)).collect()
    }
}
