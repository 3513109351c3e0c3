//! Expands pairs of triangles into the candidates: pairs of owned features whose boxes overlap [Curtis 2008].
//!
//! The two triangles may share vertices; pairs of adjacent triangles must be passed too. Only pairs of features
//! that share a vertex or are sewn together are dropped. A pair of triangles has fifteen pairs of features, which
//! are bits of a word in the layout of [`ByteBoxes::rows`]. Lookup tables remove the features that a triangle does
//! not own and the pairs that share a vertex.

use wide::i32x4;

use super::byte_boxes::{ByteBoxes, may_overlap};
use super::comoving::MovingBox;
use super::{Candidates, Counts, IS_FACE, OWNS_EDGE, OWNS_VERTEX, Surface};
use crate::column::Column;
use crate::geometry::aabb::Aabb;

/// Adds the candidates of pairs of triangles. Without byte boxes, the exact boxes of all pairs of features are
/// compared. Given moving boxes, those of the two triangles must [overlap](super::comoving) too.
pub fn add_features(
    boxes: &[Aabb],
    surface: &Surface<'_>,
    triangle_boxes: &[Aabb],
    owned: &[u8],
    byte_boxes: Option<&[ByteBoxes]>,
    pairs: &[[u32; 2]],
    moving_boxes: Option<&[MovingBox]>,
    out: &mut Candidates<'_>,
    counts: &mut Counts,
) {
    // Consecutive pairs often have the same first triangle.
    let (mut rows, mut rows_of) = (ByteBoxes::default().rows(), u32::MAX);
    for &[a, b] in pairs {
        let near = match byte_boxes {
            Some(byte_boxes) => {
                if a != rows_of {
                    (rows, rows_of) = (byte_boxes.element(a as usize).map_or(rows, ByteBoxes::rows), a);
                }
                byte_boxes.element(b as usize).map_or(0, |b| may_overlap(&rows, &b.columns()))
            }
            None => 0xffff,
        };
        let (a, b) = (a as usize, b as usize);
        let left = near & named(surface, [a, b], [owned.at(a), owned.at(b)]);
        if left == 0 || moving_boxes.is_some_and(|moving| !may_touch(moving, a, b)) {
            continue;
        }
        if let (Some(first), Some(second)) = (triangle_boxes.element(a), triangle_boxes.element(b)) {
            add_pair(boxes, surface, [a, b], [first, second], left, out, counts);
        }
    }
}

/// The bits of the pairs of features of two triangles that share no vertex and that they own, each by its `owned`.
#[inline(always)]
pub fn named(surface: &Surface<'_>, [a, b]: [usize; 2], owned: [u8; 2]) -> u32 {
    let [own, others] = owned.map(|owned| usize::from(owned & 0x7f));
    let named = ROWS.at(own) & COLUMNS.at(others);
    u32::from(named & APART.at(equal_corners(&surface.triangles.at(a), &surface.triangles.at(b))))
}

/// Adds the candidates of two triangles with these boxes, of the pairs of features whose bits are set.
#[inline(always)]
pub fn add_pair(
    boxes: &[Aabb],
    surface: &Surface<'_>,
    [a, b]: [usize; 2],
    triangle_boxes: [&Aabb; 2],
    mut left: u32,
    out: &mut Candidates<'_>,
    counts: &mut Counts,
) {
    let (p, q) = (surface.triangles.at(a), surface.triangles.at(b));
    while left != 0 {
        let bit = left.trailing_zeros() as usize;
        left &= left - 1;
        let (row, column) = (bit / 4, bit % 4);
        if row < 3 && column < 3 {
            let ends = [p.at(row), p.at((row + 1) % 3), q.at(column), q.at((column + 1) % 3)];
            if edges_overlap(boxes, &ends) && !edges_are_sewn(surface, &ends) {
                let edges = surface.triangle_edges.as_flattened();
                out.add_edge_edge(counts, edges.at(3 * a + row), edges.at(3 * b + column));
            }
        } else {
            let [first, second] = triangle_boxes;
            let (vertex, face, around, corners) =
                if row < 3 { (p.at(row), b, second, &q) } else { (q.at(column), a, first, &p) };
            let is_sewn = |&corner: &u32| surface.sewn.joins(vertex, corner);
            let overlap = boxes.element(vertex as usize).is_some_and(|own| own.overlaps(around));
            if overlap && !corners.iter().any(is_sewn) {
                out.add_vertex_triangle(counts, vertex, face as u32);
            }
        }
    }
}

