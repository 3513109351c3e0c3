//! The implicit stage that all implicit methods share. It solves this equation for v:
//! `M (v - vh) = g f(xh + g v, v)`, where g is the length of the stage, and xh and vh are the positions and velocities
//! that it starts from ([`ImplicitStage`]).
//!
//! The unknown is the change v - vh, so that small changes are not rounded to the digits of v.
//!
//! With one iteration the stage is one linear solve. The forces are linearised at the extrapolated state (xh + g vh,
//! vh), so that the solve only adds a correction to vh. This keeps the order of the method for any Jacobian [Steihaug
//! 1979], even if it is projected or leaves out how damping depends on positions. Linearising there also hardly
//! stretches rotating elements, and not at all those of free cloth whose guess [turns](super::backward_euler) with it. The
//! usual linearisation at the start of the step [Baraff 1998, eq. 3.25] would reduce the order to one. If vh deforms elements strongly within the step, the forces are linearised after only a fraction of
//! the extrapolation. In a step that follows contact it is zero if it would stretch them by more than a little.
//!
//! With more iterations the stage is Newton's method, started at vh. Each iteration moves along a descent direction of
//!
//! `G(v) = |v - vh|^2_M / 2 + E(xh + g v) + g R(v)`
//!
//! where E is the potential and R the dissipation, which is frozen during a line search. Without
//! dissipation G is the same function in all iterations, and every accepted step decreases it.

use super::conjugate_gradient;
use super::convex_term::NoTerm;
use super::per_cloth::largest_root_mean_square;
use super::stopping::Goal;
use super::{IntegratorStatistics, StepInput, Tolerance, pin_forces};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::forces::matrix;
use crate::forces::{self, TangentScale};
use crate::particles::PositionsMut;
use crate::real::{Real, SEES_ROUNDING, Sum, Vec3, dot_sum};
use crate::scratch::Scratch;
use crate::stage::Stage;

/// A backward Euler stage of `length` g from (xh, vh).
#[derive(Clone, Copy)]
pub struct ImplicitStage<'a> {
    /// g, s.
    pub length: Real,
    /// x0, m.
    pub positions: &'a [Vec3],
    /// xh - x0, m. x0 are rounded: it contains their rounding errors.
    pub offsets: &'a [Vec3],
    /// vh, m/s.
    pub velocities: &'a [Vec3],
}

/// Largest strain or turn (rad) of an element that the extrapolation to the point of linearisation may cause. A longer
/// extrapolation is shortened. Forces at much larger strains do not represent the forces during the step.
pub(crate) const MOST_STRAIN: Real = 0.5;

/// Stretch by the extrapolation beyond which a step that follows contact extrapolates nothing: contact has changed the
/// velocities abruptly, and extrapolated they stretch cloth that lands. Rotation stretches nothing: without extrapolation
/// a sheet that spins on a plane would stop.
const MOST_STRETCH: Real = 0.01;

/// Lower bound on the relative tolerance of conjugate gradients inside Newton's method. A more accurate direction would
/// not give a better step.
const INNER_TOLERANCE: Real = 1e-3;

/// Fraction of the predicted decrease that a line search requires [Armijo].
const SUFFICIENT_DECREASE: Sum = 1e-4;

/// Roundings from a difference of positions to a force: those of the strain, of the stress and of the sum over a
/// vertex's elements.
const ROUNDINGS: Real = 4.0;

/// Number of step lengths that a line search tries, each half the previous one.
const MOST_HALVINGS: u32 = 24;

/// Solves the stage for `s.stage_velocities`, and writes their change from vh to `s.velocity_changes`. On entry
/// `s.stage_velocities` are the guess, with the prescribed velocities of pins already set.
pub fn solve<D: Dispatch>(
    c: &StepInput<'_, D>,
    stage: &ImplicitStage<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let (v, vh) = (&*s.stage_velocities, stage.velocities);
    c.dispatch.run(&mut *s.velocity_changes, |start, part| {
        for (i, change) in (start..).zip(part) {
            *change = v.at(i) - vh.at(i);
        }
    });
    if c.scheme.newton <= 1 {
        linearized_step(c, stage, s, statistics);
    } else {
        newton_iterations(c, stage, s, statistics);
    }
}

