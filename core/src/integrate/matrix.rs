//! The system matrix of implicit methods: 3x3 blocks in rows (CSR), one row a vertex, the
//! diagonal block first. Rows are written and read whole, so that threads never share one.

use crate::dispatch::{Dispatch, Split};
use crate::real::{Mat3, Real, Vec3};

/// Blocks of `-(g^2 Kx + g Kv)`, borrowed. The mass is not in it.
#[derive(Debug, Default)]
pub struct BlockMatrix<'a> {
    /// Start of each row; one more than there are rows.
    pub offsets: &'a [u32],
    /// Column of each block, the row's own first.
    pub columns: &'a [u32],
    /// The blocks.
    pub blocks: &'a mut [Mat3],
}

/// For each force term, where in its row the block of each neighbour goes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Targets<'a> {
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
    blocks: &'a mut [Mat3],
}

impl RowsMut<'_> {
    /// Rows in this part.
    pub fn count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The blocks of a row, counted from the part's first.
    #[inline]
    pub fn row(&mut self, i: usize) -> &mut [Mat3] {
        let first = self.offsets[0];
        &mut self.blocks[(self.offsets[i] - first) as usize..(self.offsets[i + 1] - first) as usize]
    }

    /// Sets all blocks to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(Mat3::ZERO);
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
            let row = offsets[i] as usize..offsets[i + 1] as usize;
            let mut sum = p[i] * (mass_factor * masses[i]);
            for (block, &column) in blocks[row.clone()].iter().zip(&columns[row]) {
                sum += *block * p[column as usize];
            }
            *out = sum;
        }
    });
}

/// The pattern of the matrix and the owned columns of [`Targets`].
#[cfg(feature = "alloc")]
pub use pattern::Pattern;

#[cfg(feature = "alloc")]
mod pattern {
    use alloc::vec::Vec;

    use super::Targets;
    use crate::forces::Model;
    use crate::forces::element::Element;
    use crate::forces::spring::Springs;

    /// Which blocks a model's matrix has, and where each term's go.
    #[derive(Clone, Debug, Default)]
    pub struct Pattern {
        /// Start of each row.
        pub offsets: Vec<u32>,
        /// Column of each block, the row's own first, the others in ascending order.
        pub columns: Vec<u32>,
        stretch_springs: Vec<u16>,
        bend_springs: Vec<u16>,
        membrane: Vec<u16>,
        hinges: Vec<u16>,
        seams: Vec<u16>,
        wind: Vec<u16>,
    }

    impl Pattern {
        /// The pattern of a model over `vertices` vertices.
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

        /// The borrowed targets.
        pub fn targets(&self) -> Targets<'_> {
            Targets {
                stretch_springs: &self.stretch_springs,
                bend_springs: &self.bend_springs,
                membrane: &self.membrane,
                hinges: &self.hinges,
                seams: &self.seams,
                wind: &self.wind,
            }
        }

        /// Bytes held.
        pub fn bytes(&self) -> usize {
            let targets =
                [&self.stretch_springs, &self.bend_springs, &self.membrane, &self.hinges, &self.seams, &self.wind];
            4 * (self.offsets.len() + self.columns.len()) + 2 * targets.iter().map(|t| t.len()).sum::<usize>()
        }

        fn rows(vertices: usize, pairs: &[(u32, u32)]) -> Self {
            let (mut offsets, mut columns) = (alloc::vec![0], Vec::with_capacity(pairs.len() + vertices));
            let mut next = 0;
            for vertex in 0..vertices as u32 {
                columns.push(vertex);
                while let Some(&(_, column)) = pairs.get(next).filter(|pair| pair.0 == vertex) {
                    columns.push(column);
                    next += 1;
                }
                offsets.push(columns.len() as u32);
            }
            Self { offsets, columns, ..Self::default() }
        }

        /// Place of a column in a row. Rows are shorter than 2^16: no vertex has as many
        /// neighbours (checked when a scene is built).
        fn place(&self, row: u32, column: u32) -> u16 {
            let row_columns =
                &self.columns[self.offsets[row as usize] as usize..self.offsets[row as usize + 1] as usize];
            if row == column {
                return 0;
            }
            row_columns[1..].binary_search(&column).map_or(0, |at| at as u16 + 1)
        }

        fn of_springs(&self, springs: &Springs<'_>) -> Vec<u16> {
            let rows = 0..springs.offsets.len() as u32 - 1;
            let row = |row: u32| {
                let range = springs.offsets[row as usize] as usize..springs.offsets[row as usize + 1] as usize;
                springs.others[range].iter().map(move |&other| self.place(row, other))
            };
            rows.flat_map(row).collect()
        }

        fn of_elements<const K: usize>(&self, term: &impl Element<K>) -> Vec<u16> {
            let slots = term.incidence().slots.iter();
            let corners = slots.flat_map(|&slot| {
                let ids = term.vertices()[slot as usize / K];
                ids.map(|column| self.place(ids[slot as usize % K], column))
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
}
