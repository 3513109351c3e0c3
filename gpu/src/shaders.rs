//! The table of shaders: the source, the entry points and the columns of each stage.

use crate::slots::Slot;

/// A WGSL file whose entry points share the same columns.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Its path below `src` without the extension. Variants of one file have a suffix behind a comma.
    pub name: &'static str,
    /// The WGSL source in pieces, some of which are shared by several shaders.
    pub pieces: &'static [&'static str],
    /// Its entry points.
    pub entries: &'static [&'static str],
    /// Its columns in the order of their bindings, from 1 on, and whether it writes them.
    pub bindings: &'static [(Slot, bool)],
    /// Largest allowed difference from the results of the core: 0 for integers and copies, relative to the
    /// largest coordinate for distances, as a fraction of the step for times.
    pub bound: f32,
}

impl Shader {
    /// The complete WGSL source. It is joined on each call, because storing the shared pieces once per shader would
    /// take many times the space.
    pub fn source(&self) -> String {
        self.pieces.concat()
    }
}

/// The index of a shader in [`ALL`] and of an entry point in the shader, if both exist.
pub fn find(shader: &str, entry: &str) -> Option<[usize; 2]> {
    let at = ALL.iter().position(|own| own.name == shader)?;
    Some([at, ALL[at].entries.iter().position(|&own| own == entry)?])
}

/// The pieces that all shaders share, then the given ones, as `build.rs` wrote them.
macro_rules! wgsl {
    ($($piece:literal),*) => {
        &[
            include_str!(concat!(env!("OUT_DIR"), "/shared/params.wgsl")),
            include_str!(concat!(env!("OUT_DIR"), "/shared/counters.wgsl")),
            $(include_str!(concat!(env!("OUT_DIR"), "/", $piece))),*
        ]
    };
}

/// Bound of stages that compute integers or copy.
const EXACT: f32 = 0.0;

const READ: bool = false;
const WRITE: bool = true;

/// The boxes of triangles.
pub static BOUNDS: Shader = Shader {
    name: "broad_phase/bounds",
    pieces: wgsl!("broad_phase/bounds.wgsl"),
    entries: &["write_bounds"],
    bindings: &[
        (Slot::Boxes, READ),
        (Slot::Triangles, READ),
        (Slot::Given, READ),
        (Slot::TriangleBoxes, WRITE),
        (Slot::Owned, WRITE),
    ],
    bound: EXACT,
};

/// The division of triangles into levels by size.
pub static LEVELS: Shader = Shader {
    name: "broad_phase/levels",
    pieces: wgsl!("broad_phase/levels.wgsl"),
    entries: &["count_sizes", "divide", "assign"],
    bindings: &[(Slot::TriangleBoxes, READ), (Slot::Levels, WRITE), (Slot::Histogram, WRITE), (Slot::Counters, WRITE)],
    bound: EXACT,
};

/// The boxes of vertices in integer units.
pub static QUANTIZED_BOXES: Shader = Shader {
    name: "broad_phase/quantized_boxes",
    pieces: wgsl!("broad_phase/quantized_boxes.wgsl"),
    entries: &["choose_scale", "write_quantized_boxes"],
    bindings: &[(Slot::Boxes, READ), (Slot::QuantizedBoxes, WRITE), (Slot::Counters, WRITE)],
    bound: EXACT,
};

/// The spheres around triangles.
pub static SPHERES: Shader = Shader {
    name: "broad_phase/spheres",
    pieces: wgsl!("broad_phase/spheres.wgsl"),
    entries: &["write_spheres"],
    bindings: &[
        (Slot::QuantizedBoxes, READ),
        (Slot::Triangles, READ),
        (Slot::Levels, READ),
        (Slot::Spheres, WRITE),
        (Slot::Counters, WRITE),
    ],
    bound: EXACT,
};

/// Home cells and control bits.
pub static CELLS: Shader = Shader {
    name: "broad_phase/cells",
    pieces: wgsl!("broad_phase/control_bits.wgsl", "broad_phase/cells.wgsl"),
    entries: &["choose_grid", "write_cells"],
    bindings: &[(Slot::Spheres, READ), (Slot::Homes, WRITE), (Slot::Counters, WRITE)],
    bound: EXACT,
};

/// An entry for each cell that a triangle touches.
pub static ENTRIES: Shader = Shader {
    name: "broad_phase/entries",
    pieces: wgsl!("broad_phase/control_bits.wgsl", "shared/entry.wgsl", "broad_phase/entries.wgsl"),
    entries: &["count_entries", "write_entries"],
    bindings: &[
        (Slot::Homes, READ),
        (Slot::Levels, READ),
        (Slot::Counts, WRITE),
        (Slot::Blocks, READ),
        (Slot::Entries, WRITE),
        (Slot::Counters, WRITE),
    ],
    bound: EXACT,
};

/// Exclusive prefix sums.
pub static SCAN: Shader = Shader {
    name: "shared/scan",
    pieces: wgsl!("shared/scan.wgsl"),
    entries: &["sum_blocks", "scan_blocks", "spread"],
    bindings: &[(Slot::Counts, WRITE), (Slot::Blocks, WRITE)],
    bound: EXACT,
};

