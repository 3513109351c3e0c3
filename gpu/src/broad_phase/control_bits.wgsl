// Eleven bits that decide which of their common cells tests a pair, and where phantoms are.

const MASK: u32 = 0xffu;
const HOME_SHIFT: u32 = 8u;
const UPWARD_SHIFT: u32 = 11u;

// The type of an object's home.
fn home(control: u32) -> u32 {
    return (control >> HOME_SHIFT) & 7u;
}

// Whether the cell of a type leaves a pair to another cell.
fn skips(a: u32, b: u32, cell: u32) -> bool {
    let homes = (1u << home(a)) | (1u << home(b));
    return (a & b & homes & ((1u << cell) - 1u)) != 0u;
}
