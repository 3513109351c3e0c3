//! What the response and the implicit system tell one another: which contacts push, what friction
//! they bear, and with what impulses the system held them.

use super::constraint::{self, Constraint};
use super::friction::Grip;
use crate::contact::{ContactModel, ContactScratch};
use crate::integrate::coupling::Hold;
use crate::real::{Real, Vec3, sqrt};

/// A contact that pushes, as the implicit system holds it: at its target along the normal and,
/// where there is friction, across it where it is.
pub(crate) fn hold(constraint: &Constraint, index: u32, start: &[Vec3], end: &[Vec3]) -> Hold {
    let Constraint { contact, target, grip, .. } = *constraint;
    let rubs = grip.rubs();
    let predicted = constraint::weighted(&contact, end) - constraint::weighted(&contact, start);
    let along = contact.normal * contact.normal.dot(predicted);
    Hold {
        vertices: contact.vertices,
        weights: contact.weights,
        normal: contact.normal,
        missing: contact.normal * (target - contact.gap) - if rubs { predicted } else { along },
        slide: sqrt((predicted - along).length_squared()),
        sticks: if rubs { 1.0 } else { 0.0 },
        constraint: index,
        ..Hold::default()
    }
}

/// Lets go of contacts that the system had to pull, and softens the friction of those that it had
/// to hold beyond the cone: to the stiffness with which the slide there would be without friction
/// meets what the cone allows. Friction so made opposes the slide and cannot turn it round.
/// Returns whether there were any.
pub(crate) fn release(constraints: &[Constraint], holds: &mut [Hold], step: Real) -> bool {
    let mut any = false;
    for hold in holds.iter_mut().filter(|hold| hold.released == 0.0) {
        let along = hold.impulse.dot(hold.normal);
        if along <= 0.0 {
            (hold.released, any) = (1.0, true);
        } else if hold.sticks == 1.0 {
            let across = hold.impulse - hold.normal * along;
            let allowed = constraints[hold.constraint as usize].grip.limit(across, along);
            if allowed != across {
                let speed = (hold.slide / step).max(Real::MIN_POSITIVE);
                let stiffness = sqrt(allowed.length_squared()) / speed;
                hold.sticks = (stiffness / hold.stiffness).min(0.999);
                any = true;
            }
        }
    }
    any
}

/// Gives constraints the impulses with which the system held them, from where the response goes on.
pub(crate) fn carry(
    model: &ContactModel<'_>,
    scratch: &mut ContactScratch<'_>,
    pressed: usize,
    held: usize,
    step: Real,
) {
    for constraint in &mut scratch.constraints[..pressed] {
        *constraint = Constraint::new(constraint.contact, constraint.target, constraint.grip, model.mobility);
    }
    for hold in &scratch.holds[..held] {
        let constraint = &mut scratch.constraints[hold.constraint as usize];
        let along = hold.impulse.dot(hold.normal);
        if along > 0.0 {
            let across = hold.impulse - hold.normal * along;
            // What slid in the system does not stick now, and what stuck does not lose its grip.
            let Grip { sticks, slides } = constraint.grip;
            constraint.grip = Grip::always(if hold.sticks < 1.0 { slides } else { sticks });
            constraint.normal_impulse = along * step;
            constraint.friction_impulse = constraint.grip.limit(across, along) * step;
        }
    }
}
