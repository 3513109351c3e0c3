//! Contact in an implicit step: active contacts in, multipliers and a corrected motion out.
//!
//! Completes the step with its contacts: one solve of elasticity, contacts and friction together
//! ([`conjugate_gradient`]), and more where one linearisation cannot follow the motion. The solve pauses once, for the
//! pairs that its motion brings together: they become contacts too [Otaduy 2009].

pub mod augmented_contact;
pub mod exchange;
pub mod geometric_stiffness;
pub mod multiplier;

use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::forces;
use crate::integrate::conjugate_gradient;
use crate::integrate::newton::{self, ImplicitStage, MOST_STRAIN};
use crate::integrate::stopping::Goal;
use crate::integrate::{self, IntegratorStatistics, StepInput, Tolerance, next_velocity, pin_forces, rigid_motions};
use crate::particles::Particles;
use crate::real::{Real, Sum, Vec3};
use crate::scratch::Scratch;
use crate::stage::Stage;
use augmented_contact::{ActiveContacts, AugmentedContact, ContactLines, Friction};

/// Limit of linearisations in a step.
const MOST_LINEARIZATIONS: u32 = 8;

/// Speed of a contact at rest, relative to its slack, 1/s, beside the velocity that solves leave.
const CREEP: Real = 2.0;

/// Relative residual at which the solve pauses. It suffices to find the impacts of the motion.
const ROUGH: Sum = 1e-2;

/// Corrects the candidate state of an implicit step, whose matrix must still be in `s`. `from` is the state at the
/// start of the step. Of contacts, the relative displacement and the least displacement along the normal are given in
/// place of the velocities, m; `lines` has room for as many, in fours.
///
/// If the solve turns or stretches elements by more than a half, only a part of its step is taken, and the
/// forces are linearised there again. One linearisation would stretch cloth that a contact turns.
///
/// Returns whether anything had to be solved, for [`resume`].
pub fn correct<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    (contacts, lines): (&mut [AugmentedContact], &mut [ContactLines]),
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> bool {
    let length = c.stage_length(s.last_step);
    start(c, from, length, contacts, s);
    if !c.defers_solve() {
        if contacts.iter().all(|contact| contact.impulse == Vec3::ZERO) {
            return false;
        }
        solve_change(c, from, (contacts, lines), rough(c), s, statistics);
        return true;
    }
    geometric_stiffness::add(c.pins, c.step, from, contacts, length, s);
    let stage =
        ImplicitStage { length, positions: from.positions, offsets: from.low_positions, velocities: from.velocities };
    for linearization in 1..=MOST_LINEARIZATIONS {
        let goal = c.goal(rough(c) * newton::weight_factor(c, length, s));
        conjugate_gradient::solve(c, &mut ActiveContacts::new(contacts, lines), goal, s, statistics);
        let part = MOST_STRAIN / (length * forces::strain_rate(&c.model, s.solution));
        let left = (MOST_LINEARIZATIONS - linearization) as Real;
        // Steps that are much too long for the motion gain nothing.
        let is_last = part >= 1.0 || part * left < 1.0 || !part.is_finite();
        if is_last {
            add_solution(c, from, length, 1.0, s);
            return true;
        }
        for contact in &mut *contacts {
            contact.velocity -= contact.gather(s.solution) * (1.0 - part);
            contact.impulse = contact.impulse_at(contact.velocity);
        }
        add_solution(c, from, length * part, part, s);
        take_velocities(c, from, s);
        newton::linearize(c, &stage, s, statistics);
        geometric_stiffness::add(c.pins, c.step, from, contacts, length, s);
    }
    false
}

/// Completes the solve of [`correct`], if it `has_begun`, with more contacts: those from `known` on. If there are any, the
/// impulses of the others become their multipliers.
pub fn resume<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    (contacts, lines): (&mut [AugmentedContact], &mut [ContactLines]),
    known: usize,
    has_begun: bool,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let left = left(c);
    let (before, added) = contacts.cut_mut(known);
    if added.is_empty() && (left == 1.0 || !has_begun) {
        return;
    }
    let length = c.stage_length(s.last_step);
    if !added.is_empty() {
        before.iter_mut().for_each(AugmentedContact::update_multiplier);
        start(c, from, length, added, s);
    }
    if !has_begun {
        solve_change(c, from, (contacts, lines), c.scheme.tolerance.residual().into(), s, statistics);
        return;
    }
    let goal = Goal::Reach(left * left);
    conjugate_gradient::solve(c, &mut ActiveContacts::new(contacts, lines), goal, s, statistics);
    let to_velocity = if c.defers_solve() { 1.0 } else { length / c.step };
    add_solution(c, from, length, to_velocity, s);
}

