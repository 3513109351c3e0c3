//! The system matrix of implicit methods: 3x3 blocks in rows (CSR), one row per vertex.
//!
//! The matrix is symmetric, and a product costs about as much as reading the matrix from memory.
//! Therefore only the diagonal and the blocks right of it are stored; a product finds the blocks left
//! of the diagonal in the rows above. Each row is written by a single thread.

use super::Term;
use crate::column::{Column, fault};
use crate::dispatch::{Dispatch, Split};
use crate::real::{Lanes, Mat3, Real, Vec3, lanes};

/// Blocks of `-(g^2 Kx + g Kv)`, borrowed. The mass matrix is not included.
#[derive(Debug, Default)]
pub struct BlockMatrix<'a> {
    /// Start of each row in `columns` and `blocks`; one entry more than rows.
    pub offsets: &'a [u32],
    /// Column of each block: in each row the diagonal first, then the larger columns.
    pub columns: &'a [u32],
    /// Start of each row's entries in `mirrored`; one entry more than rows.
    pub mirrored_offsets: &'a [u32],
    /// The blocks left of the diagonal, as references to their stored mirror images.
    pub mirrored: &'a [Mirrored],
    /// The blocks.
    pub blocks: &'a mut [Block],
}

impl BlockMatrix<'_> {
    /// The columns of a row's blocks, stored or mirrored.
    pub fn columns_of(&self, row: usize) -> impl Iterator<Item = u32> {
        let range = |offsets: &[u32]| offsets.at(row) as usize..offsets.at(row + 1) as usize;
        let mirrored = self.mirrored.part(range(self.mirrored_offsets));
        let stored = self.columns.part(range(self.offsets));
        stored.iter().copied().chain(mirrored.iter().map(|mirrored| mirrored.column))
    }
}

/// A 3x3 block by columns, each padded with one zero.
pub type Block = [Lanes; 3];

/// Adds a matrix to a block.
#[inline]
pub fn add(block: &mut Block, matrix: &Mat3) {
    for (column, part) in block.iter_mut().zip([matrix.x_axis, matrix.y_axis, matrix.z_axis]) {
        *column += lanes(part);
    }
}

/// A block as a matrix, without the padding.
#[inline]
pub fn to_mat3(block: &Block) -> Mat3 {
    let [x, y, z] = block.map(to_vec3);
    Mat3::from_cols(x, y, z)
}

/// The first three lanes.
#[inline(always)]
pub fn to_vec3(lanes: Lanes) -> Vec3 {
    let [x, y, z, _] = lanes.to_array();
    Vec3::new(x, y, z)
}

/// A block left of the diagonal.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Mirrored {
    /// Its column, which is also the row that stores its mirror image.
    pub column: u32,
    /// Index of the stored block, whose transpose it is.
    pub block: u32,
}

/// In [`AssemblyMap`]: the block is left of the diagonal and not stored.
pub const NOT_STORED: u16 = u16::MAX;

/// For each force term, in the order of [`Term::ALL`], the place of each of its
/// [blocks](super::term::ForceTerm::blocks) in the row of the matrix, or [`NOT_STORED`]. A term that a model does not
/// have needs none.
pub type AssemblyMap<'a> = [&'a [u16]; Term::ALL.len()];

/// A mutable range of rows.
pub struct RowsMut<'a> {
    offsets: &'a [u32],
    blocks: &'a mut [Block],
}

impl RowsMut<'_> {
    /// Number of rows in this part.
    pub fn count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// The blocks of a row. Rows count from the first of this part.
    #[inline]
    pub fn row(&mut self, i: usize) -> &mut [Block] {
        let first = self.offsets.at(0);
        self.blocks.part_mut((self.offsets.at(i) - first) as usize..(self.offsets.at(i + 1) - first) as usize)
    }

    /// Sets all blocks to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(Block::default());
    }
}

impl Split for RowsMut<'_> {
    fn len(&self) -> usize {
        self.count()
    }
    fn split_at(self, mid: usize) -> (Self, Self) {
        let (low, high) = self.blocks.cut_mut((self.offsets.at(mid) - self.offsets.at(0)) as usize);
        let offsets = self.offsets;
        (Self { offsets: offsets.part(..=mid), blocks: low }, Self { offsets: offsets.part(mid..), blocks: high })
    }
}

impl BlockMatrix<'_> {
    /// All rows, mutable.
    pub fn rows_mut(&mut self) -> RowsMut<'_> {
        RowsMut { offsets: self.offsets, blocks: self.blocks }
    }

    /// Number of rows, one per vertex.
    pub fn rows(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }
}

/// `out = (mass_factor M + S) p`, where S is the matrix.
pub fn multiply(
    matrix: &BlockMatrix<'_>,
    masses: &[Real],
    mass_factor: Real,
    p: &[Vec3],
    out: &mut [Vec3],
    dispatch: &impl Dispatch,
) {
    dispatch.run(out, |start, part| multiply_rows(matrix, masses, mass_factor, p, start, part));
}

/// The entries of a row in a column that `offsets` divides into rows. `None` if an index is out of range.
#[inline(always)]
fn row_of<'a, T>(offsets: &[u32], row: usize, column: &'a [T]) -> Option<&'a [T]> {
    let &[first, end] = offsets.get(row..row + 2)? else { return None };
    column.get(first as usize..end as usize)
}

/// Some rows of the [product](multiply); `start` is the first.
pub fn multiply_rows(
    matrix: &BlockMatrix<'_>,
    masses: &[Real],
    mass_factor: Real,
    p: &[Vec3],
    start: usize,
    out: &mut [Vec3],
) {
    let blocks = &*matrix.blocks;
    let rows = out.iter_mut().zip(p.part(start..)).zip(masses.part(start..));
    for (i, ((out, own), mass)) in (start..).zip(rows) {
        let Some(mirrored) = row_of(matrix.mirrored_offsets, i, matrix.mirrored) else { return fault() };
        let Some(columns) = row_of(matrix.offsets, i, matrix.columns) else { return fault() };
        let Some(stored) = row_of(matrix.offsets, i, blocks) else { return fault() };
        let mut within = Block::default();
        for entry in mirrored {
            let Some(block) = blocks.element(entry.block as usize) else { return };
            let Some(&p) = p.element(entry.column as usize) else { return };
            for (within, column) in within.iter_mut().zip(block) {
                *within += *column * lanes(p);
            }
        }
        let mut over = Block::default();
        for (block, &column) in stored.iter().zip(columns) {
            let Some(p) = p.element(column as usize) else { return };
            over[0] += block[0] * Lanes::splat(p.x);
            over[1] += block[1] * Lanes::splat(p.y);
            over[2] += block[2] * Lanes::splat(p.z);
        }
        // Transposed blocks give one component per column, summed over the lanes. Stored blocks give a
        // sum over the columns.
        let [x, y, z] = within.map(to_vec3).map(|v| v.x + v.y + v.z);
        *out = *own * (mass_factor * mass) + to_vec3(over[0] + over[1] + over[2]) + Vec3::new(x, y, z);
    }
}
