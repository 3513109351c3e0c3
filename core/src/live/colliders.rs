//! Colliders that the host moves, deforms and switches on and off from step to step.

use glam::DVec3;

use super::parts::{Parts, PartsMut};
use crate::audit;
use crate::colliders::{Body, Cache, Colliders, Drive, Form};
use crate::column::Column;
use crate::error::{LiveError, checked_vector};
use crate::geometry::intersect::edge_meets_triangle;
use crate::kinematic::{Kinematic, Pose};
use crate::motion::JumpSide;
use crate::narrow_phase::{edge_edge_ccd, vertex_triangle_ccd};
use crate::reactions::Impulse;
use crate::real::{Real, Sum, Vec3, sqrt, vec3};

/// How deep cloth may be in a collider that is switched on, relative to the thickness: rounding is less.
const SLACK: Real = 1e-3;

impl<'a> Parts<'a> {
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn collider_pose(&self, collider: u32) -> Result<Pose, LiveError> {
        let of = self.rigid_collider(collider)?;
        let middle = of.middle(self.colliders.anchors);
        let (pose, _) = of.drive().pose(self.colliders.keys, middle, self.time, JumpSide::After);
        let arm = pose.rotation * self.arm(of);
        Ok(Pose { position: pose.position - arm + self.origin, ..pose })
    }

    /// The number of a mesh that can take these positions within a time.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn deformable(&self, collider: u32, to: &[[Sum; 3]], seconds: Sum) -> Result<usize, LiveError> {
        let of = self.checked_collider(collider)?;
        let (body, count) = (collider as usize, of.range().len());
        if of.form() != Form::Mesh {
            return Err(LiveError::NoMesh { collider });
        }
        if to.len() != count {
            return Err(LiveError::Points { collider, expected: count as u32, found: to.len() as u32 });
        }
        let pins = &self.pins;
        let carried = |pin: &usize| pins.axes.at(*pin) != 0 && pins.carrier(*pin) == Some(body);
        if let Some(pin) = (0..pins.vertices.len()).find(carried) {
            return Err(LiveError::Carries { collider, vertex: pins.vertices.at(pin) });
        }
        to.iter().try_for_each(|&place| checked_vector("a position", place).map(|_| ()))?;
        self.check_duration(seconds)?;
        Ok(body)
    }

    /// From the centre of a collider, which poses name, to its middle, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn arm(&self, body: &Body) -> DVec3 {
        body.arm(self.colliders.anchors, -self.origin)
    }

    /// Whether a collider can move within a time, s, without a jump.
    fn check_duration(&self, seconds: Sum) -> Result<(), LiveError> {
        let least = 1e-3 * self.step;
        if seconds >= least && seconds.is_finite() { Ok(()) } else { Err(LiveError::TooFast { seconds, least }) }
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    fn checked_collider(&self, collider: u32) -> Result<&'a Body, LiveError> {
        let bodies = self.colliders.bodies;
        bodies.get(collider as usize).ok_or(LiveError::NoCollider { collider, count: bodies.len() as u32 })
    }

    /// A collider that moves as a rigid body.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn rigid_collider(&self, collider: u32) -> Result<&'a Body, LiveError> {
        let of = self.checked_collider(collider)?;
        let deforms = matches!(of.drive(), Drive::Cache(_));
        if deforms { Err(LiveError::Deforms { collider }) } else { Ok(of) }
    }
}

