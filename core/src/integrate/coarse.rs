//! The coarse level of the two-level preconditioner `D^-1 + P (P^T A P)^-1 P^T`: the sheet is cut into patches that
//! each move affinely, and the small system of their motions is solved exactly [Nicolaides 1987; with richer patches,
//! Tamstorf 2015]. D^-1 alone spreads a change by one vertex per iteration; the coarse level spreads it across the
//! whole sheet in one iteration. A large sheet has one more level: small patches bridge the gap between single vertices
//! and large patches. The small system holds the motions of both, without the coupling between them: so each level is
//! one more term of the sum.
//!
//! The small matrix is stored as the envelope of its lower triangle. Its values are double in both
//! precisions, because the stiffness inside a patch cancels when they are summed. Solves use the factor rounded to the
//! crate's precision.

use super::columns::interleaved_dot;
use super::conjugate_gradient::System;
use super::convex_term::{ConvexTerm, Curvature};
use crate::column::Column;
use crate::forces::matrix::{Block, to_vec3};
use crate::real::{Lanes, Real, Sum, SumLanes, Vec3, lanes};

/// Motions of a patch: three axes times (1, u, v) in its own coordinates.
pub const MODES: usize = 9;

/// A pivot below this fraction of its diagonal entry marks a motion that the others already span.
const LEAST_PIVOT: Sum = 1e-10;

/// The patches, borrowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Patches<'a> {
    /// The patch of each vertex, one level after the other.
    pub labels: &'a [u32],
    /// (u, v) of each vertex in its patch, about -1 to 1, one level after the other.
    pub coordinates: &'a [[Real; 2]],
    /// Held axes of each vertex, as in [`Pins`](super::pins::Pins).
    pub held: &'a [u8],
    /// First column of each row of the small matrix.
    pub first_columns: &'a [u32],
    /// Start of each row's values, which run from its first column to the diagonal; one entry more
    /// than there are rows.
    pub offsets: &'a [u32],
}

/// The factor of the small matrix and vectors to solve in, borrowed.
#[derive(Debug, Default)]
pub struct CoarseFactor<'a> {
    /// Values of all rows while the matrix is summed and factorised.
    pub values: &'a mut [Sum],
    /// The diagonal block B of each patch while the matrix is summed, stored as X with B = X + X^T.
    pub own: &'a mut [Dense],
    /// `values` and `own` before the term is added: factors of one matrix with other contacts begin with them. Empty
    /// without contact.
    pub elastic_values: &'a mut [Sum],
    /// See `elastic_values`.
    pub elastic_own: &'a mut [Dense],
    /// 1 / diagonal; zero for motions that are left out.
    pub inverse_diagonal: &'a mut [Sum],
    /// The factor, rounded: a solve takes as long as reading it.
    pub rounded: &'a mut [Real],
    /// Right side and solution: one entry per row.
    pub vector: &'a mut [Real],
    /// Of each patch, its right side or its motion: one vector for each of (1, u, v).
    pub motions: &'a mut [[Lanes; 3]],
}

/// A block that couples the motions of two patches, indexed `[row][column]`.
pub type Dense = [[Sum; MODES]; MODES];

/// An entry for each motion of a patch, indexed `[axis][shape function]`.
type Motions = [[Sum; 3]; 3];

