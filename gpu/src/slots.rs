//! The columns that stages read and write, and their lengths.

use muslin_core::broad_phase::Surface;

use crate::params::{COUNTER_WORDS, Capacities, SCAN_BLOCK, SIDE};
use crate::readback::DetectionQuery;

/// A column on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Slot {
    /// Box of each vertex, m: the minimum, then the maximum.
    Boxes,
    /// Three vertices per triangle.
    Triangles,
    /// Three edges per triangle.
    TriangleEdges,
    /// Two vertices per edge.
    Edges,
    /// The features that each triangle owns in the surface.
    Given,
    /// The vertices that each vertex is sewn to: the offsets of the rows, then the rows.
    Sewn,
    /// Radius around each vertex, m.
    Radii,
    /// Position of each vertex at the start of the step, m.
    Start,
    /// Position of each vertex at the end of the step, m.
    End,
    /// Counters that stages write for later stages and for the host.
    Counters,
    /// Number of triangles of each size, then the level of each size.
    Histogram,
    /// Box of each triangle, m: the minimum, then the maximum.
    TriangleBoxes,
    /// The features that each triangle owns and whose vertices all have valid boxes.
    Owned,
    /// Level of each triangle.
    Levels,
    /// Box of each vertex in integer units: the minimum, then the maximum.
    QuantizedBoxes,
    /// Sphere around each triangle: twice the centre, and the squared diagonal of its box.
    Spheres,
    /// Key of the home cell and control bits of each triangle.
    Homes,
    /// Key of the cell and object of each entry.
    Entries,
    /// Entries between two passes of the sort.
    Spare,
    /// Box of each triangle in bytes: the minimum, then the maximum.
    ByteBoxes,
    /// Key, object and box of each entry.
    Boxed,
    /// The first entry and the first other entry of each tile.
    Tiles,
    /// Counts, which the scan replaces by their prefix sums.
    Counts,
    /// Sums of the blocks of a scan.
    Blocks,
    /// Triangles of the last level.
    List,
    /// Pairs of triangles.
    Pairs,
    /// The pairs of features of each pair of triangles, as bits.
    Masks,
    /// Vertex and triangle of each candidate.
    VertexTriangle,
    /// Two edges of each candidate.
    EdgeEdge,
    /// Distance of each vertex-triangle candidate, m.
    VertexTriangleDistances,
    /// Distance of each edge-edge candidate, m.
    EdgeEdgeDistances,
    /// Candidates nearer than the reach, of both kinds.
    Contacts,
    /// Time of impact of each vertex-triangle candidate, as a fraction of the step.
    VertexTriangleTimes,
    /// Time of impact of each edge-edge candidate, as a fraction of the step.
    EdgeEdgeTimes,
}

impl Slot {
    /// All slots, in the order of their numbers.
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

    /// Whether a detection with this query writes or reads the column.
    pub fn serves(self, query: DetectionQuery) -> bool {
        match self {
            Self::Edges | Self::Radii | Self::Start | Self::VertexTriangleDistances | Self::EdgeEdgeDistances => {
                query != DetectionQuery::Candidates
            }
            #[cfg(feature = "narrow-phase")]
            Self::Contacts => query == DetectionQuery::Contacts,
            #[cfg(feature = "narrow-phase")]
            Self::End | Self::VertexTriangleTimes | Self::EdgeEdgeTimes => query == DetectionQuery::Times,
            #[cfg(not(feature = "narrow-phase"))]
            Self::Contacts | Self::End | Self::VertexTriangleTimes | Self::EdgeEdgeTimes => false,
            _ => true,
        }
    }

    /// Length in words of four bytes, at least four.
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

/// Sizes of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SurfaceSizes {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of words of the column of sewn vertices.
    pub sewn: usize,
}

impl SurfaceSizes {
    /// The sizes of a surface with `vertices` vertices.
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
        // The lengths of all scans of the schedule.
        (4 * self.triangles).max(digits).max(rows).max(tiles).max(candidates)
    }
}