#[inline(always)]
fn may_touch(moving: &[MovingBox], a: usize, b: usize) -> bool {
    moving.element(a).zip(moving.element(b)).is_some_and(|(a, b)| a.overlaps(b))
}

#[inline(always)]
fn edges_overlap(boxes: &[Aabb], &ends: &[u32; 4]) -> bool {
    let [Some(a), Some(b), Some(c), Some(d)] = ends.map(|v| boxes.element(v as usize)) else { return false };
    a.union(b).overlaps(&c.union(d))
}

#[inline(always)]
fn edges_are_sewn(surface: &Surface<'_>, &[a, b, c, d]: &[u32; 4]) -> bool {
    let joins = |a, b| surface.sewn.joins(a, b);
    !surface.sewn.offsets.is_empty() && (joins(a, c) || joins(a, d) || joins(b, c) || joins(b, d))
}

/// Bit `3 i + j` is set if corner `i` of one triangle is corner `j` of the other.
#[inline(always)]
fn equal_corners(&[a, b, c]: &[u32; 3], &[d, e, f]: &[u32; 3]) -> usize {
    let other = i32x4::new([d, e, f, f].map(|corner| corner as i32));
    let equal = |corner: u32| (i32x4::splat(corner as i32).simd_eq(other).to_bitmask() & 0b111) as usize;
    equal(a) | equal(b) << 3 | equal(c) << 6
}

/// The bits of the features of the first triangle, which are the rows, indexed by its `owned` bits.
const ROWS: [u16; 128] = by_ownership(true);

/// The bits of the features of the second triangle, which are the columns, indexed by its `owned` bits.
const COLUMNS: [u16; 128] = by_ownership(false);

#[expect(clippy::indexing_slicing, reason = "the compiler evaluates it")]
const fn by_ownership(in_rows: bool) -> [u16; 128] {
    let mut table = [0; 128];
    let mut owned = 0;
    while owned < 128 {
        let mut k = 0;
        while k < 3 {
            let [edge, vertex] =
                if in_rows { [0b0111 << (4 * k), 0b1000 << (4 * k)] } else { [0x0111 << k, 0x1000 << k] };
            if owned & (OWNS_EDGE << k) as usize != 0 {
                table[owned] |= edge;
            }
            if owned & (OWNS_VERTEX << k) as usize != 0 {
                table[owned] |= vertex;
            }
            k += 1;
        }
        if owned & IS_FACE as usize != 0 {
            table[owned] |= if in_rows { 0x7000 } else { 0x0888 };
        }
        owned += 1;
    }
    table
}

/// The bits of the pairs of features that share no vertex, indexed by the result of [`equal_corners`].
#[expect(clippy::indexing_slicing, reason = "the compiler evaluates it")]
const APART: [u16; 512] = {
    let mut table = [0; 512];
    let mut equal = 0;
    while equal < 512 {
        let mut k = 0;
        while k < 3 {
            let (next, mut j) = ((k + 1) % 3, 0);
            while j < 3 {
                let next_j = (j + 1) % 3;
                let corners = 1 << (3 * k + j) | 1 << (3 * k + next_j) | 1 << (3 * next + j) | 1 << (3 * next + next_j);
                if equal & corners == 0 {
                    table[equal] |= 1 << (4 * k + j);
                }
                j += 1;
            }
            if equal >> (3 * k) & 0b111 == 0 {
                table[equal] |= 1 << (4 * k + 3);
            }
            if equal >> k & 0b1_001_001 == 0 {
                table[equal] |= 1 << (12 + k);
            }
            k += 1;
        }
        equal += 1;
    }
    table
};