fn linearized_step<D: Dispatch>(
    c: &StepInput<'_, D>,
    stage: &ImplicitStage<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let part = extrapolation(c, stage, s.stage_velocities);
    write_scaled(c, s.stage_velocities, part, s.products);
    write_positions(c, stage, s.products, &mut s.stage_positions);
    c.forces(s.stage_positions.view(), s.products, s.elements, s.forces, statistics);
    write_matrix(c, stage, s);
    write_residual(c, stage, s);
    if part < 1.0 {
        write_scaled(c, s.stage_velocities, 1.0 - part, s.direction);
        matrix::multiply(&s.matrix, c.masses, 0.0, s.direction, s.products, c.dispatch);
        add_scaled(c, s.products, -1.0, s.residual);
    }
    filter_residual(c, stage, s);
    statistics.newton_iterations += 1;
    if c.defers_solve() {
        return;
    }
    let tolerance = Sum::from(c.scheme.tolerance.residual()) * weight_factor(c, stage.length, s);
    solve_linear(c, c.goal(tolerance), s, statistics);
    add_solution(c, stage, 1.0, s);
}

/// The part of the stage over which the forces are extrapolated to the point of linearisation.
fn extrapolation<D: Dispatch>(c: &StepInput<'_, D>, stage: &ImplicitStage<'_>, v: &[Vec3]) -> Real {
    let part = (MOST_STRAIN / (stage.length * forces::strain_rate(&c.model, v))).min(1.0);
    if !c.follows_contact {
        return part;
    }
    let stretch = part * stage.length * forces::stretch_rate(&c.model, stage.positions, v);
    if stretch < MOST_STRETCH { part } else { 0.0 }
}

/// Linearises the forces at `s.stage_velocities`, which differ from vh by `s.velocity_changes`, and writes the matrix
/// and the residual there.
pub(crate) fn linearize<D: Dispatch>(
    c: &StepInput<'_, D>,
    stage: &ImplicitStage<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    write_positions(c, stage, s.stage_velocities, &mut s.stage_positions);
    c.forces(s.stage_positions.view(), s.stage_velocities, s.elements, s.forces, statistics);
    write_matrix(c, stage, s);
    write_residual(c, stage, s);
    filter_residual(c, stage, s);
    statistics.newton_iterations += 1;
}

/// The weight's impulse relative to the residual, at least 1. For a sheet near rest the residual alone gives no scale.
pub(crate) fn weight_factor<D: Dispatch>(c: &StepInput<'_, D>, length: Real, s: &Scratch<'_>) -> Sum {
    let norm = residual_norm(c, s.residual).max(Sum::MIN_POSITIVE);
    (weight_impulse(c, length) / norm).max(1.0)
}

