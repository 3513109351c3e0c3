//! Preconditioned conjugate gradients on the pre-filtered system `(S A S + I - S) y = S b` [Tamstorf 2015], A = M + S';
//! the filter S removes the held axes.
//!
//! With a [`ConvexTerm`] C, which contacts give, the function
//!
//! `(y - y0) . A (y - y0) / 2 + C(y)`
//!
//! is minimised over the change y of the velocities, where `A y0 = b` is the residual of the step. The function is
//! convex and piecewise quadratic between updates of C. The method is that for nonlinear functions [Polak 1969; Nocedal
//! 2006, ch. 5.2] with an exact line search: contacts that open, close, stick or slip on the way need no solve of their
//! own. Without contacts these are linear conjugate gradients.
//!
//! A solve stops on its residual, on negative curvature (truncated Newton) or on a limit of iterations
//! or updates.

use super::coarse::{self, CoarseFactor, Patches};
use super::columns::{Sums, dot, sum_parts};
use super::convex_term::ConvexTerm;
use super::per_cloth::{self, ClothSolve};
use super::pins::Pins;
use super::stopping::{Goal, ROUGHLY_BALANCED, UNBALANCED};
use super::{IntegratorStatistics, Preconditioner, StepInput, Tolerance};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::forces::matrix::{self, BlockMatrix};
use crate::real::{Mat3, Real, Sum, Vec3, scaled_identity};
use crate::scratch::Scratch;
use crate::stage::Stage;

/// The system matrix `M + S'` with the held axes.
pub struct System<'a> {
    /// S'.
    pub matrix: &'a BlockMatrix<'a>,
    /// Masses, kg.
    pub masses: &'a [Real],
    /// The held axes.
    pub pins: &'a Pins<'a>,
}

