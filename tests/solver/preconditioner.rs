//! Effects of the two-level preconditioner, as counts: far fewer iterations than with its blocks alone, and no more of
//! them in a large sheet; blocks that are positive definite even if the matrix is not; and Newton's method in single
//! precision stops at the rounding limit.

use glam::{Mat3, Quat};
use harness::kit::single;
use harness::rng::Rng;
use muslin_core::dispatch::Serial;
use muslin_core::forces::matrix::{self, Block, BlockMatrix};
use muslin_core::integrate::conjugate_gradient::{System, write_inverse_diagonal};
use muslin_core::integrate::convex_term::NoTerm;
use muslin_core::integrate::pins::PinColumns;
use muslin_core::integrate::{IntegratorStatistics, Preconditioner};
use muslin_core::scene::{BUILT_IN, SceneDesc};
use muslin_core::simulation::Simulation;
use nalgebra::Matrix3;

const STEPS: u32 = 12;
/// Step, s, and tolerance.
const FIXED: (Option<f64>, Option<f64>) = (Some(1.0 / 60.0), Some(1e-3));

/// Statistics of the first `steps` of a built-in scene, after `change`; steps of 1/60 s.
fn work(name: &str, steps: u32, change: impl Fn(&mut SceneDesc)) -> IntegratorStatistics {
    let text = BUILT_IN.iter().find(|(known, _)| *known == name).expect("the scene is built in").1;
    let mut scene = single::scene(text);
    // All solves end at one residual, so that their iterations can be compared.
    (scene.integrator.step, scene.integrator.tolerance) = FIXED;
    change(&mut scene);
    let mut cloth = Simulation::new(&scene, &[]).expect("built-in scenes build");
    for _ in 0..steps {
        cloth.take_step().expect("the first steps are finite");
    }
    cloth.statistics()
}

#[test]
fn patches_save_most_iterations() {
    for (name, saved) in [("hanging", 5), ("swing", 10)] {
        let of =
            |preconditioner| work(name, STEPS, |scene| scene.integrator.preconditioner = preconditioner).cg_iterations;
        let (blocks, both) = (of(Preconditioner::BlockJacobi), of(Preconditioner::TwoLevel));
        assert!(both * saved < blocks, "{name}: {both} iterations with patches, {blocks} with blocks alone");
    }
}

/// From 16,000 vertices on, large patches are cut into small ones. Without these, the larger sheet needs 1.8 times as
/// many iterations as the smaller one.
#[test]
fn a_large_sheet_needs_no_more_iterations() {
    let of = |cells| {
        work("hanging", 2, |scene| {
            scene.cloth[0].grid.as_mut().expect("the sheet is a grid").cells = [cells; 2];
        })
        .cg_iterations
    };
    let (small, large) = (of(99), of(199));
    assert!(large <= small, "{large} iterations with 40,000 vertices, {small} with 10,000");
}

#[test]
fn a_running_simulations_columns_make_another() {
    let text = BUILT_IN.iter().find(|(known, _)| *known == "swing").expect("the scene is built in").1;
    let mut scene = single::scene(text);
    (scene.integrator.step, scene.integrator.tolerance) = FIXED;
    let first = Simulation::new(&scene, &[]).expect("built-in scenes build");
    let mut columns = first.scene().clone();
    columns.cloths.clear();
    let mut second = Simulation::from_columns(columns, *first.scheme(), first.step_length());
    second.take_step().expect("the first step is finite");
    assert!(
        second.statistics().cg_iterations < 40,
        "{} iterations: there are no patches",
        second.statistics().cg_iterations
    );
}

#[test]
fn newton_in_single_precision_stops_at_rounding() {
    let newton = work("swing", STEPS, |scene| scene.integrator.newton = 20).newton_iterations;
    assert!(newton < 6 * u64::from(STEPS), "{newton} Newton iterations in {STEPS} steps");
}

#[test]
fn inverse_blocks_are_positive_definite_even_of_indefinite_ones() {
    let mut rng = Rng::new(5);
    // Every combination of signs of the three eigenvalues, a hundred times.
    let symmetric: Vec<(u32, Mat3)> = (0..800)
        .map(|k| {
            let eigenvalue = |axis: u32| (1.0 + axis as f32) * if k >> axis & 1 == 1 { -1.0 } else { 1.0 };
            let turn = Mat3::from_quat(Quat::from_scaled_axis(rng.cube(3.0).as_vec3()));
            let diagonal = Mat3::from_diagonal([eigenvalue(0), eigenvalue(1), eigenvalue(2)].into());
            (k % 8, turn * diagonal * turn.transpose())
        })
        .collect();
    let mut blocks = vec![Block::default(); symmetric.len()];
    blocks.iter_mut().zip(&symmetric).for_each(|(block, (_, matrix))| matrix::add(block, matrix));
    let rows: Vec<u32> = (0..=blocks.len() as u32).collect();
    let empty = vec![0; rows.len()];
    let matrix = &BlockMatrix {
        offsets: &rows,
        columns: &rows[..blocks.len()],
        mirrored_offsets: &empty,
        mirrored: &[],
        blocks: &mut blocks,
    };
    let pins = PinColumns::default();
    let system = System { matrix, masses: &vec![0.0; symmetric.len()], pins: &pins.view() };
    let mut inverse = vec![Mat3::ZERO; symmetric.len()];
    write_inverse_diagonal(&system, &NoTerm, &mut inverse, &Serial);
    for ((signs, block), inverse) in symmetric.iter().zip(&inverse) {
        let least = Matrix3::from_column_slice(&inverse.to_cols_array()).symmetric_eigenvalues().min();
        assert!(least > 0.0, "the inverse of a block with the signs {signs:03b} has the eigenvalue {least}");
        let identity = *inverse * *block;
        assert!(*signs != 0 || identity.abs_diff_eq(Mat3::IDENTITY, 1e-5), "{identity} is no identity");
    }
}