fn newton_iterations<D: Dispatch>(
    c: &StepInput<'_, D>,
    stage: &ImplicitStage<'_>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let weight = weight_impulse(c, stage.length);
    let (mut target, mut rounding, mut previous): (Sum, Sum, Sum) = (0.0, 0.0, Sum::INFINITY);
    let (mut correction, mut is_exact): (Sum, bool) = (Sum::INFINITY, false);
    for iteration in 0..c.scheme.newton {
        write_positions(c, stage, s.stage_velocities, &mut s.stage_positions);
        c.forces(s.stage_positions.view(), s.stage_velocities, s.elements, s.forces, statistics);
        write_residual(c, stage, s);
        filter_residual(c, stage, s);
        let norm = residual_norm(c, s.residual);
        if iteration == 0 {
            target = match c.scheme.tolerance {
                Tolerance::Residual(residual) => Sum::from(residual) * norm.max(weight),
                Tolerance::Velocity(_) => 0.0,
            };
        }
        // Once the residual may be only rounding, continue only while each iteration halves it.
        let exhausted = norm <= rounding && norm > 0.5 * previous;
        if norm <= target || is_exact || exhausted {
            return;
        }
        previous = norm;
        if !norm.is_finite() {
            return s.stage_velocities.fill(Vec3::NAN);
        }
        write_matrix(c, stage, s);
        rounding = rounding_norm(c, stage, s);
        statistics.newton_iterations += 1;
        // Save the residual, which is the negative gradient of the objective: conjugate gradients overwrite it.
        s.base_residual.copy_from(s.residual);
        let tolerance = c.scheme.tolerance.residual().max(INNER_TOLERANCE).into();
        solve_linear(c, Goal::Reduce(tolerance), s, statistics);
        let slope = -column_dot(s.base_residual, s.solution);
        let Some(scale) = search(c, stage, slope, s, statistics) else {
            statistics.stalled_searches += 1;
            return;
        };
        add_solution(c, stage, scale, s);
        let before = core::mem::replace(&mut correction, largest_root_mean_square(s.cloths, s.solution).into());
        // A shortened correction leaves a part of itself.
        is_exact = scale == 1.0 && is_converged(c.scheme.tolerance, before, correction);
    }
    statistics.unconverged += u64::from(!is_exact);
}

/// Whether the corrections of the velocities, m/s, that follow the last two add up to less than their tolerance, if
/// each is smaller than the one before by the same factor [Hairer 1996, IV.8]. They are those of the cloth that is
/// corrected most.
fn is_converged(tolerance: Tolerance, before: Sum, last: Sum) -> bool {
    let Tolerance::Velocity(most) = tolerance else { return false };
    before.is_finite() && last < before && last * last <= Sum::from(most) * (before - last)
}

/// `S = -(g^2 Kx + g Kv)` at the iterate in `stage_positions`.
fn write_matrix<D: Dispatch>(c: &StepInput<'_, D>, stage: &ImplicitStage<'_>, s: &mut Scratch<'_>) {
    let scale = TangentScale { position: stage.length * stage.length, velocity: stage.length };
    let jacobian = c.scheme.jacobian;
    forces::write_tangents(
        &c.model,
        s.stage_positions.rounded,
        scale,
        jacobian,
        &s.assembly_map,
        s.tangents,
        &mut s.matrix,
        c.dispatch,
    );
}

fn write_residual<D: Dispatch>(c: &StepInput<'_, D>, stage: &ImplicitStage<'_>, s: &mut Scratch<'_>) {
    let changes = &*s.velocity_changes;
    residual(c, stage.length, |i| changes.at(i), s.forces, s.residual);
}

/// Removes the held axes from the residual, and notes their forces.
#[cfg_attr(small, optimize(size), inline(never))]
fn filter_residual<D: Dispatch>(c: &StepInput<'_, D>, stage: &ImplicitStage<'_>, s: &mut Scratch<'_>) {
    pin_forces::note(c, stage.length, s);
    c.pins.filter(s.residual);
}

/// `out = g f - M (v - vh)` of a stage of `length` g, kg m/s. `change` is v - vh of a vertex, m/s.
pub(crate) fn residual<D: Dispatch>(
    c: &StepInput<'_, D>,
    length: Real,
    change: impl Fn(usize) -> Vec3 + Sync,
    f: &[Vec3],
    out: &mut [Vec3],
) {
    c.dispatch.run(out, |start, part| {
        for (i, r) in (start..).zip(part) {
            *r = f.at(i) * length - change(i) * c.masses.at(i);
        }
    });
}

