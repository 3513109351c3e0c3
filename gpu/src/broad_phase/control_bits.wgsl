// The control bits of an object. Bits 0 to 10 decide which common cell tests a pair; bits 11 to 13 say on which
// side of the home cell the phantom cells are, per axis.

const MASK: u32 = 0xffu;
const HOME_SHIFT: u32 = 8u;
const UPWARD_SHIFT: u32 = 11u;

// The type of an object's home cell.
fn home(control: u32) -> u32 {
    return (control >> HOME_SHIFT) & 7u;
}

// Whether the cell of type `cell` leaves the pair to another common cell.
fn skips(a: u32, b: u32, cell: u32) -> bool {
    let homes = (1u << home(a)) | (1u << home(b));
    return (a & b & homes & ((1u << cell) - 1u)) != 0u;
}
