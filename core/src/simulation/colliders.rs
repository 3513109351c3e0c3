//! Colliders that the host moves, deforms and switches on and off from step to step.

use glam::DVec3;

use super::Simulation;
use crate::audit;
use crate::colliders::{Body, Cache, Colliders, Drive, Form};
use crate::dispatch::Serial;
use crate::error::{LiveError, checked_vector};
use crate::geometry::intersect::edge_meets_triangle;
use crate::kinematic::{Kinematic, Pose};
use crate::motion::JumpSide;
use crate::narrow_phase::{edge_edge_ccd, vertex_triangle_ccd};
use crate::reactions::Impulse;
use crate::real::{Real, Sum, Vec3, sqrt, vec3};

/// How deep cloth may be in a collider that is switched on, relative to the thickness: rounding is less.
const SLACK: Real = 1e-3;

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
        self.check_duration(seconds)?;
        let now = self.time();
        let colliders = self.colliders();
        let of = &colliders.bodies[body];
        let middle = of.middle(colliders.anchors);
        let (from, before) = of.drive().pose(colliders.keys, middle, now, JumpSide::Before);
        let to = Pose { position: to.place(self.arm(of)) - self.built.origin, ..to };
        let motion = Kinematic::between(middle, [from, to], [now, now + seconds], before);
        if matches!(of.form(), Form::Plane(_)) && motion.turns() {
            return Err(LiveError::PlaneTurns { collider });
        }
        self.drive(body, Drive::Host(motion));
        if self.built.pins.carriers.contains(&collider) {
            self.take_hold(now);
        }
        Ok(())
    }

    /// The present pose of a collider in the world.
    pub fn collider_pose(&self, collider: u32) -> Result<Pose, LiveError> {
        let body = self.rigid_collider(collider)?;
        let colliders = self.colliders();
        let of = &colliders.bodies[body];
        let (pose, _) = of.drive().pose(colliders.keys, of.middle(colliders.anchors), self.time(), JumpSide::After);
        let arm = pose.rotation * self.arm(of);
        Ok(Pose { position: pose.position - arm + self.built.origin, ..pose })
    }

    /// From the centre of a collider, which poses name, to its middle, m.
    fn arm(&self, body: &Body) -> DVec3 {
        body.arm(self.colliders().anchors, -self.built.origin)
    }

    /// Whether a collider can move within a time, s, without a jump.
    fn check_duration(&self, seconds: Sum) -> Result<(), LiveError> {
        let least = 1e-3 * Sum::from(self.step);
        if seconds >= least && seconds.is_finite() { Ok(()) } else { Err(LiveError::TooFast { seconds, least }) }
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
        let (form, count) = (self.colliders().bodies[body].form(), self.colliders().bodies[body].range().len());
        if form != Form::Mesh {
            return Err(LiveError::NoMesh { collider });
        }
        if to.len() != count {
            return Err(LiveError::Points { collider, expected: count as u32, found: to.len() as u32 });
        }
        let pins = self.pins();
        let carried = |pin: &usize| pins.axes[*pin] != 0 && pins.carrier(*pin) == Some(body);
        if let Some(pin) = (0..pins.vertices.len()).find(carried) {
            return Err(LiveError::Carries { collider, vertex: pins.vertices[pin] });
        }
        to.iter().try_for_each(|&place| checked_vector("a position", place).map(|_| ()))?;
        self.check_duration(seconds)?;
        let (now, origin) = (self.time(), self.built.origin);
        let mut places = alloc::vec![Vec3::ZERO; count];
        self.colliders().place_body(&self.colliders().bodies[body], now, &mut places);
        let Some(contact) = &mut self.built.contact else { return Ok(()) };
        let first = contact.colliders.room_for_frames(body).ok_or(LiveError::Memory)?;
        let (from, next) = contact.colliders.frames[first..first + 2 * count].split_at_mut(count);
        from.copy_from_slice(&places);
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
        self.set_off(body, false);
        if self.overlaps(body) {
            self.set_off(body, true);
            return Err(LiveError::Overlaps { collider });
        }
        Ok(())
    }

    /// Whether cloth intersects a collider, deeper than by a thousandth of the thickness.
    pub(super) fn overlaps(&self, body: usize) -> bool {
        let Some(contact) = &self.built.contact else { return false };
        let (colliders, cloth) = (self.colliders(), self.positions());
        let (of, slack) = (&colliders.bodies[body], SLACK * contact.thickness);
        let places = self.collider_positions();
        let alone = Colliders { bodies: core::slice::from_ref(of), ..colliders };
        if cloth.iter().any(|&x| alone.depth(&places, x) > slack) {
            return true;
        }
        let own = &places[of.range()];
        let near = |distance: Real| distance < of.radius - slack;
        match of.form() {
            Form::Plane(_) => false,
            Form::Sphere | Form::Capsule => {
                let axis = [own[0], own[own.len() - 1]];
                self.triangles().iter().any(|corners| near(distance(axis, corners.map(|v| cloth[v as usize]))))
            }
            Form::Box | Form::Mesh => {
                let surface = &contact.surface.view();
                let first = cloth.len() as u32 + of.vertices[0];
                let is_own = |vertex: u32| (first..first + of.vertices[1]).contains(&vertex);
                audit::crossings(surface, &self.places(), &Serial).iter().any(|&[edge, triangle]| {
                    is_own(surface.edges[edge as usize][0]) || is_own(surface.triangles[triangle as usize][0])
                })
            }
        }
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

/// Distance of a segment, which may be a point, and a triangle, m.
fn distance(axis: [Vec3; 2], corners: [Vec3; 3]) -> Real {
    if edge_meets_triangle(axis, corners) {
        return 0.0;
    }
    let [a, b, c] = corners;
    let to_face = axis.map(|end| vertex_triangle_ccd::apart(&[end, a, b, c]));
    let to_edges = [[a, b], [b, c], [c, a]].map(|[p, q]| edge_edge_ccd::apart(&[axis[0], axis[1], p, q]));
    let squares = to_face.iter().chain(&to_edges).map(|apart| apart.length_squared());
    sqrt(squares.fold(Real::INFINITY, Real::min))
}
