//! Forces that the host changes between steps.

use glam::{BVec3, DVec3};

use super::parts::PartsMut;
use crate::column::Column;
use crate::diagnostics;
use crate::error::{LiveError, checked_vector};
use crate::forces::Model;
use crate::forces::gravity::Gravity;
use crate::forces::load::VertexForce;
use crate::particles::Particles;
use crate::real::{Sum, Vec3, to_f64, vec3};

/// Gravity and wind of the host, which replace those of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HostForces {
    /// Gravity, m/s^2.
    pub gravity: Option<Vec3>,
    /// Velocity of the air, m/s.
    pub wind: Option<Vec3>,
}

impl HostForces {
    /// Adds the forces of the host to those of a scene.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn add_to<'a>(&self, model: &mut Model<'a>, on_vertices: &'a [VertexForce]) {
        if let Some(acceleration) = self.gravity {
            model.gravity = Some(Gravity { acceleration, keys: &[] });
        }
        if let (Some(wind), Some(velocity)) = (&mut model.wind, self.wind) {
            (wind.velocity, wind.keys) = (velocity, &[]);
        }
        if on_vertices.iter().any(|it| it.force != DVec3::ZERO) {
            model.loads.get_or_insert_default().of_host = on_vertices;
        }
    }
}

impl PartsMut<'_> {
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn set_gravity(&mut self, acceleration: [Sum; 3]) -> Result<(), LiveError> {
        let acceleration = vec3(checked_vector("gravity", acceleration)?.into());
        let before = self.counted_energy();
        self.host.gravity = Some(acceleration);
        self.count_change(before);
        Ok(())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn set_wind(&mut self, velocity: [Sum; 3]) -> Result<(), LiveError> {
        let velocity = vec3(checked_vector("wind", velocity)?.into());
        if self.model.wind.is_none() {
            return Err(LiveError::NoWind);
        }
        self.host.wind = Some(velocity);
        Ok(())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn set_force(&mut self, vertex: u32, force: [Sum; 3]) -> Result<(), LiveError> {
        let start = DVec3::from(to_f64(self.read().checked_vertex(vertex)?));
        let force = checked_vector("the force", force)?;
        let has_force = self.forces.iter().any(|it| it.vertex == vertex && it.force != DVec3::ZERO);
        if force == DVec3::ZERO && !has_force {
            return Ok(());
        }
        let slot = VertexForce::slot(self.forces, vertex).and_then(|slot| self.forces.element_mut(slot));
        let slot = slot.ok_or(LiveError::NoSlot)?;
        let before = core::mem::replace(slot, VertexForce::new(vertex, force, start));
        // The potential of a force is zero where it began to act.
        if let Some(ledger) = &mut self.ledger {
            ledger.done.gravity -= before.force.dot(before.start - start);
        }
        Ok(())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn push(&mut self, vertex: u32, impulse: [Sum; 3]) -> Result<(), LiveError> {
        let parts = self.read();
        parts.checked_vertex(vertex)?;
        let impulse = checked_vector("the impulse", impulse)?;
        let own = parts.pins.vertices.iter().zip(parts.pins.axes).filter(|(pinned, _)| **pinned == vertex);
        let held = own.fold(0, |held, (_, axes)| held | axes);
        let vertex = vertex as usize;
        let Particles { masses, velocities, low_velocities, .. } = &mut self.particles;
        let mass = Sum::from(masses.at(vertex));
        let of = |v: Vec3| DVec3::from(to_f64(v));
        let before = of(velocities.at(vertex)) + of(low_velocities.at(vertex));
        let is_held = BVec3::from_array([1, 2, 4].map(|axis| held & axis != 0));
        let after = DVec3::select(is_held, before, before + impulse / mass);
        if !vec3(after.into()).is_finite() {
            return Err(LiveError::NotFinite { name: "the velocity" });
        }
        let velocity = vec3(after.into());
        velocities.set(vertex, velocity);
        low_velocities.set(vertex, vec3((after - of(velocity)).into()));
        if let Some(ledger) = &mut self.ledger {
            ledger.done.gravity += 0.5 * mass * (after.length_squared() - before.length_squared());
        }
        self.history.cut();
        Ok(())
    }

    /// The energy of the cloth, J, if work is counted.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn counted_energy(&self) -> Option<Sum> {
        self.ledger.as_ref()?;
        let mut model = self.model;
        self.host.add_to(&mut model, self.forces);
        let model = model.at(self.time);
        let particles = &self.particles;
        let energy = diagnostics::energy(&model, particles.masses, particles.into(), particles.velocities);
        Some(energy.total())
    }

    /// Counts a change of the energy, by other forces or at another place, as work.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn count_change(&mut self, before: Option<Sum>) {
        let after = self.counted_energy();
        if let (Some(ledger), Some(before), Some(after)) = (&mut self.ledger, before, after) {
            ledger.done.gravity += after - before;
        }
    }
}
