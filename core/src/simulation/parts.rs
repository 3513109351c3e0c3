//! The columns that a simulation lends to the [live interface](crate::live).

use super::Simulation;
use crate::error::LiveError;
use crate::forces::load::VertexForce;
use crate::live::{Owner, Parts, PartsMut, Slot};
use crate::work_done::Ledger;

impl Owner for Simulation {
    #[cfg_attr(small, optimize(size), inline(never))]
    fn parts(&self) -> Parts<'_> {
        Parts {
            origin: self.built.origin,
            time: self.time(),
            step: self.step.into(),
            substep: self.substep,
            positions: self.built.particles.exact_positions(),
            velocities: self.velocities(),
            triangles: &self.built.triangles,
            firsts: self.built.contact.as_ref().map_or(&[], |contact| &contact.firsts),
            pins: self.pins(),
            colliders: self.colliders(),
            constraints: self.contact.as_ref().map(|contact| contact.constraints()).unwrap_or_default(),
        }
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn parts_mut(&mut self) -> PartsMut<'_> {
        let (origin, time, step) = (self.built.origin, self.time(), self.step.into());
        let Self { built, scratch, contact, host, forces, substep, history, measures_work, work_done, .. } = self;
        let reactions = self.reactions.as_mut().map(|columns| columns.view(&built.pin_groups));
        let (held, previous) = scratch.of_pins();
        PartsMut {
            origin,
            time,
            step,
            substep,
            particles: built.particles.view(),
            triangles: &built.triangles,
            model: built.model.view(),
            host,
            forces,
            pins: built.pins.slots(),
            held,
            solids: built.contact.as_mut().map(|contact| contact.solids()),
            contact: contact.as_mut().map(|contact| contact.view()),
            previous,
            history,
            ledger: measures_work.then_some(Ledger { done: work_done, reactions }),
        }
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn add_slot(&mut self, slot: Slot) -> bool {
        match slot {
            Slot::Force => self.forces.push(VertexForce::default()),
            Slot::Pin => self.built.pins.add_slot(),
            Slot::CarriedPin => {
                self.built.pins.add_slot();
                self.built.pins.allow_carriers();
            }
        }
        if self.measures_work {
            self.scratch.add_work(self.built.pins.vertices.len());
        }
        true
    }

    fn make_frames(&mut self, body: usize) -> Result<usize, LiveError> {
        let contact = self.built.contact.as_mut().ok_or(LiveError::Memory)?;
        contact.colliders.room_for_frames(body).ok_or(LiveError::Memory)
    }
}