/// A pass of the radix sort into the spare column.
pub static SORT: Shader = Shader {
    name: "broad_phase/sort",
    pieces: wgsl!("broad_phase/sort.wgsl"),
    entries: &["count_digits", "scatter"],
    bindings: &[(Slot::Entries, READ), (Slot::Spare, WRITE), (Slot::Counts, WRITE), (Slot::Counters, READ)],
    bound: EXACT,
};

/// A pass of the radix sort from the spare column back.
pub static SORT_BACK: Shader = Shader {
    name: "broad_phase/sort, back",
    bindings: &[(Slot::Spare, READ), (Slot::Entries, WRITE), (Slot::Counts, WRITE), (Slot::Counters, READ)],
    ..SORT
};

/// The boxes of triangles and of entries in bytes.
pub static BYTE_BOXES: Shader = Shader {
    name: "broad_phase/byte_boxes",
    pieces: wgsl!("shared/entry.wgsl", "broad_phase/byte_boxes.wgsl"),
    entries: &["write_byte_boxes", "gather"],
    bindings: &[
        (Slot::QuantizedBoxes, READ),
        (Slot::Triangles, READ),
        (Slot::Levels, READ),
        (Slot::Entries, READ),
        (Slot::ByteBoxes, WRITE),
        (Slot::Boxed, WRITE),
        (Slot::Counters, READ),
    ],
    bound: EXACT,
};

/// The comparisons of entries, split into tiles of one size.
pub static TILES: Shader = Shader {
    name: "shared/tiles",
    pieces: wgsl!("shared/entry.wgsl", "shared/tiles.wgsl", "shared/overflow.wgsl"),
    entries: &["count_tiles", "write_tiles"],
    bindings: &[
        (Slot::Boxed, READ),
        (Slot::Counts, WRITE),
        (Slot::Blocks, READ),
        (Slot::Tiles, WRITE),
        (Slot::Counters, WRITE),
    ],
    bound: EXACT,
};

/// Pairs of triangles that share a cell and whose boxes overlap.
pub static PAIRS: Shader = Shader {
    name: "broad_phase/pairs",
    pieces: wgsl!(
        "broad_phase/control_bits.wgsl",
        "shared/entry.wgsl",
        "broad_phase/pairs.wgsl",
        "shared/may_pair.wgsl",
        "shared/overflow.wgsl"
    ),
    entries: &["count_pairs", "write_pairs", "close_pairs"],
    bindings: &[
        (Slot::Boxed, READ),
        (Slot::Tiles, READ),
        (Slot::Homes, READ),
        (Slot::TriangleBoxes, READ),
        (Slot::Counts, WRITE),
        (Slot::Blocks, READ),
        (Slot::Pairs, WRITE),
        (Slot::Counters, WRITE),
    ],
    bound: EXACT,
};

/// Pairs with triangles of the last level.
pub static BRUTE_FORCE_LEVEL: Shader = Shader {
    name: "broad_phase/brute_force_level",
    pieces: wgsl!("broad_phase/brute_force_level.wgsl", "shared/may_pair.wgsl", "shared/overflow.wgsl"),
    entries: &["count_last", "list_last", "count_brute_force", "write_brute_force", "close_brute_force"],
    bindings: &[
        (Slot::Levels, READ),
        (Slot::TriangleBoxes, READ),
        (Slot::List, WRITE),
        (Slot::Counts, WRITE),
        (Slot::Blocks, READ),
        (Slot::Pairs, WRITE),
        (Slot::Counters, WRITE),
    ],
    bound: EXACT,
};

/// The pairs of features of each pair of triangles.
pub static FEATURES: Shader = Shader {
    name: "broad_phase/features",
    pieces: wgsl!("shared/sewn.wgsl", "broad_phase/features.wgsl", "shared/overflow.wgsl"),
    entries: &["find_features"],
    bindings: &[
        (Slot::Boxes, READ),
        (Slot::Triangles, READ),
        (Slot::Owned, READ),
        (Slot::TriangleBoxes, READ),
        (Slot::Sewn, READ),
        (Slot::Pairs, READ),
        (Slot::Masks, WRITE),
        (Slot::Counters, READ),
    ],
    bound: EXACT,
};

/// The pairs of features as candidates.
pub static CANDIDATES: Shader = Shader {
    name: "shared/candidates",
    pieces: wgsl!("shared/candidates.wgsl"),
    entries: &["count_candidates", "write_candidates"],
    bindings: &[
        (Slot::Triangles, READ),
        (Slot::TriangleEdges, READ),
        (Slot::Pairs, READ),
        (Slot::Masks, READ),
        (Slot::Counts, WRITE),
        (Slot::VertexTriangle, WRITE),
        (Slot::EdgeEdge, WRITE),
        (Slot::Counters, WRITE),
    ],
    bound: EXACT,
};

