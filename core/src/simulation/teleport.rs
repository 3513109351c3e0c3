//! Moves all cloth and some colliders at once, without a velocity: a figure that appears elsewhere.

use glam::DVec3;

use super::Simulation;
use crate::colliders::{ColliderColumns, Drive, Form};
use crate::error::LiveError;
use crate::integrate::pins::PinColumns;
use crate::kinematic::{Kinematic, Pose, Twist};
use crate::motion::{Key, Motion};
use crate::particles::ParticleColumns;
use crate::real::{Sum, Vec3, to_f64, vec3};

impl Simulation {
    /// Moves all cloth, its pins and the given colliders by a rotation about the world's origin, and then by a
    /// displacement, m. Velocities turn with them; the cloth feels nothing of it. Other colliders, gravity and wind stay.
    ///
    /// Refuses where cloth would intersect a collider, where a collider still moves by keys of the scene or by a point
    /// cache, where a pin holds single axes that would have to turn, and where a collider that stays carries a pin.
    pub fn teleport(&mut self, by: Pose, colliders: &[u32]) -> Result<(), LiveError> {
        let by = by.checked().ok_or(LiveError::NotFinite { name: "the pose" })?;
        let (now, origin) = (self.time(), self.built.origin);
        // From the origin of the positions.
        let by = Rigid(Pose { position: by.place(origin) - origin, ..by });
        for &collider in colliders {
            let body = self.rigid_collider(collider)?;
            let all = self.colliders();
            if matches!(all.bodies[body].drive(), Drive::Motion(motion) if !motion.has_ended(all.keys, now)) {
                return Err(LiveError::Scripted);
            }
            if matches!(all.bodies[body].form(), Form::Plane(_)) && by.turns() {
                return Err(LiveError::PlaneTurns { collider });
            }
        }
        let pins = self.pins();
        let held = (0..pins.vertices.len()).filter(|&pin| pins.axes[pin] != 0);
        for pin in held {
            let stays = pins.carrier(pin).is_some_and(|carrier| !colliders.contains(&(carrier as u32)));
            if stays || pins.axes[pin] != 0b111 && by.turns() {
                return Err(LiveError::Held { vertex: pins.vertices[pin] });
            }
        }
        let (before, overlap) = (self.snapshot(), self.overlap());
        self.count_potential(|sim| sim.carry(&by, colliders, now, origin));
        if self.overlaps_more(overlap) {
            self.go_back(&before)?;
            return Err(LiveError::Overlaps);
        }
        Ok(())
    }

    fn carry(&mut self, by: &Rigid, colliders: &[u32], now: Sum, origin: DVec3) {
        by.carry_particles(&mut self.built.particles);
        by.carry_pins(&mut self.built.pins);
        if let Some(contact) = &mut self.built.contact {
            for &collider in colliders {
                by.carry_body(&mut contact.colliders, collider as usize, now, -origin);
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
        self.0.rotation.w.abs() < 1.0
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
            if pins.carriers.get(pin).is_none_or(|&carrier| carrier == crate::integrate::pins::NO_CARRIER) {
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
    fn carry_body(&self, columns: &mut ColliderColumns, body: usize, now: Sum, zero: DVec3) {
        let ColliderColumns { bodies, anchors, keys, .. } = columns;
        let drive = bodies[body].drive();
        let moved = if let Drive::Host(kinematic) = drive {
            let twist = |Twist { linear, angular }| Twist {
                linear: self.0.rotation * linear,
                angular: self.0.rotation * angular,
            };
            let Kinematic { poses, during, before, .. } = kinematic;
            Kinematic {
                poses: poses.map(|pose| pose.then(&self.0)),
                during: twist(during),
                before: twist(before),
                ..kinematic
            }
        } else {
            let centre = bodies[body].centre(anchors, zero);
            let (pose, _) = drive.pose(keys, centre, now, crate::motion::JumpSide::After);
            Kinematic::rest(centre, pose.then(&self.0), now)
        };
        bodies[body].set_drive(Drive::Host(moved));
    }
}
