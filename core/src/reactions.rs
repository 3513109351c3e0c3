//! The impulses that pins and colliders give to the cloth, and the moments of these impulses. Divided by a time they
//! are mean forces: the reactions.
//!
//! The impulse of a pin is the change of momentum along its held axes, less the impulses of the forces and the
//! contacts. The forces are those of the [work](crate::work_done).

use core::ops::Range;

use glam::DVec3;

use crate::column::Column;
use crate::contact::{ContactModel, ContactScratch};
use crate::integrate::StepInput;
use crate::real::{Real, Sum, Vec3, to_f64};
use crate::response::constraint::Constraint;
use crate::scratch::Scratch;

/// The pins of one `[[cloth.pin]]` of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PinGroup {
    /// Index of the cloth.
    pub cloth: u32,
    /// Number of the group in its cloth.
    pub number: u32,
    /// Its pins in the columns of pins.
    pub pins: Range<usize>,
}

/// An impulse and its moment. [`Reactions`] are those on the cloth, about the origin of the positions;
/// [`take_impulse`](crate::live::Live::take_impulse) gives that on a collider, about its centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Impulse {
    /// The impulse, N s.
    pub linear: DVec3,
    /// Its moment, N m s.
    pub angular: DVec3,
}

impl Impulse {
    fn add(&mut self, at: Vec3, impulse: DVec3) {
        self.linear += impulse;
        self.angular += DVec3::from(to_f64(at)).cross(impulse);
    }
}

/// The sums of impulses, borrowed.
#[derive(Debug)]
pub struct Reactions<'a> {
    /// The groups of pins.
    pub groups: &'a [PinGroup],
    /// Impulses of the groups.
    pub pins: &'a mut [Impulse],
    /// Impulses of the colliders, also by the pins that they carry.
    pub colliders: &'a mut [Impulse],
}

impl Reactions<'_> {
    /// The same sums for a shorter time.
    pub fn reborrow(&mut self) -> Reactions<'_> {
        Reactions { groups: self.groups, pins: self.pins, colliders: self.colliders }
    }

    /// Adds the impulses of the pins in the step to the candidate state in `s`. Its forces contain those of contacts,
    /// and along held axes those of the [equations](crate::integrate::pin_forces) of an implicit step. The positions of
    /// its stage are those in the middle of the step.
    pub fn add_pins<D>(&mut self, c: &StepInput<'_, D>, s: &Scratch<'_>) {
        let step = Sum::from(c.step);
        let impulse = |vertex: usize, axes: &mut dyn Iterator<Item = usize>| {
            let [change, force] = [&*s.velocity_changes, &*s.forces].map(|of| DVec3::from(to_f64(of.at(vertex))));
            let all = (change * Sum::from(c.masses.at(vertex)) - force * step).to_array();
            let mut own = [0.0; 3];
            axes.for_each(|axis| own.set(axis, all.at(axis)));
            own.into()
        };
        for (group, sum) in self.groups.iter().zip(&mut *self.pins) {
            for (_, vertex, mut axes) in c.pins.iter().take(group.pins.end).skip(group.pins.start) {
                sum.add(s.stage_positions.rounded.at(vertex), impulse(vertex, &mut axes));
            }
        }
        for (pin, vertex, mut axes) in c.pins.iter() {
            if let Some(carrier) = c.pins.carrier(pin) {
                self.add_collider(carrier, s.stage_positions.rounded.at(vertex), impulse(vertex, &mut axes));
            }
        }
    }

    /// Adds an impulse of one pin at a position, m. A collider may carry the pin.
    pub fn add_pin(&mut self, pin: usize, carrier: Option<usize>, at: Vec3, impulse: DVec3) {
        let groups = self.groups.iter().zip(&mut *self.pins);
        for (_, sum) in groups.filter(|(group, _)| group.pins.contains(&pin)) {
            sum.add(at, impulse);
        }
        if let Some(carrier) = carrier {
            self.add_collider(carrier, at, impulse);
        }
    }

    /// Adds the impulses of colliders. `step` is the length of the step, s.
    pub fn add_colliders(&mut self, model: &ContactModel<'_>, contact: &ContactScratch<'_>, step: Real) {
        let cloth = model.cloth();
        for constraint in contact.constraints.part(..contact.lengths.constraints) {
            let Some(vertex) = constraint.contact.vertices.iter().find(|&&v| v as usize >= cloth) else { continue };
            let body = model.colliders.body_of(*vertex as usize - cloth);
            for (v, impulse) in impulses(constraint, step).filter(|(v, _)| *v < cloth) {
                self.add_collider(body, contact.end.at(v), impulse);
            }
        }
    }

    /// Adds an impulse of one collider at a position, m.
    fn add_collider(&mut self, collider: usize, at: Vec3, impulse: DVec3) {
        if let Some(sum) = self.colliders.element_mut(collider) {
            sum.add(at, impulse);
        }
    }
}

/// The impulses of a contact on its vertices, N s.
pub fn impulses(constraint: &Constraint, step: Real) -> impl Iterator<Item = (usize, DVec3)> {
    let contact = constraint.contact;
    // Impulse times the step, kg m.
    let impulse = contact.normal * constraint.normal_impulse + constraint.friction_impulse;
    let impulse = DVec3::from(to_f64(impulse)) / Sum::from(step);
    let corners = contact.vertices.into_iter().zip(contact.weights);
    corners.map(move |(vertex, weight)| (vertex as usize, impulse * Sum::from(weight)))
}

/// The owned columns of [`Reactions`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReactionColumns {
    /// Impulses of the groups of pins.
    pub pins: alloc::vec::Vec<Impulse>,
    /// Impulses of the colliders.
    pub colliders: alloc::vec::Vec<Impulse>,
}

#[cfg(feature = "alloc")]
impl ReactionColumns {
    /// The borrowed view that a step takes.
    pub fn view<'a>(&'a mut self, groups: &'a [PinGroup]) -> Reactions<'a> {
        Reactions { groups, pins: &mut self.pins, colliders: &mut self.colliders }
    }

    /// Sets all sums to zero.
    pub fn clear(&mut self) {
        self.pins.fill(Impulse::default());
        self.colliders.fill(Impulse::default());
    }

    /// Copies the sums without an allocation; both have the same lengths.
    pub fn copy_from(&mut self, other: &Self) {
        self.pins.copy_from_slice(&other.pins);
        self.colliders.copy_from_slice(&other.colliders);
    }

    /// Size of the columns, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.pins[..]) + size_of_val(&self.colliders[..])
    }
}
