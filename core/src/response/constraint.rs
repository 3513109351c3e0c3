//! One contact to be kept: n . sum W d >= target - gap for the displacements d of a step, with an
//! impulse along n that only pushes, and friction across it. Solved one after the other
//! (projected Gauss-Seidel), in a fixed order: the bits do not depend on the threads
//! [Bridson 2002, Harmon 2008].

use super::friction::Grip;
use crate::narrow_phase::Contact;
use crate::real::{Mat3, Real, Vec3, sqrt};

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
    pub fn new(contact: Contact, target: Real, grip: Grip, compliance: impl Compliance, lever: Real) -> Self {
        let inverse_mass = movable_mass(&contact, compliance, lever);
        Self { contact, target, inverse_mass, grip, normal_impulse: 0.0, friction_impulse: Vec3::ZERO }
    }
}

/// How vertices give way to impulses.
pub trait Compliance: Copy {
    /// The displacement of a vertex by an impulse times the step, m.
    fn give(self, vertex: u32, impulse: Vec3) -> Vec3;
}

/// By their masses alone: one inverse mass an axis, 0 where it is held, 1/kg.
impl Compliance for &[Vec3] {
    #[inline]
    fn give(self, vertex: u32, impulse: Vec3) -> Vec3 {
        impulse * self[vertex as usize]
    }
}

/// As the implicit system gives way at each vertex for itself.
#[derive(Clone, Copy)]
pub struct Coupled<'a> {
    /// Inverse masses, 0 where an axis is held, 1/kg.
    pub mobility: &'a [Vec3],
    /// Inverse diagonal blocks of the system, one for each vertex that it has, 1/kg.
    pub blocks: &'a [Mat3],
}

impl Compliance for Coupled<'_> {
    #[inline]
    fn give(self, vertex: u32, impulse: Vec3) -> Vec3 {
        let Some(&block) = self.blocks.get(vertex as usize) else { return Vec3::ZERO };
        let free = self.mobility[vertex as usize].cmpgt(Vec3::ZERO);
        Vec3::select(free, block * impulse, Vec3::ZERO)
    }
}

/// The inverse mass along the normal; 0 where what could move would have to go more than `lever`
/// times as far as the contact, which is as good as at what cannot: beside a pin.
fn movable_mass(contact: &Contact, compliance: impl Compliance, lever: Real) -> Real {
    let total = inverse_mass(contact, contact.normal, compliance);
    let gives = |(&v, weight): (&u32, Real)| (compliance.give(v, contact.normal) * weight).length_squared();
    let farthest = contact.vertices.iter().zip(contact.weights).map(gives).fold(0.0, Real::max);
    if farthest <= (lever * total) * (lever * total) { total } else { 0.0 }
}

/// sum W^2 u . C u along a unit vector u, 1/kg.
pub fn inverse_mass(contact: &Contact, along: Vec3, compliance: impl Compliance) -> Real {
    let parts = contact.vertices.iter().zip(contact.weights);
    parts.map(|(&v, weight)| weight * weight * along.dot(compliance.give(v, along))).sum()
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
pub fn push(contact: &Contact, impulse: Vec3, compliance: impl Compliance, moves: &mut [Vec3]) {
    for (&v, weight) in contact.vertices.iter().zip(contact.weights) {
        moves[v as usize] += compliance.give(v, impulse) * weight;
    }
}

/// Solves one constraint against the displacements as they are, with friction where it `rubs`.
/// Returns by how much it was violated, m, and whether anything moved.
pub fn solve(constraint: &mut Constraint, compliance: impl Compliance, rubs: bool, moves: &mut [Vec3]) -> (Real, bool) {
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
    if rubs && constraint.grip.rubs() {
        total += rub(constraint, relative - normal * relative.dot(normal), compliance);
    }
    push(&contact, total, compliance, moves);
    (missing, total != Vec3::ZERO)
}

/// The change of the friction impulse that a sliding displacement asks for.
fn rub(constraint: &mut Constraint, sliding: Vec3, compliance: impl Compliance) -> Vec3 {
    let size = sqrt(sliding.length_squared());
    let across = if size > 0.0 { inverse_mass(&constraint.contact, sliding / size, compliance) } else { 0.0 };
    let wanted =
        if across > 0.0 { constraint.friction_impulse - sliding / across } else { constraint.friction_impulse };
    let before = constraint.friction_impulse;
    constraint.friction_impulse = constraint.grip.limit(wanted, constraint.normal_impulse);
    constraint.friction_impulse - before
}
