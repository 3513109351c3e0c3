//! Gravity, f = m g. It may change with time.

use glam::DVec3;

use super::term::ForceTerm;
use super::{Energy, Term};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::keys::{Key, Moment};
use crate::particles::Positions;
use crate::real::{Real, Sum, Vec3, to_f64, vec3};
use crate::traffic::SCALAR;

/// Gravity.
#[derive(Clone, Copy, Debug)]
pub struct Gravity<'a> {
    /// The acceleration g, m/s^2.
    pub acceleration: Vec3,
    /// The acceleration over time, m/s^2; empty: it is constant.
    pub keys: &'a [Key],
}

impl Gravity<'_> {
    /// With the acceleration of a moment.
    pub fn at(self, moment: Moment) -> Self {
        if self.keys.is_empty() {
            return self;
        }
        Self { acceleration: vec3(moment.value(self.keys).into()), ..self }
    }
}

impl ForceTerm for Gravity<'_> {
    /// Sets the forces: gravity is the first term, so that no other pass needs to clear them.
    fn add_forces(
        &self,
        masses: &[Real],
        _: Positions<'_>,
        _: &[Vec3],
        _: &mut [Vec3],
        f: &mut [Vec3],
        dispatch: &impl Dispatch,
    ) {
        let gravity = self.acceleration;
        dispatch.run(f, |start, part| {
            for (f, &mass) in part.iter_mut().zip(masses.part(start..)) {
                *f = gravity * mass;
            }
        });
    }

    /// The potential energy, zero at the origin.
    fn energy(&self, _: Term, masses: &[Real], x: Positions<'_>) -> Energy {
        let weight = |mass: Real| DVec3::from(to_f64(self.acceleration * mass));
        let gravity = -masses.iter().enumerate().map(|(i, &mass)| weight(mass).dot(x.place(i))).sum::<Sum>();
        Energy { gravity, ..Energy::default() }
    }

    fn bytes(&self) -> usize {
        0
    }

    /// Reads the masses.
    fn force_traffic(&self, vertices: usize) -> usize {
        vertices * SCALAR
    }
}

/// The owned columns of [`Gravity`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct GravityColumns {
    /// The acceleration, m/s^2.
    pub acceleration: Vec3,
    /// The acceleration over time, m/s^2; empty: it is constant.
    pub keys: alloc::vec::Vec<Key>,
}

#[cfg(feature = "alloc")]
impl GravityColumns {
    /// Constant gravity, m/s^2.
    pub fn constant(acceleration: Vec3) -> Self {
        Self { acceleration, ..Self::default() }
    }

    /// The borrowed view that kernels take.
    pub fn view(&self) -> Gravity<'_> {
        Gravity { acceleration: self.acceleration, keys: &self.keys }
    }
}
