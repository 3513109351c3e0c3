//! Preconditioned conjugate gradients on the pre-filtered system `(S A S + I - S) y = S b`
//! [Tamstorf 2015], A = M + S': held axes never enter. Stops on the preconditioned residual, on
//! negative curvature (truncated Newton) or on the limit of iterations.

use super::IntegratorStatistics;
use super::coarse::{self, CoarseFactor, Patches};
use super::coupling::{self, Hold};
use super::pins::Pins;
use crate::dispatch::Dispatch;
use crate::forces::matrix::{self, BlockMatrix};
use crate::real::{Mat3, Real, Sum, Vec3, scaled_identity};

/// Iterations after which a solve is given up and counted as unconverged.
const MOST_ITERATIONS: u32 = 20_000;

/// Vertices whose inner products are summed in one part; fixed, so that the bits do not depend
/// on the threads.
pub const PART: usize = 1024;

/// `M + S'` with held axes.
pub struct System<'a> {
    /// S'.
    pub matrix: &'a BlockMatrix<'a>,
    /// kg.
    pub masses: &'a [Real],
    /// The held axes.
    pub pins: &'a Pins<'a>,
    /// Contacts that push.
    pub holds: &'a [Hold],
}

/// What the residual is multiplied with before a step.
pub struct FactoredPreconditioner<'a, 'b> {
    /// Inverse of each diagonal block.
    pub inverse_diagonal: &'a [Mat3],
    /// Patches and the factor of their small system, where there are two levels.
    pub coarse: Option<(Patches<'a>, &'a mut CoarseFactor<'b>)>,
}

/// The columns that a solve works in.
pub struct Vectors<'a> {
    /// y, written.
    pub solution: &'a mut [Vec3],
    /// b with held axes cleared; consumed.
    pub residual: &'a mut [Vec3],
    /// Search direction.
    pub direction: &'a mut [Vec3],
    /// A times the direction.
    pub product: &'a mut [Vec3],
    /// The preconditioned residual.
    pub preconditioned: &'a mut [Vec3],
    /// One partial sum for each [`PART`] vertices.
    pub partials: &'a mut [Sum],
}

/// Where a solve begins and ends.
#[derive(Clone, Copy, Debug)]
pub struct StoppingCriterion {
    /// The preconditioned residual of the solution beside that of zero.
    pub reduction: Sum,
    /// Whether to begin from the solution that there is; else from zero.
    pub warm_start: bool,
}

impl StoppingCriterion {
    /// From zero.
    pub fn reduced_by(reduction: Sum) -> Self {
        Self { reduction, warm_start: false }
    }
}

/// Writes the inverse of each diagonal block, held axes decoupled.
pub fn write_inverse_diagonal(system: &System<'_>, inverse: &mut [Mat3], dispatch: &impl Dispatch) {
    let matrix = system.matrix;
    dispatch.run(&mut *inverse, |start, part| {
        for (i, block) in (start..).zip(part) {
            *block = matrix::to_mat3(&matrix.blocks[matrix.offsets[i] as usize]) + scaled_identity(system.masses[i]);
        }
    });
    coupling::add_diagonal(system.holds, inverse);
    system.pins.filter_diagonal(inverse);
    dispatch.run(inverse, |_, part| {
        for block in part {
            // An indefinite block (exact Jacobian) is replaced by its trace.
            *block = if is_positive_definite(block) {
                block.inverse()
            } else {
                scaled_identity(3.0 / (block.x_axis.x.abs() + block.y_axis.y.abs() + block.z_axis.z.abs()))
            };
        }
    });
}

/// By the leading minors [Sylvester].
fn is_positive_definite(block: &Mat3) -> bool {
    let minor = block.x_axis.x * block.y_axis.y - block.x_axis.y * block.y_axis.x;
    block.x_axis.x > 0.0 && minor > 0.0 && block.determinant() > 0.0
}

/// Solves for `vectors.solution`.
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
    let guessed = if stopping.warm_start {
        statistics.matrix_products += 1;
        apply(system, solution, product, dispatch);
        product.iter_mut().zip(&*residual).for_each(|(q, &b)| *q = b - *q);
        precondition(system, preconditioner, product, direction, dispatch);
        Some(dot(product, direction, partials, dispatch))
    } else {
        None
    };
    // A guess that is worse than none is dropped.
    if let Some(better) = guessed.filter(|&guessed| guessed < rho) {
        rho = better;
        residual.copy_from_slice(product);
    } else {
        solution.fill(Vec3::ZERO);
        direction.copy_from_slice(preconditioned);
    }
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
        // Never a step without its forces: what is not a number is found after the step.
        solution.fill(Vec3::NAN);
    }
}

/// `out = S A p` for a `p` with held axes clear.
fn apply(system: &System<'_>, p: &[Vec3], out: &mut [Vec3], dispatch: &impl Dispatch) {
    matrix::multiply(system.matrix, system.masses, 1.0, p, out, dispatch);
    coupling::add_product(system.holds, p, out);
    system.pins.filter(out);
}

fn precondition(
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

/// Inner product in parts of fixed size: within a part in the crate's precision, over the parts
/// in double.
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
