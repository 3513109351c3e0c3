//! The forces of contacts, kept from one step to the next by the vertices of their features: the Lagrange multipliers
//! from which the next implicit step starts.

use bytemuck::{Pod, Zeroable};

use crate::column::Column;
use crate::real::{Real, Vec3};
use crate::response::constraint::{self, Constraint};

/// The force of a contact in the last step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Multiplier {
    /// The vertices of both features.
    pub vertices: [u32; 4],
    /// The force on the first feature, N.
    pub force: Vec3,
}

/// The force of a contact; zero if it had none. The multipliers are sorted by their vertices.
pub fn force(multipliers: &[Multiplier], vertices: [u32; 4]) -> Vec3 {
    let found = multipliers.binary_search_by_key(&vertices, |multiplier| multiplier.vertices);
    found.map_or(Vec3::ZERO, |k| multipliers.at(k).force)
}

/// Writes the forces of the constraints that push, sorted by their vertices; constraints of the same features are
/// summed. Returns how many there are. `order` and `out` have room for all constraints.
pub fn write(constraints: &[Constraint], step: Real, order: &mut [u32], out: &mut [Multiplier]) -> usize {
    let mut pushing = 0;
    for (index, constraint) in (0..).zip(constraints) {
        if constraint.normal_impulse > 0.0 {
            order.set(pushing, index);
            pushing += 1;
        }
    }
    let order = order.part_mut(..pushing);
    constraint::sort_by_vertices(constraints, order);
    let mut count = 0;
    for &index in &*order {
        let Some(constraint) = constraints.element(index as usize) else { continue };
        let Constraint { contact, normal_impulse, friction_impulse, .. } = *constraint;
        let force = (contact.normal * normal_impulse + friction_impulse) / (step * step);
        match out.part_mut(..count).last_mut() {
            Some(last) if last.vertices == contact.vertices => last.force += force,
            _ => {
                out.set(count, Multiplier { vertices: contact.vertices, force });
                count += 1;
            }
        }
    }
    count
}
