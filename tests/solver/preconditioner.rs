//! What the two-level preconditioner is for, in counts: far fewer iterations than its blocks
//! alone; and Newton's method in single precision stops where rounding stops it.

use harness::steps::Steps;
use muslin_core::integrate::{Preconditioner, Work};
use muslin_core::scene::{BUILT_IN, SceneDesc};
use muslin_core::simulation::Simulation;

const STEPS: u32 = 12;

/// Work of the first steps of a built-in scene, changed a little.
fn work(name: &str, change: impl Fn(&mut SceneDesc)) -> Work {
    let text = BUILT_IN.iter().find(|(known, _)| *known == name).expect("the scene is built in").1;
    let mut scene: SceneDesc = toml::from_str(text).expect("built-in scenes parse");
    change(&mut scene);
    let mut cloth = Simulation::new(&scene, &[]).expect("built-in scenes build");
    for _ in 0..STEPS {
        cloth.take_step().expect("the first steps are finite");
    }
    cloth.work()
}

#[test]
fn patches_save_most_iterations() {
    for (name, saved) in [("hanging", 5), ("swing", 10)] {
        let of = |preconditioner| work(name, |scene| scene.integrator.preconditioner = preconditioner).cg_iterations;
        let (blocks, both) = (of(Preconditioner::BlockJacobi), of(Preconditioner::TwoLevel));
        assert!(both * saved < blocks, "{name}: {both} iterations with patches, {blocks} with blocks alone");
    }
}

#[test]
fn a_running_simulations_columns_make_another() {
    let text = BUILT_IN.iter().find(|(known, _)| *known == "swing").expect("the scene is built in").1;
    let scene: SceneDesc = toml::from_str(text).expect("built-in scenes parse");
    let first = Simulation::new(&scene, &[]).expect("built-in scenes build");
    let mut columns = first.scene().clone();
    columns.cloths.clear();
    let mut second = Simulation::from_columns(columns, *first.scheme(), first.step_length());
    second.take_step().expect("the first step is finite");
    assert!(second.work().cg_iterations < 40, "{} iterations: there are no patches", second.work().cg_iterations);
}

#[test]
fn newton_in_single_precision_stops_at_rounding() {
    let newton = work("swing", |scene| scene.integrator.newton = 20).newton_iterations;
    assert!(newton < 6 * u64::from(STEPS), "{newton} Newton iterations in {STEPS} steps");
}