/// Distances of vertex-triangle candidates.
#[cfg(feature = "narrow-phase")]
pub static VERTEX_TRIANGLE: Shader = Shader {
    name: "narrow_phase/proximity, vertex_triangle",
    pieces: wgsl!(
        "geometry/point_edge.wgsl",
        "geometry/point_triangle.wgsl",
        "narrow_phase/vertex_triangle.wgsl",
        "shared/gather.wgsl",
        "narrow_phase/proximity.wgsl"
    ),
    entries: &["write_distances"],
    bindings: &[
        (Slot::VertexTriangle, READ),
        (Slot::Triangles, READ),
        (Slot::Start, READ),
        (Slot::Radii, READ),
        (Slot::VertexTriangleDistances, WRITE),
        (Slot::Counters, READ),
    ],
    bound: 1e-5,
};

/// Distances of edge-edge candidates.
#[cfg(feature = "narrow-phase")]
pub static EDGE_EDGE: Shader = Shader {
    name: "narrow_phase/proximity, edge_edge",
    pieces: wgsl!(
        "geometry/point_edge.wgsl",
        "geometry/edge_edge.wgsl",
        "narrow_phase/edge_edge.wgsl",
        "shared/gather.wgsl",
        "narrow_phase/proximity.wgsl"
    ),
    entries: &["write_distances"],
    bindings: &[
        (Slot::EdgeEdge, READ),
        (Slot::Edges, READ),
        (Slot::Start, READ),
        (Slot::Radii, READ),
        (Slot::EdgeEdgeDistances, WRITE),
        (Slot::Counters, READ),
    ],
    bound: 1e-5,
};

/// Candidates nearer than the reach.
#[cfg(feature = "narrow-phase")]
pub static CONTACTS: Shader = Shader {
    name: "narrow_phase/contacts",
    pieces: wgsl!("narrow_phase/contacts.wgsl"),
    entries: &["count_contacts", "write_contacts"],
    bindings: &[
        (Slot::VertexTriangle, READ),
        (Slot::EdgeEdge, READ),
        (Slot::VertexTriangleDistances, READ),
        (Slot::EdgeEdgeDistances, READ),
        (Slot::Counts, WRITE),
        (Slot::Blocks, READ),
        (Slot::Contacts, WRITE),
        (Slot::Counters, WRITE),
    ],
    bound: EXACT,
};

/// Times of impact of vertex-triangle candidates.
#[cfg(feature = "narrow-phase")]
pub static VERTEX_TRIANGLE_CCD: Shader = Shader {
    name: "narrow_phase/continuous, vertex_triangle",
    pieces: wgsl!(
        "geometry/point_edge.wgsl",
        "geometry/point_triangle.wgsl",
        "narrow_phase/vertex_triangle.wgsl",
        "shared/gather.wgsl",
        "narrow_phase/advance.wgsl",
        "narrow_phase/continuous.wgsl"
    ),
    entries: &["write_times"],
    bindings: &[
        (Slot::VertexTriangle, READ),
        (Slot::Triangles, READ),
        (Slot::Start, READ),
        (Slot::End, READ),
        (Slot::Radii, READ),
        (Slot::VertexTriangleDistances, READ),
        (Slot::VertexTriangleTimes, WRITE),
        (Slot::Counters, READ),
    ],
    bound: 1e-3,
};

/// Times of impact of edge-edge candidates.
#[cfg(feature = "narrow-phase")]
pub static EDGE_EDGE_CCD: Shader = Shader {
    name: "narrow_phase/continuous, edge_edge",
    pieces: wgsl!(
        "geometry/point_edge.wgsl",
        "geometry/edge_edge.wgsl",
        "narrow_phase/edge_edge.wgsl",
        "shared/gather.wgsl",
        "narrow_phase/advance.wgsl",
        "narrow_phase/continuous.wgsl"
    ),
    entries: &["write_times"],
    bindings: &[
        (Slot::EdgeEdge, READ),
        (Slot::Edges, READ),
        (Slot::Start, READ),
        (Slot::End, READ),
        (Slot::Radii, READ),
        (Slot::EdgeEdgeDistances, READ),
        (Slot::EdgeEdgeTimes, WRITE),
        (Slot::Counters, READ),
    ],
    bound: 1e-3,
};

/// All shaders, in the order of the data flow.
pub static ALL: &[&Shader] = &[
    &BOUNDS,
    &LEVELS,
    &QUANTIZED_BOXES,
    &SPHERES,
    &CELLS,
    &ENTRIES,
    &SCAN,
    &SORT,
    &SORT_BACK,
    &BYTE_BOXES,
    &TILES,
    &PAIRS,
    &BRUTE_FORCE_LEVEL,
    &FEATURES,
    &CANDIDATES,
    #[cfg(feature = "narrow-phase")]
    &VERTEX_TRIANGLE,
    #[cfg(feature = "narrow-phase")]
    &EDGE_EDGE,
    #[cfg(feature = "narrow-phase")]
    &CONTACTS,
    #[cfg(feature = "narrow-phase")]
    &VERTEX_TRIANGLE_CCD,
    #[cfg(feature = "narrow-phase")]
    &EDGE_EDGE_CCD,
];
