//! Contact does not draw cloth out: a method that rings does not ring with what it met.
//!
//! Run: `cargo test --release -p muslin-tests --test response stretch`; with `-- --nocapture` it
//! prints the largest stretch of every method.

use muslin_tests::both_precisions;

/// A napkin on a box that is drawn away under it.
const NAPKIN: &str = r#"
    name = "drawn away"
    duration = 0.3
    frame_rate = 100
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.3, 0.3], cells = [12, 8] }
    position = [-0.022, 0.001, -0.033]
    density = 0.2
    stretch = { model = "membrane", stiffness = 1000.0, damping = 0.0005 }
    shear = { stiffness = 300.0 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.001 }
    [[collider]]
    shape = "box"
    center = [0.0, -0.05, 0.0]
    half = [0.05, 0.05, 0.05]
    motion = { keys = [[0.0, 0, 0, 0], [0.2, 0.1, -0.036, -0.01], [0.5, 0, 0, 0]] }
    [contact]
    thickness = 0.004
    [integrator]
    step = 0.01
    newton = 5
"#;

/// Edges may be drawn out so far in the step in which something lands.
const MOST: f64 = 2.0;

both_precisions! {
    use super::{MOST, NAPKIN};

    #[test]
    #[cfg_attr(debug_assertions, ignore = "slow: run with --release")]
    fn no_implicit_method_rings_with_what_it_met() {
        for method in ["backward-euler", "implicit-midpoint", "bdf2"] {
            let mut sim = kit::simulation(&format!("{NAPKIN}method = \"{method}\"\n"), &[]);
            let mut most: f64 = 1.0;
            kit::run(&mut sim, 0.3, |sim| most = most.max(sim.stretch().max.into()));
            println!("{} {method}: stretched by at most {most:.3}", muslin::real::NAME);
            assert!(most < MOST, "{} {method}: stretched {most}fold, bound {MOST}", muslin::real::NAME);
        }
    }
}
