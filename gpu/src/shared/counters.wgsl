// Words of the counters: what stages tell later ones, and the host.

// Bits of what did not fit.
const STATUS: u32 = 0u;
const GRADED: u32 = 1u;
// Triangles of the last level.
const SINGLE: u32 = 2u;
// The greatest extent in each level, as bits.
const EXTENTS: u32 = 3u;
// Around all boxes in levels with cells, as ordered bits: three least, three greatest.
const SCENE: u32 = 11u;
const ENTRIES: u32 = 17u;
const PAIRS: u32 = 18u;
const VERTEX_TRIANGLE: u32 = 19u;
const EDGE_EDGE: u32 = 20u;
// From metres to units: three coordinates and the scale, as bits.
const QUANTIZATION: u32 = 21u;
// Of the spheres: how many, the greatest square of a diagonal, the last centre on each axis.
const SPHERES: u32 = 25u;
// The edge of a cell, then the bits of a key for each axis.
const CELL_GRID: u32 = 30u;
// The most entries of any level.
const MOST_ENTRIES: u32 = 34u;
// Contacts: vertices with triangles, and edges.
const CONTACTS: u32 = 35u;
// Tiles of the level, and the most of any.
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

// What tiles are counted without.
const NO_ROOM_BEFORE_TILES: u32 = 3u;
// What pairs are counted without.
const NO_ROOM_BEFORE_PAIRS: u32 = 15u;
// And found without.
const NO_ROOM_FOR_PAIRS: u32 = 31u;

// A sum that does not wrap: what is too much for a word has no room either.
fn saturated(a: u32, b: u32) -> u32 {
    return a + min(b, ~a);
}

const NO_LEVEL: u32 = 255u;
