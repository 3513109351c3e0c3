//! The work that is done on the cloth by pins, colliders and wind, by gravity and loads that change, and by the
//! response where it moves overlapping surfaces apart. With it, a host can balance the energy of the cloth: a larger
//! gain of energy comes from errors. The work that contacts take is measured too, and with [reactions](crate::reactions)
//! that of damping: then the rest of the balance is the error of the method.
//!
//! Where gravity or a load changes, the potential energy changes at a fixed position. This is work too: the whole
//! change of the potential energy plus the work of the force along the displacement.
//!
//! A force is evaluated in the middle of the step and multiplied by the displacement: this is exact to the second order
//! for every method. The forces on pins are those of the [equations](crate::integrate::pin_forces) of an implicit step.

use glam::DVec3;

use crate::column::Column;
use crate::contact::{ContactModel, ContactScratch};
use crate::dispatch::Dispatch;
use crate::forces::{self, Model, Term};
use crate::implicit_contact::exchange;
use crate::integrate::pin_forces;
use crate::integrate::pins::{JumpSide, Pins};
use crate::integrate::{Method, StepInput, next_velocity};
use crate::particles::Particles;
use crate::reactions::{Reactions, impulses};
use crate::real::{Real, Sum, Vec3, dot_sum, to_f64};
use crate::response::constraint::Constraint;
use crate::scratch::Scratch;

/// Work done on the cloth, J.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct WorkDone {
    /// By pins that move.
    pub pins: Sum,
    /// By colliders that move.
    pub colliders: Sum,
    /// By wind; negative where it slows the cloth down.
    pub wind: Sum,
    /// By gravity, loads and materials that change, and by impulses and teleports of the host. Like the potential
    /// energy, it depends on where heights count from.
    pub gravity: Sum,
    /// By [moving overlapping surfaces apart](crate::response), against the forces. It changes no velocity.
    pub separation: Sum,
    /// By friction and impacts; negative.
    pub contacts: Sum,
    /// By damping and drag; negative. Measured with reactions, and by implicit midpoint, which rings where cloth is
    /// stiff: damping takes the energy that it adds.
    pub damping: Sum,
    /// The amounts of the work of all steps by pins, colliders and wind: errors of the steps also change the forces of
    /// pins, to and fro.
    pub exchanged: Sum,
}

impl WorkDone {
    /// The work from outside: what pins, colliders and wind, gravity and loads that change, and the separation of
    /// surfaces gave, J.
    pub fn from_outside(&self) -> Sum {
        self.pins + self.colliders + self.wind + self.gravity + self.separation
    }
}

impl core::ops::AddAssign for WorkDone {
    fn add_assign(&mut self, other: Self) {
        self.pins += other.pins;
        self.colliders += other.colliders;
        self.wind += other.wind;
        self.gravity += other.gravity;
        self.separation += other.separation;
        self.contacts += other.contacts;
        self.damping += other.damping;
        self.exchanged += other.exchanged;
    }
}

/// The sums to which a step adds.
#[derive(Debug)]
pub struct Ledger<'a> {
    /// The work.
    pub done: &'a mut WorkDone,
    /// The reactions; `None`: neither they nor the work of damping are measured.
    pub reactions: Option<Reactions<'a>>,
}

impl Ledger<'_> {
    /// The same sums for a shorter time.
    pub fn reborrow(&mut self) -> Ledger<'_> {
        Ledger { done: self.done, reactions: self.reactions.as_mut().map(Reactions::reborrow) }
    }
}

