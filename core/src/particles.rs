//! Particle columns: one array per attribute.
//!
//! A position is the sum of a rounded position and its rounding error [Dekker 1971]. All kernels compute with the rounded one,
//! and each step adds to both. So the motions of many steps add up, even where a step moves a particle by less than the last
//! digit of its position. Velocities are sums likewise.

use crate::real::{Real, Vec3};

/// The state of the cloth's particles and their masses, borrowed.
#[derive(Debug)]
pub struct Particles<'a> {
    /// Positions, rounded, m.
    pub positions: &'a mut [Vec3],
    /// Velocities, rounded, m/s.
    pub velocities: &'a mut [Vec3],
    /// Rounding errors of the positions, m.
    pub low_positions: &'a mut [Vec3],
    /// Rounding errors of the velocities, m/s.
    pub low_velocities: &'a mut [Vec3],
    /// Masses, kg. A pinned vertex keeps its mass, because pins prescribe positions and velocities.
    pub masses: &'a [Real],
    /// Inverse masses, 1/kg. They are stored so that explicit steps need no division per particle.
    pub inverse_masses: &'a [Real],
}

/// The owned columns of [`Particles`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct ParticleColumns {
    /// Positions, rounded, m.
    pub positions: alloc::vec::Vec<Vec3>,
    /// Velocities, rounded, m/s.
    pub velocities: alloc::vec::Vec<Vec3>,
    /// Rounding errors of the positions, m.
    pub low_positions: alloc::vec::Vec<Vec3>,
    /// Rounding errors of the velocities, m/s.
    pub low_velocities: alloc::vec::Vec<Vec3>,
    /// Masses, kg.
    pub masses: alloc::vec::Vec<Real>,
    /// Inverse masses, 1/kg.
    pub inverse_masses: alloc::vec::Vec<Real>,
}

#[cfg(feature = "alloc")]
impl ParticleColumns {
    /// Particles at rest, of positions, m, masses, kg, and inverse masses, 1/kg.
    pub fn at_rest(
        positions: alloc::vec::Vec<Vec3>,
        masses: alloc::vec::Vec<Real>,
        inverse_masses: alloc::vec::Vec<Real>,
    ) -> Self {
        let zero = alloc::vec![Vec3::ZERO; positions.len()];
        let (low_positions, low_velocities) = (zero.clone(), zero.clone());
        Self { positions, velocities: zero, low_positions, low_velocities, masses, inverse_masses }
    }

    /// The borrowed view that a step takes.
    pub fn view(&mut self) -> Particles<'_> {
        Particles {
            positions: &mut self.positions,
            velocities: &mut self.velocities,
            low_positions: &mut self.low_positions,
            low_velocities: &mut self.low_velocities,
            masses: &self.masses,
            inverse_masses: &self.inverse_masses,
        }
    }
}
