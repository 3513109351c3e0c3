//! A simulation of another method takes over the changes that a host made.

use harness::kit::double as kit;
use muslin_core_f64::error::LiveError;
use muslin_core_f64::kinematic::Pose;
use muslin_core_f64::live::Live as _;
use muslin_core_f64::simulation::Simulation;

const METHODS: [&str; 3] = [
    "integrator = { step = 0.005 }",
    "integrator = { method = \"bdf2\", step = 0.005 }",
    "integrator = { error = 0.001 }",
];

/// A ball that moves by keys, and two pins, one of which begins late.
fn build(method: &str) -> Simulation {
    let pins = "[[cloth]]\npin = [{ select = { vertices = [0] } }, { select = { vertices = [12] }, from = 0.02 }]";
    let scene = super::ball("motion = { keys = [[0, 0, 0, 0], [0.3, 0.05, 0.02, 0]] }", "")
        .replace("integrator = { step = 0.005, tolerance = 1e-10 }", method);
    kit::simulation(&scene.replace("[[cloth]]", pins), &[])
}

/// The host moves the ball, pins, attaches, pushes and lets go.
fn act(sim: &mut Simulation) {
    super::lead(sim, 30, |_, _| ());
    assert!(sim.release(12));
    assert_eq!(sim.attach(84, 0), Ok(()));
    assert_eq!(sim.move_to(90, [0.1, 0.05, 0.1], 0.1), Ok(()));
    assert_eq!(sim.set_force(40, [0.0, 1e-3, 0.0]), Ok(()));
    let pose = sim.collider_pose(0).expect("it exists");
    assert_eq!(sim.move_collider(0, Pose { position: pose.position + 0.01, ..pose }, 0.05), Ok(()));
    super::lead(sim, 5, |_, _| ());
}

/// A new simulation, of the method, that goes on where another one is.
fn go_on(from: &Simulation, method: &str) -> Simulation {
    let mut next = build(method);
    assert!(next.restore(&from.state(), from.statistics(), from.contact_statistics()));
    assert_eq!(next.keep_colliders(from), Ok(()));
    assert_eq!(next.keep_pins(from), Ok(()));
    next
}

#[test]
fn another_simulation_of_the_scene_goes_on_with_the_same_bits() {
    for method in METHODS {
        let mut sim = build(method);
        act(&mut sim);
        let mut next = go_on(&sim, method);
        for other in [&mut sim, &mut next] {
            super::lead(other, 40, |_, _| ());
        }
        assert_eq!(next.positions(), sim.positions(), "{method}");
        assert_eq!(next.pins().held().collect::<Vec<_>>(), [0, 84, 90], "{method}");
    }
}

#[test]
fn another_method_goes_on_with_pins_forces_and_colliders() {
    let mut sim = build(METHODS[0]);
    act(&mut sim);
    let mut next = go_on(&sim, METHODS[2].replace("0.001", "0.0002").as_str());
    for other in [&mut sim, &mut next] {
        super::lead(other, 40, |_, _| ());
    }
    let held: Vec<_> = next.pins().held().collect();
    assert_eq!(held, [0, 84, 90]);
    for vertex in held {
        let [own, other] = [&next, &sim].map(|sim| sim.positions()[vertex as usize]);
        assert!(own.distance(other) < 1e-12, "vertex {vertex}: {own} and {other}");
    }
    assert_eq!(next.collider_pose(0), sim.collider_pose(0));
}

#[test]
fn a_vertex_of_a_collider_that_is_gone_rests() {
    let mut sim = build(METHODS[0]);
    act(&mut sim);
    let text = super::hanging("gravity = [0, -9.81, 0]\nintegrator = { step = 0.005 }");
    let mut next = kit::simulation(&text.replace("[0.4, 0.4], cells = [10, 10]", "[0.5, 0.5], cells = [12, 12]"), &[]);
    assert!(next.restore(&sim.state(), sim.statistics(), sim.contact_statistics()));
    assert_eq!((next.keep_colliders(&sim), next.keep_pins(&sim)), (Ok(()), Ok(())));
    let before = next.positions()[84];
    super::lead(&mut next, 20, |_, _| ());
    assert_eq!(next.positions()[84], before);
}

#[test]
fn other_colliders_and_other_cloths_are_refused() {
    let ball = kit::simulation(&super::ball("", ""), &[]);
    let mut larger = kit::simulation(&super::ball("", "").replace("radius = 0.1", "radius = 0.11"), &[]);
    assert_eq!(larger.keep_colliders(&ball), Err(LiveError::OtherScene));
    let mut other = kit::simulation(&super::hanging(""), &[]);
    assert_eq!(other.keep_pins(&ball), Err(LiveError::OtherScene));
}
