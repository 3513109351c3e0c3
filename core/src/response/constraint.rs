//! One contact to be kept: n . sum W d >= target - gap for the displacements d of a step, with an
//! impulse along n that only pushes, and friction across it. Solved one after the other
//! (projected Gauss-Seidel), in a fixed order: the bits do not depend on the threads
//! [Bridson 2002, Harmon 2008].

use super::friction::Grip;
use crate::narrow_phase::Contact;
use crate::real::{Real, Vec3, sqrt};

/// A contact with what it has to keep and the impulses that keep it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Constraint {
    /// Who meets whom, where and along which normal.
    pub contact: Contact,
    /// Least gap at the end of the step, m.
    pub target: Real,
    /// Effective inverse mass along the normal, 1/kg; 0: nothing can move.
    pub inverse_mass: Real,
    /// The friction that it bears.
    pub grip: Grip,
    /// Impulse along the normal times the step, kg m.
    pub normal_impulse: Real,
    /// Impulse across it times the step, kg m.
    pub friction_impulse: Vec3,
}

impl Constraint {
    /// A constraint without impulses yet. Nothing moves what would have to go more than `lever` times as
    /// far as the contact.
    pub fn new(contact: Contact, target: Real, grip: Grip, mobility: &[Vec3], lever: Real) -> Self {
        let inverse_mass = movable_mass(&contact, mobility, lever);
        Self { contact, target, inverse_mass, grip, normal_impulse: 0.0, friction_impulse: Vec3::ZERO }
    }
}

/// Sorts indices of constraints by the vertices of their features, those of the same features by their index. Not
/// inlined: a sort is long.
#[inline(never)]
pub fn sort_by_vertices(constraints: &[Constraint], order: &mut [u32]) {
    order.sort_unstable_by_key(|&index| (constraints[index as usize].contact.vertices, index));
}

/// The inverse mass along the normal; 0 where what could move would have to go more than `lever`
/// times as far as the contact, which is as good as at what cannot: beside a pin.
fn movable_mass(contact: &Contact, mobility: &[Vec3], lever: Real) -> Real {
    let total = inverse_mass(contact, contact.normal, mobility);
    let gives = |(&v, weight): (&u32, Real)| (contact.normal * mobility[v as usize] * weight).length_squared();
    let farthest = contact.vertices.iter().zip(contact.weights).map(gives).fold(0.0, Real::max);
    if farthest <= (lever * total) * (lever * total) { total } else { 0.0 }
}

/// sum W^2 u . C u along a unit vector u, 1/kg.
pub fn inverse_mass(contact: &Contact, along: Vec3, mobility: &[Vec3]) -> Real {
    let parts = contact.vertices.iter().zip(contact.weights);
    parts.map(|(&v, weight)| weight * weight * along.dot(along * mobility[v as usize])).sum()
}

/// sum W c over a contact's vertices.
#[inline]
pub fn weighted(contact: &Contact, column: &[Vec3]) -> Vec3 {
    let [a, b, c, d] = contact.vertices.map(|v| column[v as usize]);
    let w = contact.weights;
    a * w[0] + b * w[1] + c * w[2] + d * w[3]
}

/// Adds an impulse (times the step) to the displacements.
#[inline]
pub fn push(contact: &Contact, impulse: Vec3, mobility: &[Vec3], moves: &mut [Vec3]) {
    for (&v, weight) in contact.vertices.iter().zip(contact.weights) {
        moves[v as usize] += impulse * mobility[v as usize] * weight;
    }
}

/// Solves one constraint against the displacements as they are, with friction. Returns by how much it
/// was violated, m, and whether anything moved.
pub fn solve(constraint: &mut Constraint, mobility: &[Vec3], moves: &mut [Vec3]) -> (Real, bool) {
    let Constraint { contact, inverse_mass: along, .. } = *constraint;
    if along <= 0.0 {
        return (0.0, false);
    }
    let relative = weighted(&contact, moves);
    let normal = contact.normal;
    let missing = constraint.target - contact.gap - relative.dot(normal);
    let impulse = (constraint.normal_impulse + missing / along).max(0.0);
    let change = impulse - constraint.normal_impulse;
    if impulse == 0.0 && change == 0.0 {
        return (0.0, false);
    }
    constraint.normal_impulse = impulse;
    let mut total = normal * change;
    if constraint.grip.rubs() {
        total += rub(constraint, relative - normal * relative.dot(normal), mobility);
    }
    push(&contact, total, mobility, moves);
    (missing, total != Vec3::ZERO)
}

/// The change of the friction impulse that a sliding displacement asks for.
fn rub(constraint: &mut Constraint, sliding: Vec3, mobility: &[Vec3]) -> Vec3 {
    let size = sqrt(sliding.length_squared());
    let across = if size > 0.0 { inverse_mass(&constraint.contact, sliding / size, mobility) } else { 0.0 };
    let wanted =
        if across > 0.0 { constraint.friction_impulse - sliding / across } else { constraint.friction_impulse };
    let before = constraint.friction_impulse;
    constraint.friction_impulse = constraint.grip.limit(wanted, constraint.normal_impulse);
    constraint.friction_impulse - before
}
