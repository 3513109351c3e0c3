//! Known faults, one test each: a test passes while its fault exists. A failing test means that the fault is
//! fixed: reverse the assertion, move it to the tests of its module, and delete the line from the limits in the
//! manual (`core/README.md`).
//!
//! Run: `cargo test -p muslin-tests --test known_issues`.

use glam::DVec3;
use harness::belt::{belt, drum, hanging, holding_end};
use harness::kit::double as kit;
use harness::steps::Steps;
use muslin_core_f64::forces::TangentScale;
use muslin_core_f64::forces::element::Element;
use muslin_core_f64::forces::hinge::HingeColumns;
use muslin_core_f64::forces::seam::SeamColumns;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::scene::{BUILT_IN, SceneDesc};
use muslin_core_f64::simulation::Simulation;

/// One hinge of two triangles of height 1 over an edge of length 1, flat at rest.
fn hinge() -> HingeColumns {
    HingeColumns {
        vertices: vec![[0, 1, 2, 3]],
        stiffness: vec![1.0],
        rest_angles: vec![0.0],
        least_heights: vec![0.1],
        ..HingeColumns::default()
    }
}

/// The hinge bent by an angle; its second triangle has the given height.
fn bent(degrees: f64, height: f64) -> [DVec3; 4] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 1.0, 0.0), DVec3::new(0.5, -height * cosine, height * sine)]
}

#[test]
fn a_hinge_folded_beyond_half_a_turn_counts_from_the_other_side() {
    let columns = hinge();
    let energy = |degrees: f64| columns.view().energy(0, &bent(degrees, 1.0)).bend;
    assert!((energy(181.0) - energy(179.0)).abs() < 1e-12, "the angle is continued beyond half a turn");
}

#[test]
fn the_exact_jacobian_of_a_collapsing_hinge_ignores_its_relief() {
    let columns = hinge();
    let (view, low) = (columns.view(), bent(30.0, 0.05));
    let step = 1e-7;
    let scale = TangentScale { position: 1.0, velocity: 0.0 };
    let exact = view.exact(0, &low, &[DVec3::ZERO; 4], scale)[3][3].z_axis.z;
    let force = |dz: f64| {
        let mut x = low;
        x[3].z += dz;
        view.force(0, &x, &[DVec3::ZERO; 4])[3].z
    };
    let difference = -(force(step) - force(-step)) / (2.0 * step);
    assert!((exact - difference).abs() > 0.1 * exact.abs(), "{exact} agrees with {difference}");
}

#[test]
fn the_damping_of_a_gaping_seam_resists_its_turning() {
    let columns = SeamColumns {
        vertices: vec![[0, 1, 2]],
        weights: vec![0.5],
        stiffness: vec![1.0],
        damping: vec![1.0],
        ..SeamColumns::default()
    };
    let x = [DVec3::ZERO, DVec3::new(1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)];
    let turning = x.map(|x| DVec3::Z.cross(x));
    let damping = columns.view().force(0, &x, &turning)[0] - columns.view().force(0, &x, &[DVec3::ZERO; 3])[0];
    assert!(damping.length() > 0.5, "a turning seam is free of damping: {damping}");
}

#[test]
fn one_linear_step_of_a_stiff_sheet_can_overshoot() {
    let stretch = |newton: u32| {
        let text = format!(
            "name = \"released\"\nduration = 1.0\nframe_rate = 10\ngravity = [0.0, -9.81, 0.0]\n\
             [[cloth]]\ngrid = {{ size = [1.0, 1.0], cells = [16, 18] }}\ndensity = 0.2\n\
             stretch = {{ model = \"membrane\", stiffness = 2000.0 }}\nshear = {{ stiffness = 500.0 }}\n\
             bend = {{ model = \"hinge\", rigidity = 1e-5 }}\npin = [{{ select = {{ corners = [0, 1] }} }}]\n\
             [integrator]\nstep = 0.1\nnewton = {newton}\n"
        );
        let scene: SceneDesc = toml::from_str(&text).expect("the scene of this test parses");
        let mut cloth = Simulation::new(&scene, &[]).expect("the scene of this test builds");
        let mut largest = 0.0_f64;
        for _ in 0..10 {
            cloth.take_step().expect("the scene of this test stays finite");
            largest = largest.max(cloth.stretch().max);
        }
        largest
    };
    let (linear, converged) = (stretch(1), stretch(20));
    assert!((1.02..1.03).contains(&converged), "converged, the sheet is stretched to {converged}");
    assert!(linear > 2.0, "one linear step stretches to {linear}, converged to {converged}");
}

#[test]
fn error_control_of_implicit_midpoint_lets_a_stiff_sheet_ring() {
    let text = BUILT_IN.iter().find(|(name, _)| *name == "skirt").expect("the scene is built in").1;
    let stretch = |step: f64, error: Option<f64>| {
        let mut scene: SceneDesc = toml::from_str(text).expect("built-in scenes parse");
        scene.integrator.method = Method::ImplicitMidpoint;
        (scene.integrator.step, scene.integrator.error) = (Some(step), error);
        let mut cloth = Simulation::new(&scene, &[]).expect("built-in scenes build");
        let mut largest = 0.0_f64;
        while cloth.time() < 0.2 {
            cloth.take_step().expect("the start of the scene stays finite");
            largest = largest.max(cloth.stretch().max - 1.0);
        }
        largest
    };
    let (controlled, fixed) = (stretch(1.0 / 60.0, Some(0.001)), stretch(1.0 / 240.0, None));
    assert!(fixed < 0.02, "by steps of 1/240 s the skirt stretches by {fixed}");
    assert!(controlled > 2.0 * fixed, "under error control it stretches by {controlled}, by fixed steps by {fixed}");
}

#[test]
#[ignore = "slow"]
fn by_long_steps_a_belt_holds_on_a_drum_of_edges_where_it_should_slip() {
    let resources = [kit::resource("belt", belt(0.5 * holding_end(0.3), 0.012)), kit::resource("drum", drum(24))];
    let collider = "shape = \"mesh\"\nfile = \"drum\"";
    let falls = |method: &str, step: f64| {
        let integrator = format!("[integrator]\nmethod = \"{method}\"\nstep = {step:?}");
        kit::falls(&hanging(0.3, 100.0, &integrator, collider), &resources, 0.4)
    };
    let [long, five, two, short] = [0.01, 0.005, 0.0025, 0.001].map(|step| falls("backward-euler", step));
    let explicit = falls("symplectic-euler", 1e-4);
    println!("by 10, 5, 2.5, 1 ms: {long:.3}, {five:.3}, {two:.3}, {short:.3} m; explicit {explicit:.3} m");
    assert!(
        (short / explicit - 1.0).abs() < 0.05,
        "by 1 ms the belt goes {short} m, by an explicit method {explicit} m"
    );
    assert!(long < 0.7 * explicit, "by 10 ms the belt goes {long} m, by an explicit method {explicit} m");
}
