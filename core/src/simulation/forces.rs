//! Forces and materials that the host changes between steps.

use glam::DVec3;

use super::Simulation;
use crate::error::{LiveError, SceneError, checked_vector};
use crate::forces::gravity::GravityColumns;
use crate::forces::{ModelColumns, Term};
use crate::particles::ParticleColumns;
use crate::real::{Sum, Vec3, to_f64, vec3};
use crate::scene::{self, BuiltScene, Resource, SceneDesc};

impl Simulation {
    /// Replaces gravity by a constant one, m/s^2.
    pub fn set_gravity(&mut self, acceleration: [Sum; 3]) -> Result<(), LiveError> {
        let acceleration = vec3(checked_vector("gravity", acceleration)?.into());
        self.count_potential(|sim| sim.built.model.gravity = Some(GravityColumns::constant(acceleration)));
        Ok(())
    }

    /// Replaces the velocity of the air by a constant one, m/s. The scene must have wind, if only at velocity 0: it gives
    /// the coefficients.
    pub fn set_wind(&mut self, velocity: [Sum; 3]) -> Result<(), LiveError> {
        let velocity = vec3(checked_vector("wind", velocity)?.into());
        let wind = self.built.model.wind.as_mut().ok_or(LiveError::NoWind)?;
        wind.velocity = velocity;
        wind.keys.clear();
        Ok(())
    }

    /// Sets a force on a vertex, N, until it is set again. It adds to the loads of the scene. The first force on a vertex
    /// allocates.
    pub fn set_force(&mut self, vertex: u32, force: [Sum; 3]) -> Result<(), LiveError> {
        let place = DVec3::from(to_f64(self.checked_vertex(vertex)?));
        let force = checked_vector("the force", force)?;
        let loads = self.built.model.loads.get_or_insert_default();
        let (start, before) = loads.set(vertex, place, force);
        // The potential of a force is zero where it began to act.
        self.work_done.gravity -= if self.measures_work { before.dot(start - place) } else { 0.0 };
        Ok(())
    }

    /// Gives a vertex an impulse, N s: its velocity changes at once, but not along axes that a pin holds.
    pub fn push(&mut self, vertex: u32, impulse: [Sum; 3]) -> Result<(), LiveError> {
        self.checked_vertex(vertex)?;
        let impulse = checked_vector("the impulse", impulse)?;
        let vertex = vertex as usize;
        let mut held = 0;
        for (&pinned, &axes) in self.built.pins.vertices.iter().zip(&self.built.pins.axes) {
            held |= if pinned as usize == vertex { axes } else { 0 };
        }
        let ParticleColumns { velocities, low_velocities, masses, .. } = &mut self.built.particles;
        let mass = Sum::from(masses[vertex]);
        let of = |v: Vec3| DVec3::from(to_f64(v));
        let before = of(velocities[vertex]) + of(low_velocities[vertex]);
        let mut after = before + impulse / mass;
        (0..3).filter(|axis| held >> axis & 1 == 1).for_each(|axis| after[axis] = before[axis]);
        velocities[vertex] = vec3(after.into());
        low_velocities[vertex] = vec3((after - of(velocities[vertex])).into());
        if self.measures_work {
            self.work_done.gravity += 0.5 * mass * (after.length_squared() - before.length_squared());
        }
        self.history.cut();
        Ok(())
    }

    /// Takes the numbers of another scene with the same meshes and force terms: masses, stiffnesses, damping, rest shapes,
    /// wind, gravity, loads, thickness and friction. State, pins and colliders stay, and so do the forces of the host. It builds the
    /// columns of the scene, but not those of the solver and of contact.
    pub fn set_materials(&mut self, desc: &SceneDesc, resources: &[Resource]) -> Result<(), MaterialError> {
        let mut next = scene::build(desc, resources)?;
        if !self.is_alike(&next) {
            return Err(LiveError::OtherScene.into());
        }
        if let Some(loads) = &mut next.model.loads {
            loads.of_scene = loads.groups.len();
        }
        if let Some(loads) = &self.built.model.loads {
            let kept = next.model.loads.get_or_insert_default();
            for group in &loads.groups[loads.of_scene..] {
                let [vertex, key] = [group.vertices[0] as usize, group.keys[0] as usize];
                kept.set(loads.vertices[vertex], group.start, loads.keys[key].value);
            }
        }
        self.count_potential(|sim| {
            let BuiltScene { particles, model, rest_lengths, contact, .. } = &mut sim.built;
            *model = next.model;
            *rest_lengths = next.rest_lengths;
            particles.masses = next.particles.masses;
            particles.inverse_masses = next.particles.inverse_masses;
            if let Some((own, next)) = contact.as_mut().zip(next.contact) {
                (own.thickness, own.material, own.laws) = (next.thickness, next.material, next.laws);
            }
        });
        self.take_over_pins();
        self.history.cut();
        Ok(())
    }

    /// Whether a scene has the same meshes, force terms and laws of friction.
    fn is_alike(&self, next: &BuiltScene) -> bool {
        let own = &self.built;
        fn laws(scene: &BuiltScene) -> Option<(usize, &[u32])> {
            scene.contact.as_ref().map(|contact| (contact.laws.len(), &contact.law_of[..]))
        }
        own.triangles == next.triangles
            && own.cloths == next.cloths
            && own.sewn() == next.sewn()
            && terms(&own.model) == terms(&next.model)
            && laws(own) == laws(next)
    }

    /// Changes the forces. The potential energy changes with them: this counts as work.
    pub(super) fn count_potential(&mut self, change: impl FnOnce(&mut Self)) {
        if !self.measures_work {
            return change(self);
        }
        let total = |sim: &Self| sim.energy().total();
        let (work, before) = (self.work_done().gravity, total(self));
        change(self);
        let gained = total(self) - before;
        self.work_done.gravity = work + gained + self.lift();
    }
}

/// The columns of a solver depend on this: the terms of the model, and the sizes of their work columns.
pub(super) fn terms(model: &ModelColumns) -> impl PartialEq + use<> {
    let view = model.view();
    let has = Term::ALL.map(|term| term != Term::Gravity && term != Term::Load && view.only(term).is_some());
    (has, view.force_scratch(), view.tangent_scratch())
}

/// Reason why [`Simulation::set_materials`] refuses a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialError {
    /// The scene cannot be built.
    Scene(SceneError),
    /// The scene does not suit the simulation.
    Live(LiveError),
}

impl From<SceneError> for MaterialError {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

impl From<LiveError> for MaterialError {
    fn from(error: LiveError) -> Self {
        Self::Live(error)
    }
}

impl core::fmt::Display for MaterialError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(f),
            Self::Live(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for MaterialError {}