/// Adds the work, and the reactions, in the step to the candidate state in `s`. Overwrites the columns of the stage and
/// of the forces.
pub fn in_step<D: Dispatch>(
    c: &StepInput<'_, D>,
    from: &Particles<'_>,
    contact: Option<(&ContactModel<'_>, &ContactScratch<'_>)>,
    ledger: Ledger<'_>,
    s: &mut Scratch<'_>,
) {
    let c = &c.after(0.5);
    let mut done = WorkDone::default();
    let Ledger { done: sum, mut reactions } = ledger;
    if let Some((model, contact)) = contact {
        add_contacts(c, model, contact, &mut done);
        done.contacts += by_contacts(c, model, contact, from, s);
        if let Some(reactions) = &mut reactions {
            reactions.add_colliders(model, contact, c.step);
        }
    }
    let wind = c.model.only(Term::Wind);
    let everything = reactions.is_some() || c.scheme.method == Method::ImplicitMidpoint && c.model.dissipates();
    let separated = contact.map(|(_, contact)| contact.response().1.part(..from.positions.len()));
    let separated = separated.filter(|corrections| corrections.iter().any(|&moved| moved != Vec3::ZERO));
    let needs_forces = pins_move(c) || separated.is_some() || everything;
    if needs_forces || wind.is_some() {
        write_middle(c, from, s);
    }
    if needs_forces {
        evaluate(c, &c.model, s);
    }
    if let Some(corrections) = separated {
        done.separation -= along(s.forces, corrections);
    }
    let of_all = if everything { along(s.forces, s.displacements) } else { 0.0 };
    // From here on the forces along held axes are those of the equations of the step.
    pin_forces::write(c, s);
    if pins_move(c) {
        done.pins += by_pins(c, from, s);
    }
    if let Some(mut reactions) = reactions {
        if let Some((_, contact)) = contact {
            exchange::add_impulses(contact, c.step * c.step, s.forces);
        }
        reactions.add_pins(c, s);
    }
    if let Some(wind) = wind {
        evaluate(c, &wind, s);
        done.wind += along(s.forces, s.displacements);
    }
    if c.model.potential_varies() {
        done.gravity += by_change(c, from, s);
    }
    done.exchanged = done.pins.abs() + done.colliders.abs() + done.wind.abs();
    if everything && c.model.dissipates() {
        s.stage_velocities.fill(Vec3::ZERO);
        evaluate(c, &c.model.conservative(), s);
        done.damping += of_all - done.wind - along(s.forces, s.displacements);
    }
    *sum += done;
}

/// Adds the impulses by which pins give their vertices the prescribed velocities just after `time`, and their work.
#[cfg_attr(small, optimize(size))]
pub fn by_taking_hold(pins: &Pins<'_>, time: Sum, particles: &Particles<'_>, ledger: Ledger<'_>) {
    let Ledger { done, mut reactions } = ledger;
    for (pin, vertex, axes) in pins.iter() {
        let (_, target) = pins.target(pin, time, JumpSide::After);
        by_kick(pins, (pin, vertex, axes), target, particles, done, reactions.as_mut());
    }
}

/// Adds the impulses by which pins [let a vertex fly](Pins::let_fly) at `time`, and their work.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn by_letting_fly(pins: &Pins<'_>, vertex: u32, time: Sum, particles: &Particles<'_>, ledger: Ledger<'_>) {
    let Ledger { done, mut reactions } = ledger;
    for (pin, axes, velocity) in pins.ended(vertex, time) {
        by_kick(pins, (pin, vertex as usize, axes), velocity, particles, done, reactions.as_mut());
    }
}

/// Adds the impulse by which a pin gives its vertex a velocity, m/s, and its work.
#[cfg_attr(small, optimize(size), inline(never))]
fn by_kick(
    pins: &Pins<'_>,
    (pin, vertex, axes): (usize, usize, impl Iterator<Item = usize>),
    velocity: Vec3,
    particles: &Particles<'_>,
    done: &mut WorkDone,
    reactions: Option<&mut Reactions<'_>>,
) {
    let (mass, v) = (Sum::from(particles.masses.at(vertex)), particles.velocities.at(vertex));
    let (mut impulse, mut work) = ([0.0; 3], 0.0);
    for axis in axes {
        let [before, after] = [v, velocity].map(|v| to_f64(v).at(axis));
        impulse.set(axis, mass * (after - before));
        work += 0.5 * mass * (after * after - before * before);
    }
    (done.pins, done.exchanged) = (done.pins + work, done.exchanged + work.abs());
    if let Some(reactions) = reactions {
        reactions.add_pin(pin, pins.carrier(pin), particles.positions.at(vertex), impulse.into());
    }
}

fn pins_move<D>(c: &StepInput<'_, D>) -> bool {
    (0..c.pins.vertices.len()).any(|pin| c.pins.moves(pin))
}

/// Writes the state in the middle of the step to the columns of the stage.
fn write_middle<D: Dispatch>(c: &StepInput<'_, D>, from: &Particles<'_>, s: &mut Scratch<'_>) {
    let dx = &*s.displacements;
    s.stage_positions.write(from.positions, from.low_positions, (dx, 0.5), c.dispatch);
    c.dispatch.run(&mut *s.stage_velocities, |start, part| {
        for (v, &dx) in part.iter_mut().zip(dx.part(start..)) {
            *v = dx / c.step;
        }
    });
}

