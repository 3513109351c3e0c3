//! Memory traffic of each stage, in bytes. Every column that a stage reads or writes counts once,
//! even if the kernel reads it again from the caches. This is the cost of a kernel that is limited by
//! memory alone.

use crate::forces::matrix::{Block, Mirrored};
use crate::forces::term::ForceTerm;
use crate::forces::{Model, for_each_term};
use crate::integrate::IntegratorStatistics;
use crate::real::{Mat3, Real, Vec3};
use crate::stage::{Stage, Term};

pub(crate) const SCALAR: usize = size_of::<Real>();
pub(crate) const VECTOR: usize = size_of::<Vec3>();
const INDEX: usize = 4;

/// Sizes that the traffic depends on.
#[derive(Clone, Copy, Debug)]
pub struct TrafficSizes {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of blocks that the system matrix stores, and number of mirrored blocks.
    pub blocks: [usize; 2],
    /// Number of values in the small matrix of the two-level preconditioner; 0 without it.
    pub coarse_values: usize,
}

impl TrafficSizes {
    /// Bytes of a pass that adds to every block of the matrix and reads the positions.
    pub(crate) fn assembly(&self) -> usize {
        2 * self.blocks[0] * size_of::<Block>() + self.vertices * VECTOR
    }
}

/// Bytes of one unit of work of a stage: one evaluation of a force term or of its Jacobian, one
/// iteration of the solver, or one explicit update. Contact stages are not counted.
pub fn bytes(stage: Stage, model: &Model<'_>, sizes: TrafficSizes) -> usize {
    let n = sizes.vertices;
    match stage {
        Stage::Force(term) => force(term, model, n),
        Stage::Jacobian(term) => jacobian(term, model, sizes),
        Stage::Solve => iteration(sizes),
        // The traffic of contact depends on the number of pairs. It is not counted.
        Stage::BroadPhase | Stage::NarrowPhase | Stage::Response => 0,
        // Update: reads x, v, f, 1/m and writes x, v. Check: reads x, v.
        Stage::Integrate => n * (3 * VECTOR + SCALAR + 2 * VECTOR + 2 * VECTOR),
    }
}

/// Bytes of all work that `statistics` counts: every evaluation with an update, every Jacobian and every
/// iteration.
pub fn total_bytes(statistics: &IntegratorStatistics, model: &Model<'_>, sizes: TrafficSizes) -> u64 {
    let stage = |stage| bytes(stage, model, sizes) as u64;
    let evaluation = Term::ALL.into_iter().map(|term| stage(Stage::Force(term))).sum::<u64>();
    let jacobians = Term::ALL.into_iter().map(|term| stage(Stage::Jacobian(term))).sum::<u64>();
    statistics.force_evaluations * (evaluation + stage(Stage::Integrate))
        + statistics.newton_iterations * jacobians
        + statistics.cg_iterations * stage(Stage::Solve)
}

/// Clearing the forces counts as gravity.
fn force(name: Term, model: &Model<'_>, vertices: usize) -> usize {
    let mut bytes = if name == Term::Gravity { vertices * VECTOR } else { 0 };
    for_each_term!(model, |other, term| if other == name {
        bytes += term.force_traffic(vertices);
    });
    bytes
}

/// Clearing the matrix counts as drag.
fn jacobian(name: Term, model: &Model<'_>, sizes: TrafficSizes) -> usize {
    let mut bytes = if name == Term::Drag { sizes.blocks[0] * size_of::<Block>() } else { 0 };
    for_each_term!(model, |other, term| if other == name {
        bytes += term.tangent_traffic(sizes);
    });
    bytes
}

/// Bytes of one iteration of conjugate gradients.
fn iteration(sizes: TrafficSizes) -> usize {
    let [stored, mirrored] = sizes.blocks;
    // The small matrix is read forward and backward. Two passes over the vertices read labels,
    // coordinates and a vector.
    let coarse = match sizes.coarse_values {
        0 => 0,
        values => 2 * values * size_of::<Real>() + sizes.vertices * 2 * (INDEX + 2 * SCALAR + VECTOR),
    };
    let matrix = stored * (size_of::<Block>() + INDEX) + mirrored * size_of::<Mirrored>();
    // Vectors: product 2, two inner products 4, solution and residual 6, preconditioner 2, direction 3.
    matrix + coarse + sizes.vertices * (17 * VECTOR + 2 * INDEX + SCALAR + size_of::<Mat3>())
}