/// The preconditioner, ready to be applied to a residual.
pub struct FactoredPreconditioner<'a, 'b> {
    /// Inverse of each diagonal block.
    pub inverse_diagonal: &'a mut [Mat3],
    /// The patches and the factor of their small system; `None` for block Jacobi.
    pub coarse: Option<(Patches<'a>, &'a mut CoarseFactor<'b>)>,
}

/// Writes the inverse of each diagonal block, with held axes decoupled.
pub fn write_inverse_diagonal(
    system: &System<'_>,
    term: &dyn ConvexTerm,
    inverse: &mut [Mat3],
    dispatch: &impl Dispatch,
) {
    let matrix = system.matrix;
    dispatch.run(&mut *inverse, |start, part| {
        let rows = matrix.offsets.part(start..).iter().zip(system.masses.part(start..));
        for (block, (&first, &mass)) in part.iter_mut().zip(rows) {
            let Some(diagonal) = matrix.blocks.element(first as usize) else { continue };
            *block = matrix::to_mat3(diagonal) + scaled_identity(mass);
        }
    });
    add_diagonal(term, inverse);
    system.pins.filter_diagonal(inverse);
    dispatch.run(inverse, |_, part| {
        for block in part {
            // A block that is not positive definite (exact Jacobian) is replaced by the mean of its
            // absolute diagonal.
            *block = if is_positive_definite(block) {
                block.inverse()
            } else {
                scaled_identity(3.0 / (block.x_axis.x.abs() + block.y_axis.y.abs() + block.z_axis.z.abs()))
            };
        }
    });
}

/// Adds the diagonal blocks of the term's curvature.
pub fn add_diagonal(term: &dyn ConvexTerm, blocks: &mut [Mat3]) {
    term.visit_curvature(&mut |part| {
        for (&v, weight) in part.vertices.iter().zip(part.weights) {
            if let Some(block) = blocks.get_mut(v as usize) {
                *block += part.matrix * (weight * weight);
            }
        }
    });
}

/// Tests the leading minors [Sylvester].
fn is_positive_definite(block: &Mat3) -> bool {
    let minor = block.x_axis.x * block.y_axis.y - block.x_axis.y * block.y_axis.x;
    block.x_axis.x > 0.0 && minor > 0.0 && block.determinant() > 0.0
}

/// Iterations after which the bounds of friction are updated, at the latest. If the solve takes long, the update waits
/// for this part of its iterations: normal impulses and bounds that chase each other need time to settle.
const UPDATE_AFTER: u32 = 8;
const UPDATE_PART: u32 = 8;

/// The bounds are also updated when the squared residual is this small, relative to that of the last update.
const UPDATE_BELOW: Sum = 0.01;

/// Updates of the bounds in a solve that also update the multipliers. More of them need more iterations. Without them a
/// landing stretches cloth twice as much: what is left of its violation is corrected by the response, which moves
/// single vertices, and its multiplier throws the cloth back in the next step.
const MULTIPLIER_UPDATES: u32 = 4;

/// Updates of a solve that has converged, after which its bounds are no longer changed. A solve that they leave above
/// its tolerance is counted as unconverged.
const MOST_LAST_UPDATES: u32 = 8;

/// Squared residual that the last update of the bounds may leave, relative to that at which the solve stops.
const LEFT: Sum = 100.0;

/// Slope at the end of a line search, relative to that at its start.
const SEARCHED: Sum = 0.01;

/// Squared residual after the vertices of a cloth moved together that is taken for rounding, relative to the one before.
const STILL: Sum = 1e-6;

/// Limit of evaluations in a line search.
const MOST_EVALUATIONS: u32 = 12;

/// The columns of a solve.
pub(super) struct Iterate<'a, 'b> {
    pub(super) system: System<'a>,
    pub(super) preconditioner: FactoredPreconditioner<'a, 'b>,
    pub(super) cloths: &'a mut [ClothSolve],
    /// Positions at which the forces are linearised, m.
    pub(super) positions: &'a [Vec3],
    /// y.
    pub(super) solution: &'a mut [Vec3],
    /// `A (y0 - y)`: the residual without contacts.
    pub(super) elastic: &'a mut [Vec3],
    /// The residual with the impulses of contacts, the negative gradient.
    pub(super) residual: &'a mut [Vec3],
    pub(super) preconditioned: &'a mut [Vec3],
    pub(super) direction: &'a mut [Vec3],
    pub(super) product: &'a mut [Vec3],
    /// The product of the residual with the direction.
    pub(super) slope: Sum,
    pub(super) partials: &'a mut [Sums],
}

/// Writes y to `s.solution`; NaN if the residual is not finite. `A y0` is in `s.residual`; a solve with contacts leaves
/// `A (y0 - y)` there.
#[inline(never)]
pub(crate) fn solve<D: Dispatch>(
    c: &StepInput<'_, D>,
    term: &mut dyn ConvexTerm,
    goal: Goal,
    s: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    c.dispatch.enter(Stage::Solve);
    let mut i = Iterate::new(c, s);
    if goal.is_new() {
        i.factorise(term, false, c.dispatch);
        per_cloth::start(i.cloths, c.masses, i.positions, c.pins);
    }
    i.solution.fill(Vec3::ZERO);
    i.residual.copy_from(i.elastic);
    let [_, mut rho] = i.precondition(c.dispatch);
    if goal.is_new() {
        i.set_references();
    }
    let has_patches = i.preconditioner.coarse.is_some();
    // Without patches, or within a residual, a solve leaves little.
    let leaves_much = has_patches && matches!(c.scheme.tolerance, Tolerance::Velocity(_));
    if !term.is_zero() {
        rho = i.gradient(term, c.dispatch);
    } else if leaves_much && matches!(goal, Goal::Within(_)) && i.aim(term) {
        rho = i.translate(term, statistics, c.dispatch);
        // The fall is solved, and the rest is small beside it.
        i.cloths.iter_mut().filter(|cloth| cloth.is_free()).for_each(|cloth| cloth.target *= STILL);
    }
    i.set_targets(goal, c.scheme.method);
    let (mut updated_at, mut iterations, mut since_update) = (rho, 0, 0);
    let (mut updates, mut last_updates, mut is_translated) = (0, 0, false);
    // A solve that only pauses at its goal is completed by one that balances it.
    let balances = matches!(goal, Goal::Within(_) | Goal::Reach(_)) && has_patches;
    let most = goal.most_iterations(!term.is_zero());
    i.restart(rho);
    loop {
        let is_small = i.is_within(rho, 1.0);
        if is_small && term.is_zero() {
            statistics.negative_curvature += u64::from(rho < 0.0);
            if matches!(goal, Goal::Within(_)) {
                i.complete(c.dispatch);
            }
            break;
        }
        let unbalanced = if last_updates > 0 { ROUGHLY_BALANCED } else { UNBALANCED };
        let is_balanced = is_small && (!balances || i.is_balanced(unbalanced));
        // Translations and the last updates of the bounds may undo each other again and again.
        let may_translate = leaves_much && !is_translated && last_updates == 0;
        if is_small && !is_balanced && may_translate && i.aim(term) {
            // It counts too, so the limit may be passed by one.
            (is_translated, iterations) = (true, iterations + 1);
            statistics.cg_iterations += 1;
            c.dispatch.spend(1, 0);
            rho = i.translate(term, statistics, c.dispatch);
            i.restart(rho);
            continue;
        }
        if is_balanced {
            term.update(false);
            if last_updates == 0 {
                i.factorise(term, true, c.dispatch);
            }
            rho = i.gradient(term, c.dispatch);
            last_updates += 1;
            let (left, unbalanced) = if last_updates > 1 { (LEFT, ROUGHLY_BALANCED) } else { (1.0, UNBALANCED) };
            let is_done = i.is_within(rho, left) && (!balances || i.is_balanced(unbalanced));
            if is_done || last_updates == MOST_LAST_UPDATES {
                statistics.unconverged += u64::from(!is_done);
                break;
            }
            i.restart(rho);
            (updated_at, since_update) = (rho, 0);
        }
        if c.dispatch.stopped() {
            // The driver gives up the step before anything is made of this.
            break;
        }
        if !rho.is_finite() || iterations >= most {
            let asked = matches!(goal, Goal::Iterations(_));
            statistics.unconverged += u64::from(rho.is_finite() && !asked);
            break;
        }
        (iterations, since_update, is_translated) = (iterations + 1, since_update + 1, false);
        statistics.cg_iterations += 1;
        statistics.matrix_products += 1;
        c.dispatch.spend(1, 0);
        let curvature = i.multiply(c.dispatch);
        let Some(length) = i.search(term, curvature) else {
            statistics.negative_curvature += 1;
            if iterations == 1 {
                i.solution.copy_from(i.direction);
            }
            break;
        };
        i.advance(term, length, c.dispatch);
        let is_due = since_update >= UPDATE_AFTER.max(iterations / UPDATE_PART) || rho < UPDATE_BELOW * updated_at;
        if is_due && !term.is_zero() {
            term.update(updates < MULTIPLIER_UPDATES);
            (updated_at, since_update, updates) = (rho, 0, updates + 1);
            if updates == 1 {
                i.factorise(term, true, c.dispatch);
                rho = i.gradient(term, c.dispatch);
                i.restart(rho);
                continue;
            }
        }
        rho = i.turn(term, rho, c.dispatch);
    }
    if !rho.is_finite() {
        // A solve that fails writes NaN, so that the check after the step rejects it.
        i.solution.fill(Vec3::NAN);
    }
}

impl<'a, 'b> Iterate<'a, 'b> {
    fn new<D: Dispatch>(c: &StepInput<'a, D>, s: &'a mut Scratch<'b>) -> Self {
        let coarse = match c.scheme.preconditioner {
            Preconditioner::BlockJacobi => None,
            Preconditioner::TwoLevel => Some((s.patches, &mut s.coarse)),
        };
        Self {
            system: System { matrix: &s.matrix, masses: c.masses, pins: c.pins },
            preconditioner: FactoredPreconditioner { inverse_diagonal: s.inverse_diagonal, coarse },
            cloths: s.cloths,
            positions: s.stage_positions.rounded,
            solution: s.solution,
            elastic: s.residual,
            residual: s.gradient,
            preconditioned: s.preconditioned,
            direction: s.direction,
            product: s.products,
            slope: 0.0,
            partials: s.partials,
        }
    }

