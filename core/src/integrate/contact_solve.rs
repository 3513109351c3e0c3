//! Solves a step together with its contacts: minimises
//!
//! `(y - y0) . A (y - y0) / 2 + sum of the contacts' potentials of u + G y`
//!
//! over the change y of the velocities, where A is the matrix of the step, `A y0` its residual and G y the change of a
//! contact's relative velocity. The function is convex and piecewise quadratic while the bounds of friction are fixed
//! ([`AugmentedContact`]). It is minimised by preconditioned conjugate gradients for nonlinear functions [Polak 1969;
//! Nocedal 2006, ch. 5.2] with an exact line search: contacts that open, close, stick or slip on the way need no solve
//! of their own. Without contacts these are linear conjugate gradients.

use super::augmented_contact::{AugmentedContact, ContactLine};
use super::conjugate_gradient::{self, FactoredPreconditioner, MOST_ITERATIONS, System};
use super::newton::{self, ImplicitStage, MOST_STRAIN};
use super::{IntegratorStatistics, Method, StepInput};
use crate::dispatch::Dispatch;
use crate::forces::{self, matrix};
use crate::real::{Real, Sum, Vec3};
use crate::scratch::Scratch;
use crate::stage::Stage;

/// Limit of linearisations in a step.
const MOST_LINEARIZATIONS: u32 = 8;

/// Iterations after which the bounds of friction are updated, at the latest.
const UPDATE_AFTER: u32 = 8;

/// The bounds are also updated when the squared residual is this small, relative to that of the last update.
const UPDATE_BELOW: Sum = 0.01;

/// Updates of a solve that has converged, after which its bounds are no longer changed.
const MOST_LAST_UPDATES: u32 = 8;

/// Squared residual that the last update of the bounds may leave, relative to that at which the solve stops.
const LEFT: Sum = 100.0;

/// Slope at the end of a line search, relative to that at its start.
const SEARCHED: Sum = 0.01;

/// Limit of evaluations in a line search.
const MOST_EVALUATIONS: u32 = 12;

/// Length over which the velocity that the stage was solved for moves the positions, s.
fn stage_length(method: Method, step: Real, has_history: bool) -> Real {
    match method {
        Method::Bdf2 if has_history => step * (2.0 / 3.0),
        _ => step,
    }
}

/// Corrects the candidate state of an implicit step, whose matrix must still be in `s`. `x` and `v` are the state at the
/// start of the step. Of contacts, the relative displacement and the least displacement along the normal are given in
/// place of the velocities, m; `lines` has room for as many.
///
/// If the solve turns or stretches elements by more than [`MOST_STRAIN`], only a part of its step is taken, and the
/// forces are linearised there again. One linearisation would stretch cloth that a contact turns.
pub fn correct<D: Dispatch>(
    c: &StepInput<'_, D>,
    [x, v]: [&[Vec3]; 2],
    (contacts, lines): (&mut [AugmentedContact], &mut [ContactLine]),
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let length = stage_length(c.scheme.method, c.step, s.has_history);
    for contact in &mut *contacts {
        contact.velocity /= length;
        contact.least_velocity /= length;
        contact.start(c.masses, &s.matrix);
    }
    if !c.defers_solve() {
        if contacts.iter().any(|contact| contact.impulse != Vec3::ZERO) {
            s.residual.fill(Vec3::ZERO);
            solve(c, (contacts, lines), c.scheme.tolerance.into(), s, statistics);
            // A contact changes the velocity as much as the displacement over the step. The second-order methods would
            // extrapolate the change, and so return what the contact has stopped.
            add_solution(c, length, length / c.step, s);
        }
        return;
    }
    let stage = ImplicitStage { length, positions: x, velocities: v };
    for linearization in 1..=MOST_LINEARIZATIONS {
        let tolerance = Sum::from(c.scheme.tolerance) * newton::weight_factor(c, length, s);
        solve(c, (contacts, lines), tolerance, s, statistics);
        let part = MOST_STRAIN / (length * forces::strain_rate(c.model, s.solution));
        let left = (MOST_LINEARIZATIONS - linearization) as Real;
        // Steps that are much too long for the motion gain nothing.
        let is_last = part >= 1.0 || part * left < 1.0 || !part.is_finite();
        if is_last {
            return add_solution(c, length, 1.0, s);
        }
        for contact in &mut *contacts {
            contact.velocity -= contact.gather(s.solution) * (1.0 - part);
            contact.impulse = contact.impulse_at(contact.velocity);
        }
        add_solution(c, length * part, part, s);
        newton::linearize(c, &stage, s, statistics);
    }
}