impl<'a> Patches<'a> {
    /// The patches of each level.
    fn levels(&self) -> impl Iterator<Item = Self> + use<'a> {
        let (all, vertices) = (*self, self.held.len().max(1));
        let levels = all.labels.chunks(vertices).zip(all.coordinates.chunks(vertices));
        levels.map(move |(labels, coordinates)| Self { labels, coordinates, ..all })
    }

    #[inline]
    fn shape(&self, vertex: usize) -> [Sum; 3] {
        let [u, v] = self.coordinates.at(vertex);
        [1.0, u.into(), v.into()]
    }

    /// (u, v) in all lanes, and the patch, of each vertex from the first on.
    #[inline(always)]
    fn places(&self, first: usize) -> impl Iterator<Item = (Lanes, Lanes, usize)> {
        let places = self.coordinates.part(first..).iter().zip(self.labels.part(first..));
        places.map(|(&[u, v], &label)| (Lanes::splat(u), Lanes::splat(v), label as usize))
    }

    /// Whether the envelope contains the block of two patches; `high` is the larger number.
    fn are_coupled(&self, high: usize, low: usize) -> bool {
        self.first_columns.at(high * MODES) as usize <= low * MODES
    }

    /// Range of a row's values, from its first column to the diagonal.
    #[inline]
    fn row(&self, row: usize) -> core::ops::Range<usize> {
        self.offsets.at(row) as usize..self.offsets.at(row + 1) as usize
    }

    /// Index of the value in a row and a column.
    #[inline]
    fn entry(&self, row: usize, column: usize) -> usize {
        self.offsets.at(row) as usize + column - self.first_columns.at(row) as usize
    }
}

impl CoarseFactor<'_> {
    /// The part of a row that couples it with a patch: its own one or one with a smaller number.
    #[inline]
    fn block_row(&mut self, patches: &Patches<'_>, row: usize, patch: usize) -> Option<&mut [Sum; MODES]> {
        if row / MODES == patch {
            return self.own.as_flattened_mut().element_mut(row);
        }
        let start = patches.entry(row, patch * MODES);
        self.values.part_mut(start..start + MODES).first_chunk_mut()
    }
}

/// Writes the small matrix `P^T (M + S' + C) P`, where C is the curvature of the term, and
/// factorises it. `is_same_matrix`: S' is that of the call before.
pub fn write_factor(
    patches: &Patches<'_>,
    system: &System<'_>,
    term: &dyn ConvexTerm,
    is_same_matrix: bool,
    factor: &mut CoarseFactor<'_>,
) {
    let keeps = !factor.elastic_values.is_empty();
    if keeps && is_same_matrix {
        factor.values.copy_from(factor.elastic_values);
        factor.own.copy_from(factor.elastic_own);
    } else {
        write_matrix(patches, system, factor);
        if keeps {
            factor.elastic_values.copy_from(factor.values);
            factor.elastic_own.copy_from(factor.own);
        }
    }
    for patches in patches.levels() {
        term.visit_curvature(&mut |part| add_curvature(&patches, part, factor));
    }
    for (patch, own) in factor.own.iter().enumerate() {
        for (r, row) in own.iter().enumerate() {
            let end = patches.row(patch * MODES + r).end;
            let values = factor.values.part_mut(end - 1 - r..end);
            for ((value, entry), column) in values.iter_mut().zip(row).zip(own) {
                *value += entry + column.at(r);
            }
        }
    }
    factorise(patches, factor);
    for (rounded, &value) in factor.rounded.iter_mut().zip(&*factor.values) {
        *rounded = value as Real;
    }
}

/// Writes `P^T (M + S') P` to `values` and `own`.
fn write_matrix(patches: &Patches<'_>, system: &System<'_>, factor: &mut CoarseFactor<'_>) {
    factor.values.fill(0.0);
    factor.own.fill([[0.0; MODES]; MODES]);
    for patches in patches.levels() {
        for vertex in 0..system.masses.len() {
            add_row(&patches, system, vertex, factor);
        }
    }
}

/// Adds a vertex's row of the system. Consecutive columns of one patch are first summed, weighted
/// by their shape functions; the sum is then spread over the shape functions of the row.
fn add_row(patches: &Patches<'_>, system: &System<'_>, vertex: usize, factor: &mut CoarseFactor<'_>) {
    let matrix = system.matrix;
    let row = matrix.offsets.at(vertex) as usize..matrix.offsets.at(vertex + 1) as usize;
    let label = |column: u32| patches.labels.at(column as usize) as usize;
    let (own, mut sums) = (patches.labels.at(vertex) as usize, [Motions::default(); 3]);
    let mut entries = matrix.columns.part(row.clone()).iter().zip(matrix.blocks.part(row)).peekable();
    while let Some((&column, block)) = entries.next() {
        add_block(patches, system, vertex, (column as usize, block), &mut sums);
        let other = label(column);
        if entries.peek().is_none_or(|&(&next, _)| label(next) != other) {
            if patches.are_coupled(own.max(other), own.min(other)) {
                spread(patches, vertex, other, &sums, factor);
            }
            sums = [Motions::default(); 3];
        }
    }
}

