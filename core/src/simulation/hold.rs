//! Vertices that a host takes hold of, leads and lets go: a hand in the cloth.

use super::Simulation;
use crate::real::{Sum, Vec3};

impl Simulation {
    /// Leads a vertex, held until now or not, to a place, m, evenly within so many seconds from now on, at
    /// once where there are none; there it rests. False, and nothing done, where there is no such vertex, the
    /// place or the time is not finite, or the time less than nothing.
    pub fn lead(&mut self, vertex: u32, place: Vec3, seconds: Sum) -> bool {
        let Some(&from) = self.positions().get(vertex as usize) else { return false };
        if !place.is_finite() || !(0.0..Sum::INFINITY).contains(&seconds) {
            return false;
        }
        let now = self.time();
        self.built.pins.lead(vertex, [now, now + seconds], [from, place]);
        // A method of two steps cannot look back over what a hand does.
        self.scratch.has_history = false;
        self.built.pins.view().set_out(now, &mut self.built.particles.velocities);
        true
    }

    /// Lets go of a vertex, whatever held it; false where nothing does.
    pub fn release(&mut self, vertex: u32) -> bool {
        let released = self.built.pins.release(vertex);
        self.scratch.has_history &= !released;
        released
    }
}
