//! The home cell of every sphere, and the control bits that encode which cells the sphere touches.
//!
//! Cell indices wrap around with an even period of at least four, so that keys stay short. Cells with the same key
//! are too far apart for one box to overlap objects of both, so wrapping neither loses nor repeats a pair.

use bytemuck::{Pod, Zeroable};

use super::control_bits::HOME_SHIFT;
use super::spheres::Sphere;
use crate::column::Column;
use crate::dispatch::Dispatch;

/// Bit in [`Home::control`]: shifted left by an axis, the phantom cells lie on the greater side of the home cell.
pub const UPWARD: u32 = 1 << (HOME_SHIFT + 3);

/// The home cell and the control bits of an object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Home {
    /// The key of its home cell.
    pub key: u32,
    /// [Control bits](super::control_bits), then [`UPWARD`]; zero for an absent object.
    pub control: u32,
}

/// The size of the cells and the layout of their keys.
#[derive(Clone, Copy, Debug)]
pub struct CellGrid {
    /// Edge of a cell in half units.
    pub size: i32,
    /// Number of bits of the key for each axis.
    pub bits: [u32; 3],
}

impl CellGrid {
    /// The grid for spheres: cells measure at least `2 R + sqrt(2) R`, and there are about as many keys as objects.
    pub fn new(spheres: &[Sphere]) -> Self {
        let (mut count, mut diagonal_squared, mut last) = (0u32, 0, [0; 3]);
        for sphere in spheres.iter().filter(|&s| *s != Sphere::ABSENT) {
            count += 1;
            diagonal_squared = sphere.diagonal_squared.max(diagonal_squared);
            for (last, center) in last.iter_mut().zip(sphere.center) {
                *last = center.max(*last);
            }
        }
        let least = 2 * root_above(diagonal_squared) + root_above(2 * diagonal_squared) + 1;
        let size = least as i32;
        let mut bits = last.map(|last| {
            let cells = last.checked_div(size).unwrap_or(0) + 1;
            (i32::BITS - cells.leading_zeros()).max(2)
        });
        let most = (u32::BITS - count.leading_zeros() + 1).max(6);
        while bits[0] + bits[1] + bits[2] > most {
            if let Some(longest) = bits.iter_mut().max_by_key(|bits| **bits) {
                *longest -= 1;
            }
        }
        Self { size, bits }
    }

    /// Number of bits of a key.
    pub fn key_bits(&self) -> u32 {
        self.bits[0] + self.bits[1] + self.bits[2]
    }

    /// Bit at which each axis starts in a key.
    #[inline]
    pub fn shifts(&self) -> [u32; 3] {
        [0, self.bits[0], self.bits[0] + self.bits[1]]
    }

    /// The type of a cell: the parities of its indices, one bit per axis.
    #[inline]
    pub fn cell_type(&self, key: u32) -> u32 {
        let [x, y, z] = self.shifts().map(|shift| key >> shift & 1);
        x | y << 1 | z << 2
    }
}

/// The smallest integer whose square is at least `n`.
fn root_above(n: u32) -> u32 {
    n.isqrt() + u32::from(n.isqrt() * n.isqrt() < n)
}

/// Writes the home cell and the control bits of every sphere.
pub fn write_cells(spheres: &[Sphere], grid: &CellGrid, homes: &mut [Home], dispatch: &impl Dispatch) {
    dispatch.run(homes, |start, part| {
        for (sphere, home) in spheres.part(start..).iter().zip(part) {
            *home = home_of(sphere, grid);
        }
    });
}

#[inline]
fn home_of(sphere: &Sphere, grid: &CellGrid) -> Home {
    if *sphere == Sphere::ABSENT {
        return Home::default();
    }
    let (size, shifts, cover_squared) = (grid.size, grid.shifts(), 2 * sphere.diagonal_squared);
    let (mut key, mut parity, mut upward) = (0, 0, 0);
    let mut gaps_squared = [0; 3];
    for (k, center) in sphere.center.into_iter().enumerate() {
        let cell = center.checked_div(size).unwrap_or(0);
        let below = center - cell * size;
        let above = size - below;
        key |= (cell as u32 & ((1 << grid.bits.at(k)) - 1)) << shifts.at(k);
        parity |= (cell as u32 & 1) << k;
        upward |= u32::from(above < below) << k;
        let gap = above.min(below).min(1 << 14) as u32;
        gaps_squared.set(k, gap * gap);
    }
    let mut mask = 0;
    for across in 0..8 {
        let gap_squared: u32 = (0..3).map(|k| if across >> k & 1 == 1 { gaps_squared.at(k) } else { 0 }).sum();
        mask |= u32::from(gap_squared <= cover_squared) << (parity ^ across);
    }
    Home { key, control: mask | (parity << HOME_SHIFT) | (upward * UPWARD) }
}
