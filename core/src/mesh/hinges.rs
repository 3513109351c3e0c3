//! Hinges: pairs of triangles that share an edge.

use alloc::vec::Vec;

use super::edges::{Edge, NONE};

/// A hinge: the ends `a b` of the shared edge, then the vertex `c` opposite to it in triangle
/// `(a, b, c)` and the vertex `d` opposite to it in triangle `(a, d, b)`.
pub type Hinge = [u32; 4];

/// The hinges of a mesh, each with the index of its edge, in the order of the edges.
pub fn build(edges: &[Edge]) -> Vec<(Hinge, u32)> {
    let interior = edges.iter().enumerate().filter(|(_, edge)| edge.triangles[1] != NONE);
    interior
        .map(|(i, edge)| ([edge.ends[0], edge.ends[1], edge.opposite[0], edge.opposite[1]], i as u32))
        // Between two triangles with the same three vertices the angle is undefined.
        .filter(|(h, _)| h[2] != h[3])
        .collect()
}