/// Adds multiples of the solution to the positions and velocities of the candidate state.
fn add_solution<D: Dispatch>(c: &StepInput<'_, D>, to_position: Real, to_velocity: Real, s: &mut Scratch<'_>) {
    c.dispatch.enter(Stage::Integrate);
    let y = &*s.solution;
    c.dispatch.run((&mut *s.next_positions, &mut *s.next_velocities), |start, (x, v)| {
        for (i, (x, v)) in (start..).zip(x.iter_mut().zip(v)) {
            *x += y[i] * to_position;
            *v += y[i] * to_velocity;
        }
    });
}

/// The columns of a solve.
struct Iterate<'a, 'b> {
    system: System<'a>,
    preconditioner: FactoredPreconditioner<'a, 'b>,
    /// y.
    solution: &'a mut [Vec3],
    /// `A (y0 - y)`: the residual without contacts.
    elastic: &'a mut [Vec3],
    /// The residual with the impulses of contacts, the negative gradient.
    residual: &'a mut [Vec3],
    preconditioned: &'a mut [Vec3],
    direction: &'a mut [Vec3],
    product: &'a mut [Vec3],
    partials: &'a mut [Sum],
    /// The contacts along the direction; room for all of them.
    lines: &'a mut [ContactLine],
}

/// Writes y to `s.solution`, and the contacts' impulses. `A y0` is in `s.residual`.
fn solve<D: Dispatch>(
    c: &StepInput<'_, D>,
    (contacts, lines): (&mut [AugmentedContact], &mut [ContactLine]),
    tolerance: Sum,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    c.dispatch.enter(Stage::Solve);
    let system = System { matrix: &s.matrix, masses: c.masses, pins: c.pins };
    let preconditioner = conjugate_gradient::factor(
        &system,
        contacts,
        c.scheme.preconditioner,
        s.inverse_diagonal,
        s.patches,
        &mut s.coarse,
        c.dispatch,
    );
    let mut i = Iterate {
        system,
        preconditioner,
        solution: s.solution,
        elastic: s.residual,
        residual: s.base_residual,
        preconditioned: s.preconditioned,
        direction: s.direction,
        product: s.products,
        partials: s.partials,
        lines,
    };
    i.solution.fill(Vec3::ZERO);
    i.residual.copy_from_slice(i.elastic);
    let free = i.precondition(c.dispatch);
    let mut rho = i.gradient(contacts, c.dispatch);
    let target = free.max(rho) * tolerance * tolerance;
    let (mut updated_at, mut iterations, mut since_update, mut last_updates) = (rho, 0, 0, 0);
    i.direction.copy_from_slice(i.preconditioned);
    loop {
        if rho <= target {
            contacts.iter_mut().for_each(|contact| contact.update_friction(true));
            rho = i.gradient(contacts, c.dispatch);
            last_updates += 1;
            let left = if last_updates > 1 { LEFT * target } else { target };
            if rho <= left || last_updates == MOST_LAST_UPDATES {
                break;
            }
            i.direction.copy_from_slice(i.preconditioned);
            (updated_at, since_update) = (rho, 0);
        }
        if !rho.is_finite() || iterations == MOST_ITERATIONS {
            statistics.unconverged += u64::from(rho.is_finite());
            break;
        }
        (iterations, since_update) = (iterations + 1, since_update + 1);
        statistics.cg_iterations += 1;
        statistics.matrix_products += 1;
        let Some(length) = i.search(contacts, rho, c.dispatch) else {
            statistics.negative_curvature += 1;
            if iterations == 1 {
                i.solution.copy_from_slice(i.direction);
            }
            break;
        };
        i.advance(contacts, length, c.dispatch);
        if since_update >= UPDATE_AFTER || rho < UPDATE_BELOW * updated_at {
            contacts.iter_mut().for_each(|contact| contact.update_friction(last_updates > 0));
            (updated_at, since_update) = (rho, 0);
        }
        rho = i.turn(contacts, rho, c.dispatch);
    }
    if !rho.is_finite() {
        // A solve that fails writes NaN, so that the check after the step rejects it.
        i.solution.fill(Vec3::NAN);
    }
}

