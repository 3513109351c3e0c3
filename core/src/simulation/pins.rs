//! Pins that change: the host pins a vertex, moves it or attaches it to a collider, and releases it; or the time of a pin
//! begins or ends.

use glam::DVec3;

use super::Simulation;
use crate::error::{LiveError, checked_vector};
use crate::integrate::pins::Pins;
use crate::real::{Sum, Vec3, to_f64, vec3};
use crate::scene::BuiltScene;
use crate::work_done::{self, Ledger};

impl Simulation {
    /// Moves a vertex, pinned or free, at constant velocity to `place`, in the world, m, within `seconds`, or at once
    /// for 0. It stays pinned there.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn move_to(&mut self, vertex: u32, place: [Sum; 3], seconds: Sum) -> Result<(), LiveError> {
        let from = self.checked_vertex(vertex)?;
        let place = checked_vector("the place", place)? - self.built.origin;
        if !(0.0..Sum::INFINITY).contains(&seconds) {
            return Err(LiveError::Seconds { seconds });
        }
        let now = self.time();
        let before = self.pins().held_velocity(vertex, now);
        self.built.pins.make_room(vertex);
        self.built.pins.slots().move_to(vertex, [now, now + seconds], from, place, before.unwrap_or_default());
        self.hold_anew(before.is_none());
        Ok(())
    }

    /// Pins a vertex to a collider where it is now: it moves with the collider.
    pub fn attach(&mut self, vertex: u32, collider: u32) -> Result<(), LiveError> {
        let place = DVec3::from(to_f64(self.checked_vertex(vertex)?));
        let body = self.rigid_collider(collider)?;
        let colliders = self.colliders();
        let anchor = vec3(colliders.bodies[body].drive().undo(colliders.keys, place, self.time()).into());
        self.built.pins.make_room(vertex);
        self.built.pins.allow_carriers();
        self.built.pins.slots().attach(vertex, anchor, collider);
        self.hold_anew(true);
        Ok(())
    }

    /// Removes all pins of a vertex. It keeps the velocity with which they moved it until now. Returns false if it has no
    /// pin.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn release(&mut self, vertex: u32) -> bool {
        self.let_fly(vertex);
        let released = self.built.pins.slots().release(vertex);
        if released {
            self.take_over_pins();
            self.history.cut();
        }
        released
    }

    /// Gives a held vertex back the velocity with which a motion has brought it to where that motion ended now. There,
    /// the vertex stands still.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn let_fly(&mut self, vertex: u32) {
        let now = self.time();
        let BuiltScene { pins, particles, pin_groups: groups, contact, .. } = &mut self.built;
        let pins = &pins.carried_by(contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default());
        if self.measures_work {
            let reactions = self.reactions.as_mut().map(|reactions| reactions.view(groups));
            let ledger = Ledger { done: &mut self.work_done, reactions };
            work_done::by_letting_fly(pins, vertex, now, &particles.view(), ledger);
        }
        pins.let_fly(vertex, now, &mut particles.view());
    }

    /// Lets the pins begin and end whose time has come at the start of this step.
    pub(super) fn change_pins(&mut self) {
        let now = self.time();
        if self.built.pins.slots().change(now, &self.built.particles.positions) {
            self.hold_anew(true);
        }
    }

    /// Takes over pins that have changed. If one holds what was free, a two-step method cannot use the state from before
    /// it. If one has another velocity now, the step sees this itself.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(super) fn hold_anew(&mut self, held_more: bool) {
        self.take_over_pins();
        if held_more {
            self.history.cut();
        }
        self.take_hold(self.time());
    }

    /// Gives pinned vertices the velocities of their pins.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(super) fn take_hold(&mut self, now: Sum) {
        let BuiltScene { pins, particles, pin_groups: groups, contact, .. } = &mut self.built;
        let pins = &pins.carried_by(contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default());
        if self.measures_work {
            let reactions = self.reactions.as_mut().map(|reactions| reactions.view(groups));
            work_done::by_taking_hold(pins, now, &particles.view(), Ledger { done: &mut self.work_done, reactions });
        }
        pins.set_out(now, &mut particles.velocities);
    }

    /// Copies the held axes to contact and the preconditioner.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(super) fn take_over_pins(&mut self) {
        let BuiltScene { particles, pins, contact, .. } = &mut self.built;
        let pins = &pins.view();
        self.scratch.set_pins(pins);
        if self.measures_work {
            self.scratch.add_work(pins.vertices.len());
        }
        if let Some(contact) = contact {
            let cloth = particles.positions.len();
            pins.write_inverse_masses(&particles.inverse_masses, &mut contact.inverse_masses[..cloth]);
        }
    }

    /// The pinned vertices.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn pins(&self) -> Pins<'_> {
        self.built.pins.carried_by(self.colliders())
    }

    /// The position of a vertex that exists, m.
    pub(super) fn checked_vertex(&self, vertex: u32) -> Result<Vec3, LiveError> {
        let missing = LiveError::NoVertex { vertex, count: self.positions().len() as u32 };
        self.positions().get(vertex as usize).copied().ok_or(missing)
    }
}
