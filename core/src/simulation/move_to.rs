//! Pins that change: the host pins a vertex, moves it and releases it, or the time of a pin begins or ends.

use glam::DVec3;

use super::Simulation;
use crate::real::Sum;
use crate::scene::BuiltScene;
use crate::work_done::{self, Ledger};

impl Simulation {
    /// Moves a vertex, pinned or free, at constant velocity to `place`, in the world, m, within `seconds`, or at once
    /// for 0. It stays pinned there. Returns false and changes nothing if the vertex does not exist, the place or the
    /// time is not finite, or the time is negative.
    pub fn move_to(&mut self, vertex: u32, place: [Sum; 3], seconds: Sum) -> bool {
        let Some(&from) = self.positions().get(vertex as usize) else { return false };
        let place = DVec3::from(place) - self.built.origin;
        if !place.is_finite() || !(0.0..Sum::INFINITY).contains(&seconds) {
            return false;
        }
        let now = self.time();
        self.built.pins.move_to(vertex, [now, now + seconds], from, place);
        self.take_over_pins();
        // A two-step method cannot use the state from before the new motion.
        self.history.cut();
        self.take_hold(now);
        true
    }

    /// Removes all pins of a vertex. Returns false if it has no pin.
    pub fn release(&mut self, vertex: u32) -> bool {
        let released = self.built.pins.release(vertex);
        self.take_over_pins();
        if released {
            self.history.cut();
        }
        released
    }

    /// Lets the pins begin and end whose time has come at the start of this step.
    pub(super) fn change_pins(&mut self) {
        let now = self.time();
        if self.built.pins.change(now, &self.built.particles.positions) {
            self.take_over_pins();
            self.history.cut();
            self.take_hold(now);
        }
    }

    /// Gives pinned vertices the velocities of their pins.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn take_hold(&mut self, now: Sum) {
        let BuiltScene { pins, particles, pin_groups: groups, .. } = &mut self.built;
        let pins = &pins.view();
        if self.measures_work {
            let reactions = self.reactions.as_mut().map(|reactions| reactions.view(groups));
            work_done::by_taking_hold(pins, now, &particles.view(), Ledger { done: &mut self.work_done, reactions });
        }
        pins.set_out(now, &mut particles.velocities);
    }

    /// Copies the held axes to contact and the preconditioner.
    pub(super) fn take_over_pins(&mut self) {
        let BuiltScene { particles, pins, contact, .. } = &mut self.built;
        let pins = &pins.view();
        self.scratch.set_pins(pins);
        if let Some(contact) = contact {
            let cloth = particles.positions.len();
            pins.write_inverse_masses(&particles.inverse_masses, &mut contact.inverse_masses[..cloth]);
        }
    }
}
