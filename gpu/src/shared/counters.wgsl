// Indices and bits of the counters, which stages write for later stages and for the host.

// Bits that say which capacities were too small.
const STATUS: u32 = 0u;
const GRADED: u32 = 1u;
// Number of triangles of the last level, which has no cells.
const SINGLE: u32 = 2u;
// The largest extent in each level, as bits.
const EXTENTS: u32 = 3u;
// The box around all triangles in levels with cells, as ordered bits: the minimum, then the maximum.
const SCENE: u32 = 11u;
const ENTRIES: u32 = 17u;
const PAIRS: u32 = 18u;
const VERTEX_TRIANGLE: u32 = 19u;
const EDGE_EDGE: u32 = 20u;
// The conversion from metres to units: the three coordinates of the origin and the scale, as bits.
const QUANTIZATION: u32 = 21u;
// The spheres: their number, the largest squared diagonal, the largest coordinate of a centre on each axis.
const SPHERES: u32 = 25u;
// The edge length of a cell, then the bits of a key for each axis.
const CELL_GRID: u32 = 30u;
// The largest number of entries of any level.
const MOST_ENTRIES: u32 = 34u;
// Number of vertex-triangle contacts, then of edge-edge contacts.
const CONTACTS: u32 = 35u;
// Number of tiles of this level, and the largest number of any level.
const TILES: u32 = 37u;
const MOST_TILES: u32 = 38u;

const NO_ROOM_LEVELS: u32 = 1u;
const NO_ROOM_ENTRIES: u32 = 2u;
const NO_ROOM_TILES: u32 = 4u;
const NO_ROOM_ROUNDS: u32 = 8u;
const NO_ROOM_PAIRS: u32 = 16u;
const NO_ROOM_VERTEX_TRIANGLE: u32 = 32u;
const NO_ROOM_EDGE_EDGE: u32 = 64u;
const NO_ROOM_CONTACTS: u32 = 128u;

// If one of these bits is set, tiles are not counted.
const NO_ROOM_BEFORE_TILES: u32 = 3u;
// If one of these bits is set, pairs are not counted.
const NO_ROOM_BEFORE_PAIRS: u32 = 15u;
// If one of these bits is set, pairs are neither written nor used.
const NO_ROOM_FOR_PAIRS: u32 = 31u;

// A sum that saturates instead of wrapping: a count that overflows a word exceeds every capacity anyway.
fn saturated(a: u32, b: u32) -> u32 {
    return a + min(b, ~a);
}

const NO_LEVEL: u32 = 255u;
