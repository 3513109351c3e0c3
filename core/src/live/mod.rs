//! The live interface: the calls by which a host changes and reads a cloth between steps. A
//! [`Simulation`](crate::simulation::Simulation) and a [cooked](crate::cooked) cloth have the same calls, because both
//! lend the same columns.
//!
//! Positions are in the world, in meters; times are in seconds. A call that is refused changes nothing.

mod colliders;
mod forces;
mod parts;
mod pins;
mod query;
mod teleport;

pub use query::{Hit, Side, SurfacePoint, Touch};

pub(crate) use forces::HostForces;
pub(crate) use parts::{Owner, Parts, PartsMut, Slot};

use crate::error::LiveError;
use crate::kinematic::Pose;
use crate::reactions::Impulse;
use crate::real::Sum;

/// The calls.
pub trait Live: Owner {
    /// Moves a collider evenly from its present pose to another one within `seconds`. Then it rests there.
    /// It turns by the shorter of the two ways, so by at most half a turn. Call this before every step with the length of
    /// the step; each call replaces the motion before, also that of the scene. The steps detect everything in the
    /// way of the collider.
    ///
    /// The centre of a collider is the middle of a sphere, a capsule or a box, or the point of a plane; that of a mesh is
    /// the zero of the coordinates of its vertices. The rotation is that from the orientation in the scene.
    fn move_collider(&mut self, collider: u32, to: Pose, seconds: Sum) -> Result<(), LiveError> {
        self.parts_mut().move_collider(collider, to, seconds)
    }

    /// The present pose of a collider. Before the first move its place is that of the scene rounded to the precision of
    /// columns.
    fn collider_pose(&self, collider: u32) -> Result<Pose, LiveError> {
        self.parts().collider_pose(collider)
    }

    /// The impulse that the cloth has given a collider since the last call, N s, and its moment about the present centre
    /// of the collider, or about the world's origin for one that deforms, N m s. A rigid-body engine adds both to its body.
    /// A host that divides the impulse by the time since the last call gets the mean force, N. They must be
    /// [measured](crate::simulation::Simulation::measure_reactions). What the cloth loses the collider gets, to rounding
    /// and to the tolerance of the solver.
    fn take_impulse(&mut self, collider: u32) -> Result<Impulse, LiveError> {
        self.parts_mut().take_impulse(collider)
    }

    /// Moves every vertex of a mesh evenly to a position within `seconds`. Then they rest there. Each call replaces the
    /// motion before. The first call for a collider needs memory: a simulation allocates it, a cooked cloth has it if the
    /// scene was cooked with room for it.
    fn deform_collider(&mut self, collider: u32, to: &[[Sum; 3]], seconds: Sum) -> Result<(), LiveError> {
        let body = self.parts().deformable(collider, to, seconds)?;
        let first = self.make_frames(body)?;
        self.parts_mut().deform_collider(body, first, to, seconds);
        Ok(())
    }

    /// Switches a collider off: nothing touches it any more. It still moves.
    fn switch_off(&mut self, collider: u32) -> Result<(), LiveError> {
        self.parts_mut().switch_off(collider)
    }

    /// Switches a collider on again. Refuses where cloth intersects it.
    fn switch_on(&mut self, collider: u32) -> Result<(), LiveError> {
        self.parts_mut().switch_on(collider)
    }

    /// Moves a vertex, pinned or free, at constant velocity to `place` within `seconds`, or at once for 0. It stays pinned
    /// there. A cooked cloth has a fixed number of slots for such vertices.
    fn move_to(&mut self, vertex: u32, place: [Sum; 3], seconds: Sum) -> Result<(), LiveError> {
        with_slot(self, Slot::Pin, |parts| parts.move_to(vertex, place, seconds))
    }

    /// Pins a vertex to a collider where it is now: it moves with the collider.
    fn attach(&mut self, vertex: u32, collider: u32) -> Result<(), LiveError> {
        with_slot(self, Slot::CarriedPin, |parts| parts.attach(vertex, collider))
    }

    /// Removes all pins of a vertex. It keeps the velocity with which they moved it until now. Returns false if it has no
    /// pin or does not exist.
    fn release(&mut self, vertex: u32) -> bool {
        self.parts_mut().release(vertex)
    }

    /// Replaces gravity by a constant one, m/s^2.
    fn set_gravity(&mut self, acceleration: [Sum; 3]) -> Result<(), LiveError> {
        self.parts_mut().set_gravity(acceleration)
    }

    /// Replaces the velocity of the air by a constant one, m/s. The scene must have wind, if only at velocity 0: it gives
    /// the coefficients.
    fn set_wind(&mut self, velocity: [Sum; 3]) -> Result<(), LiveError> {
        self.parts_mut().set_wind(velocity)
    }

    /// Sets a force on a vertex, N, until it is set again. It adds to the loads of the scene. A simulation may allocate; a
    /// cooked cloth has a fixed number of slots for vertices with a force.
    fn set_force(&mut self, vertex: u32, force: [Sum; 3]) -> Result<(), LiveError> {
        with_slot(self, Slot::Force, |parts| parts.set_force(vertex, force))
    }

    /// Gives a vertex an impulse, N s: its velocity changes at once, but not along axes that a pin holds.
    fn push(&mut self, vertex: u32, impulse: [Sum; 3]) -> Result<(), LiveError> {
        self.parts_mut().push(vertex, impulse)
    }

    /// Moves all cloth, its pins and the given colliders by a rotation about the world's origin, and then by a
    /// displacement, m. Velocities turn with them; the cloth feels nothing of it. Other colliders, gravity and wind stay.
    ///
    /// Refuses where cloth would intersect a collider that stays, where one that comes along still moves by keys or by a
    /// point cache, where a pin holds single axes that would have to turn, and where a collider that stays carries a pin.
    /// [Take](Self::take_impulse) impulses before it: it does not turn them.
    fn teleport(&mut self, by: Pose, colliders: &[u32]) -> Result<(), LiveError> {
        self.parts_mut().teleport(by, colliders)
    }

    /// The contacts that push, in the last step, or in its last substep if it was divided. The list is empty after a step
    /// that failed, a teleport or going back to a snapshot.
    fn touches(&self) -> impl Iterator<Item = Touch> {
        self.parts().touches()
    }

    /// The point of a triangle with these barycentric coordinates, for example to hang something on it or to move a finer
    /// mesh with it. The coordinates may be negative; their sum should be 1.
    fn point(&self, triangle: u32, weights: [Sum; 3]) -> Result<SurfacePoint, LiveError> {
        self.parts().point(triangle, weights)
    }

    /// The first triangle of any cloth, from either side, that a ray hits [Möller 1997]. `direction` need not have unit
    /// length; a direction of zero hits nothing. Colliders hide nothing. Every triangle is tested.
    fn hit(&self, origin: [Sum; 3], direction: [Sum; 3]) -> Result<Option<Hit>, LiveError> {
        self.parts().hit(origin, direction)
    }
}

impl<T: Owner> Live for T {}

/// Makes a call, and again with one slot more if it lacks one and the owner can add it.
fn with_slot<T: Owner + ?Sized>(
    owner: &mut T,
    slot: Slot,
    call: impl Fn(&mut PartsMut<'_>) -> Result<(), LiveError>,
) -> Result<(), LiveError> {
    match call(&mut owner.parts_mut()) {
        Err(LiveError::NoSlot) if owner.add_slot(slot) => call(&mut owner.parts_mut()),
        result => result,
    }
}