/// `sums[axis][by][s] += entry[axis][by] shape[s]`; only half of the diagonal block, because
/// [`CoarseFactor::own`] is added with its transpose.
#[inline]
fn add_block(
    patches: &Patches<'_>,
    system: &System<'_>,
    vertex: usize,
    (column, block): (usize, &Block),
    sums: &mut [Motions; 3],
) {
    let (shape, held) = (patches.shape(column), patches.held.at(column));
    let (half, mass) = if column == vertex { (0.5, system.masses.at(vertex)) } else { (1.0, 0.0) };
    for (by, column) in block.iter().enumerate().filter(|(by, _)| held >> by & 1 == 0) {
        let [x, y, z, _] = column.to_array();
        let mut entries = [x, y, z];
        entries.add(by, mass);
        for (sums, entry) in sums.iter_mut().zip(entries) {
            let Some(sums) = sums.element_mut(by) else { continue };
            for (sum, shape) in sums.iter_mut().zip(shape) {
                *sum += half * Sum::from(entry) * shape;
            }
        }
    }
}

/// Adds `shape[t] sums[axis]` to the rows (axis, t) of the vertex's patch and the columns of the
/// other patch, or the transpose if the other patch has the larger number.
fn spread(patches: &Patches<'_>, vertex: usize, other: usize, sums: &[Motions; 3], factor: &mut CoarseFactor<'_>) {
    let (patch, held) = (patches.labels.at(vertex) as usize, patches.held.at(vertex));
    for (axis, sums) in sums.iter().enumerate().filter(|(axis, _)| held >> axis & 1 == 0) {
        for (row, shape) in (patch * MODES + 3 * axis..).zip(patches.shape(vertex)) {
            if other <= patch {
                let Some(values) = factor.block_row(patches, row, other) else { continue };
                for (value, sum) in values.iter_mut().zip(sums.as_flattened()) {
                    *value += sum * shape;
                }
            } else {
                for (other, sum) in (other * MODES..).zip(sums.as_flattened()) {
                    factor.values.add(patches.entry(other, row), sum * shape);
                }
            }
        }
    }
}

/// Adds a part of the term's curvature. If the envelope has no block for two of its patches, only the diagonal
/// block of each patch is added, times the number of patches: an upper bound (by Cauchy's
/// inequality), so that the small system is never too soft.
fn add_curvature(patches: &Patches<'_>, part: &Curvature, factor: &mut CoarseFactor<'_>) {
    let (shares, count) = shares(patches, part);
    let shares = shares.part(..count);
    let [x, y, z] = part.matrix.to_cols_array_2d();
    let stiffness = [x, y, z].map(|column| column.map(Sum::from));
    let fits = |a: &Share, b: &Share| a.patch <= b.patch || patches.are_coupled(a.patch, b.patch);
    let together = shares.iter().all(|a| shares.iter().all(|b| fits(a, b)));
    let times = if together { 1.0 } else { count as Sum };
    for a in shares {
        for b in shares.iter().filter(|b| b.patch == a.patch || together && b.patch < a.patch) {
            let half = if a.patch == b.patch { 0.5 } else { 1.0 };
            for (r, a_moves) in a.moves.as_flattened().iter().enumerate() {
                let stiffness = stiffness.at(r / 3);
                let Some(values) = factor.block_row(patches, a.patch * MODES + r, b.patch) else { continue };
                for (c, (value, b_moves)) in values.iter_mut().zip(b.moves.as_flattened()).enumerate() {
                    *value += half * (times * stiffness.at(c / 3) * a_moves * b_moves);
                }
            }
        }
    }
}

