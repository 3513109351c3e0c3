//! The exchange of contacts between the response and the solve of an implicit step. The solve gets the constraints,
//! with the impulses of the step before. The response gets the impulses that the solve found.

use core::ops::Range;

use super::augmented_contact::{AugmentedContact, Friction};
use super::multiplier;
use crate::column::Column;
use crate::contact::{ContactModel, ContactScratch};
use crate::narrow_phase::gather;
use crate::real::{Real, Vec3, sqrt};
use crate::response::constraint::Constraint;
use crate::response::friction::FrictionCoefficients;
use crate::response::repulsion::{Known, MOST_LEVER_RATIO};

/// How far from the cone friction may be left, relative to what the cone allows.
const SLACK: Real = 0.05;

/// Violation of a contact in a solve that makes it stiffer, relative to the thickness.
const VIOLATION: Real = 0.3;

/// A slide that the response may stop, relative to the thickness. A larger one is as the cloth gives way to friction on
/// the cone: the response knows only masses, and a little more friction would hold against all tension.
const SMALL: Real = 0.1;

/// Adds the constraints whose vertices can move to the contacts of the solve, with their predicted displacements in place
/// of velocities. If a pair has several constraints, the first one gets its multiplier. `step` is the length of the step,
/// s.
pub fn add_contacts(model: &ContactModel<'_>, scratch: &mut ContactScratch<'_>, constraints: Range<usize>, step: Real) {
    let multipliers = scratch.multipliers.part(..scratch.lengths.multipliers);
    let known = Known::sort(scratch.constraints.part(..constraints.end), scratch.order);
    let mut given = scratch.lengths.contacts;
    for (index, constraint) in (constraints.start as u32..).zip(scratch.constraints.part(constraints)) {
        let Constraint { contact, target, coefficients, inverse_mass, .. } = *constraint;
        if inverse_mass <= 0.0 {
            continue;
        }
        let is_first = known.first(scratch.constraints, contact.vertices) == Some(index);
        let force = if is_first { multiplier::force(multipliers, contact.vertices) } else { Vec3::ZERO };
        let radius = gather(contact.vertices, model.radii).into_iter().fold(0.0, Real::max);
        let added = AugmentedContact {
            vertices: contact.vertices,
            weights: contact.weights,
            normal: contact.normal,
            centre_distance: if radius > 0.0 { radius + contact.gap } else { 0.0 },
            least_velocity: target - contact.gap,
            slack: VIOLATION * model.thickness,
            velocity: constraint.relative(scratch.displacements),
            multiplier: force * step,
            coefficients: [coefficients.at_rest, coefficients.kinetic],
            constraint: index,
            ..AugmentedContact::default()
        };
        scratch.contacts.set(given, added);
        given += 1;
    }
    scratch.lengths.contacts = given;
}

/// Adds the impulses of the constraints to a column over the vertices of the cloth, kg m/s. `step` is the length of the
/// step, s.
pub fn add_impulses(scratch: &ContactScratch<'_>, step: Real, out: &mut [Vec3]) {
    for constraint in scratch.constraints.part(..scratch.lengths.constraints) {
        let impulse = (constraint.contact.normal * constraint.normal_impulse + constraint.friction_impulse) / step;
        for (&vertex, weight) in constraint.contact.vertices.iter().zip(constraint.contact.weights) {
            if let Some(out) = out.get_mut(vertex as usize) {
                *out += impulse * weight;
            }
        }
    }
}

/// Writes the impulses that the solve found to the constraints. The response starts from them. `length` is that of the
/// stage, s: the solve moves the cloth over it.
pub fn write_impulses(model: &ContactModel<'_>, scratch: &mut ContactScratch<'_>, length: Real) {
    for constraint in scratch.constraints.part_mut(..scratch.lengths.constraints) {
        let Constraint { contact, target, roll, coefficients, .. } = *constraint;
        let fresh = Constraint::new(contact, target, coefficients, &model.inverse_masses, MOST_LEVER_RATIO);
        *constraint = Constraint { roll, ..fresh };
    }
    for solved in scratch.contacts.part(..scratch.lengths.contacts) {
        let Some(constraint) = scratch.constraints.element_mut(solved.constraint as usize) else { continue };
        let along = solved.normal_impulse();
        if along > 0.0 {
            // A contact that slid in the solve does not stick now, and one that stuck keeps its friction.
            let across = solved.impulse - solved.normal * along;
            let FrictionCoefficients { at_rest, kinetic } = constraint.coefficients;
            constraint.coefficients = FrictionCoefficients::always(match solved.friction {
                Friction::Rests | Friction::Sticks => at_rest,
                Friction::Slips if solved.slide(solved.velocity) * length < SMALL * model.thickness => kinetic,
                Friction::Slips => kinetic.min((1.0 + SLACK) * sqrt(across.length_squared()) / along),
            });
            constraint.is_solved = true.into();
            constraint.normal_impulse = along * length;
            constraint.friction_impulse = constraint.coefficients.limit(across, along) * length;
        }
    }
}
