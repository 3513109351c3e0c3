// The bits of an entry: what it is of, and which triangle.

const IS_HOME: u32 = 0x80000000u;
const IS_OWN: u32 = 0x40000000u;
const ID: u32 = 0x3fffffffu;

// Both bits as a number; a smaller phantom is 0.
const OWN_HOME: u32 = 3u;
const SMALLER_HOME: u32 = 2u;
const OWN_PHANTOM: u32 = 1u;

fn kind_of(object: u32) -> u32 {
    return object >> 30u;
}

// Entries on either side of a tile of comparisons.
const SIDE: u32 = 64u;