/// The weighted sum of the vertices' velocities per unit of each motion of a patch.
#[derive(Clone, Copy, Default)]
struct Share {
    patch: usize,
    moves: Motions,
}

/// The shares of the patches, and their number.
fn shares(patches: &Patches<'_>, part: &Curvature) -> ([Share; 4], usize) {
    let mut shares = [Share::default(); 4];
    let mut count = 0;
    for (&v, weight) in part.vertices.iter().zip(part.weights) {
        let Some(&label) = patches.labels.get(v as usize) else { continue };
        let k = shares.iter().take(count).position(|share| share.patch == label as usize).unwrap_or(count);
        count = count.max(k + 1);
        let Some(share) = shares.element_mut(k) else { continue };
        share.patch = label as usize;
        let (shape, held) = (patches.shape(v as usize), patches.held.at(v as usize));
        for (_, moves) in share.moves.iter_mut().enumerate().filter(|(axis, _)| held >> axis & 1 == 0) {
            for (moves, shape) in moves.iter_mut().zip(shape) {
                *moves += Sum::from(weight) * shape;
            }
        }
    }
    (shares, count)
}

/// Number of rows that are factorised together. They belong to one patch and so have the same
/// first column.
const TOGETHER: usize = 3;
const _: () = assert!(MODES.is_multiple_of(TOGETHER));

/// Cholesky factorisation within the envelope, [`TOGETHER`] rows at a time.
fn factorise(patches: &Patches<'_>, factor: &mut CoarseFactor<'_>) {
    for row in (0..patches.first_columns.len()).step_by(TOGETHER) {
        let (above, from_here) = factor.values.cut_mut(patches.offsets.at(row) as usize);
        let first = patches.first_columns.at(row) as usize;
        let width = row - first;
        let (top, from_middle) = from_here.cut_mut(width + 1);
        let (middle, from_bottom) = from_middle.cut_mut(width + 2);
        let mut rows: [_; TOGETHER] = [top, middle, from_bottom.part_mut(..width + 3)];
        for column in first..row {
            let column_first = patches.first_columns.at(column) as usize;
            let common = first.max(column_first);
            let other = above.part(patches.row(column)).part(common - column_first..column - column_first);
            let products = dots(rows.each_ref().map(|row| row.part(common - first..column - first)), other);
            let inverse = factor.inverse_diagonal.at(column);
            for (values, product) in rows.iter_mut().zip(products) {
                if let Some(value) = values.element_mut(column - first) {
                    *value = (*value - product) * inverse;
                }
            }
        }
        for k in 0..TOGETHER {
            let Some((values, done)) = rows.part_mut(..=k).split_last_mut() else { continue };
            for (column, other) in (width..).zip(done) {
                let product = dot(values.part(..column), other.part(..column));
                let inverse = factor.inverse_diagonal.at(first + column);
                values.set(column, (values.at(column) - product) * inverse);
            }
            let Some((diagonal, left)) = values.split_last() else { continue };
            let pivot = diagonal - dot(left, left);
            let inverse = if pivot > LEAST_PIVOT * diagonal { 1.0 / libm::sqrt(pivot) } else { 0.0 };
            factor.inverse_diagonal.set(row + k, inverse);
        }
    }
}

/// Writes the motions `(P^T A P)^-1 P^T r` of the patches. Held axes of `r` must be zero.
pub fn solve(patches: &Patches<'_>, factor: &mut CoarseFactor<'_>, r: &[Vec3]) {
    restrict(patches, r, factor);
    substitute(patches, factor);
    for (motion, rows) in factor.motions.iter_mut().zip(factor.vector.as_chunks::<MODES>().0) {
        *motion = core::array::from_fn(|s| Lanes::new([rows.at(s), rows.at(3 + s), rows.at(6 + s), 0.0]));
    }
}