impl PartsMut<'_> {
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn move_collider(&mut self, collider: u32, to: Pose, seconds: Sum) -> Result<(), LiveError> {
        let parts = self.read();
        let of = parts.rigid_collider(collider)?;
        let to = to.checked().ok_or(LiveError::NotFinite { name: "the pose" })?;
        parts.check_duration(seconds)?;
        let (now, colliders) = (parts.time, parts.colliders);
        let middle = of.middle(colliders.anchors);
        let (from, before) = of.drive().pose(colliders.keys, middle, now, JumpSide::Before);
        let to = Pose { position: to.place(parts.arm(of)) - parts.origin, ..to };
        let motion = Kinematic::between(middle, [from, to], [now, now + seconds], before);
        if ![motion.during.linear, motion.during.angular].iter().all(|&v| vec3(v.into()).is_finite()) {
            return Err(LiveError::NotFinite { name: "the velocity" });
        }
        if matches!(of.form(), Form::Plane(_)) && motion.turns() {
            return Err(LiveError::PlaneTurns { collider });
        }
        self.drive(collider as usize, Drive::Host(motion));
        if self.pins.carriers.contains(&collider) {
            self.take_hold();
        }
        Ok(())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn take_impulse(&mut self, collider: u32) -> Result<Impulse, LiveError> {
        let parts = self.read();
        parts.checked_collider(collider)?;
        let pose = parts.collider_pose(collider).map_or(DVec3::ZERO, |pose| pose.position);
        let centre = pose - self.origin;
        let reactions = self.ledger.as_mut().and_then(|ledger| ledger.reactions.as_mut());
        let own = reactions.ok_or(LiveError::NotMeasured)?.colliders.element_mut(collider as usize);
        let Impulse { linear, angular } = own.map(core::mem::take).unwrap_or_default();
        Ok(Impulse { linear: -linear, angular: centre.cross(linear) - angular })
    }

    /// Moves every vertex of a mesh to a position. Its two frames begin at `first`.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn deform_collider(&mut self, body: usize, first: usize, to: &[[Sum; 3]], seconds: Sum) {
        let (now, origin) = (self.time, self.origin);
        let (Some(solids), Some(contact)) = (&mut self.solids, &mut self.contact) else { return };
        let Some(of) = solids.bodies.element(body) else { return };
        let places = contact.start.part_mut(..to.len());
        solids.colliders().place_body(of, now, places);
        let (from, next) = solids.frames.part_mut(first..first + 2 * to.len()).cut_mut(to.len());
        from.copy_from(places);
        for (next, &place) in next.iter_mut().zip(to) {
            *next = vec3((DVec3::from(place) - origin).into());
        }
        self.drive(body, Drive::Cache(Cache { first: first as u32, frames: 2, rate: 1.0 / seconds, start: now }));
    }

    pub fn switch_off(&mut self, collider: u32) -> Result<(), LiveError> {
        self.read().checked_collider(collider)?;
        self.set_off(collider as usize, true);
        Ok(())
    }

    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn switch_on(&mut self, collider: u32) -> Result<(), LiveError> {
        if !self.read().checked_collider(collider)?.is_off() {
            return Ok(());
        }
        let body = collider as usize;
        self.set_off(body, false);
        if self.overlaps(body, &|x| x) {
            self.set_off(body, true);
            return Err(LiveError::Overlaps { collider });
        }
        Ok(())
    }

    /// Whether cloth, of which each vertex is `moved`, intersects a collider, deeper than by a thousandth of the thickness.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(super) fn overlaps(&mut self, body: usize, moved: &dyn Fn(Vec3) -> Vec3) -> bool {
        let (Some(solids), Some(contact)) = (&self.solids, &mut self.contact) else { return false };
        let (colliders, slack) = (solids.colliders(), SLACK * solids.thickness);
        let Some(of) = colliders.bodies.element(body) else { return false };
        let count = self.particles.positions.len();
        let (cloth, places) = contact.start.cut_mut(count);
        for (out, &x) in cloth.iter_mut().zip(&*self.particles.positions) {
            *out = moved(x);
        }
        colliders.place(self.time, places);
        let alone = Colliders { bodies: core::slice::from_ref(of), ..colliders };
        if cloth.iter().any(|&x| alone.depth(places, x) > slack) {
            return true;
        }
        let own = places.part(of.range());
        match of.form() {
            Form::Plane(_) => false,
            Form::Sphere | Form::Capsule => {
                let axis = [own.first(), own.last()].map(|end| end.copied().unwrap_or_default());
                let near = |corners: &[u32; 3]| distance(axis, cloth.gather(corners)) < of.radius - slack;
                self.triangles.iter().any(near)
            }
            Form::Box | Form::Mesh => {
                let surface = &solids.surface;
                let first = count as u32 + of.vertices[0];
                let is_own = |vertex: u32| (first..first + of.vertices[1]).contains(&vertex);
                audit::any_crossing(surface, contact.start, &mut contact.room, |[edge, triangle]| {
                    is_own(surface.edges.at(edge as usize)[0]) || is_own(surface.triangles.at(triangle as usize)[0])
                })
            }
        }
    }

    fn set_off(&mut self, body: usize, is_off: bool) {
        if let Some(of) = self.solids.as_mut().and_then(|solids| solids.bodies.element_mut(body)) {
            of.set_off(is_off);
        }
        if let Some(contact) = &mut self.contact {
            contact.kept.forget();
        }
    }

    fn drive(&mut self, body: usize, drive: Drive) {
        if let Some(of) = self.solids.as_mut().and_then(|solids| solids.bodies.element_mut(body)) {
            of.set_drive(drive);
        }
    }
}

/// Distance of a segment, which may be a point, and a triangle, m.
#[cfg_attr(small, optimize(size), inline(never))]
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
