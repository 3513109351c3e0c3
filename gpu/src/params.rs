//! What stages are told, and the words that they leave in the plan.

use bytemuck::{Pod, Zeroable};

/// `struct Params` of `shared/params.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Params {
    /// Vertices.
    pub vertices: u32,
    /// Triangles.
    pub triangles: u32,
    /// The first passive triangle.
    pub first_passive: u32,
    /// 1: those before pair with one another.
    pub own_contact: u32,
    /// 1: some vertices are sewn.
    pub sewn: u32,
    /// The level; of pairs with the last level the round, of the division how many levels are run.
    pub level: u32,
    /// Of the sort: the lowest bit of a pass.
    pub shift: u32,
    /// Of the scan: how many numbers; of the division: of the last level how many triangles are compared.
    pub length: u32,
    /// Room for entries.
    pub entries: u32,
    /// Room for tiles.
    pub tiles: u32,
    /// Room for pairs of triangles.
    pub pairs: u32,
    /// Room for vertices with triangles.
    pub vertex_triangle: u32,
    /// Room for edges with edges.
    pub edge_edge: u32,
    /// m; further apart the boxes' distance will do.
    pub reach: f32,
    /// m that moving features keep.
    pub separation: f32,
    /// Room for contacts.
    pub contacts: u32,
}

/// Room, in things; grown to what was counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacities {
    /// Levels with cells.
    pub levels: usize,
    /// Entries of triangles in cells, in one level.
    pub entries: usize,
    /// Tiles of comparisons of these.
    pub tiles: usize,
    /// Rounds of as many triangles of the last level as [`ROUND`].
    pub rounds: usize,
    /// Pairs of triangles.
    pub pairs: usize,
    /// Vertices with triangles.
    pub vertex_triangle: usize,
    /// Edges with edges.
    pub edge_edge: usize,
    /// Contacts of both kinds.
    pub contacts: usize,
}

impl Params {
    /// The same with this room.
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

/// Entries on either side of a tile.
pub const SIDE: usize = 64;

/// Triangles of the last level that are compared with all others in one round.
pub const ROUND: usize = 64;

/// Numbers that a group scans.
pub const SCAN_BLOCK: usize = 2048;

/// Words of the plan.
pub const COUNTER_WORDS: usize = 64;

/// Places in the plan, as in `shared/counters.wgsl`.
pub mod counters {
    /// What did not fit.
    pub const STATUS: usize = 0;
    /// Levels with cells.
    pub const GRADED: usize = 1;
    /// Triangles of the last level.
    pub const SINGLE: usize = 2;
    /// Around all boxes.
    pub const SCENE: usize = 11;
    /// Entries of the last level that was run.
    pub const ENTRIES: usize = 17;
    /// Pairs of triangles.
    pub const PAIRS: usize = 18;
    /// Candidates.
    pub const VERTEX_TRIANGLE: usize = 19;
    /// Candidates.
    pub const EDGE_EDGE: usize = 20;
    /// The most entries of any level.
    pub const MOST_ENTRIES: usize = 34;
    /// Contacts: vertices with triangles, and edges.
    pub const CONTACTS: usize = 35;
    /// Tiles of the last level that was run.
    pub const TILES: usize = 37;
    /// The most tiles of any level.
    pub const MOST_TILES: usize = 38;
}

/// The plan before the first stage: no box is around anything.
pub fn initial_counters() -> [u32; COUNTER_WORDS] {
    let mut words = [0; COUNTER_WORDS];
    words[counters::SCENE..counters::SCENE + 3].fill(u32::MAX);
    words
}
