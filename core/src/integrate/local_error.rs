//! Estimate of the error of an implicit step: how far its candidate positions are from the exact motion from the same
//! state, in the root mean square over the vertices of the cloth where it is largest.
//!
//! It has two parts. The truncation error is the first term that the method neglects [Hairer 1993, III.2, III.5], from
//! differences of the velocities. The defect is the residual of the nonlinear equations of the step, with the impulses
//! of contacts, through a few iterations of conjugate gradients. It is about the displacement by one more iteration of
//! Newton's method, so it contains the errors of the linearisation, of the solver and of the response.

use super::conjugate_gradient;
use super::convex_term::NoTerm;
use super::newton;
use super::per_cloth::largest_root_mean_square;
use super::stopping::Goal;
use super::{IntegratorStatistics, Method, StepInput, bdf2, next_velocity};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::particles::Particles;
use crate::real::{Real, Vec3};
use crate::scratch::Scratch;

/// Iterations of conjugate gradients. The preconditioner alone underestimates the waves between the size of an element
/// and that of a patch: the whole error by a factor of four on hanging cloth that swings.
const ITERATIONS: u32 = 4;

/// Estimates the error of the candidate state in `s`, m; `None` for an explicit method. `corrected` says whether
/// contact corrected the state. `add_impulses` adds the impulses of contacts to a column over the vertices, kg m/s.
pub fn estimate<D: Dispatch>(
    c: &StepInput<'_, D>,
    particles: &Particles<'_>,
    corrected: bool,
    add_impulses: impl FnOnce(&mut [Vec3]),
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> Option<Real> {
    if !c.scheme.method.is_implicit() {
        return None;
    }
    let truncation = truncation(c, corrected, s);
    // Newton's method has made its own defect small, perhaps without a solve whose preconditioner could measure it.
    if c.scheme.newton > 1 {
        return Some(truncation);
    }
    let to_position = write_residual(c, particles, corrected, s, statistics);
    add_impulses(s.residual);
    c.pins.filter(s.residual);
    conjugate_gradient::solve(c, &mut NoTerm, Goal::Iterations(ITERATIONS), s, statistics);
    Some(truncation + to_position * largest_root_mean_square(s.cloths, s.solution))
}

/// The truncation error, m.
fn truncation<D: Dispatch>(c: &StepInput<'_, D>, corrected: bool, s: &mut Scratch<'_>) -> Real {
    // After contact, velocities have jumped, and every method has first order.
    let last = s.last_step.filter(|_| !corrected);
    let [now, before] = coefficients(c.scheme.method, c.step, last);
    let (dv, dvp) = (&*s.velocity_changes, &*s.previous_velocity_changes);
    c.dispatch.run(&mut *s.products, |start, part| {
        for (i, error) in (start..).zip(part) {
            *error = dv.at(i) * now;
            if before != 0.0 {
                *error += dvp.at(i) * before;
            }
        }
    });
    largest_root_mean_square(s.cloths, s.products)
}

/// Factors, s, whose products with the change of the velocities in this step and in the last one add up to the
/// truncation error. `last` is the length of the last step if this one continues it.
fn coefficients(method: Method, step: Real, last: Option<Real>) -> [Real; 2] {
    // The third derivative of the positions, from two differences of the velocities, times step^3 and a constant.
    let third = |constant: Real, last: Real| {
        let factor = 2.0 * constant * step * step * step / (step + last);
        [factor / step, -factor / last]
    };
    match (method, last) {
        (Method::ImplicitMidpoint, Some(last)) => third(1.0 / 12.0, last),
        (Method::Bdf2, Some(last)) => third(bdf2::error_constant(step, last), last),
        (Method::BackwardEuler | Method::ImplicitMidpoint | Method::Bdf2, _) => [0.5 * step, 0.0],
        (Method::ExplicitEuler | Method::SymplecticEuler | Method::Midpoint | Method::Rk4, _) => [0.0; 2],
    }
}

/// Writes the residual of the equations that the step solved to `s.residual`: of the stage of its method, after contact
/// of backward Euler, because the response changes the end of the step. Returns by how much a change of the stage's
/// velocities changes the positions at the end of the step, s.
fn write_residual<D: Dispatch>(
    c: &StepInput<'_, D>,
    particles: &Particles<'_>,
    corrected: bool,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> Real {
    let v0 = &*particles.velocities;
    let (is_middle, extrapolates) = match c.scheme.method {
        Method::ImplicitMidpoint => (!corrected, false),
        Method::Bdf2 => (!corrected && s.last_step.is_none(), !corrected && s.last_step.is_some()),
        Method::BackwardEuler => (false, false),
        Method::ExplicitEuler | Method::SymplecticEuler | Method::Midpoint | Method::Rk4 => (false, false),
    };
    let (dx, dv) = (&*s.displacements, &*s.velocity_changes);
    let part = if is_middle { 0.5 } else { 1.0 };
    s.stage_positions.write(particles.positions, particles.low_positions, (dx, part), c.dispatch);
    c.dispatch.run(&mut *s.products, |start, part| {
        for (i, v) in (start..).zip(part) {
            *v = if is_middle { dx.at(i) / c.step } else { next_velocity(particles, dv, i) };
        }
    });
    c.after(part.into()).forces(s.stage_positions.view(), s.products, s.elements, s.forces, statistics);
    let last = s.last_step.filter(|_| extrapolates);
    let (length, v, dvp) = (c.stage_length(last), &*s.products, &*s.previous_velocity_changes);
    match last.map(|last| bdf2::extrapolation(c.step, last)) {
        Some(part) => newton::residual(c, length, |i| dv.at(i) - dvp.at(i) * part, s.forces, s.residual),
        None if is_middle => newton::residual(c, 0.5 * c.step, |i| v.at(i) - v0.at(i), s.forces, s.residual),
        None => newton::residual(c, length, |i| dv.at(i), s.forces, s.residual),
    }
    if is_middle { c.step } else { length }
}
