//! Passes over columns of the solver that also add something up, in parts of a fixed size.

use core::ops::Range;

use crate::column::Column;
use crate::dispatch::{Dispatch, Split};
use crate::real::{Lanes, Real, Sum, Vec3};

/// Number of vertices in each part. It is fixed, so that sums do not depend on the number of threads, bit for bit.
pub const PART: usize = 256;

/// Two sums, which one pass over a column adds up.
pub type Sums = [Sum; 2];

/// A column in parts of [`PART`] vertices; the last one may be shorter.
struct Parts<'a>(&'a mut [Vec3]);

impl Split for Parts<'_> {
    fn len(&self) -> usize {
        self.0.len().div_ceil(PART)
    }
    fn split_at(self, mid: usize) -> (Self, Self) {
        let (low, high) = self.0.cut_mut((mid * PART).min(self.0.len()));
        (Self(low), Self(high))
    }
}

/// Calls the kernel for each part of a column, with the range of its vertices, and adds up the results. `partials` has
/// one entry per part.
pub fn sum_parts(
    column: &mut [Vec3],
    partials: &mut [Sums],
    dispatch: &impl Dispatch,
    kernel: impl Fn(Range<usize>, &mut [Vec3]) -> Sums + Sync,
) -> Sums {
    dispatch.run((&mut *partials, Parts(column)), |first, (partials, column)| {
        for ((k, partial), part) in (first..).zip(partials).zip(column.0.chunks_mut(PART)) {
            *partial = kernel(k * PART..k * PART + part.len(), part);
        }
    });
    partials.iter().fold([0.0; 2], |[a, b], partial| [a + partial[0], b + partial[1]])
}

/// Inner product of two parts of columns.
#[inline]
pub fn dot(a: &[Vec3], b: &[Vec3]) -> Sum {
    interleaved_dot(bytemuck::cast_slice::<Vec3, Real>(a), bytemuck::cast_slice(b)).into()
}

/// Inner product in eight interleaved sums.
#[inline]
pub fn interleaved_dot(a: &[Real], b: &[Real]) -> Real {
    let (a, b) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [Lanes::ZERO; 2];
    for (&[a0, a1, a2, a3, a4, a5, a6, a7], &[b0, b1, b2, b3, b4, b5, b6, b7]) in a.0.iter().zip(b.0) {
        sums[0] += Lanes::new([a0, a1, a2, a3]) * Lanes::new([b0, b1, b2, b3]);
        sums[1] += Lanes::new([a4, a5, a6, a7]) * Lanes::new([b4, b5, b6, b7]);
    }
    let [x, y, z, w] = (sums[0] + sums[1]).to_array();
    (x + y) + (z + w) + a.1.iter().zip(b.1).map(|(a, b)| a * b).sum::<Real>()
}
