//! Inverse masses for contact: those of colliders and along held axes are zero.

use crate::column::Column;
use crate::real::{Real, Vec3};

/// By the bits of the held axes: 1 along a free axis, 0 along a held one.
const FREE: [Vec3; 8] = [free(0), free(1), free(2), free(3), free(4), free(5), free(6), free(7)];

const fn free(held: u8) -> Vec3 {
    Vec3::new((!held & 1) as Real, (!held >> 1 & 1) as Real, (!held >> 2 & 1) as Real)
}

/// The inverse mass of each vertex along each axis.
#[derive(Clone, Copy, Debug)]
pub struct InverseMasses<'a> {
    /// 1/kg; zero for colliders.
    pub along_free: &'a [Real],
    /// Bits of the held axes.
    pub held: &'a [u8],
}

impl InverseMasses<'_> {
    /// That of a vertex along each axis, 1/kg.
    #[inline]
    pub fn at(&self, vertex: usize) -> Vec3 {
        FREE.at(usize::from(self.held.at(vertex) & 7)) * self.along_free.at(vertex)
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.along_free.len()
    }

    /// Whether there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.along_free.is_empty()
    }
}