/// Passes on the momentum that the last solve of the step left, if solves may leave much.
pub fn finish<D: Dispatch>(c: &StepInput<'_, D>, from: &Particles<'_>, s: &mut Scratch<'_>) {
    if matches!(c.scheme.tolerance, Tolerance::Velocity(_)) {
        let to_velocity = if c.defers_solve() { 1.0 } else { c.stage_length(s.last_step) / c.step };
        rigid_motions::pass_on(s, to_velocity);
        integrate::write_next(c, from, s);
    }
}

/// Relative residual at which [`correct`] stops.
fn rough<D: Dispatch>(c: &StepInput<'_, D>) -> Sum {
    ROUGH.max(c.scheme.tolerance.residual().into())
}

/// By how much [`resume`] reduces the residual that [`correct`] left.
fn left<D: Dispatch>(c: &StepInput<'_, D>) -> Sum {
    match c.scheme.tolerance {
        Tolerance::Residual(residual) => Sum::from(residual) / rough(c),
        // The solve does not pause before its goal, which is rough enough.
        Tolerance::Velocity(_) => 1.0,
    }
}

/// Starts contacts, whose displacements over a stage of `length` become velocities.
fn start<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    length: Real,
    contacts: &mut [AugmentedContact],
    s: &Scratch<'_>,
) {
    let left = match c.scheme.tolerance {
        Tolerance::Velocity(velocity) => velocity,
        Tolerance::Residual(_) => 0.0,
    };
    for contact in contacts {
        let before = (contact.velocity - contact.gather(s.displacements)) / length + contact.gather(from.velocities);
        let has_slid = contact.slide(before) > CREEP * contact.slack + left;
        contact.friction = if has_slid { Friction::Slips } else { Friction::Rests };
        contact.velocity /= length;
        contact.least_velocity /= length;
        contact.slack /= length;
        contact.start(c.masses, &s.matrix);
    }
}

/// Solves for the change that contacts make to a step that is complete without them.
fn solve_change<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    (contacts, lines): (&mut [AugmentedContact], &mut [ContactLines]),
    tolerance: Sum,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let length = c.stage_length(s.last_step);
    s.residual.fill(Vec3::ZERO);
    geometric_stiffness::add(c.pins, c.step, from, contacts, length, s);
    conjugate_gradient::solve(c, &mut ActiveContacts::new(contacts, lines), c.goal(tolerance), s, statistics);
    // A contact changes the velocity as much as the displacement over the step. The second-order methods would
    // extrapolate the change: the cloth would bounce.
    add_solution(c, from, length, length / c.step, s);
}

/// The velocities of the stage become those of the candidate state.
fn take_velocities<D: Dispatch>(c: &StepInput<'_, D>, from: &Particles<'_>, s: &mut Scratch<'_>) {
    let changes = &*s.velocity_changes;
    c.dispatch.run(&mut *s.stage_velocities, |start, part| {
        for (i, v) in (start..).zip(part) {
            *v = next_velocity(from, changes, i);
        }
    });
}

/// Adds multiples of the solution to the changes of positions and velocities, and to the candidate state.
#[inline(never)]
fn add_solution<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    to_position: Real,
    to_velocity: Real,
    s: &mut Scratch<'_>,
) {
    c.dispatch.enter(Stage::Integrate);
    let length = c.stage_length(s.last_step);
    pin_forces::add_change(c, length, to_position / length, s);
    let y = &*s.solution;
    c.dispatch.run((&mut *s.displacements, &mut *s.velocity_changes), |start, (dx, dv)| {
        for ((dx, dv), &y) in dx.iter_mut().zip(dv).zip(y.part(start..)) {
            *dx += y * to_position;
            *dv += y * to_velocity;
        }
    });
    integrate::write_next(c, from, s);
}
