//! The faces around edges and vertices of a surface, and a union-find structure for its connected pieces.

use alloc::vec;
use alloc::vec::Vec;

use crate::broad_phase::{IS_FACE, Surface};
use crate::mesh::IncidenceColumns;

/// Marks the absence of a triangle.
pub const NONE: u32 = u32::MAX;

/// The faces around edges and vertices.
#[derive(Debug)]
pub struct Topology {
    /// The edges of faces.
    pub edges: Vec<u32>,
    /// The first two faces on each edge, or [`NONE`].
    pub sides: Vec<[u32; 2]>,
    /// The edges at each vertex: slot `2 e + k` is end k of edge e of [`Surface::edges`].
    pub at: IncidenceColumns,
}

impl Topology {
    /// Builds the topology of all faces.
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

    /// The vertices at the other ends of the edges at a vertex.
    pub fn neighbours<'a>(&'a self, surface: &'a Surface<'_>, vertex: u32) -> impl Iterator<Item = u32> + 'a {
        let slots = self.at.view().at(vertex as usize);
        slots.iter().map(|&slot| surface.edges[slot as usize / 2][1 - slot as usize % 2])
    }
}

/// Union-find. The smallest member of a piece is its representative.
#[derive(Debug)]
pub struct Pieces(Vec<u32>);

impl Pieces {
    /// Starts with one piece per member.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The representative of a member's piece.
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

    /// The representative of each member's piece.
    pub fn roots(mut self) -> Vec<u32> {
        (0..self.0.len() as u32).map(|member| self.root(member)).collect()
    }
}
