//! A copy of all that steps and the host change, to go back to.

use alloc::vec::Vec;

use super::Simulation;
use super::materials::terms;
use crate::colliders::ColliderColumns;
use crate::contact::ContactScratchColumns;
use crate::error::LiveError;
use crate::forces::ModelColumns;
use crate::forces::load::VertexForce;
use crate::implicit_contact::multiplier::Multiplier;
use crate::integrate::IntegratorStatistics;
use crate::integrate::pins::PinColumns;
use crate::live::HostForces;
use crate::particles::ParticleColumns;
use crate::reactions::ReactionColumns;
use crate::real::{Real, Vec3};
use crate::response::ContactStatistics;
use crate::response::friction::Law;
use crate::step::History;
use crate::work_done::WorkDone;

/// State, pins, colliders, forces and materials of a simulation.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The hash of the meshes, and the length of a step, s.
    scene: (u64, Real),
    particles: ParticleColumns,
    model: ModelColumns,
    pins: PinColumns,
    host: HostForces,
    forces: Vec<VertexForce>,
    rest_lengths: Vec<Real>,
    contact: Option<Touching>,
    previous: [Vec<Vec3>; 2],
    multipliers: Vec<Multiplier>,
    reactions: Option<ReactionColumns>,
    history: History,
    halvings: u32,
    estimate: Option<Real>,
    work_done: WorkDone,
    steps: u64,
    statistics: (IntegratorStatistics, ContactStatistics),
}

/// Colliders, and the numbers of contact that [`set_materials`](Simulation::set_materials) changes.
#[derive(Clone, Debug)]
struct Touching {
    colliders: ColliderColumns,
    laws: Vec<Law>,
    thickness: Real,
    material: Vec<Vec3>,
}

impl Simulation {
    /// A copy of all that steps and the host change. After [`go_back`](Self::go_back) to it the same steps give the same
    /// bits.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn snapshot(&self) -> Snapshot {
        let scratch = &self.scratch;
        let built = &self.built;
        Snapshot {
            particles: built.particles.clone(),
            model: built.model.clone(),
            pins: built.pins.clone(),
            host: self.host,
            forces: self.forces.clone(),
            rest_lengths: built.rest_lengths.clone(),
            contact: built.contact.as_ref().map(|contact| Touching {
                colliders: contact.colliders.clone(),
                laws: contact.laws.clone(),
                thickness: contact.thickness,
                material: contact.material.clone(),
            }),
            scene: (self.meshes, self.step),
            previous: [scratch.previous_displacements.clone(), scratch.previous_velocity_changes.clone()],
            multipliers: self.contact.as_ref().map_or(&[][..], ContactScratchColumns::multipliers).to_vec(),
            reactions: self.reactions.clone(),
            history: self.history,
            halvings: self.halvings,
            estimate: self.estimate,
            work_done: self.work_done,
            steps: self.steps,
            statistics: (self.statistics, self.contact_statistics),
        }
    }

    /// Goes back to a snapshot of this simulation, or of one of the same scene. It neither begins nor stops to measure
    /// work and impulses. The list of [`touches`](crate::live::Live::touches) is empty until the next step.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn go_back(&mut self, to: &Snapshot) -> Result<(), LiveError> {
        let (scratch, built) = (&mut self.scratch, &mut self.built);
        let lengths = [to.particles.positions.len(), to.previous[0].len(), to.rest_lengths.len()];
        let own = [built.particles.positions.len(), scratch.previous_displacements.len(), built.rest_lengths.len()];
        let sizes =
            |colliders: &ColliderColumns, laws: &[Law]| (colliders.bodies.len(), colliders.anchors.len(), laws.len());
        let touching = built.contact.as_ref().map(|contact| sizes(&contact.colliders, &contact.laws));
        let same = (lengths, to.scene) == (own, (self.meshes, self.step))
            && touching == to.contact.as_ref().map(|contact| sizes(&contact.colliders, &contact.laws))
            && terms(&built.model) == terms(&to.model);
        if !same {
            return Err(LiveError::OtherScene);
        }
        if self.contact.as_mut().is_some_and(|contact| !contact.grow_constraints(to.multipliers.len())) {
            return Err(LiveError::Memory);
        }
        built.particles.clone_from(&to.particles);
        built.model.clone_from(&to.model);
        built.pins.clone_from(&to.pins);
        self.host = to.host;
        self.forces.clone_from(&to.forces);
        built.rest_lengths.clone_from(&to.rest_lengths);
        if let Some((contact, to)) = built.contact.as_mut().zip(to.contact.as_ref()) {
            contact.colliders.clone_from(&to.colliders);
            contact.laws.clone_from(&to.laws);
            contact.material.clone_from(&to.material);
            contact.thickness = to.thickness;
        }
        scratch.previous_displacements.copy_from_slice(&to.previous[0]);
        scratch.previous_velocity_changes.copy_from_slice(&to.previous[1]);
        if let Some(contact) = &mut self.contact {
            contact.set_multipliers(&to.multipliers);
            contact.forget_pairs();
        }
        // The snapshot may lack impulses that this simulation measures.
        if let Some(reactions) = &mut self.reactions {
            match &to.reactions {
                Some(to) => reactions.copy_from(to),
                None => reactions.clear(),
            }
        }
        (self.history, self.halvings, self.estimate) = (to.history, to.halvings, to.estimate);
        (self.work_done, self.substep, self.steps) = (to.work_done, 0.0, to.steps);
        (self.statistics, self.contact_statistics) = to.statistics;
        self.take_over_pins();
        Ok(())
    }
}
