//! Memory traffic of each stage, in bytes. Every column that a stage reads or writes counts once,
//! even if the kernel reads it again from the caches. This is the cost of a kernel that is limited by
//! memory alone.

use crate::forces::Model;
use crate::forces::element::Element;
use crate::forces::matrix::{Block, Mirrored};
use crate::forces::spring::Springs;
use crate::integrate::IntegratorStatistics;
use crate::real::{Mat3, Real, Vec3};
use crate::stage::{Stage, Term};

const SCALAR: usize = size_of::<Real>();
const VECTOR: usize = size_of::<Vec3>();
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

fn force(term: Term, model: &Model<'_>, n: usize) -> usize {
    let springs = |s: &Option<Springs<'_>>| s.map_or(0, |s| spring_columns(&s) + n * (3 * VECTOR + INDEX));
    match term {
        Term::Gravity => n * (SCALAR + VECTOR),
        Term::Drag => model.drag.map_or(0, |_| n * (SCALAR + 3 * VECTOR)),
        Term::StretchSpring => springs(&model.stretch_springs),
        Term::BendSpring => springs(&model.bend_springs),
        Term::Membrane => model.membrane.map_or(0, |m| elements(&m, n, 5 * SCALAR + 2)),
        Term::Hinge => model.hinges.map_or(0, |h| elements(&h, n, 3 * SCALAR)),
        Term::Seam => model.seams.map_or(0, |s| elements(&s, n, 3 * SCALAR)),
        Term::Wind => model.wind.map_or(0, |w| elements(&w, n, 0)),
    }
}

fn spring_columns(springs: &Springs<'_>) -> usize {
    springs.others.len() * (INDEX + 2 * SCALAR) + springs.damping.len() * SCALAR
}

/// Bytes of an element term. The element pass reads corners and `rest` bytes of material and writes the
/// force slots; the gather reads the slots and adds to the forces.
fn elements<const K: usize>(term: &impl Element<K>, n: usize, rest: usize) -> usize {
    term.vertices().len() * (K * INDEX + rest + 2 * K * VECTOR + K * INDEX) + n * (4 * VECTOR + INDEX)
}

fn jacobian(term: Term, model: &Model<'_>, sizes: TrafficSizes) -> usize {
    let matrix = 2 * sizes.blocks[0] * size_of::<Block>() + sizes.vertices * (VECTOR + INDEX);
    let springs = |s: &Option<Springs<'_>>| s.map_or(0, |s| spring_columns(&s) + s.others.len() * 2 + matrix);
    match term {
        // Drag is added in the pass that clears the matrix.
        Term::Drag => sizes.blocks[0] * size_of::<Block>(),
        Term::Gravity => 0,
        Term::StretchSpring => springs(&model.stretch_springs),
        Term::BendSpring => springs(&model.bend_springs),
        Term::Membrane => model.membrane.map_or(0, |m| packed(&m, 5 * SCALAR + 2) + matrix),
        Term::Hinge => model.hinges.map_or(0, |h| packed(&h, 3 * SCALAR) + matrix),
        Term::Seam => model.seams.map_or(0, |s| packed(&s, 3 * SCALAR) + matrix),
        Term::Wind => model.wind.map_or(0, |w| packed(&w, 0) + matrix),
    }
}

/// Bytes of an element Jacobian: corners, `rest` bytes of material, the packed Jacobian written and read,
/// incidence and assembly map.
fn packed<const K: usize, E: Element<K>>(term: &E, rest: usize) -> usize {
    term.vertices().len() * (2 * K * INDEX + rest + 2 * size_of::<E::Tangent>() + 2 * K * K)
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
