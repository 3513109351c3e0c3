//! Unique edges of a triangle mesh, each with its one or two triangles.

use alloc::vec::Vec;

use crate::error::MeshError;

pub use super::NONE;

/// An edge with its triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The two ends, in the winding order of the first triangle.
    pub ends: [u32; 2],
    /// The triangles on both sides; the second is [`NONE`] at the border.
    pub triangles: [u32; 2],
    /// For each triangle, its vertex that is not on the edge; [`NONE`] where there is no triangle.
    pub opposite: [u32; 2],
}

/// Builds the unique edges, sorted by their smaller end, then by their larger end.
///
/// Errors: an edge with more than two triangles.
#[cfg_attr(small, optimize(size))]
pub fn build(triangles: &[[u32; 3]]) -> Result<Vec<Edge>, MeshError> {
    let mut sides: Vec<(u32, u32, u32, u8)> = Vec::with_capacity(triangles.len() * 3);
    for (t, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            sides.push((a.min(b), a.max(b), t as u32, k as u8));
        }
    }
    sides.sort_unstable();
    let mut edges: Vec<Edge> = Vec::with_capacity(triangles.len() * 3 / 2 + 1);
    let mut last = None;
    for (low, high, triangle, side) in sides {
        let corners = triangles[triangle as usize];
        let opposite = corners[(side as usize + 2) % 3];
        match edges.last_mut() {
            Some(edge) if last == Some((low, high)) => {
                if edge.triangles[1] != NONE {
                    return Err(MeshError::NonManifoldEdge { a: low, b: high });
                }
                edge.triangles[1] = triangle;
                edge.opposite[1] = opposite;
            }
            _ => edges.push(Edge {
                ends: [corners[side as usize], corners[(side as usize + 1) % 3]],
                triangles: [triangle, NONE],
                opposite: [opposite, NONE],
            }),
        }
        last = Some((low, high));
    }
    Ok(edges)
}
