//! The numbers of another scene, which replace those of a running simulation.

use super::Simulation;
use crate::error::{LiveError, SceneError};
use crate::forces::{ModelColumns, Term};
use crate::live::{HostForces, Owner as _};
use crate::scene::{self, BuiltScene, Resource, SceneDesc};

impl Simulation {
    /// Takes the numbers of another scene with the same meshes and force terms: masses, stiffnesses, damping, rest
    /// shapes, wind, gravity, loads, thickness and friction. State, pins and colliders stay, and so do the forces of the
    /// host on vertices and the switches of contact (`self`, `continuous`, `halving`). It builds the columns of the
    /// scene, but not those of the solver and of contact.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn set_materials(&mut self, desc: &SceneDesc, resources: &[Resource]) -> Result<(), MaterialError> {
        let next = scene::build(desc, resources)?;
        if !self.is_alike(&next) {
            return Err(LiveError::OtherScene.into());
        }
        let before = self.parts_mut().counted_energy();
        let BuiltScene { particles, model, rest_lengths, contact, .. } = &mut self.built;
        *model = next.model;
        self.host = HostForces::default();
        *rest_lengths = next.rest_lengths;
        particles.masses = next.particles.masses;
        particles.inverse_masses = next.particles.inverse_masses;
        if let Some((own, next)) = contact.as_mut().zip(next.contact) {
            (own.thickness, own.material, own.laws) = (next.thickness, next.material, next.laws);
        }
        self.parts_mut().count_change(before);
        self.take_over_pins();
        self.history.cut();
        Ok(())
    }

    /// Whether a scene has the same meshes, force terms and laws of friction.
    #[cfg_attr(small, optimize(size), inline(never))]
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
