//! Eleven bits that decide, without looking elsewhere, which of their common cells tests a pair
//! [Le Grand 2007].
//!
//! A cell's type is the parities of its three indices. An object's home is the cell of its centre,
//! its other cells are phantoms: those within sqrt(2) radii of the centre. Bits 0..8: the types of
//! all its cells; bits 8..11: the type of its home. A cell with the home of at least one of two
//! objects tests them, unless an object has its home in a common cell of lower type.
//!
//! With cells of at least `2 R + sqrt(2) R` a pair whose spheres overlap is tested exactly once:
//! (i) of two homes at least one is covered by the other object, for with both out of reach the
//! centres would be farther apart than `sqrt(2 a^2 + 2 b^2) >= a + b`; (ii) a type names one cell,
//! for the next of the same type is out of reach; (iii) of two common homes the lower type tests.

/// The mask of cell types, with the home's.
pub const MASK: u32 = 0xff;
/// Where the type of the home starts.
pub const HOME_SHIFT: u32 = 8;

/// The type of an object's home.
#[inline]
pub fn home(control: u32) -> u32 {
    control >> HOME_SHIFT & 7
}

/// Whether the cell of type `cell` leaves a pair to another cell.
#[inline]
pub fn skips(a: u32, b: u32, cell: u32) -> bool {
    let homes = 1 << home(a) | 1 << home(b);
    a & b & homes & ((1 << cell) - 1) != 0
}
