//! Pins that change: the host pins a vertex, moves it or attaches it to a collider, and releases it; or the time of a pin
//! begins or ends.

use glam::DVec3;

use super::parts::{Parts, PartsMut};
use crate::error::{LiveError, checked_vector};
use crate::real::{Sum, Vec3, to_f64, vec3};
use crate::work_done;

impl Parts<'_> {
    /// The position of a vertex that exists, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn checked_vertex(&self, vertex: u32) -> Result<Vec3, LiveError> {
        let positions = self.positions.rounded;
        let missing = LiveError::NoVertex { vertex, count: positions.len() as u32 };
        positions.get(vertex as usize).copied().ok_or(missing)
    }
}

impl PartsMut<'_> {
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn move_to(&mut self, vertex: u32, place: [Sum; 3], seconds: Sum) -> Result<(), LiveError> {
        let from = self.read().checked_vertex(vertex)?;
        let place = checked_vector("the place", place)? - self.origin;
        if !(0.0..Sum::INFINITY).contains(&seconds) {
            return Err(LiveError::Seconds { seconds });
        }
        let velocity = (place - DVec3::from(to_f64(from))) / seconds;
        if seconds > 0.0 && !vec3(velocity.into()).is_finite() {
            return Err(LiveError::NotFinite { name: "the velocity" });
        }
        let now = self.time;
        let before = self.read().pins.held_velocity(vertex, now);
        if !self.pins.move_to(vertex, [now, now + seconds], from, place, before.unwrap_or_default()) {
            return Err(LiveError::NoSlot);
        }
        self.hold_anew(before.is_none());
        Ok(())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn attach(&mut self, vertex: u32, collider: u32) -> Result<(), LiveError> {
        let parts = self.read();
        let place = DVec3::from(to_f64(parts.checked_vertex(vertex)?));
        let body = parts.rigid_collider(collider)?;
        let colliders = parts.colliders;
        let anchor = vec3(body.drive().undo(colliders.keys, place, self.time).into());
        if !self.pins.attach(vertex, anchor, collider) {
            return Err(LiveError::NoSlot);
        }
        self.hold_anew(true);
        Ok(())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn release(&mut self, vertex: u32) -> bool {
        self.let_fly(vertex);
        let released = self.pins.release(vertex, self.time);
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
        let colliders = self.solids.as_ref().map(|solids| solids.colliders()).unwrap_or_default();
        let pins = &self.pins.carried_by(colliders);
        if let Some(ledger) = &mut self.ledger {
            work_done::by_letting_fly(pins, vertex, self.time, &self.particles, ledger.reborrow());
        }
        pins.let_fly(vertex, self.time, &mut self.particles);
    }

    /// Lets the pins begin and end whose time has come at the start of this step.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn change_pins(&mut self) {
        if self.pins.change(self.time, self.particles.positions) {
            self.hold_anew(true);
        }
    }

    /// Takes over pins that have changed. If one holds what was free, a two-step method cannot use the state from before
    /// it. If one has another velocity now, the step sees this itself.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn hold_anew(&mut self, held_more: bool) {
        self.take_over_pins();
        if held_more {
            self.history.cut();
        }
        self.take_hold();
    }

    /// Gives pinned vertices the velocities of their pins.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn take_hold(&mut self) {
        let colliders = self.solids.as_ref().map(|solids| solids.colliders()).unwrap_or_default();
        let pins = &self.pins.carried_by(colliders);
        if let Some(ledger) = &mut self.ledger {
            work_done::by_taking_hold(pins, self.time, &self.particles, ledger.reborrow());
        }
        pins.set_out(self.time, self.particles.velocities);
    }

    /// Copies the held axes to contact and the preconditioner.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn take_over_pins(&mut self) {
        let pins = &self.pins.carried_by(Default::default());
        pins.write_held(self.held);
        if let Some(solids) = &mut self.solids {
            pins.write_held(solids.held);
        }
    }
}