    /// Prepares the preconditioner. Contacts that slip no longer resist as those that stick: by the preconditioner from
    /// before, a large residual would look small.
    #[cfg_attr(small, optimize(size))]
    #[inline(never)]
    fn factorise(&mut self, term: &dyn ConvexTerm, is_same_matrix: bool, dispatch: &impl Dispatch) {
        let Self { system, preconditioner, .. } = self;
        write_inverse_diagonal(system, term, preconditioner.inverse_diagonal, dispatch);
        if let Some((patches, factor)) = &mut preconditioner.coarse {
            coarse::write_factor(patches, system, term, is_same_matrix, factor);
        }
    }

    /// Writes the residual from its elastic part and the impulses, and preconditions it. Returns its squared norm.
    pub(super) fn gradient(&mut self, term: &dyn ConvexTerm, dispatch: &impl Dispatch) -> Sum {
        self.residual.copy_from(self.elastic);
        self.add_impulses(term);
        let [_, rho] = self.precondition(dispatch);
        rho
    }

    /// Adds the impulses to the residual.
    fn add_impulses(&mut self, term: &dyn ConvexTerm) {
        term.add_impulses(self.residual);
        self.system.pins.filter(self.residual);
    }

    /// Makes the preconditioned residual the direction; `rho` is its slope.
    fn restart(&mut self, rho: Sum) {
        self.direction.copy_from(self.preconditioned);
        self.slope = rho;
    }

