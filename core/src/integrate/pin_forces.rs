//! The forces on pinned vertices in the equations of an implicit stage. They include the change of the forces by the
//! solution of the linear system. Forces at any point between the ends of a step would differ from them: between
//! these ends edges that turn are shorter, so stiff cloth would pull at its pins.

use super::StepInput;
use super::pins::set_axis;
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::forces::matrix;
use crate::real::{Real, Vec3};
use crate::scratch::Scratch;

/// Notes the forces f in the residual of a stage, before its held axes are removed: `residual = g f - M changes`, where
/// g is the `length` of the stage, s.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn note<D>(c: &StepInput<'_, D>, length: Real, s: &mut Scratch<'_>) {
    for (force, &vertex) in s.pin_forces.iter_mut().zip(c.pins.vertices) {
        let vertex = vertex as usize;
        *force = (s.residual.at(vertex) + s.velocity_changes.at(vertex) * c.masses.at(vertex)) / length;
    }
}

/// Adds the change of the forces by a `part` of the solution y, `-S' y / g` times this part.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn add_change<D: Dispatch>(c: &StepInput<'_, D>, length: Real, part: Real, s: &mut Scratch<'_>) {
    for (force, &vertex) in s.pin_forces.iter_mut().zip(c.pins.vertices) {
        let mut product = [Vec3::ZERO];
        matrix::multiply_rows(&s.matrix, c.masses, 0.0, s.solution, vertex as usize, &mut product);
        *force -= product[0] * (part / length);
    }
}

/// Writes the noted forces along the held axes to the column of forces.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn write<D>(c: &StepInput<'_, D>, s: &mut Scratch<'_>) {
    for (&force, (_, vertex, axes)) in s.pin_forces.iter().zip(c.pins.iter()) {
        axes.for_each(|axis| set_axis(s.forces, vertex, axis, force));
    }
}
