//! Moves all cloth and some colliders at once, without a velocity: a figure that appears elsewhere.

use alloc::vec::Vec;

use glam::DVec3;

use super::Simulation;
use crate::colliders::{ColliderColumns, Drive, Form};
use crate::error::LiveError;
use crate::integrate::pins::{Hold, NO_CARRIER, PinColumns};
use crate::kinematic::{Kinematic, Pose, Twist};
use crate::motion::{JumpSide, Key, Motion};
use crate::particles::ParticleColumns;
use crate::real::{Sum, Vec3, to_f64, vec3};

impl Simulation {
    /// Moves all cloth, its pins and the given colliders by a rotation about the world's origin, and then by a
    /// displacement, m. Velocities turn with them; the cloth feels nothing of it. Other colliders, gravity and wind stay.
    ///
    /// Refuses where cloth would intersect a collider that stays, where one that comes along still moves by keys or by a
    /// point cache, where a pin holds single axes that would have to turn, and where a collider that stays carries a pin.
    pub fn teleport(&mut self, by: Pose, colliders: &[u32]) -> Result<(), LiveError> {
        let by = by.checked().ok_or(LiveError::NotFinite { name: "the pose" })?;
        let (now, origin) = (self.time(), self.built.origin);
        // From the origin of the positions.
        let by = Rigid(Pose { position: by.place(origin) - origin, ..by });
        let count = self.colliders().bodies.len() as u32;
        let moved: Vec<usize> = (0..count as usize).filter(|&body| colliders.contains(&(body as u32))).collect();
        if let Some(&collider) = colliders.iter().find(|&&collider| collider >= count) {
            return Err(LiveError::NoCollider { collider, count });
        }
        for &body in &moved {
            let (all, collider) = (self.colliders(), body as u32);
            let has_ended = match all.bodies[body].drive() {
                Drive::Rest | Drive::Host(_) => true,
                Drive::Motion(motion) => motion.has_ended(all.keys, now),
                Drive::Cache(cache) => cache.end() <= now * (1.0 + 1e-14),
            };
            if !has_ended {
                return Err(LiveError::Scripted { collider });
            }
            if matches!(all.bodies[body].form(), Form::Plane(_)) && by.turns() {
                return Err(LiveError::PlaneTurns { collider });
            }
        }
        let pins = self.pins();
        for pin in 0..pins.vertices.len() {
            // A pin may hold later.
            let axes = self.built.pins.holds.get(pin).map_or(pins.axes[pin], Hold::axes);
            let stays = pins.carrier(pin).is_some_and(|carrier| !moved.contains(&carrier));
            if axes != 0 && (stays || axes != 0b111 && by.turns()) {
                return Err(LiveError::Held { vertex: pins.vertices[pin] });
            }
        }
        let staying = || (0..count as usize).filter(|body| !moved.contains(body));
        let before: Vec<bool> = staying().map(|body| self.overlaps(body)).collect();
        let snapshot = self.snapshot();
        self.count_potential(|sim| sim.carry(&by, &moved, now));
        let struck = staying().zip(before).find(|&(body, before)| !before && self.overlaps(body));
        if let Some((body, _)) = struck {
            self.go_back(&snapshot)?;
            return Err(LiveError::Overlaps { collider: body as u32 });
        }
        Ok(())
    }

    fn carry(&mut self, by: &Rigid, bodies: &[usize], now: Sum) {
        // The contacts of the last step are elsewhere.
        self.substep = 0.0;
        by.carry_particles(&mut self.built.particles);
        by.carry_pins(&mut self.built.pins);
        if let Some(contact) = &mut self.built.contact {
            for &body in bodies {
                by.carry_body(&mut contact.colliders, body, now);
            }
        }
        by.turn(&mut self.scratch.previous_displacements);
        by.turn(&mut self.scratch.previous_velocity_changes);
        if let Some(contact) = &mut self.contact {
            let mut multipliers = contact.multipliers().to_vec();
            multipliers.iter_mut().for_each(|multiplier| multiplier.force = by.turned(multiplier.force));
            contact.set_multipliers(&multipliers);
            contact.forget_pairs();
        }
    }
}

/// A rigid motion of columns, from the origin of their positions.
struct Rigid(Pose);

impl Rigid {
    fn turns(&self) -> bool {
        self.0.rotation.xyz().length() > 1e-9
    }

    fn turned(&self, vector: Vec3) -> Vec3 {
        vec3((self.0.rotation * DVec3::from(to_f64(vector))).into())
    }

    fn turn(&self, column: &mut [Vec3]) {
        column.iter_mut().for_each(|vector| *vector = self.turned(*vector));
    }

    fn carry_particles(&self, particles: &mut ParticleColumns) {
        let ParticleColumns { positions, velocities, low_positions, low_velocities, .. } = particles;
        let exact = |high: Vec3, low: Vec3| DVec3::from(to_f64(high)) + DVec3::from(to_f64(low));
        for (high, low) in positions.iter_mut().zip(low_positions) {
            let place = self.0.place(exact(*high, *low));
            *high = vec3(place.into());
            *low = vec3((place - DVec3::from(to_f64(*high))).into());
        }
        self.turn(velocities);
        self.turn(low_velocities);
    }

    /// Those that a collider carries move with it.
    fn carry_pins(&self, pins: &mut PinColumns) {
        for (pin, anchor) in pins.anchors.iter_mut().enumerate() {
            if pins.carriers.get(pin).is_none_or(|&carrier| carrier == NO_CARRIER) {
                *anchor = vec3(self.0.place(to_f64(*anchor).into()).into());
            }
        }
        self.turn_keys(&mut pins.keys);
        for motion in &mut pins.table {
            self.carry_turn(motion);
        }
    }

    fn turn_keys(&self, keys: &mut [Key]) {
        keys.iter_mut().for_each(|key| key.value = self.0.rotation * key.value);
    }

    fn carry_turn(&self, motion: &mut Motion) {
        if let Some(turn) = motion.turn() {
            motion.set_axis(self.0.rotation * turn.axis, self.0.place(turn.centre));
        }
    }

    /// A collider at rest rests elsewhere; one that the host moves goes on moving there.
    fn carry_body(&self, columns: &mut ColliderColumns, body: usize, now: Sum) {
        let ColliderColumns { bodies, anchors, keys, frames, .. } = columns;
        let of = &mut bodies[body];
        let moved = match of.drive() {
            Drive::Cache(cache) => {
                let first = cache.first as usize;
                let all = &mut frames[first..first + cache.frames as usize * of.range().len()];
                all.iter_mut().for_each(|place| *place = vec3(self.0.place(to_f64(*place).into()).into()));
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
