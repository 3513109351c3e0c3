//! Axis-aligned boxes. Minimum, maximum and comparison never round, so all methods on all machines agree on which
//! boxes overlap.

use bytemuck::{Pod, Zeroable};

use crate::real::{Real, Vec3};

/// A box. The empty box has its corners swapped at infinity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Aabb {
    /// Low corner, m.
    pub min: Vec3,
    /// High corner, m.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: Vec3::splat(Real::INFINITY), max: Vec3::splat(Real::NEG_INFINITY) };

    /// The smallest box around both boxes.
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the other box lies in this one; touching counts.
    #[inline]
    pub fn contains(&self, other: &Self) -> bool {
        other.min.cmpge(self.min).all() && other.max.cmple(self.max).all()
    }

    /// Whether the boxes share a point; touching counts.
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}
