//! Particle columns: one array per attribute.

use crate::real::{Real, Vec3};

/// The state of the cloth's particles and their masses, borrowed.
#[derive(Debug)]
pub struct Particles<'a> {
    /// Positions, m.
    pub positions: &'a mut [Vec3],
    /// Velocities, m/s.
    pub velocities: &'a mut [Vec3],
    /// Masses, kg. A pinned vertex keeps its mass, because pins prescribe positions and velocities.
    pub masses: &'a [Real],
    /// Inverse masses, 1/kg. They are stored so that explicit steps need no division per particle.
    pub inverse_masses: &'a [Real],
}

/// The owned columns of [`Particles`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct ParticleColumns {
    /// Positions, m.
    pub positions: alloc::vec::Vec<Vec3>,
    /// Velocities, m/s.
    pub velocities: alloc::vec::Vec<Vec3>,
    /// Masses, kg.
    pub masses: alloc::vec::Vec<Real>,
    /// Inverse masses, 1/kg.
    pub inverse_masses: alloc::vec::Vec<Real>,
}
