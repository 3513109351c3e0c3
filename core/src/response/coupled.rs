//! What the response and the implicit system tell one another: which contacts push, what friction
//! they bear, and with what impulses the system held them.

use super::constraint::{self, Constraint};
use super::friction::Grip;
use super::repulsion::MOST_LEVER;
use crate::contact::{ContactModel, ContactScratch};
use crate::integrate::coupling::Hold;
use crate::real::{Real, Vec3, sqrt};

/// How far from the cone friction may be left, of what the cone allows.
const SLACK: Real = 0.05;

/// A slide that the response may stop, of the thickness. A larger one is as the cloth gives way to
/// friction on the cone: the response knows only masses, and a little more friction would hold
/// against all tension.
const SMALL: Real = 0.1;

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
        slide: length(predicted - along),
        sticks: if rubs { 1.0 } else { 0.0 },
        constraint: index,
        ..Hold::default()
    }
}

/// Lets go of contacts that the system had to pull, and softens the friction of those that it had
/// to hold beyond the cone. Returns whether there were any.
pub(crate) fn release(model: &ContactModel<'_>, constraints: &[Constraint], holds: &mut [Hold], step: Real) -> bool {
    let mut any = false;
    for hold in holds.iter_mut().filter(|hold| hold.released == 0.0) {
        let along = hold.impulse.dot(hold.normal);
        if along <= 0.0 {
            (hold.released, any) = (1.0, true);
        } else if hold.sticks > 0.0 {
            any |= soften(model, constraints[hold.constraint as usize].grip, hold, along, step);
        }
    }
    any
}

/// Makes friction as stiff as meets what the cone allows with the slide there: at first that
/// without friction, then as friction slows it. Friction so made opposes the slide and cannot turn
/// it round. Returns whether it was another.
fn soften(model: &ContactModel<'_>, grip: Grip, hold: &mut Hold, along: Real, step: Real) -> bool {
    let (across, cone) = (length(across(hold, along)), grip.slides * along);
    let free = hold.slide / step;
    let speed = if hold.sticks == 1.0 {
        if across <= grip.sticks * along {
            return false;
        }
        free
    } else {
        let speed = speed(hold, across);
        // The response gives a small slide what the cone still allows, but takes nothing back.
        let least = if is_small(model, speed * step) { 0.0 } else { (1.0 - SLACK) * cone };
        if (least..=(1.0 + SLACK) * cone).contains(&across) {
            return false;
        }
        speed + (free - speed).max(0.0) * (1.0 - cone / across).max(0.0)
    };
    hold.sticks = (cone / (speed.max(Real::MIN_POSITIVE) * hold.stiffness)).min(0.999);
    true
}

/// The impulse of friction, kg m/s.
fn across(hold: &Hold, along: Real) -> Vec3 {
    hold.impulse - hold.normal * along
}

fn length(v: Vec3) -> Real {
    sqrt(v.length_squared())
}

/// With which friction of that impulse leaves a contact to slide, m/s.
fn speed(hold: &Hold, across: Real) -> Real {
    across / (hold.sticks * hold.stiffness)
}

fn is_small(model: &ContactModel<'_>, slide: Real) -> bool {
    slide < SMALL * model.thickness
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
        let Constraint { contact, target, grip, .. } = *constraint;
        *constraint = Constraint::new(contact, target, grip, model.mobility, MOST_LEVER);
    }
    for hold in &scratch.holds[..held] {
        let constraint = &mut scratch.constraints[hold.constraint as usize];
        let along = hold.impulse.dot(hold.normal);
        if along > 0.0 {
            // What slid in the system does not stick now, and what stuck does not lose its grip.
            let (Grip { sticks, slides }, across) = (constraint.grip, across(hold, along));
            constraint.grip = Grip::always(match hold.sticks {
                1.0 => sticks,
                _ if is_small(model, speed(hold, length(across)) * step) => slides,
                _ => slides.min((1.0 + SLACK) * length(across) / along),
            });
            constraint.normal_impulse = along * step;
            constraint.friction_impulse = constraint.grip.limit(across, along) * step;
        }
    }
}
