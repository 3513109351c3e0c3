//! The system matrix of implicit methods: 3x3 blocks in rows (CSR), one row a vertex.
//!
//! The matrix is symmetric and streaming it is what a product costs, so only the diagonal and the
//! blocks right of it are stored; a row finds those left of it in the rows above. Rows are
//! written whole, so that threads never share one.

use crate::dispatch::{Dispatch, Split};
use crate::real::{Lanes, Mat3, Real, Vec3, lanes};

/// Blocks of `-(g^2 Kx + g Kv)`, borrowed. The mass is not in it.
#[derive(Debug, Default)]
pub struct BlockMatrix<'a> {
    /// Start of each row; one more than there are rows.
    pub offsets: &'a [u32],
    /// Column of each block: the row's own first, then larger ones.
    pub columns: &'a [u32],
    /// Start of each row's entries in `mirrored`.
    pub mirrored_offsets: &'a [u32],
    /// The blocks left of the diagonal: where their mirror images are.
    pub mirrored: &'a [Mirrored],
    /// The blocks.
    pub blocks: &'a mut [Block],
}

/// A 3x3 block by columns, each padded with a zero.
pub type Block = [Lanes; 3];

/// Adds a matrix to a block.
#[inline]
pub fn add(block: &mut Block, matrix: &Mat3) {
    for (column, part) in block.iter_mut().zip([matrix.x_axis, matrix.y_axis, matrix.z_axis]) {
        *column += lanes(part);
    }
}

/// A block without its padding.
#[inline]
pub fn to_mat3(block: &Block) -> Mat3 {
    let [x, y, z] = block.map(to_vec3);
    Mat3::from_cols(x, y, z)
}

#[inline(always)]
fn to_vec3(lanes: Lanes) -> Vec3 {
    let [x, y, z, _] = lanes.to_array();
    Vec3::new(x, y, z)
}

/// A block left of the diagonal.
#[derive(Clone, Copy, Debug)]
pub struct Mirrored {
    /// Its column, and the row that stores it.
    pub column: u32,
    /// Index of the block whose transpose it is.
    pub block: u32,
}

/// In [`AssemblyMap`]: the block lies left of the diagonal and is not stored.
pub const NOT_STORED: u16 = u16::MAX;

/// For each force term, where in its row the block of each neighbour goes.
#[derive(Clone, Copy, Debug, Default)]
pub struct AssemblyMap<'a> {
    /// One for each stored spring end.
    pub stretch_springs: &'a [u16],
    /// One for each stored spring end.
    pub bend_springs: &'a [u16],
    /// Three for each triangle corner in the order of the incidence.
    pub membrane: &'a [u16],
    /// Four for each hinge corner in the order of the incidence.
    pub hinges: &'a [u16],
    /// Three for each stitch corner in the order of the incidence.
    pub seams: &'a [u16],
    /// Three for each triangle corner in the order of the incidence.
    pub wind: &'a [u16],
}

/// A part of the rows, to write.
pub struct RowsMut<'a> {
    offsets: &'a [u32],
    blocks: &'a mut [Block],
}

impl RowsMut<'_> {
    /// Rows in this part.
    pub fn count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The blocks of a row, counted from the part's first.
    #[inline]
    pub fn row(&mut self, i: usize) -> &mut [Block] {
        let first = self.offsets[0];
        &mut self.blocks[(self.offsets[i] - first) as usize..(self.offsets[i + 1] - first) as usize]
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
        let (low, high) = self.blocks.split_at_mut((self.offsets[mid] - self.offsets[0]) as usize);
        (Self { offsets: &self.offsets[..=mid], blocks: low }, Self { offsets: &self.offsets[mid..], blocks: high })
    }
}

impl BlockMatrix<'_> {
    /// All rows, to write.
    pub fn rows_mut(&mut self) -> RowsMut<'_> {
        RowsMut { offsets: self.offsets, blocks: self.blocks }
    }

    /// Rows, one a vertex.
    pub fn rows(&self) -> usize {
        self.offsets.len() - 1
    }
}

/// `out = (mass_factor M + S) p`.
pub fn multiply(
    matrix: &BlockMatrix<'_>,
    masses: &[Real],
    mass_factor: Real,
    p: &[Vec3],
    out: &mut [Vec3],
    dispatch: &impl Dispatch,
) {
    let (offsets, columns, blocks) = (matrix.offsets, matrix.columns, &*matrix.blocks);
    dispatch.run(out, |start, part| {
        for (i, out) in (start..).zip(part) {
            let left = matrix.mirrored_offsets[i] as usize..matrix.mirrored_offsets[i + 1] as usize;
            let mut within = Block::default();
            for entry in &matrix.mirrored[left] {
                let (block, p) = (&blocks[entry.block as usize], lanes(p[entry.column as usize]));
                for column in 0..3 {
                    within[column] += block[column] * p;
                }
            }
            let row = offsets[i] as usize..offsets[i + 1] as usize;
            let mut over = Block::default();
            for (block, &column) in blocks[row.clone()].iter().zip(&columns[row]) {
                let p = p[column as usize];
                over[0] += block[0] * Lanes::splat(p.x);
                over[1] += block[1] * Lanes::splat(p.y);
                over[2] += block[2] * Lanes::splat(p.z);
            }
            // What is mirrored sums within its columns, what is stored over them.
            let [x, y, z] = within.map(to_vec3).map(|v| v.x + v.y + v.z);
            *out = p[i] * (mass_factor * masses[i]) + to_vec3(over[0] + over[1] + over[2]) + Vec3::new(x, y, z);
        }
    });
}
