//! Colliders that the host moves, deforms and switches on and off from step to step.

use glam::DVec3;

use super::Simulation;
use super::pins::checked_vector;
use crate::colliders::{Cache, Colliders, Drive, Form};
use crate::error::LiveError;
use crate::kinematic::{Kinematic, Pose};
use crate::motion::JumpSide;
use crate::reactions::Impulse;
use crate::real::{Sum, Vec3, vec3};

impl Simulation {
    /// Moves a collider evenly from its present pose to another one, in the world, within `seconds`. Then it rests there.
    /// It turns by the shorter of the two ways, so by at most half a turn. Call this before every step with the length of
    /// the step; each call replaces the motion before, also that of the scene. The steps detect what the collider meets
    /// on the way.
    ///
    /// The centre of a collider is the middle of a sphere, a capsule or a box, or the point of a plane; that of a mesh is
    /// the zero of the coordinates of its vertices. The rotation is that from the orientation in the scene.
    pub fn move_collider(&mut self, collider: u32, to: Pose, seconds: Sum) -> Result<(), LiveError> {
        let body = self.rigid_collider(collider)?;
        let to = to.checked().ok_or(LiveError::NotFinite { name: "the pose" })?;
        if !(seconds > 0.0 && seconds.is_finite()) {
            return Err(LiveError::Seconds { seconds });
        }
        let (now, origin) = (self.time(), self.built.origin);
        let colliders = self.colliders();
        let of = &colliders.bodies[body];
        let centre = of.centre(colliders.anchors, -origin);
        let (from, before) = of.drive().pose(colliders.keys, centre, now, JumpSide::Before);
        let to = Pose { position: to.position - origin, ..to };
        let motion = Kinematic::between(centre, [from, to], [now, now + seconds], before);
        if matches!(of.form(), Form::Plane(_)) && motion.turns() {
            return Err(LiveError::PlaneTurns { collider });
        }
        self.drive(body, Drive::Host(motion));
        if self.built.pins.carriers.contains(&collider) {
            self.hold_anew(false);
        }
        Ok(())
    }

    /// The present pose of a collider in the world.
    pub fn collider_pose(&self, collider: u32) -> Result<Pose, LiveError> {
        let body = self.rigid_collider(collider)?;
        let colliders = self.colliders();
        let of = &colliders.bodies[body];
        let centre = of.centre(colliders.anchors, -self.built.origin);
        let (pose, _) = of.drive().pose(colliders.keys, centre, self.time(), JumpSide::After);
        Ok(Pose { position: pose.position + self.built.origin, ..pose })
    }

    /// The impulse that the cloth has given a collider since the last call, and its moment about the present centre of
    /// the collider, or about the world's origin for one that deforms. They must be
    /// [measured](Self::measure_reactions). What the cloth loses the collider gets, to rounding and to the tolerance of
    /// the solver.
    pub fn take_impulse(&mut self, collider: u32) -> Result<Impulse, LiveError> {
        let body = self.checked_collider(collider)?;
        let pose = self.collider_pose(collider).map_or(DVec3::ZERO, |pose| pose.position);
        let centre = pose - self.built.origin;
        let reactions = self.reactions.as_mut().ok_or(LiveError::NotMeasured)?;
        let Impulse { linear, angular } = core::mem::take(&mut reactions.colliders[body]);
        Ok(Impulse { linear: -linear, angular: centre.cross(linear) - angular })
    }

    /// Moves every vertex of a mesh evenly to a position in the world, m, within `seconds`. Then they rest there. Each
    /// call replaces the motion before. The first call for a collider allocates.
    pub fn deform_collider(&mut self, collider: u32, to: &[[Sum; 3]], seconds: Sum) -> Result<(), LiveError> {
        let body = self.checked_collider(collider)?;
        let (form, range) = (self.colliders().bodies[body].form(), self.colliders().bodies[body].range());
        let count = range.len();
        if form != Form::Mesh {
            return Err(LiveError::NoMesh { collider });
        }
        if to.len() != count {
            return Err(LiveError::Points { collider, expected: count as u32, found: to.len() as u32 });
        }
        if self.built.pins.carriers.contains(&collider) {
            return Err(LiveError::Deforms { collider });
        }
        to.iter().try_for_each(|&place| checked_vector("a position", place).map(|_| ()))?;
        if !(seconds > 0.0 && seconds.is_finite()) {
            return Err(LiveError::Seconds { seconds });
        }
        let (now, origin) = (self.time(), self.built.origin);
        let mut places = alloc::vec![Vec3::ZERO; self.colliders().anchors.len()];
        self.colliders().place(now, &mut places);
        let Some(contact) = &mut self.built.contact else { return Ok(()) };
        let first = contact.colliders.room_for_frames(body).ok_or(LiveError::Memory)?;
        let (from, next) = contact.colliders.frames[first..first + 2 * count].split_at_mut(count);
        from.copy_from_slice(&places[range]);
        for (next, &place) in next.iter_mut().zip(to) {
            *next = vec3((DVec3::from(place) - origin).into());
        }
        self.drive(body, Drive::Cache(Cache { first: first as u32, frames: 2, rate: 1.0 / seconds, start: now }));
        Ok(())
    }

    /// Switches a collider off: nothing touches it any more. It still moves.
    pub fn switch_off(&mut self, collider: u32) -> Result<(), LiveError> {
        let body = self.checked_collider(collider)?;
        self.set_off(body, true);
        Ok(())
    }

    /// Switches a collider on again. Refuses where cloth intersects it.
    pub fn switch_on(&mut self, collider: u32) -> Result<(), LiveError> {
        let body = self.checked_collider(collider)?;
        let before = self.overlap();
        self.set_off(body, false);
        if self.overlaps_more(before) {
            self.set_off(body, true);
            return Err(LiveError::Overlaps);
        }
        Ok(())
    }

    /// The number of crossings, and the greatest depth of a vertex inside a collider, m.
    pub(super) fn overlap(&self) -> (usize, crate::real::Real) {
        (self.crossings(&crate::dispatch::Serial), self.penetration().unwrap_or_default())
    }

    /// Whether surfaces overlap more than before.
    pub(super) fn overlaps_more(&self, (crossings, depth): (usize, crate::real::Real)) -> bool {
        let now = self.overlap();
        now.0 > crossings || now.1 > depth
    }

    fn set_off(&mut self, body: usize, is_off: bool) {
        if let Some(contact) = &mut self.built.contact {
            contact.colliders.bodies[body].set_off(is_off);
        }
        if let Some(contact) = &mut self.contact {
            contact.forget_pairs();
        }
    }

    fn drive(&mut self, body: usize, drive: Drive) {
        if let Some(contact) = &mut self.built.contact {
            contact.colliders.bodies[body].set_drive(drive);
        }
    }

    /// The colliders.
    pub fn colliders(&self) -> Colliders<'_> {
        self.built.contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default()
    }

    fn checked_collider(&self, collider: u32) -> Result<usize, LiveError> {
        let count = self.colliders().bodies.len() as u32;
        if collider < count { Ok(collider as usize) } else { Err(LiveError::NoCollider { collider, count }) }
    }

    /// A collider that moves as a rigid body.
    pub(super) fn rigid_collider(&self, collider: u32) -> Result<usize, LiveError> {
        let body = self.checked_collider(collider)?;
        let deforms = matches!(self.colliders().bodies[body].drive(), Drive::Cache(_));
        if deforms { Err(LiveError::Deforms { collider }) } else { Ok(body) }
    }
}