fn evaluate<D: Dispatch>(c: &StepInput<'_, D>, model: &Model<'_>, s: &mut Scratch<'_>) {
    forces::evaluate(model, c.masses, s.stage_positions.view(), s.stage_velocities, s.elements, s.forces, c.dispatch);
}

/// The work of forces along displacements.
fn along(forces: &[Vec3], displacements: &[Vec3]) -> Sum {
    forces.iter().zip(displacements).map(|(&force, &moved)| dot_sum(force, moved)).sum()
}

/// The work of gravity and loads that change: the whole change of their potential energy, plus the work of their forces
/// along the displacement.
fn by_change<D: Dispatch>(c: &StepInput<'_, D>, from: &Particles<'_>, s: &mut Scratch<'_>) -> Sum {
    let model = Model { gravity: c.model.gravity, loads: c.model.loads, ..Model::default() };
    evaluate(c, &model, s);
    let potential = |time, x: &[Vec3]| forces::energy(&model.at(time), c.masses, x.into()).gravity;
    potential(c.time_after(1.0), s.next_positions) - potential(c.time, from.positions)
        + along(s.forces, s.displacements)
}

/// A pin holds against the forces, and changes the velocity of its vertex.
fn by_pins<D>(c: &StepInput<'_, D>, from: &Particles<'_>, s: &Scratch<'_>) -> Sum {
    let of_axis = |vertex: usize, axis: usize| {
        let scalar = |column: &[Vec3]| to_f64(column.at(vertex)).at(axis);
        let after = to_f64(next_velocity(from, s.velocity_changes, vertex)).at(axis);
        let before = scalar(from.velocities);
        let inertia = 0.5 * Sum::from(c.masses.at(vertex)) * (after * after - before * before);
        inertia - scalar(s.forces) * scalar(s.displacements)
    };
    c.pins.iter().map(|(_, vertex, axes)| axes.map(|axis| of_axis(vertex, axis)).sum::<Sum>()).sum()
}

/// Adds the forces of contacts times the displacements of the axes that pins and colliders prescribe, with the opposite
/// sign.
fn add_contacts<D>(c: &StepInput<'_, D>, model: &ContactModel<'_>, contact: &ContactScratch<'_>, done: &mut WorkDone) {
    for constraint in contact.constraints.part(..contact.lengths.constraints) {
        for (vertex, impulse) in impulses(constraint, c.step) {
            let is_prescribed = model.inverse_masses.at(vertex).cmpeq(Vec3::ZERO);
            let moved = Vec3::select(is_prescribed, contact.displacements.at(vertex), Vec3::ZERO);
            let work = -impulse.dot(to_f64(moved).into()) / Sum::from(c.step);
            *if vertex < model.cloth() { &mut done.pins } else { &mut done.colliders } += work;
        }
        done.colliders -= by_roll(constraint, c.step);
    }
}

/// The work of contacts on the relative motion of their features. An impulse changes the kinetic energy of a free
/// vertex by its product with the mean of the velocities before and after.
fn by_contacts<D>(
    c: &StepInput<'_, D>,
    model: &ContactModel<'_>,
    contact: &ContactScratch<'_>,
    from: &Particles<'_>,
    s: &Scratch<'_>,
) -> Sum {
    let velocity = |vertex: usize| {
        let prescribed = contact.displacements.at(vertex) / c.step;
        let Some(&before) = from.velocities.get(vertex) else { return prescribed };
        let is_prescribed = model.inverse_masses.at(vertex).cmpeq(Vec3::ZERO);
        Vec3::select(is_prescribed, prescribed, (before + next_velocity(from, s.velocity_changes, vertex)) * 0.5)
    };
    let constraints = contact.constraints.part(..contact.lengths.constraints);
    let of_vertex = |(vertex, impulse): (usize, DVec3)| impulse.dot(to_f64(velocity(vertex)).into());
    let each = constraints
        .iter()
        .map(|constraint| by_roll(constraint, c.step) + impulses(constraint, c.step).map(of_vertex).sum::<Sum>());
    each.sum()
}

/// The work of a contact on a surface that [turns](crate::response::roll) under it, J.
fn by_roll(constraint: &Constraint, step: Real) -> Sum {
    dot_sum(constraint.friction_impulse, constraint.roll) / (Sum::from(step) * Sum::from(step))
}