impl Iterate<'_, '_> {
    /// Writes the residual from its elastic part and the impulses, and preconditions it. Returns its squared norm.
    fn gradient(&mut self, contacts: &[AugmentedContact], dispatch: &impl Dispatch) -> Sum {
        self.write_residual(contacts);
        self.precondition(dispatch)
    }

    fn write_residual(&mut self, contacts: &[AugmentedContact]) {
        self.residual.copy_from_slice(self.elastic);
        for contact in contacts.iter().filter(|contact| contact.impulse != Vec3::ZERO) {
            contact.scatter_impulse(self.residual);
        }
        self.system.pins.filter(self.residual);
    }

    fn precondition(&mut self, dispatch: &impl Dispatch) -> Sum {
        let Self { system, preconditioner, residual, preconditioned, partials, .. } = self;
        conjugate_gradient::precondition(system, preconditioner, residual, preconditioned, dispatch);
        conjugate_gradient::dot(residual, preconditioned, partials, dispatch)
    }

    /// Length of the step along the direction that minimises the function there; `None` where it has no minimum.
    fn search(&mut self, contacts: &mut [AugmentedContact], rho: Sum, dispatch: &impl Dispatch) -> Option<Sum> {
        let mut slope = conjugate_gradient::dot(self.residual, self.direction, self.partials, dispatch);
        if slope <= 0.0 {
            self.direction.copy_from_slice(self.preconditioned);
            slope = rho;
        }
        let Self { system, elastic, direction, product, partials, lines, .. } = self;
        matrix::multiply(system.matrix, system.masses, 1.0, direction, product, dispatch);
        system.pins.filter(product);
        let curvature = conjugate_gradient::dot(direction, product, partials, dispatch);
        let elastic_slope = conjugate_gradient::dot(elastic, direction, partials, dispatch);
        let mut count = 0;
        for contact in &mut *contacts {
            contact.change = contact.gather(direction);
            if let Some(line) = contact.line(contact.change) {
                lines[count] = line;
                count += 1;
            }
        }
        let lines = &lines[..count];
        // The derivative of the function along the direction increases with the length of the step.
        let evaluate = |length: Sum| {
            let (mut derivative, mut second) = (length * curvature - elastic_slope, curvature);
            for line in lines {
                let (slope, curvature) = line.slope_and_curvature(length as Real);
                derivative -= Sum::from(slope);
                second += Sum::from(curvature);
            }
            (derivative, second)
        };
        let (mut low, mut high, mut length) = (0.0, Sum::INFINITY, 0.0);
        let (mut derivative, mut second) = (-slope, evaluate(0.0).1);
        for _ in 0..MOST_EVALUATIONS {
            if derivative < 0.0 {
                low = length
            } else {
                high = length
            }
            let newton = length - derivative / second;
            length = match (low < newton && newton < high, high.is_finite()) {
                (true, _) => newton,
                (false, true) => 0.5 * (low + high),
                (false, false) => return None,
            };
            if lines.is_empty() {
                break;
            }
            (derivative, second) = evaluate(length);
            if derivative.abs() <= SEARCHED * slope {
                break;
            }
        }
        Some(length)
    }

    fn advance(&mut self, contacts: &mut [AugmentedContact], length: Sum, dispatch: &impl Dispatch) {
        let length = length as Real;
        let (p, q) = (&*self.direction, &*self.product);
        dispatch.run((&mut *self.solution, &mut *self.elastic), |start, (y, r)| {
            for (i, (y, r)) in (start..).zip(y.iter_mut().zip(r)) {
                *y += p[i] * length;
                *r -= q[i] * length;
            }
        });
        for contact in contacts {
            contact.velocity += contact.change * length;
            contact.impulse = contact.impulse_at(contact.velocity);
        }
    }

    /// Writes the next residual and the next conjugate direction. Returns the squared norm of the residual.
    fn turn(&mut self, contacts: &[AugmentedContact], rho: Sum, dispatch: &impl Dispatch) -> Sum {
        self.write_residual(contacts);
        let crossed = conjugate_gradient::dot(self.residual, self.preconditioned, self.partials, dispatch);
        let next = self.precondition(dispatch);
        let beta = ((next - crossed) / rho).max(0.0) as Real;
        let z = &*self.preconditioned;
        dispatch.run(&mut *self.direction, |start, part| {
            for (p, &z) in part.iter_mut().zip(&z[start..]) {
                *p = z + *p * beta;
            }
        });
        next
    }
}
