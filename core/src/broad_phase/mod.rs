//! Boxes in, pairs out: which features can touch at all. Knows nothing of cloth.
//!
//! A *candidate* is a pair of features, a vertex and a triangle or two edges, that share no
//! vertex, are not sewn together, and whose boxes overlap: exactly this set, by every method.

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
    /// What is sewn to what.
    pub sewn: Sewn<'a>,
    /// Triangles from here on are passive: they never pair with one another.
    pub first_passive: u32,
    /// Whether the triangles before pair with one another.
    pub own_contact: bool,
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
