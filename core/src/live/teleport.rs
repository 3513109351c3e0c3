//! Moves all cloth and some colliders at once, without a velocity: a figure that appears elsewhere.

use glam::DVec3;

use super::parts::PartsMut;
use crate::colliders::{Body, Drive, Form};
use crate::column::Column;
use crate::contact::Solids;
use crate::error::LiveError;
use crate::integrate::pins::{NO_CARRIER, PinSlots};
use crate::kinematic::{Kinematic, Pose, Twist};
use crate::motion::{JumpSide, Key, Motion};
use crate::particles::Particles;
use crate::real::{Sum, Vec3, to_f64, vec3};

impl PartsMut<'_> {
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn teleport(&mut self, by: Pose, colliders: &[u32]) -> Result<(), LiveError> {
        let by = by.checked().ok_or(LiveError::NotFinite { name: "the pose" })?;
        // From the origin of the positions.
        let by = Rigid(Pose { position: by.place(self.origin) - self.origin, ..by });
        let count = self.colliders().bodies.len() as u32;
        if let Some(&collider) = colliders.iter().find(|&&collider| collider >= count) {
            return Err(LiveError::NoCollider { collider, count });
        }
        if !self.particles.positions.iter().chain(&*self.pins.anchors).all(|&x| by.moved(x).is_finite()) {
            return Err(LiveError::NotFinite { name: "the place" });
        }
        self.check_moved(&by, colliders)?;
        self.check_held(&by, colliders)?;
        for collider in (0..count).filter(|body| !colliders.contains(body)) {
            let body = collider as usize;
            let is_off = self.colliders().bodies.element(body).is_none_or(Body::is_off);
            if !is_off && self.overlaps(body, &|x| by.moved(x)) && !self.overlaps(body, &|x| x) {
                return Err(LiveError::Overlaps { collider });
            }
        }
        let before = self.counted_energy();
        self.carry(&by, colliders);
        self.count_change(before);
        Ok(())
    }

    /// Whether colliders can be moved: none goes on moving to a place in the world.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn check_moved(&self, by: &Rigid, colliders: &[u32]) -> Result<(), LiveError> {
        let (all, now) = (self.colliders(), self.time);
        for &collider in colliders {
            let Some(body) = all.bodies.element(collider as usize) else { continue };
            let has_ended = match body.drive() {
                Drive::Rest | Drive::Host(_) => true,
                Drive::Motion(motion) => motion.has_ended(all.keys, now),
                Drive::Cache(cache) => cache.end() <= now * (1.0 + 1e-14),
            };
            if !has_ended {
                return Err(LiveError::Scripted { collider });
            }
            if matches!(body.form(), Form::Plane(_)) && by.turns() {
                return Err(LiveError::PlaneTurns { collider });
            }
        }
        Ok(())
    }

    /// Whether pins can come along.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn check_held(&self, by: &Rigid, colliders: &[u32]) -> Result<(), LiveError> {
        let pins = self.read().pins;
        for (pin, &vertex) in pins.vertices.iter().enumerate() {
            // A pin may hold later.
            let axes = self.pins.holds.get(pin).map_or(pins.axes.at(pin), |hold| hold.axes_from(self.time));
            let stays = pins.carrier(pin).is_some_and(|carrier| !colliders.contains(&(carrier as u32)));
            if axes != 0 && (stays || axes != 0b111 && by.turns()) {
                return Err(LiveError::Held { vertex });
            }
        }
        Ok(())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn carry(&mut self, by: &Rigid, colliders: &[u32]) {
        // The contacts of the last step are elsewhere.
        *self.substep = 0.0;
        by.carry_particles(&mut self.particles);
        by.carry_pins(&mut self.pins);
        if let Some(solids) = &mut self.solids {
            for body in (0..solids.bodies.len()).filter(|&body| colliders.contains(&(body as u32))) {
                by.carry_body(solids, body, self.time);
            }
        }
        for column in &mut self.previous {
            by.turn(column);
        }
        if let Some(contact) = &mut self.contact {
            for multiplier in contact.multipliers.part_mut(..contact.lengths.multipliers) {
                multiplier.force = by.turned(multiplier.force);
            }
            contact.kept.forget();
        }
    }
}

/// A rigid motion of columns, from the origin of their positions.
struct Rigid(Pose);

impl Rigid {
    fn turns(&self) -> bool {
        self.0.rotation.xyz().length() > 1e-9
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn moved(&self, place: Vec3) -> Vec3 {
        vec3(self.0.place(to_f64(place).into()).into())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn turned(&self, vector: Vec3) -> Vec3 {
        vec3((self.0.rotation * DVec3::from(to_f64(vector))).into())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn turn(&self, column: &mut [Vec3]) {
        column.iter_mut().for_each(|vector| *vector = self.turned(*vector));
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn carry_particles(&self, particles: &mut Particles<'_>) {
        let Particles { positions, velocities, low_positions, low_velocities, .. } = particles;
        let exact = |high: Vec3, low: Vec3| DVec3::from(to_f64(high)) + DVec3::from(to_f64(low));
        for (high, low) in positions.iter_mut().zip(&mut **low_positions) {
            let place = self.0.place(exact(*high, *low));
            *high = vec3(place.into());
            *low = vec3((place - DVec3::from(to_f64(*high))).into());
        }
        self.turn(velocities);
        self.turn(low_velocities);
    }

    /// Those that a collider carries move with it.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn carry_pins(&self, pins: &mut PinSlots<'_>) {
        for (pin, anchor) in pins.anchors.iter_mut().enumerate() {
            if pins.carriers.get(pin).is_none_or(|&carrier| carrier == NO_CARRIER) {
                *anchor = self.moved(*anchor);
            }
        }
        self.turn_keys(pins.keys);
        for motion in &mut *pins.table {
            self.carry_turn(motion);
        }
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn turn_keys(&self, keys: &mut [Key]) {
        keys.iter_mut().for_each(|key| key.value = self.0.rotation * key.value);
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn carry_turn(&self, motion: &mut Motion) {
        if let Some(turn) = motion.turn() {
            motion.set_axis(self.0.rotation * turn.axis, self.0.place(turn.centre));
        }
    }

    /// A collider at rest rests elsewhere; one that the host moves goes on moving there.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn carry_body(&self, solids: &mut Solids<'_>, body: usize, now: Sum) {
        let Solids { bodies, anchors, keys, frames, .. } = solids;
        let Some(of) = bodies.element_mut(body) else { return };
        let moved = match of.drive() {
            Drive::Cache(cache) => {
                let first = cache.first as usize;
                let all = frames.part_mut(first..first + cache.frames as usize * of.range().len());
                all.iter_mut().for_each(|place| *place = self.moved(*place));
                return;
            }
            Drive::Host(kinematic) => {
                let twist = |Twist { linear, angular }| {
                    let rotation = self.0.rotation;
                    Twist { linear: rotation * linear, angular: rotation * angular }
                };
                let Kinematic { poses, during, before, .. } = kinematic;
                let poses = poses.map(|pose| pose.then(&self.0));
                Kinematic { poses, during: twist(during), before: twist(before), ..kinematic }
            }
            drive @ (Drive::Rest | Drive::Motion(_)) => {
                let middle = of.middle(anchors);
                let (pose, _) = drive.pose(keys, middle, now, JumpSide::After);
                Kinematic::rest(middle, pose.then(&self.0), now)
            }
        };
        of.set_drive(Drive::Host(moved));
    }
}
