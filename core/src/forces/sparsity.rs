//! The sparsity pattern of the system matrix, and the slot in it of each term's blocks.

use alloc::vec::Vec;

use super::matrix::{AssemblyMap, Mirrored, NOT_STORED};
use crate::forces::Model;
use crate::forces::element::Element;
use crate::forces::spring::Springs;

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
    stretch_springs: Vec<u16>,
    bend_springs: Vec<u16>,
    membrane: Vec<u16>,
    hinges: Vec<u16>,
    seams: Vec<u16>,
    wind: Vec<u16>,
}

impl SparsityPattern {
    /// The pattern of a model over `vertices` vertices.
    #[cfg_attr(small, optimize(size))]
    pub fn build(vertices: usize, model: &Model<'_>) -> Self {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for springs in [&model.stretch_springs, &model.bend_springs].into_iter().flatten() {
            for vertex in 0..vertices {
                let range = springs.offsets[vertex] as usize..springs.offsets[vertex + 1] as usize;
                pairs.extend(springs.others[range].iter().map(|&other| (vertex as u32, other)));
            }
        }
        element_pairs(&mut pairs, model.membrane.as_ref().map_or(&[], |term| term.vertices));
        element_pairs(&mut pairs, model.hinges.as_ref().map_or(&[], |term| term.vertices));
        element_pairs(&mut pairs, model.seams.as_ref().map_or(&[], |term| term.vertices));
        element_pairs(&mut pairs, model.wind.as_ref().map_or(&[], |term| term.vertices));
        pairs.sort_unstable();
        pairs.dedup();
        let mut pattern = Self::rows(vertices, &pairs);
        let term = |springs: &Option<Springs<'_>>| springs.as_ref().map_or(Vec::new(), |s| pattern.of_springs(s));
        let (stretch_springs, bend_springs) = (term(&model.stretch_springs), term(&model.bend_springs));
        let membrane = model.membrane.as_ref().map_or(Vec::new(), |term| pattern.of_elements(term));
        let hinges = model.hinges.as_ref().map_or(Vec::new(), |term| pattern.of_elements(term));
        let seams = model.seams.as_ref().map_or(Vec::new(), |term| pattern.of_elements(term));
        let wind = model.wind.as_ref().map_or(Vec::new(), |term| pattern.of_elements(term));
        pattern = Self { stretch_springs, bend_springs, membrane, hinges, seams, wind, ..pattern };
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
        AssemblyMap {
            stretch_springs: &self.stretch_springs,
            bend_springs: &self.bend_springs,
            membrane: &self.membrane,
            hinges: &self.hinges,
            seams: &self.seams,
            wind: &self.wind,
        }
    }

    /// Bytes of the columns.
    pub fn bytes(&self) -> usize {
        let assembly_map =
            [&self.stretch_springs, &self.bend_springs, &self.membrane, &self.hinges, &self.seams, &self.wind];
        4 * (self.offsets.len() + self.columns.len() + self.mirrored_offsets.len())
            + 8 * self.mirrored.len()
            + 2 * assembly_map.iter().map(|t| t.len()).sum::<usize>()
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

    fn of_springs(&self, springs: &Springs<'_>) -> Vec<u16> {
        let rows = 0..springs.offsets.len() as u32 - 1;
        let row = |row: u32| {
            let range = springs.offsets[row as usize] as usize..springs.offsets[row as usize + 1] as usize;
            springs.others[range].iter().map(move |&other| self.slot(row, other))
        };
        rows.flat_map(row).collect()
    }

    fn of_elements<const K: usize>(&self, term: &impl Element<K>) -> Vec<u16> {
        let slots = term.incidence().slots.iter();
        let corners = slots.flat_map(|&slot| {
            let ids = term.vertices()[slot as usize / K];
            ids.map(|column| self.slot(ids[slot as usize % K], column))
        });
        corners.collect()
    }
}

fn element_pairs<const K: usize>(pairs: &mut Vec<(u32, u32)>, elements: &[[u32; K]]) {
    for ids in elements {
        for &a in ids {
            pairs.extend(ids.iter().filter(|&&b| b != a).map(|&b| (a, b)));
        }
    }
}
