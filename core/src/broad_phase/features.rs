//! A pair of triangles -> the pairs of features that the two stand for, whose boxes overlap
//! [Curtis 2008].
//!
//! The triangles may share vertices: what is dropped are pairs of features that do, or that are
//! sewn together. So pairs of neighbours must come here too.

use super::{Candidates, Counts, IS_FACE, OWNS_EDGE, OWNS_VERTEX, Surface};
use crate::geometry::aabb::Aabb;

/// What [`write_bounds`](super::bounds::write_bounds) makes of the boxes of vertices.
#[derive(Clone, Copy, Debug)]
pub struct FeatureBoxes<'a> {
    /// One a vertex.
    pub vertices: &'a [Aabb],
    /// One a triangle.
    pub triangles: &'a [Aabb],
    /// One an edge.
    pub edges: &'a [Aabb],
    /// For which features each triangle stands, without invalid faces.
    pub owned: &'a [u8],
}

/// Adds the candidates of a pair of triangles.
#[inline]
pub fn add_features(
    boxes: &FeatureBoxes<'_>,
    surface: &Surface<'_>,
    pair: [u32; 2],
    out: &mut Candidates<'_>,
    counts: &mut Counts,
) {
    let [a, b] = pair.map(|triangle| triangle as usize);
    if !surface.may_pair(pair[0], pair[1]) {
        return;
    }
    for (a, b) in [(a, b), (b, a)] {
        if boxes.owned[b] & IS_FACE == 0 {
            continue;
        }
        let corners = surface.triangles[b];
        for k in (0..3).filter(|&k| boxes.owned[a] & OWNS_VERTEX << k != 0) {
            let vertex = surface.triangles[a][k];
            if boxes.vertices[vertex as usize].overlaps(&boxes.triangles[b])
                && corners.iter().all(|&corner| are_apart(surface, vertex, corner))
            {
                out.add_vertex_triangle(counts, vertex, b as u32);
            }
        }
    }
    for i in (0..3).filter(|&k| boxes.owned[a] & OWNS_EDGE << k != 0) {
        let first = surface.triangle_edges[a][i];
        let first_box = &boxes.edges[first as usize];
        for j in (0..3).filter(|&k| boxes.owned[b] & OWNS_EDGE << k != 0) {
            let second = surface.triangle_edges[b][j];
            if first_box.overlaps(&boxes.edges[second as usize]) {
                let [p, q] = surface.edges[first as usize];
                let ends = surface.edges[second as usize];
                if ends.iter().all(|&end| are_apart(surface, p, end) && are_apart(surface, q, end)) {
                    out.add_edge_edge(counts, first, second);
                }
            }
        }
    }
}

#[inline]
fn are_apart(surface: &Surface<'_>, a: u32, b: u32) -> bool {
    a != b && !surface.sewn.joins(a, b)
}
