// The bits of an entry's object: its kind and the triangle.

const IS_HOME: u32 = 0x80000000u;
const IS_OWN: u32 = 0x40000000u;
const ID: u32 = 0x3fffffffu;

// The kinds: both bits as a number. A smaller phantom is 0.
const OWN_HOME: u32 = 3u;
const SMALLER_HOME: u32 = 2u;
const OWN_PHANTOM: u32 = 1u;

fn kind_of(object: u32) -> u32 {
    return object >> 30u;
}

// Entries on each side of a tile of comparisons.
const SIDE: u32 = 64u;