    /// Writes `P residual`. Returns the products of the residual with the preconditioned residual before and now.
    #[inline(never)]
    fn precondition(&mut self, dispatch: &impl Dispatch) -> Sums {
        let Self { system, preconditioner, residual, preconditioned, partials, .. } = self;
        let (inverse, residual) = (&*preconditioner.inverse_diagonal, &**residual);
        if let Some((patches, factor)) = &mut preconditioner.coarse {
            coarse::solve(patches, factor, residual);
        }
        let coarse = preconditioner.coarse.as_ref().map(|(patches, factor)| (patches, &*factor.motions));
        let products = sum_parts(preconditioned, partials, dispatch, |range, z| {
            let r = residual.part(range.clone());
            let before = dot(r, z);
            for ((z, &r), inverse) in z.iter_mut().zip(r).zip(inverse.part(range.clone())) {
                *z = *inverse * r;
            }
            if let Some((patches, motions)) = coarse {
                coarse::add_motions(patches, motions, range.start, z);
            }
            // Held axes of the residual are zero.
            [before, dot(r, z)]
        });
        system.pins.filter(preconditioned);
        products
    }

    /// Writes the product of the matrix with the direction. Returns the curvature along the direction.
    fn multiply(&mut self, dispatch: &impl Dispatch) -> Sum {
        let Self { system, direction, product, partials, .. } = self;
        let direction = &**direction;
        let [curvature, _] = sum_parts(product, partials, dispatch, |range, q| {
            matrix::multiply_rows(system.matrix, system.masses, 1.0, direction, range.start, q);
            // Held axes of the direction are zero.
            [dot(direction.part(range), q), 0.0]
        });
        system.pins.filter(product);
        curvature
    }

    /// Length of the step along the direction that minimises the function there; `None` where it has no minimum.
    pub(super) fn search(&mut self, term: &mut dyn ConvexTerm, curvature: Sum) -> Option<Sum> {
        let slope = self.slope;
        if term.is_zero() {
            // The length is dimensionless, as P A is. Beyond 1 / EPSILON the matrix is singular within rounding errors.
            return (curvature > Sum::EPSILON * slope).then(|| slope / curvature);
        }
        let elastic_slope = slope - term.set_direction(self.direction);
        // The derivative of the function along the direction increases with the length of the step.
        let evaluate = |length: Sum| {
            let [slope, second] = term.slope_and_curvature(length as Real);
            (length * curvature - elastic_slope - slope, curvature + second)
        };
        let (mut low, mut high, mut length) = (0.0, Sum::INFINITY, 0.0);
        let (mut derivative, mut second) = evaluate(0.0);
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
            (derivative, second) = evaluate(length);
            if derivative.abs() <= SEARCHED * slope {
                break;
            }
        }
        Some(length)
    }

    /// Moves along the direction. The residual becomes its elastic part.
    pub(super) fn advance(&mut self, term: &mut dyn ConvexTerm, length: Sum, dispatch: &impl Dispatch) {
        let length = length as Real;
        let (p, q) = (&*self.direction, &*self.product);
        let columns = (&mut *self.solution, &mut *self.elastic, &mut *self.residual);
        dispatch.run(columns, |start, (y, elastic, residual)| {
            let columns = y.iter_mut().zip(elastic).zip(residual);
            for (((y, elastic), residual), (&p, &q)) in columns.zip(p.part(start..).iter().zip(q.part(start..))) {
                *y += p * length;
                *elastic -= q * length;
                *residual = *elastic;
            }
        });
        term.advance(length);
    }

    /// Adds the motions of the patches by which the preconditioner answered the last residual. Then no momentum is left
    /// in the residual of a free cloth; step after step the same part of a fall would be lost. These motions are affine
    /// in each patch: rotations of cloth that is curved there are not among them. The residual is no longer that of the
    /// solution, so this is for solves without contacts.
    #[cfg_attr(small, inline(never))]
    fn complete(&mut self, dispatch: &impl Dispatch) {
        let Some((patches, factor)) = &self.preconditioner.coarse else { return };
        dispatch.run(&mut *self.solution, |start, part| coarse::add_motions(patches, factor.motions, start, part));
        self.system.pins.filter(self.solution);
    }

    /// Completes the residual and writes the next conjugate direction. Returns the squared norm of the residual.
    fn turn(&mut self, term: &dyn ConvexTerm, rho: Sum, dispatch: &impl Dispatch) -> Sum {
        self.add_impulses(term);
        let [crossed, next] = self.precondition(dispatch);
        // Zero for a quadratic function.
        let crossed = if term.is_zero() { 0.0 } else { crossed };
        let beta = ((next - crossed) / rho).max(0.0) as Real;
        let (r, z) = (&*self.residual, &*self.preconditioned);
        [self.slope, _] = sum_parts(self.direction, self.partials, dispatch, |range, p| {
            for (p, &z) in p.iter_mut().zip(z.part(range.clone())) {
                *p = z + *p * beta;
            }
            [dot(r.part(range), p), 0.0]
        });
        if self.slope <= 0.0 {
            self.restart(next);
        }
        next
    }
}
