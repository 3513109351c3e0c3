//! The columns that the live interface reads and changes, borrowed from their owner.

use glam::DVec3;

use super::forces::HostForces;
use crate::colliders::Colliders;
use crate::column::Column;
use crate::contact::{ContactScratch, Solids};
use crate::error::LiveError;
use crate::forces::Model;
use crate::forces::load::VertexForce;
use crate::integrate::pins::{PinSlots, Pins};
use crate::particles::{Particles, Positions};
use crate::real::{Sum, Vec3};
use crate::response::constraint::Constraint;
use crate::step::History;
use crate::work_done::Ledger;

/// An owner of a cloth.
pub trait Owner {
    /// The columns that calls read.
    fn parts(&self) -> Parts<'_>;
    /// The columns that calls change.
    fn parts_mut(&mut self) -> PartsMut<'_>;
    /// Adds a slot; false if the owner cannot.
    fn add_slot(&mut self, slot: Slot) -> bool;
    /// Index of the first of two frames for a collider that the host deforms.
    fn make_frames(&mut self, body: usize) -> Result<usize, LiveError>;
}

/// Room for something that the host adds to one vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// A pin.
    Pin,
    /// A pin that a collider carries.
    CarriedPin,
    /// A force.
    Force,
}

/// Columns to read.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    /// The point in the world from which positions are measured, m.
    pub origin: DVec3,
    /// Simulated time, s.
    pub time: Sum,
    /// Length of a step, s.
    pub step: Sum,
    /// Length of the last substep, s; 0: its contacts do not count any more.
    pub substep: Sum,
    /// Positions of the cloth, m.
    pub positions: Positions<'a>,
    /// Velocities of the cloth, m/s.
    pub velocities: &'a [Vec3],
    /// Triangles of the cloth.
    pub triangles: &'a [[u32; 3]],
    /// First vertex of each cloth and, last, of the colliders; empty without contact.
    pub firsts: &'a [u32],
    /// The pins.
    pub pins: Pins<'a>,
    /// The colliders.
    pub colliders: Colliders<'a>,
    /// The contacts of the last step.
    pub constraints: &'a [Constraint],
}

/// Columns to change.
pub struct PartsMut<'a> {
    /// The point in the world from which positions are measured, m.
    pub origin: DVec3,
    /// Simulated time, s.
    pub time: Sum,
    /// Length of a step, s.
    pub step: Sum,
    /// Length of the last substep, s; 0: its contacts do not count any more.
    pub substep: &'a mut Sum,
    /// The cloth.
    pub particles: Particles<'a>,
    /// Triangles of the cloth.
    pub triangles: &'a [[u32; 3]],
    /// The forces of the scene.
    pub model: Model<'a>,
    /// Gravity and wind of the host.
    pub host: &'a mut HostForces,
    /// Forces of the host on vertices.
    pub forces: &'a mut [VertexForce],
    /// The pins.
    pub pins: PinSlots<'a>,
    /// Held axes of each vertex for the preconditioner; may be empty.
    pub held: &'a mut [u8],
    /// What can touch.
    pub solids: Option<Solids<'a>>,
    /// The columns of contact.
    pub contact: Option<ContactScratch<'a>>,
    /// Changes of positions and velocities in the last step; may be empty.
    pub previous: [&'a mut [Vec3]; 2],
    /// How the state came about.
    pub history: &'a mut History,
    /// Where work and impulses are counted, if they are.
    pub ledger: Option<Ledger<'a>>,
}

impl PartsMut<'_> {
    /// The same columns, to read.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn read(&self) -> Parts<'_> {
        let colliders = self.colliders();
        let constraints = self.contact.as_ref().map(|contact| contact.constraints.part(..contact.lengths.constraints));
        Parts {
            origin: self.origin,
            time: self.time,
            step: self.step,
            substep: *self.substep,
            positions: (&self.particles).into(),
            velocities: self.particles.velocities,
            triangles: self.triangles,
            firsts: self.solids.as_ref().map_or(&[], |solids| solids.firsts),
            pins: self.pins.carried_by(colliders),
            colliders,
            constraints: constraints.unwrap_or_default(),
        }
    }

    /// The colliders.
    pub fn colliders(&self) -> Colliders<'_> {
        self.solids.as_ref().map(Solids::colliders).unwrap_or_default()
    }
}