/// Solves `(M + S) y = r` and writes y to `s.solution`. S is in `s.matrix` and r is in `s.residual`.
fn solve_linear<D: Dispatch>(
    c: &StepInput<'_, D>,
    goal: Goal,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    conjugate_gradient::solve(c, &mut NoTerm, goal, s, statistics);
    c.dispatch.enter(Stage::Integrate);
}

/// Norm of the impulse of gravity during a stage: sqrt(sum m) times the gravitational acceleration times the length
/// of the stage. Residuals are compared with it, because for a sheet at rest the residual itself gives no scale.
fn weight_impulse<D: Dispatch>(c: &StepInput<'_, D>, length: Real) -> Sum {
    let gravity = c.model.gravity.map_or(Vec3::ZERO, |gravity| gravity.acceleration) * length;
    let mass: Sum = c.masses.iter().map(|&m| Sum::from(m)).sum();
    libm::sqrt(mass * dot_sum(gravity, gravity))
}

/// sqrt(sum |r|^2 / m): the mass-weighted norm of the velocity change r / m.
fn residual_norm<D: Dispatch>(c: &StepInput<'_, D>, residual: &[Vec3]) -> Sum {
    libm::sqrt(residual.iter().zip(c.inverse_masses).map(|(&r, &w)| dot_sum(r, r) * Sum::from(w)).sum())
}

/// Bound on the part of the residual that is due to rounding, g K d epsilon. If forces see only rounded positions, d is
/// the distance from the origin; else it is the longest edge plus the way in the stage, some [times](ROUNDINGS).
#[cfg_attr(small, optimize(size))]
fn rounding_norm<D: Dispatch>(c: &StepInput<'_, D>, stage: &ImplicitStage<'_>, s: &Scratch<'_>) -> Sum {
    let at_vertex = |vertex: usize| {
        let diagonal = matrix::to_mat3(&s.matrix.blocks.at(s.matrix.offsets.at(vertex) as usize));
        let stiffness = diagonal.x_axis.x.max(diagonal.y_axis.y).max(diagonal.z_axis.z) / stage.length;
        let rounded = if SEES_ROUNDING {
            ROUNDINGS * (longest_edge(s, vertex) + stage.length * s.stage_velocities.at(vertex).abs().max_element())
        } else {
            s.stage_positions.rounded.at(vertex).abs().max_element()
        };
        let error = Sum::from(stiffness * rounded * Real::EPSILON);
        error * error * Sum::from(c.inverse_masses.at(vertex))
    };
    libm::sqrt((0..c.masses.len()).map(at_vertex).sum())
}

/// The largest coordinate of a difference between a vertex and another one in its row of the matrix, m.
#[cfg_attr(small, optimize(size))]
fn longest_edge(s: &Scratch<'_>, vertex: usize) -> Real {
    let x = &*s.stage_positions.rounded;
    let apart = |other: u32| (x.at(other as usize) - x.at(vertex)).abs().max_element();
    s.matrix.columns_of(vertex).map(apart).fold(0.0, Real::max)
}

/// `out = xh + g v`, m; `v` in m/s.
fn write_positions<D: Dispatch>(
    c: &StepInput<'_, D>,
    stage: &ImplicitStage<'_>,
    v: &[Vec3],
    out: &mut PositionsMut<'_>,
) {
    out.write(stage.positions, stage.offsets, (v, stage.length), c.dispatch);
}

/// `out = from * scale`.
fn write_scaled<D: Dispatch>(c: &StepInput<'_, D>, from: &[Vec3], scale: Real, out: &mut [Vec3]) {
    c.dispatch.run(out, |start, part| {
        for (to, &from) in part.iter_mut().zip(from.part(start..)) {
            *to = from * scale;
        }
    });
}

