//! The constraint of a contact: n . sum W d >= target - gap for the displacements d of a step, with an impulse along n
//! that only pushes, and friction across n. Constraints are solved one after the other (projected Gauss-Seidel) in a
//! fixed order, so that the bits do not depend on the number of threads [Bridson 2002, Harmon 2008].

use super::friction::FrictionCoefficients;
use crate::column::Column;
use crate::inverse_masses::InverseMasses;
use crate::narrow_phase::Contact;
use crate::quicksort;
use crate::real::{Flag, Real, Vec3, sqrt};

/// A contact with its least gap and its impulses.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Constraint {
    /// The features, their nearest points and the normal.
    pub contact: Contact,
    /// Least gap at the end of the step, m.
    pub target: Real,
    /// Effective inverse mass along the normal, 1/kg; 0: nothing can move.
    pub inverse_mass: Real,
    /// Displacement of the first feature relative to a surface that [turns](super::roll) under it, m.
    pub roll: Vec3,
    /// The coefficients of friction.
    pub coefficients: FrictionCoefficients,
    /// Whether an implicit solve found its friction, which is not changed.
    pub is_solved: Flag,
    /// Impulse along the normal times the step, kg m.
    pub normal_impulse: Real,
    /// Impulse across it times the step, kg m.
    pub friction_impulse: Vec3,
}

impl Constraint {
    /// A constraint with zero impulses, of surfaces that do not turn. It is not solved if a vertex would have to move
    /// more than `lever_ratio` times as far as the contact.
    #[cfg_attr(small, inline(never))]
    pub fn new(
        contact: Contact,
        target: Real,
        coefficients: FrictionCoefficients,
        inverse_masses: &InverseMasses<'_>,
        lever_ratio: Real,
    ) -> Self {
        let inverse_mass = movable_inverse_mass(&contact, inverse_masses, lever_ratio);
        Self { contact, target, inverse_mass, coefficients, ..Self::default() }
    }

    /// Whether it is violated, or pushes apart, by at most `tolerance`, m.
    pub fn is_within(&self, tolerance: Real, displacements: &[Vec3]) -> bool {
        self.violation(self.relative(displacements)).abs() <= tolerance
    }

    /// By how much the gap at the end is less than the target, m, for a relative displacement.
    fn violation(&self, relative: Vec3) -> Real {
        self.target - self.contact.gap - relative.dot(self.contact.normal)
    }

    /// Relative displacement of the two surfaces, m.
    pub fn relative(&self, displacements: &[Vec3]) -> Vec3 {
        weighted(&self.contact, displacements) + self.roll
    }
}

/// Sorts indices of constraints by the vertices of their features, those of the same features by their index. Not
/// inlined: a sort is long.
#[inline(never)]
pub fn sort_by_vertices(constraints: &[Constraint], order: &mut [u32]) {
    quicksort::sort_by_key(order, |&index| (as_number(vertices(constraints, index)), index));
}

/// The four vertices as one number, in the same order. It is compared without branches.
pub fn as_number(vertices: [u32; 4]) -> u128 {
    vertices.iter().fold(0, |number, &v| number << 32 | u128::from(v))
}

/// The vertices of the features of a constraint.
pub fn vertices(constraints: &[Constraint], index: u32) -> [u32; 4] {
    constraints.element(index as usize).map_or([0; 4], |constraint| constraint.contact.vertices)
}

/// The inverse mass along the normal. It is 0 if a vertex would have to move more than `lever_ratio` times as far as
/// the contact, as beside a pin.
fn movable_inverse_mass(contact: &Contact, inverse_masses: &InverseMasses<'_>, lever_ratio: Real) -> Real {
    let total = inverse_mass(contact, contact.normal, inverse_masses);
    let gives = |(&v, weight): (&u32, Real)| (contact.normal * inverse_masses.at(v as usize) * weight).length_squared();
    let farthest = contact.vertices.iter().zip(contact.weights).map(gives).fold(0.0, Real::max);
    if farthest <= (lever_ratio * total) * (lever_ratio * total) { total } else { 0.0 }
}

/// sum W^2 u . C u along a unit vector u, 1/kg.
pub fn inverse_mass(contact: &Contact, along: Vec3, inverse_masses: &InverseMasses<'_>) -> Real {
    let parts = contact.vertices.iter().zip(contact.weights);
    parts.map(|(&v, weight)| weight * weight * along.dot(along * inverse_masses.at(v as usize))).sum()
}

/// sum W c over a contact's vertices.
#[inline]
pub fn weighted(contact: &Contact, column: &[Vec3]) -> Vec3 {
    let [a, b, c, d] = column.gather(&contact.vertices);
    let w = contact.weights;
    a * w[0] + b * w[1] + c * w[2] + d * w[3]
}

/// Adds an impulse (times the step) to the displacements.
#[inline]
pub fn apply_impulse(contact: &Contact, impulse: Vec3, inverse_masses: &InverseMasses<'_>, displacements: &mut [Vec3]) {
    for (&v, weight) in contact.vertices.iter().zip(contact.weights) {
        displacements.add(v as usize, impulse * inverse_masses.at(v as usize) * weight);
    }
}

/// Solves one constraint with friction for the present displacements. Returns its violation, m, and whether a vertex
/// moved.
pub fn solve(
    constraint: &mut Constraint,
    inverse_masses: &InverseMasses<'_>,
    displacements: &mut [Vec3],
) -> (Real, bool) {
    let Constraint { contact, inverse_mass: along, .. } = *constraint;
    if along <= 0.0 {
        return (0.0, false);
    }
    let relative = constraint.relative(displacements);
    let normal = contact.normal;
    let violation = constraint.violation(relative);
    let impulse = (constraint.normal_impulse + violation / along).max(0.0);
    let change = impulse - constraint.normal_impulse;
    if impulse == 0.0 && change == 0.0 {
        return (0.0, false);
    }
    constraint.normal_impulse = impulse;
    let mut total = normal * change;
    if constraint.coefficients.has_friction() && !constraint.is_solved.is_set() {
        total += friction_change(constraint, relative - normal * relative.dot(normal), inverse_masses);
    }
    apply_impulse(&contact, total, inverse_masses, displacements);
    (violation, total != Vec3::ZERO)
}

/// The change of the friction impulse for a sliding displacement.
fn friction_change(constraint: &mut Constraint, sliding: Vec3, inverse_masses: &InverseMasses<'_>) -> Vec3 {
    let size = sqrt(sliding.length_squared());
    let across = if size > 0.0 { inverse_mass(&constraint.contact, sliding / size, inverse_masses) } else { 0.0 };
    let needed =
        if across > 0.0 { constraint.friction_impulse - sliding / across } else { constraint.friction_impulse };
    let before = constraint.friction_impulse;
    constraint.friction_impulse = constraint.coefficients.limit(needed, constraint.normal_impulse);
    constraint.friction_impulse - before
}
