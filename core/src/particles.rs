//! Particle columns: one array per attribute.

use crate::real::{Real, Vec3};

/// The moving state of a cloth, borrowed.
#[derive(Debug)]
pub struct Particles<'a> {
    /// m.
    pub positions: &'a mut [Vec3],
    /// m/s.
    pub velocities: &'a mut [Vec3],
    /// kg; a held vertex keeps its mass, pins act on velocities.
    pub masses: &'a [Real],
    /// 1/kg, beside the masses because explicit steps would otherwise divide per particle.
    pub inverse_masses: &'a [Real],
}

/// The owned columns.
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct ParticleColumns {
    /// m.
    pub positions: alloc::vec::Vec<Vec3>,
    /// m/s.
    pub velocities: alloc::vec::Vec<Vec3>,
    /// kg.
    pub masses: alloc::vec::Vec<Real>,
    /// 1/kg.
    pub inverse_masses: alloc::vec::Vec<Real>,
}