/// Halves the step along `s.solution` until the objective decreases enough. `slope` is the derivative
/// of the objective at the start. Returns the scale of the step, or `None` if no step decreases it.
fn search<D: Dispatch>(
    c: &StepInput<'_, D>,
    stage: &ImplicitStage<'_>,
    slope: Sum,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> Option<Real> {
    let (linear, quadratic) = dissipation(c, s, statistics);
    let start = objective(c, 0.0, s);
    // A decrease smaller than the rounding of the objective cannot be detected.
    let rounding = 8.0 * Sum::from(Real::EPSILON) * start.abs();
    let mut scale = 1.0;
    for _ in 0..MOST_HALVINGS {
        s.products.copy_from(s.stage_velocities);
        add_scaled(c, s.solution, scale, s.products);
        write_positions(c, stage, s.products, &mut s.stage_positions);
        let t = Sum::from(scale);
        let dissipated = Sum::from(stage.length) * t * (linear + 0.5 * t * quadratic);
        let change = objective(c, scale, s) - start + dissipated;
        if change <= SUFFICIENT_DECREASE * t * slope + rounding {
            return Some(scale);
        }
        scale *= 0.5;
    }
    None
}

/// `|v + scale y - vh|^2_M / 2 + E` at `s.stage_positions`, J.
fn objective<D: Dispatch>(c: &StepInput<'_, D>, scale: Real, s: &Scratch<'_>) -> Sum {
    let columns = s.velocity_changes.iter().zip(&*s.solution).zip(c.masses);
    let inertia: Sum = columns
        .map(|((&change, &y), &m)| {
            let d = change + y * scale;
            0.5 * Sum::from(m) * dot_sum(d, d)
        })
        .sum();
    inertia + forces::energy(&c.model, c.masses, s.stage_positions.view()).total()
}

/// Slope and curvature of the frozen dissipation R along `s.solution`. The gradient of R is minus the non-conservative
/// force.
fn dissipation<D: Dispatch>(
    c: &StepInput<'_, D>,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> (Sum, Sum) {
    if !c.model.dissipates() {
        return (0.0, 0.0);
    }
    let conservative = c.model.conservative();
    s.products.fill(Vec3::ZERO);
    statistics.force_evaluations += 1;
    forces::evaluate(
        &conservative,
        c.masses,
        s.stage_positions.view(),
        s.products,
        s.elements,
        s.direction,
        c.dispatch,
    );
    for (p, (&v, &y)) in s.products.iter_mut().zip(s.stage_velocities.iter().zip(&*s.solution)) {
        *p = v + y;
    }
    c.forces(s.stage_positions.view(), s.products, s.elements, s.preconditioned, statistics);
    let difference = |a: &[Vec3], b: &[Vec3]| -> Sum {
        a.iter().zip(b).zip(&*s.solution).map(|((&a, &b), &y)| dot_sum(a - b, y)).sum()
    };
    (-difference(s.forces, s.direction), -difference(s.preconditioned, s.forces))
}

fn column_dot(a: &[Vec3], b: &[Vec3]) -> Sum {
    a.iter().zip(b).map(|(&a, &b)| dot_sum(a, b)).sum()
}

/// Adds a multiple of the solution to the changes, and to the velocities.
fn add_solution<D: Dispatch>(c: &StepInput<'_, D>, stage: &ImplicitStage<'_>, scale: Real, s: &mut Scratch<'_>) {
    let (y, vh) = (&*s.solution, stage.velocities);
    c.dispatch.run((&mut *s.velocity_changes, &mut *s.stage_velocities), |start, (changes, v)| {
        for (i, (change, v)) in (start..).zip(changes.iter_mut().zip(v)) {
            *change += y.at(i) * scale;
            *v = vh.at(i) + *change;
        }
    });
    pin_forces::add_change(c, stage.length, scale, s);
}

fn add_scaled<D: Dispatch>(c: &StepInput<'_, D>, from: &[Vec3], scale: Real, to: &mut [Vec3]) {
    c.dispatch.run(to, |start, part| {
        for (to, &from) in part.iter_mut().zip(from.part(start..)) {
            *to += from * scale;
        }
    });
}
