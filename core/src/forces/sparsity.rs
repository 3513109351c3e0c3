//! The sparsity pattern of the system matrix, and the slot in it of each term's blocks.

use alloc::vec::Vec;

use super::matrix::{AssemblyMap, Mirrored, NOT_STORED};
use super::term::ForceTerm;
use super::{Model, Term, for_each_term};

/// The blocks that the matrix of a model has, and the slot of each term's blocks in them.
#[derive(Clone, Debug, Default)]
pub struct SparsityPattern {
    /// Start of each row in `columns`; one entry more than rows.
    pub offsets: Vec<u32>,
    /// Column of each block: in each row the diagonal first, then the larger columns in ascending order.
    pub columns: Vec<u32>,
    /// Start of each row's entries in `mirrored`; one entry more than rows.
    pub mirrored_offsets: Vec<u32>,
    /// The blocks left of the diagonal, in ascending order of their columns.
    pub mirrored: Vec<Mirrored>,
    slots: [Vec<u16>; Term::ALL.len()],
}

impl SparsityPattern {
    /// The pattern of a model over `vertices` vertices.
    #[cfg_attr(small, optimize(size))]
    pub fn build(vertices: usize, model: &Model<'_>) -> Self {
        let mut blocks: [Vec<(u32, u32)>; Term::ALL.len()] = Default::default();
        for_each_term!(model, |name, term| blocks[name as usize] = term.blocks().collect());
        let mut pairs: Vec<_> = blocks.iter().flatten().copied().filter(|(row, column)| row != column).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut pattern = Self::rows(vertices, &pairs);
        pattern.slots = blocks.map(|blocks| blocks.iter().map(|&(row, column)| pattern.slot(row, column)).collect());
        pattern
    }

    /// Every stored block off the diagonal, as (row, column).
    pub fn pairs(&self) -> impl Iterator<Item = (u32, u32)> {
        let row = |row: usize| {
            let columns = &self.columns[self.offsets[row] as usize + 1..self.offsets[row + 1] as usize];
            columns.iter().map(move |&column| (row as u32, column))
        };
        (0..self.offsets.len().saturating_sub(1)).flat_map(row)
    }

    /// The assembly map, borrowed.
    pub fn assembly_map(&self) -> AssemblyMap<'_> {
        self.slots.each_ref().map(Vec::as_slice)
    }

    /// Bytes of the columns.
    pub fn bytes(&self) -> usize {
        4 * (self.offsets.len() + self.columns.len() + self.mirrored_offsets.len())
            + 8 * self.mirrored.len()
            + 2 * self.slots.iter().map(Vec::len).sum::<usize>()
    }

    /// The pattern of pairs `(row, column)`. Pairs are in ascending order, and each is given in both
    /// directions.
    fn rows(vertices: usize, pairs: &[(u32, u32)]) -> Self {
        let mut pattern = Self { offsets: alloc::vec![0], mirrored_offsets: alloc::vec![0], ..Self::default() };
        let mut rest = pairs;
        for vertex in 0..vertices as u32 {
            let count = rest.iter().take_while(|pair| pair.0 == vertex).count();
            let (row, after) = rest.split_at(count);
            let (left, right) = row.split_at(row.partition_point(|pair| pair.1 < vertex));
            pattern.columns.push(vertex);
            pattern.columns.extend(right.iter().map(|pair| pair.1));
            pattern.offsets.push(pattern.columns.len() as u32);
            for &(_, column) in left {
                let block = pattern.offsets[column as usize] + u32::from(pattern.slot(column, vertex));
                pattern.mirrored.push(Mirrored { column, block });
            }
            pattern.mirrored_offsets.push(pattern.mirrored.len() as u32);
            rest = after;
        }
        pattern
    }

    /// Place of a column in a row, [`NOT_STORED`] left of the diagonal. It fits into 16 bits, because
    /// a mesh with too many triangles at one vertex is refused.
    fn slot(&self, row: u32, column: u32) -> u16 {
        let columns = &self.columns[self.offsets[row as usize] as usize..self.offsets[row as usize + 1] as usize];
        columns.binary_search(&column).map_or(NOT_STORED, |at| at as u16)
    }
}