/// Adds the motions of the patches to `z`, whose first vertex is `start`. The caller clears the held axes.
pub fn add_motions(patches: &Patches<'_>, motions: &[[Lanes; 3]], start: usize, z: &mut [Vec3]) {
    for patches in patches.levels() {
        for ((u, v, patch), z) in patches.places(start).zip(&mut *z) {
            let Some(&[constant, along_u, along_v]) = motions.element(patch) else { continue };
            *z += to_vec3(constant + along_u * u + along_v * v);
        }
    }
}

/// Writes `P^T r` to the vector.
fn restrict(patches: &Patches<'_>, r: &[Vec3], factor: &mut CoarseFactor<'_>) {
    factor.motions.fill([Lanes::ZERO; 3]);
    for patches in patches.levels() {
        for ((u, v, patch), &r) in patches.places(0).zip(r) {
            let Some([constant, along_u, along_v]) = factor.motions.element_mut(patch) else { continue };
            let r = lanes(r);
            *constant += r;
            *along_u += r * u;
            *along_v += r * v;
        }
    }
    for (motion, rows) in factor.motions.iter().zip(factor.vector.as_chunks_mut::<MODES>().0) {
        for (s, motion) in motion.iter().enumerate() {
            let [x, y, z, _] = motion.to_array();
            rows.set(s, x);
            rows.set(3 + s, y);
            rows.set(6 + s, z);
        }
    }
}

/// Solves with the factor, in place.
fn substitute(patches: &Patches<'_>, factor: &mut CoarseFactor<'_>) {
    let rows = patches.first_columns.len();
    for row in 0..rows {
        let first = patches.first_columns.at(row) as usize;
        let left = factor.rounded.part(patches.row(row)).part(..row - first);
        let product = interleaved_dot(left, factor.vector.part(first..row));
        factor.vector.set(row, (factor.vector.at(row) - product) * factor.inverse_diagonal.at(row) as Real);
    }
    for row in (0..rows).rev() {
        let first = patches.first_columns.at(row) as usize;
        let solved = factor.vector.at(row) * factor.inverse_diagonal.at(row) as Real;
        factor.vector.set(row, solved);
        let left = factor.rounded.part(patches.row(row)).part(..row - first);
        for (entry, value) in factor.vector.part_mut(first..row).iter_mut().zip(left) {
            *entry -= value * solved;
        }
    }
}

/// Inner product in four interleaved sums. Not inlined: copies in its callers are longer and no faster.
#[inline(never)]
fn dot(a: &[Sum], b: &[Sum]) -> Sum {
    let (a, b) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = SumLanes::ZERO;
    for (&a, &b) in a.0.iter().zip(b.0) {
        sums += SumLanes::new(a) * SumLanes::new(b);
    }
    total(sums, a.1, b.1)
}

/// Inner products of three rows with `other`, which is read once. Written out, because loops over the three
/// rows are not unrolled in builds optimised for size.
fn dots([a, b, c]: [&[Sum]; TOGETHER], other: &[Sum]) -> [Sum; TOGETHER] {
    let [a, b, c] = [a, b, c].map(|row| row.as_chunks::<4>());
    let (fours, rest) = other.as_chunks::<4>();
    let [mut x, mut y, mut z] = [SumLanes::ZERO; TOGETHER];
    for (((&a, &b), &c), &other) in a.0.iter().zip(b.0).zip(c.0).zip(fours) {
        let other = SumLanes::new(other);
        x += SumLanes::new(a) * other;
        y += SumLanes::new(b) * other;
        z += SumLanes::new(c) * other;
    }
    [total(x, a.1, rest), total(y, b.1, rest), total(z, c.1, rest)]
}

/// Adds up the four interleaved sums and the products of the remaining entries.
#[inline]
fn total(sums: SumLanes, a: &[Sum], b: &[Sum]) -> Sum {
    let [x, y, z, w] = sums.to_array();
    (x + y) + (z + w) + a.iter().zip(b).map(|(a, b)| a * b).sum::<Sum>()
}
