//! The columns that stages commands on, and how long they are.

use muslin_core::broad_phase::Surface;

use crate::params::{COUNTER_WORDS, Capacities, SCAN_BLOCK, SIDE};
use crate::readback::DetectionQuery;

/// A column on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Slot {
    /// Six numbers a vertex: least and greatest corner, m.
    Boxes,
    /// Three vertices a triangle.
    Triangles,
    /// Three edges a triangle.
    TriangleEdges,
    /// Two vertices an edge.
    Edges,
    /// What each triangle stands for.
    Given,
    /// Rows of what is sewn to what.
    Sewn,
    /// m around each vertex.
    Radii,
    /// Three coordinates a vertex, m.
    Start,
    /// Likewise.
    End,
    /// Words that stages leave for one another and for the host.
    Counters,
    /// Triangles by size, and the level of each size.
    Histogram,
    /// Six numbers a triangle.
    TriangleBoxes,
    /// What each triangle stands for whose vertices are valid.
    Owned,
    /// A level a triangle.
    Levels,
    /// Six integers a vertex.
    QuantizedBoxes,
    /// Four integers a triangle.
    Spheres,
    /// Key and control bits of each triangle.
    Homes,
    /// Key and object of each entry.
    Entries,
    /// To sort into.
    Spare,
    /// Least and greatest corner of each triangle in bytes.
    ByteBoxes,
    /// Key, object and box of each entry.
    Boxed,
    /// The first entry and the first other of each tile.
    Tiles,
    /// What is counted, and then scanned.
    Counts,
    /// Sums of blocks of counts.
    Blocks,
    /// Triangles of the last level.
    List,
    /// Pairs of triangles.
    Pairs,
    /// The features of each pair.
    Masks,
    /// Candidates: vertex and triangle.
    VertexTriangle,
    /// Candidates: two edges.
    EdgeEdge,
    /// m.
    VertexTriangleDistances,
    /// m.
    EdgeEdgeDistances,
    /// Candidates that are near.
    Contacts,
    /// Parts of the step.
    VertexTriangleTimes,
    /// Likewise.
    EdgeEdgeTimes,
}

impl Slot {
    /// All of them.
    pub const ALL: [Self; 34] = [
        Self::Boxes,
        Self::Triangles,
        Self::TriangleEdges,
        Self::Edges,
        Self::Given,
        Self::Sewn,
        Self::Radii,
        Self::Start,
        Self::End,
        Self::Counters,
        Self::Histogram,
        Self::TriangleBoxes,
        Self::Owned,
        Self::Levels,
        Self::QuantizedBoxes,
        Self::Spheres,
        Self::Homes,
        Self::Entries,
        Self::Spare,
        Self::ByteBoxes,
        Self::Boxed,
        Self::Tiles,
        Self::Counts,
        Self::Blocks,
        Self::List,
        Self::Pairs,
        Self::Masks,
        Self::VertexTriangle,
        Self::EdgeEdge,
        Self::VertexTriangleDistances,
        Self::EdgeEdgeDistances,
        Self::Contacts,
        Self::VertexTriangleTimes,
        Self::EdgeEdgeTimes,
    ];

    /// Whether anything is written to it, or read from it, where this is query.
    pub fn serves(self, query: DetectionQuery) -> bool {
        match self {
            Self::Contacts => query == DetectionQuery::Contacts,
            Self::End | Self::VertexTriangleTimes | Self::EdgeEdgeTimes => query == DetectionQuery::Times,
            _ => true,
        }
    }

    /// Words of four bytes, at least one.
    pub fn words(self, sizes: &SurfaceSizes, capacities: &Capacities) -> usize {
        let SurfaceSizes { vertices, triangles, edges, sewn } = *sizes;
        let Capacities { entries, tiles, pairs, vertex_triangle, edge_edge, contacts, .. } = *capacities;
        let words = match self {
            Self::Boxes | Self::QuantizedBoxes => 6 * vertices,
            Self::Triangles | Self::TriangleEdges => 3 * triangles,
            Self::Edges => 2 * edges,
            Self::Given | Self::Owned | Self::Levels | Self::List => triangles,
            Self::Sewn => sewn,
            Self::Radii => vertices,
            Self::Start | Self::End => 3 * vertices,
            Self::Counters => COUNTER_WORDS,
            Self::Histogram => 2048,
            Self::TriangleBoxes => 6 * triangles,
            Self::Spheres => 4 * triangles,
            Self::Homes | Self::ByteBoxes => 2 * triangles,
            Self::Entries | Self::Spare => 2 * entries,
            Self::Boxed => 4 * entries,
            Self::Tiles => 2 * tiles,
            Self::Counts => sizes.longest_scan(capacities),
            Self::Blocks => sizes.longest_scan(capacities).div_ceil(SCAN_BLOCK) + 1,
            Self::Pairs => 2 * pairs,
            Self::Masks => pairs,
            Self::VertexTriangle => 2 * vertex_triangle,
            Self::EdgeEdge => 2 * edge_edge,
            Self::Contacts => 2 * contacts,
            Self::VertexTriangleDistances | Self::VertexTriangleTimes => vertex_triangle,
            Self::EdgeEdgeDistances | Self::EdgeEdgeTimes => edge_edge,
        };
        words.max(4)
    }
}

/// How large a surface is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SurfaceSizes {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Edges.
    pub edges: usize,
    /// Words of the rows of what is sewn.
    pub sewn: usize,
}

impl SurfaceSizes {
    /// Of a surface with so many vertices.
    pub fn of(surface: &Surface<'_>, vertices: usize) -> Self {
        Self {
            vertices,
            triangles: surface.triangles.len(),
            edges: surface.edges.len(),
            sewn: surface.sewn.offsets.len() + surface.sewn.others.len(),
        }
    }

    fn longest_scan(&self, capacities: &Capacities) -> usize {
        let Capacities { entries, tiles, pairs, vertex_triangle, edge_edge, .. } = *capacities;
        let (digits, rows) = (16 * entries.div_ceil(SCAN_BLOCK), entries.div_ceil(SIDE));
        let candidates = (2 * pairs).max(vertex_triangle + edge_edge);
        // Whatever the scans are of: few of these are ever the longest.
        (4 * self.triangles).max(digits).max(rows).max(tiles).max(candidates)
    }
}
