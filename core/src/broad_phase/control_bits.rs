//! Control bits: eleven bits per object that decide, from the two objects alone, which of their common cells tests
//! the pair [Le Grand 2007].
//!
//! The type of a cell is given by the parities of its three indices. The home cell of an object is the cell of its
//! centre; its phantom cells are the other cells within sqrt(2) radii of the centre. Bits 0..8 are the types of all
//! its cells, and bits 8..11 are the type of its home cell. A cell tests two objects if it is the home cell of at
//! least one of them, unless one of them has its home in a common cell of lower type.
//!
//! If cells measure at least `2 R + sqrt(2) R`, a pair whose spheres overlap is tested exactly once:
//! (i) At least one of the two home cells is a cell of the other object. If neither were, the centres would be
//! farther apart than `sqrt(2 a^2 + 2 b^2) >= a + b`.
//! (ii) A type identifies one cell, because the next cell of the same type is out of reach.
//! (iii) If both home cells are common cells, only the one of lower type tests the pair.

/// Mask of the types of all cells of the object, including its home cell.
pub const MASK: u32 = 0xff;
/// Bit at which the type of the home cell starts.
pub const HOME_SHIFT: u32 = 8;

/// The type of an object's home cell.
#[inline]
pub fn home(control: u32) -> u32 {
    control >> HOME_SHIFT & 7
}

/// Whether the cell of type `cell` leaves the pair to another cell.
#[inline]
pub fn skips(a: u32, b: u32, cell: u32) -> bool {
    let homes = 1 << home(a) | 1 << home(b);
    a & b & homes & ((1 << cell) - 1) != 0
}
