//! Parameters of the stages, their capacities, and the layout of the counters.

use bytemuck::{Pod, Zeroable};

/// Parameters of a dispatch: `struct Params` of `shared/params.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Params {
    /// Number of vertices.
    pub vertices: u32,
    /// Number of triangles.
    pub triangles: u32,
    /// The first passive triangle.
    pub first_passive: u32,
    /// 1: triangles before `first_passive` may pair with one another.
    pub own_contact: u32,
    /// 1: some vertices are sewn together.
    pub sewn: u32,
    /// The level. In the brute-force level: the round. In `divide`: the number of levels that are run.
    pub level: u32,
    /// In the sort: the lowest bit that this pass looks at.
    pub shift: u32,
    /// In the scan: the number of values. In `divide`: the number of triangles of the last level that are compared.
    pub length: u32,
    /// Capacity for entries.
    pub entries: u32,
    /// Capacity for tiles.
    pub tiles: u32,
    /// Capacity for pairs of triangles.
    pub pairs: u32,
    /// Capacity for vertex-triangle candidates.
    pub vertex_triangle: u32,
    /// Capacity for edge-edge candidates.
    pub edge_edge: u32,
    /// Distance of boxes beyond which the exact distance is not computed, m.
    pub reach: f32,
    /// Separation that moving features keep, m.
    pub separation: f32,
    /// Capacity for contacts.
    pub contacts: u32,
}

/// Capacities, in elements. They grow to the counted sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacities {
    /// Levels with cells that are run.
    pub levels: usize,
    /// Entries of triangles in cells, for one level.
    pub entries: usize,
    /// Tiles of comparisons of these entries.
    pub tiles: usize,
    /// Rounds of [`ROUND`] triangles of the last level.
    pub rounds: usize,
    /// Pairs of triangles.
    pub pairs: usize,
    /// Vertex-triangle candidates.
    pub vertex_triangle: usize,
    /// Edge-edge candidates.
    pub edge_edge: usize,
    /// Contacts of both kinds.
    pub contacts: usize,
}

impl Params {
    /// The same parameters with these capacities.
    pub fn with_room(self, capacities: &Capacities) -> Self {
        let Capacities { entries, tiles, pairs, vertex_triangle, edge_edge, contacts, .. } = *capacities;
        Self {
            entries: entries as u32,
            tiles: tiles as u32,
            pairs: pairs as u32,
            vertex_triangle: vertex_triangle as u32,
            edge_edge: edge_edge as u32,
            contacts: contacts as u32,
            ..self
        }
    }
}

/// Entries on each side of a tile.
pub const SIDE: usize = 64;

/// Triangles of the last level that are compared with all others in one round.
pub const ROUND: usize = 64;

/// Numbers that one workgroup scans.
pub const SCAN_BLOCK: usize = 2048;

/// Number of words of the counters.
pub const COUNTER_WORDS: usize = 64;

/// Indices of the counters, as in `shared/counters.wgsl`.
pub mod counters {
    /// Bits that say which capacities were too small.
    pub const STATUS: usize = 0;
    /// Number of levels with cells.
    pub const GRADED: usize = 1;
    /// Number of triangles of the last level, which has no cells.
    pub const SINGLE: usize = 2;
    /// Box around all triangles in levels with cells.
    pub const SCENE: usize = 11;
    /// Number of entries of the level with cells that ran last.
    pub const ENTRIES: usize = 17;
    /// Number of pairs of triangles.
    pub const PAIRS: usize = 18;
    /// Number of vertex-triangle candidates.
    pub const VERTEX_TRIANGLE: usize = 19;
    /// Number of edge-edge candidates.
    pub const EDGE_EDGE: usize = 20;
    /// Largest number of entries of any level.
    pub const MOST_ENTRIES: usize = 34;
    /// Number of vertex-triangle contacts, then of edge-edge contacts.
    pub const CONTACTS: usize = 35;
    /// Number of tiles of the level with cells that ran last.
    pub const TILES: usize = 37;
    /// Largest number of tiles of any level.
    pub const MOST_TILES: usize = 38;
}

/// The counters before the first stage: all counts are 0, and the box of the scene is empty.
pub fn initial_counters() -> [u32; COUNTER_WORDS] {
    let mut words = [0; COUNTER_WORDS];
    words[counters::SCENE..counters::SCENE + 3].fill(u32::MAX);
    words
}
