//! Preconditioned conjugate gradients on the pre-filtered system `(S A S + I - S) y = S b`
//! [Tamstorf 2015], A = M + S'; the filter S removes the held axes. A solve stops on the
//! preconditioned residual, on negative curvature (truncated Newton) or on the limit of iterations.

use super::IntegratorStatistics;
use super::Preconditioner;
use super::augmented_contact::{self, AugmentedContact};
use super::coarse::{self, CoarseFactor, Patches};
use super::pins::Pins;
use crate::dispatch::Dispatch;
use crate::forces::matrix::{self, BlockMatrix};
use crate::real::{Mat3, Real, Sum, Vec3, scaled_identity};

/// Limit of iterations. A solve that reaches it is counted as unconverged.
pub(super) const MOST_ITERATIONS: u32 = 20_000;

/// Number of vertices in each partial sum of an inner product. It is fixed, so that results do not
/// depend on the number of threads, bit for bit.
pub const PART: usize = 1024;

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
    pub inverse_diagonal: &'a [Mat3],
    /// The patches and the factor of their small system; `None` for block Jacobi.
    pub coarse: Option<(Patches<'a>, &'a mut CoarseFactor<'b>)>,
}

/// The columns that a solve reads and writes.
pub struct Vectors<'a> {
    /// y.
    pub solution: &'a mut [Vec3],
    /// b with held axes cleared; overwritten.
    pub residual: &'a mut [Vec3],
    /// Search direction.
    pub direction: &'a mut [Vec3],
    /// S A times the search direction.
    pub product: &'a mut [Vec3],
    /// The preconditioned residual.
    pub preconditioned: &'a mut [Vec3],
    /// One partial sum for each [`PART`] vertices.
    pub partials: &'a mut [Sum],
}

/// When a solve stops.
#[derive(Clone, Copy, Debug)]
pub struct StoppingCriterion {
    /// Norm of the preconditioned residual at which to stop, relative to its norm for y = 0.
    pub reduction: Sum,
}

/// Computes the preconditioner of the system with the contacts that push.
pub(super) fn factor<'a, 'b>(
    system: &System<'_>,
    contacts: &[AugmentedContact],
    kind: Preconditioner,
    inverse_diagonal: &'a mut [Mat3],
    patches: Patches<'a>,
    factor: &'a mut CoarseFactor<'b>,
    dispatch: &impl Dispatch,
) -> FactoredPreconditioner<'a, 'b> {
    write_inverse_diagonal(system, contacts, inverse_diagonal, dispatch);
    let coarse = match kind {
        Preconditioner::BlockJacobi => None,
        Preconditioner::TwoLevel => {
            coarse::write_factor(&patches, system, contacts, factor);
            Some((patches, factor))
        }
    };
    FactoredPreconditioner { inverse_diagonal, coarse }
}

