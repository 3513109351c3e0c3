//! What is known to be wrong, one test each: it passes while the fault is there. When a test
//! fails the fault is mended: turn the assertion round and move it to the tests of its module, and
//! strike the line from the README's "what it does not do".
//!
//! Run with `cargo test -p muslin-tests --test known_issues`.

use glam::DVec3;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::forces::TangentScale;
use muslin_core_f64::forces::element::Element;
use muslin_core_f64::forces::hinge::HingeColumns;
use muslin_core_f64::forces::seam::SeamColumns;
use muslin_core_f64::scene::SceneDesc;
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

/// The hinge bent by an angle, its second triangle `height` high.
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
            cloth.step(&Serial).expect("the scene of this test stays finite");
            largest = largest.max(cloth.stretch().max);
        }
        largest
    };
    let (linear, converged) = (stretch(1), stretch(50));
    assert!(converged < 1.2, "converged, the sheet is stretched to {converged}");
    assert!(linear > 1.5 * converged, "one linear step stretches to {linear}, converged to {converged}");
}

/// Pins within the thickness of a box push a sheet along it, with friction: it catches on the edge
/// and is drawn out, and by half the step it is not.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow: run with --release")]
fn pins_within_the_thickness_that_push_cloth_draw_it_out() {
    let text = |step: f64| {
        format!(
            r#"
            name = "pushed"
            duration = 0.3
            frame_rate = 30
            gravity = [0.0, -9.81, 0.0]
            [[cloth]]
            grid = {{ size = [0.4, 0.4], cells = [16, 18] }}
            position = [0.0, 0.103, 0.0]
            density = 0.2
            stretch = {{ model = "membrane", stiffness = 1000.0, damping = 0.0005 }}
            shear = {{ stiffness = 300.0 }}
            bend = {{ model = "hinge", rigidity = 1e-5, damping = 0.001 }}
            pin = [{{ select = {{ edge = "left" }}, motion = {{ keys = [[0.0, 0, 0, 0], [0.5, 0.3, 0, 0]] }} }}]
            [[collider]]
            shape = "box"
            center = [0.0, 0.05, 0.0]
            half = [0.15, 0.05, 0.15]
            [contact]
            thickness = 0.004
            friction = 0.3
            [integrator]
            step = {step:?}
            "#
        )
    };
    let most = |step: f64| {
        let scene: SceneDesc = toml::from_str(&text(step)).expect("the scene parses");
        let mut cloth = Simulation::new(&scene, &[]).expect("the scene builds");
        let mut most = 1.0;
        while cloth.time() < 0.3 {
            cloth.step(&Serial).expect("the step can be taken");
            most = cloth.stretch().max.max(most);
        }
        most
    };
    let [coarse, fine] = [5e-3, 2.5e-3].map(most);
    println!("stretched to {coarse:.2} by steps of 5 ms, to {fine:.3} by steps of 2.5 ms");
    assert!(coarse < 4.0 && fine < 1.1, "5 ms: {coarse}, 2.5 ms: {fine}: drawn out by more than is known");
    assert!(coarse > 1.5, "5 ms: {coarse}: the fault is mended");
}

/// A sheet slides down a slope of 0.5 with friction 0.3: on a plane as far as it should, on a box
/// less far, since the edge across the box's face has contacts of its own, which lean.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow: run with --release")]
fn the_edge_across_a_flat_face_holds_what_slides_over_it() {
    let slide = |collider: &str| {
        let text = format!(
            r#"
            name = "sliding"
            duration = 0.4
            frame_rate = 10
            gravity = [4.38717, -8.77433, 0.0]
            [[cloth]]
            grid = {{ size = [0.3, 0.3], cells = [8, 9] }}
            position = [0.0, 0.0041, 0.0]
            density = 0.2
            stretch = {{ model = "membrane", stiffness = 1000.0, damping = 0.0005 }}
            shear = {{ stiffness = 300.0 }}
            bend = {{ model = "hinge", rigidity = 1e-5, damping = 0.001 }}
            [[collider]]
            {collider}
            [contact]
            thickness = 0.004
            friction = 0.3
            [integrator]
            step = 0.0025
            "#
        );
        let scene: SceneDesc = toml::from_str(&text).expect("the scene parses");
        let mut cloth = Simulation::new(&scene, &[]).expect("the scene builds");
        let middle = |cloth: &Simulation| {
            let sum: f64 = cloth.positions().iter().map(|x| x.x).sum();
            sum / cloth.positions().len() as f64
        };
        let start = middle(&cloth);
        while cloth.time() < 0.4 {
            cloth.step(&Serial).expect("the step can be taken");
        }
        middle(&cloth) - start
    };
    let plane = slide("shape = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]");
    let face = slide("shape = \"box\"\ncenter = [0, -0.1, 0]\nhalf = [1, 0.1, 1]");
    // g (sin - mu cos) t^2 / 2.
    let expected = 0.5 * (4.38717 - 0.3 * 8.77433) * 0.4 * 0.4;
    println!("slides {plane:.4} m on a plane, {face:.4} m on a box, expected {expected:.4} m");
    assert!((plane / expected - 1.0).abs() < 0.05, "on a plane {plane} m, expected {expected} m");
    assert!(face < 0.95 * expected, "on a box {face} m, expected {expected} m: the fault is mended");
}
