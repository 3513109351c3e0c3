//! Owned features (R-triangles): every vertex and every edge is owned by exactly one triangle, so
//! that pairs of triangles name every pair of features exactly once [Curtis 2008].
//!
//! A feature goes to the incident triangle that owns the fewest features of its kind at that point.
//! On average a triangle owns half a vertex and one and a half edges. Triangles may repeat vertices:
//! `[v, v, v]` is a lone point, `[a, b, b]` a lone edge. Edges may have any number of triangles, and
//! the same triangle may occur more than once.

use alloc::vec;
use alloc::vec::Vec;

use super::edges::NONE;
use super::incidence::IncidenceColumns;
use crate::broad_phase::{IS_FACE, OWNS_EDGE, OWNS_VERTEX, Sewn, Surface};

/// The owned columns of a [`Surface`].
#[derive(Clone, Debug, Default)]
pub struct SurfaceColumns {
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Edges of each triangle: edge k joins its vertices k and k + 1; [`NONE`] where they are the same vertex.
    pub triangle_edges: Vec<[u32; 3]>,
    /// Bits of the features that each triangle owns, and of whether it is a face.
    pub owned: Vec<u8>,
    /// Ends of each edge, the smaller first. Edges are in ascending order.
    pub edges: Vec<[u32; 2]>,
    /// The triangle corners at each vertex.
    pub incidence: IncidenceColumns,
    /// Start of each vertex's row in `sewn_others`; empty if no vertices are sewn.
    pub sewn_offsets: Vec<u32>,
    /// The vertices that each vertex is sewn to.
    pub sewn_others: Vec<u32>,
    /// Index of the first passive triangle; all later ones are passive too. Passive triangles share no
    /// vertex with the others.
    pub first_passive: u32,
    /// Whether triangles that are not passive pair with one another.
    pub own_contact: bool,
}

impl SurfaceColumns {
    /// A surface without passive triangles that collides with itself. Panics if a triangle or a sewn
    /// pair names a vertex that does not exist.
    #[cfg_attr(small, optimize(size))]
    pub fn build(vertices: usize, triangles: &[[u32; 3]], sewn: &[[u32; 2]]) -> Self {
        let (edges, triangle_edges) = unique_edges(triangles);
        let (sewn_offsets, sewn_others) = rows(vertices, sewn);
        Self {
            owned: assign(triangles, &triangle_edges),
            triangles: triangles.to_vec(),
            triangle_edges,
            edges,
            incidence: IncidenceColumns::build(vertices, triangles),
            sewn_offsets,
            sewn_others,
            first_passive: triangles.len() as u32,
            own_contact: true,
        }
    }

    /// Bytes of the columns.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.triangles[..])
            + size_of_val(&self.triangle_edges[..])
            + size_of_val(&self.owned[..])
            + size_of_val(&self.edges[..])
            + self.incidence.view().bytes()
            + size_of_val(&self.sewn_offsets[..])
            + size_of_val(&self.sewn_others[..])
    }

    /// The borrowed view that the broad phase takes.
    pub fn view(&self) -> Surface<'_> {
        Surface {
            triangles: &self.triangles,
            triangle_edges: &self.triangle_edges,
            owned: &self.owned,
            edges: &self.edges,
            incidence: self.incidence.view(),
            sewn: Sewn { offsets: &self.sewn_offsets, others: &self.sewn_others },
            first_passive: self.first_passive,
            own_contact: self.own_contact,
        }
    }
}

fn unique_edges(triangles: &[[u32; 3]]) -> (Vec<[u32; 2]>, Vec<[u32; 3]>) {
    let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(triangles.len() * 3);
    for (slot, corners) in (0u32..).step_by(3).zip(triangles) {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if a != b {
                sides.push(([a.min(b), a.max(b)], slot + k as u32));
            }
        }
    }
    sides.sort_unstable();
    let mut edges: Vec<[u32; 2]> = Vec::with_capacity(triangles.len() * 3 / 2 + 1);
    let mut triangle_edges = vec![[NONE; 3]; triangles.len()];
    for (ends, slot) in sides {
        if edges.last() != Some(&ends) {
            edges.push(ends);
        }
        triangle_edges.as_flattened_mut()[slot as usize] = edges.len() as u32 - 1;
    }
    (edges, triangle_edges)
}

fn assign(triangles: &[[u32; 3]], triangle_edges: &[[u32; 3]]) -> Vec<u8> {
    let is_face = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let mut owned: Vec<u8> = triangles.iter().map(|t| if is_face(t) { IS_FACE } else { 0 }).collect();
    share_out(triangles, OWNS_VERTEX, &mut owned);
    share_out(triangle_edges, OWNS_EDGE, &mut owned);
    owned
}

/// Assigns each feature to one of the corners or sides that name it, and sets that slot's bit.
fn share_out(names: &[[u32; 3]], first_bit: u8, owned: &mut [u8]) {
    let named = (0u32..).zip(names.as_flattened()).filter(|&(_, &name)| name != NONE);
    let mut slots: Vec<_> = named.map(|(slot, &name)| (name, slot)).collect();
    slots.sort_unstable();
    for group in slots.chunk_by(|a, b| a.0 == b.0) {
        let load = |slot: &u32| (owned[*slot as usize / 3] & (first_bit * 0b111)).count_ones();
        if let Some(slot) = group.iter().map(|&(_, slot)| slot).min_by_key(load) {
            owned[slot as usize / 3] |= first_bit << (slot % 3);
        }
    }
}

/// Both directions of each pair, grouped by vertex: offsets and the other vertices.
fn rows(vertices: usize, pairs: &[[u32; 2]]) -> (Vec<u32>, Vec<u32>) {
    if pairs.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let mut both: Vec<[u32; 2]> = pairs.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
    both.sort_unstable();
    both.dedup();
    let mut offsets = vec![0u32; vertices + 1];
    for &[a, _] in &both {
        offsets[a as usize + 1] += 1;
    }
    for v in 0..vertices {
        offsets[v + 1] += offsets[v];
    }
    (offsets, both.iter().map(|&[_, b]| b).collect())
}