/// Writes the inverse of each diagonal block, with held axes decoupled.
pub fn write_inverse_diagonal(
    system: &System<'_>,
    contacts: &[AugmentedContact],
    inverse: &mut [Mat3],
    dispatch: &impl Dispatch,
) {
    let matrix = system.matrix;
    dispatch.run(&mut *inverse, |start, part| {
        for (i, block) in (start..).zip(part) {
            *block = matrix::to_mat3(&matrix.blocks[matrix.offsets[i] as usize]) + scaled_identity(system.masses[i]);
        }
    });
    augmented_contact::add_diagonal(contacts, inverse);
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

/// Tests the leading minors [Sylvester].
fn is_positive_definite(block: &Mat3) -> bool {
    let minor = block.x_axis.x * block.y_axis.y - block.x_axis.y * block.y_axis.x;
    block.x_axis.x > 0.0 && minor > 0.0 && block.determinant() > 0.0
}

/// Solves the system and writes `vectors.solution`; NaN if the residual is not finite.
pub fn solve(
    system: &System<'_>,
    preconditioner: &mut FactoredPreconditioner<'_, '_>,
    stopping: StoppingCriterion,
    vectors: Vectors<'_>,
    statistics: &mut IntegratorStatistics,
    dispatch: &impl Dispatch,
) {
    let Vectors { solution, residual, direction, product, preconditioned, partials } = vectors;
    precondition(system, preconditioner, residual, preconditioned, dispatch);
    let mut rho = dot(residual, preconditioned, partials, dispatch);
    let target = rho * stopping.reduction * stopping.reduction;
    solution.fill(Vec3::ZERO);
    direction.copy_from_slice(preconditioned);
    let mut iteration = 0;
    while rho > target && rho > 0.0 {
        if iteration == MOST_ITERATIONS {
            statistics.unconverged += 1;
            return;
        }
        iteration += 1;
        statistics.cg_iterations += 1;
        statistics.matrix_products += 1;
        apply(system, direction, product, dispatch);
        let curvature = dot(direction, product, partials, dispatch);
        if curvature <= 0.0 {
            statistics.negative_curvature += 1;
            if iteration == 1 {
                solution.copy_from_slice(direction);
            }
            return;
        }
        let alpha = (rho / curvature) as Real;
        let (p, q) = (&*direction, &*product);
        dispatch.run((&mut *solution, &mut *residual), |start, (y, r)| {
            for (i, (y, r)) in (start..).zip(y.iter_mut().zip(r)) {
                *y += p[i] * alpha;
                *r -= q[i] * alpha;
            }
        });
        precondition(system, preconditioner, residual, preconditioned, dispatch);
        let next = dot(residual, preconditioned, partials, dispatch);
        let beta = (next / rho) as Real;
        rho = next;
        let z = &*preconditioned;
        dispatch.run(&mut *direction, |start, part| {
            for (p, &z) in part.iter_mut().zip(&z[start..]) {
                *p = z + *p * beta;
            }
        });
    }
    if rho < 0.0 {
        statistics.negative_curvature += 1;
    }
    if !(rho.is_finite() && target.is_finite()) {
        // A solve that fails writes NaN, so that the check after the step rejects it.
        solution.fill(Vec3::NAN);
    }
}

/// `out = S A p`. The held axes of `p` must be zero.
fn apply(system: &System<'_>, p: &[Vec3], out: &mut [Vec3], dispatch: &impl Dispatch) {
    matrix::multiply(system.matrix, system.masses, 1.0, p, out, dispatch);
    system.pins.filter(out);
}

/// `out = P residual`, with held axes cleared.
pub(super) fn precondition(
    system: &System<'_>,
    preconditioner: &mut FactoredPreconditioner<'_, '_>,
    residual: &[Vec3],
    out: &mut [Vec3],
    dispatch: &impl Dispatch,
) {
    let inverse = preconditioner.inverse_diagonal;
    dispatch.run(&mut *out, |start, part| {
        for (i, out) in (start..).zip(part) {
            *out = inverse[i] * residual[i];
        }
    });
    if let Some((patches, factor)) = &mut preconditioner.coarse {
        coarse::add_correction(patches, factor, residual, out);
        system.pins.filter(out);
    }
}

/// Inner product. Sums within parts of [`PART`] vertices in the crate's precision, and over the
/// parts in double precision.
pub fn dot(a: &[Vec3], b: &[Vec3], partials: &mut [Sum], dispatch: &impl Dispatch) -> Sum {
    dispatch.run(&mut *partials, |start, part| {
        for (k, partial) in (start..).zip(part) {
            let range = k * PART..((k + 1) * PART).min(a.len());
            let sum = a[range.clone()].iter().zip(&b[range]).fold(Vec3::ZERO, |sum, (&a, &b)| sum + a * b);
            *partial = Sum::from(sum.x) + Sum::from(sum.y) + Sum::from(sum.z);
        }
    });
    partials.iter().sum()
}
