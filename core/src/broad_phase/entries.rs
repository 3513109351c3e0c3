//! The entries of the grid: one for each cell that an object touches, written once all control bits are known.
//!
//! Home entries come before phantom entries, and the level's own objects before smaller ones. The sort is stable,
//! so every cell lists its entries in this order: own homes, smaller homes, own phantoms, smaller phantoms.

use bytemuck::{Pod, Zeroable};

use super::cells::{CellGrid, Home, UPWARD};
use super::control_bits;
use crate::column::Column;

/// Flag in [`Entry::object`]: the cell is the object's home cell.
pub const IS_HOME: u32 = 1 << 31;
/// Flag in [`Entry::object`]: the object is on this level, not on a level of smaller ones.
pub const IS_OWN: u32 = 1 << 30;

/// An object in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Entry {
    /// The key of the cell.
    pub key: u32,
    /// The index of the object, with the flags [`IS_HOME`] and [`IS_OWN`].
    pub object: u32,
}

impl Entry {
    /// The index of the object.
    #[inline]
    pub fn id(&self) -> u32 {
        self.object & !(IS_HOME | IS_OWN)
    }
}

/// Writes the entries of all objects, at most eight per object, and returns their number.
pub fn write_entries(homes: &[Home], levels: &[u8], level: u8, grid: &CellGrid, entries: &mut [Entry]) -> usize {
    let (shifts, mut end) = (grid.shifts(), 0);
    let fields: [u32; 3] = core::array::from_fn(|k| ((1 << grid.bits.at(k)) - 1) << shifts.at(k));
    let mut push = |key, object| {
        entries.set(end, Entry { key, object });
        end += 1;
    };
    for own in [IS_OWN, 0] {
        for (id, home) in present(homes, levels, level, own) {
            push(home.key, id | own | IS_HOME);
        }
    }
    for own in [IS_OWN, 0] {
        for (id, home) in present(homes, levels, level, own) {
            let parity = control_bits::home(home.control);
            let mut phantoms = home.control & control_bits::MASK & !(1 << parity);
            while phantoms != 0 {
                let across = phantoms.trailing_zeros() ^ parity;
                phantoms &= phantoms - 1;
                let mut key = home.key;
                for k in 0..3 {
                    if across >> k & 1 == 1 {
                        let one = 1u32 << shifts.at(k);
                        let step = if home.control & UPWARD << k != 0 { one } else { one.wrapping_neg() };
                        key = key & !fields.at(k) | key.wrapping_add(step) & fields.at(k);
                    }
                }
                push(key, id | own);
            }
        }
    }
    end
}

fn present<'a>(homes: &'a [Home], levels: &'a [u8], level: u8, own: u32) -> impl Iterator<Item = (u32, &'a Home)> {
    let belongs = move |own_level: u8| (own_level == level) == (own != 0);
    let objects = (0..).zip(homes.iter().zip(levels));
    objects.filter_map(move |(id, (home, &own_level))| (home.control != 0 && belongs(own_level)).then_some((id, home)))
}
