//! A simulation of the same cloth, with another method or step, takes over the changes that a host made.

use super::Simulation;
use crate::error::LiveError;
use crate::live::{Owner as _, Slot};

impl Simulation {
    /// Keeps the pins and the forces on vertices that the host set in another simulation of the same cloth, and the
    /// pins of the scene that it let go there. Call it after [`restore`](Self::restore), and after
    /// [`keep_colliders`](Self::keep_colliders), which carry pins. A vertex that a collider carries rests if this
    /// simulation has no such collider.
    ///
    /// Errors: [`LiveError::OtherScene`] if the number of vertices is another one.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn keep_pins(&mut self, of: &Self) -> Result<(), LiveError> {
        if self.positions().len() != of.positions().len() {
            return Err(LiveError::OtherScene);
        }
        self.forces.clone_from(&of.forces);
        let from = &of.built.pins;
        for vertex in from.let_go_by_host(&self.built.pins) {
            // Without the velocity of the pin, and without cutting the history: both are in the state.
            self.built.pins.slots().release(vertex, 0.0);
        }
        for pin in from.of_host() {
            let carrier = from.carrier(pin).filter(|&body| (body as usize) < self.colliders().bodies.len());
            self.add_slot(if carrier.is_some() { Slot::CarriedPin } else { Slot::Pin });
            let rests = (from.carrier(pin).is_some() && carrier.is_none()) || self.origin() != of.origin();
            let now = self.positions()[from.vertices[pin] as usize];
            self.built.pins.copy_slot(from, pin, rests.then_some(now));
        }
        self.parts_mut().take_over_pins();
        Ok(())
    }

    /// Keeps the poses, motions, deformations and switches of the colliders of another simulation of the same scene.
    ///
    /// Errors: [`LiveError::OtherScene`] if their number, shapes, or places at the start are others, or if both
    /// simulations measure positions from different origins.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn keep_colliders(&mut self, of: &Self) -> Result<(), LiveError> {
        let is_alike = self.origin() == of.origin();
        match (&mut self.built.contact, &of.built.contact) {
            (Some(own), Some(of)) if is_alike && own.colliders.is_alike(&of.colliders) => {
                own.colliders.clone_from(&of.colliders);
                Ok(())
            }
            (Some(_), Some(_)) => Err(LiveError::OtherScene),
            // Without contact there are no colliders.
            _ => Ok(()),
        }
    }
}
