//! Particle columns: one array per attribute.
//!
//! A position is the sum of a rounded position and its rounding error [Dekker 1971]. Each step adds to both. So the
//! motions of many steps add up, even where a step moves a particle by less than the last digit of its position.
//! Velocities are sums likewise.
//!
//! Forces of implicit steps, and energies, see the rounding errors of positions. In a long step stiff cloth would feel
//! the last digit of a position as strain, and this strain would move it in directions in which it is soft. Explicit
//! steps are too short for that, and would cost a tenth more; they, Jacobians, velocities and contact use the rounded
//! values.

use glam::DVec3;

use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::real::{Real, SEES_ROUNDING, Vec3, rounding_error, to_f64};

/// Positions with their rounding errors, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Positions<'a> {
    /// Positions, rounded, m.
    pub rounded: &'a [Vec3],
    /// Their rounding errors, m; empty: they count as zero.
    pub low: &'a [Vec3],
}

impl<'a> From<&'a Particles<'_>> for Positions<'a> {
    fn from(particles: &'a Particles<'_>) -> Self {
        Self { rounded: particles.positions, low: particles.low_positions }
    }
}

impl<'a, T: AsRef<[Vec3]> + ?Sized> From<&'a T> for Positions<'a> {
    fn from(rounded: &'a T) -> Self {
        Self { rounded: rounded.as_ref(), low: &[] }
    }
}

impl Positions<'_> {
    /// The vector from one particle to another, m. It is as exact as its own digits, not as those of the positions:
    /// stiff cloth feels their last digit as strain.
    #[inline(always)]
    pub fn between(&self, from: u32, to: u32) -> Vec3 {
        let (from, to) = (from as usize, to as usize);
        let rounded = self.rounded.at(to) - self.rounded.at(from);
        if SEES_ROUNDING && !self.low.is_empty() { rounded + (self.low.at(to) - self.low.at(from)) } else { rounded }
    }

    /// The position of a particle in doubles, m.
    #[inline]
    pub fn place(&self, particle: usize) -> DVec3 {
        let low = self.low.get(particle).map_or(DVec3::ZERO, |&low| to_f64(low).into());
        DVec3::from(to_f64(self.rounded.at(particle))) + low
    }

    /// The vectors from the first of some particles to each, m.
    #[inline(always)]
    pub fn relative<const K: usize>(&self, particles: &[u32; K]) -> [Vec3; K] {
        let mut rounded = self.rounded.gather(particles);
        subtract_first(&mut rounded);
        if SEES_ROUNDING && !self.low.is_empty() {
            let mut low = self.low.gather(particles);
            subtract_first(&mut low);
            for (rounded, low) in rounded.iter_mut().zip(low) {
                *rounded += low;
            }
        }
        rounded
    }
}

#[inline(always)]
fn subtract_first<const K: usize>(points: &mut [Vec3; K]) {
    let first = points.at(0);
    for point in points {
        *point -= first;
    }
}

/// [`Positions`] that a step writes.
#[derive(Debug, Default)]
pub struct PositionsMut<'a> {
    /// Positions, rounded, m.
    pub rounded: &'a mut [Vec3],
    /// Their rounding errors, m.
    pub low: &'a mut [Vec3],
}

impl PositionsMut<'_> {
    /// To read them.
    pub fn view(&self) -> Positions<'_> {
        Positions { rounded: self.rounded, low: self.low }
    }

    /// Writes `positions + (offsets + moves * part)`, m.
    #[inline(never)]
    pub fn write(
        &mut self,
        positions: &[Vec3],
        offsets: &[Vec3],
        (moves, part): (&[Vec3], Real),
        dispatch: &impl Dispatch,
    ) {
        dispatch.run((&mut *self.rounded, &mut *self.low), |start, (rounded, low)| {
            for (i, (rounded, low)) in (start..).zip(rounded.iter_mut().zip(low)) {
                let (position, moved) = (positions.at(i), offsets.at(i) + moves.at(i) * part);
                *rounded = position + moved;
                *low = rounding_error(position, moved, *rounded);
            }
        });
    }
}

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

impl Particles<'_> {
    /// The same columns for a shorter time.
    pub fn reborrow(&mut self) -> Particles<'_> {
        Particles {
            positions: self.positions,
            velocities: self.velocities,
            low_positions: self.low_positions,
            low_velocities: self.low_velocities,
            masses: self.masses,
            inverse_masses: self.inverse_masses,
        }
    }
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
    #[cfg_attr(small, optimize(size))]
    pub fn at_rest(
        positions: alloc::vec::Vec<Vec3>,
        masses: alloc::vec::Vec<Real>,
        inverse_masses: alloc::vec::Vec<Real>,
    ) -> Self {
        let zero = alloc::vec![Vec3::ZERO; positions.len()];
        let (low_positions, low_velocities) = (zero.clone(), zero.clone());
        Self { positions, velocities: zero, low_positions, low_velocities, masses, inverse_masses }
    }

    /// The positions with their rounding errors.
    pub fn exact_positions(&self) -> Positions<'_> {
        Positions { rounded: &self.positions, low: &self.low_positions }
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
