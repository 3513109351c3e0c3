//! Vertices that the host holds, moves, attaches to colliders and lets go.

use glam::{DQuat, DVec3};
use muslin_core_f64::error::LiveError;
use muslin_core_f64::kinematic::Pose;
use muslin_core_f64::live::Live as _;
use muslin_core_f64::refusal::Cause;

use super::{apart, ball, hanging, kit, lead};

const STEP: f64 = 0.005;

#[test]
fn an_attached_vertex_moves_with_its_collider() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    for vertex in [0, 12] {
        assert_eq!(sim.attach(vertex, 0), Ok(()));
    }
    let pose = sim.collider_pose(0).expect("it exists");
    let arms = [0, 12].map(|v: usize| sim.positions()[v] - pose.position);
    lead(&mut sim, 40, |sim, n| {
        let rotation = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.02 * f64::from(n));
        let to = Pose { position: pose.position + DVec3::new(0.0, 0.002, 0.001) * f64::from(n), rotation };
        assert_eq!(sim.move_collider(0, to, STEP), Ok(()));
    });
    let now = sim.collider_pose(0).expect("it exists");
    for (vertex, arm) in [0, 12].into_iter().zip(arms) {
        let off = sim.positions()[vertex].distance(now.place(arm));
        assert!(off < 1e-14, "vertex {vertex} is {off} m off");
    }
    assert!(sim.release(0) && !sim.release(0));
    let before = sim.positions()[0];
    lead(&mut sim, 20, |_, _| ());
    assert!(sim.positions()[0].distance(before) > 0.01, "let go, it does not fall");
}

/// A sheet on a scripted collider, whose rotation goes on after the vertex is attached.
#[test]
fn a_vertex_follows_a_collider_that_the_scene_moves() {
    let motion = "motion = { keys = [[0, 0, 0, 0], [1, 0.3, 0.1, 0]], turn = { axis = [0, 1, 0], rate = 2 } }";
    let mut sim = kit::simulation(&ball(motion, ""), &[]);
    lead(&mut sim, 3, |_, _| ());
    assert_eq!(sim.attach(5, 0), Ok(()));
    let pose = sim.collider_pose(0).expect("it exists");
    let arm = pose.rotation.conjugate() * (sim.positions()[5] - pose.position);
    lead(&mut sim, 20, |_, _| ());
    let off = sim.positions()[5].distance(sim.collider_pose(0).expect("it exists").place(arm));
    assert!(off < 1e-14, "it is {off} m off");
}

/// One move over many steps is the same as a move in each of them. For BDF2 this shows that its history is kept.
#[test]
fn a_hand_that_moves_in_every_step_is_one_that_moves_once() {
    for method in ["rk4", "backward-euler", "bdf2", "implicit-midpoint"] {
        let head = format!("integrator = {{ method = \"{method}\", step = 0.0001, tolerance = 1e-10 }}");
        let scene = hanging(&head);
        let [mut once, mut often] = [(); 2].map(|()| kit::simulation(&scene, &[]));
        let from = DVec3::from(once.places_in_world().nth(60).expect("it exists"));
        let way = DVec3::new(0.001, 0.002, 0.0005);
        assert_eq!(once.move_to(60, (from + way).into(), 0.004), Ok(()));
        lead(&mut once, 40, |_, _| ());
        lead(&mut often, 40, |sim, n| {
            let to = from + way * f64::from(n + 1) / 40.0;
            assert_eq!(sim.move_to(60, to.into(), 0.0001), Ok(()));
        });
        let [gap, moved] = [apart(&once, &often), once.positions()[49].distance(DVec3::ZERO)];
        assert!(gap < 1e-11, "{method}: {gap} m apart, a vertex beside it is at {moved} m");
        assert_eq!(once.statistics().committed, often.statistics().committed, "{method}");
    }
}

#[test]
fn pins_of_the_scene_keep_their_reactions_when_others_are_let_go() {
    let two = "pin = [{ select = { edge = \"left\" } }, { select = { edge = \"right\" } }]";
    let scene = hanging("gravity = [0, -9.81, 0]").replace("pin = [{ select = { edge = \"left\" } }]", two);
    let mut sim = kit::simulation(&scene, &[]);
    sim.measure_work(Default::default());
    sim.measure_reactions();
    let left: Vec<_> = sim.scene().pin_groups[0].pins.clone().map(|pin| sim.pins().vertices[pin]).collect();
    left.iter().for_each(|&vertex| assert!(sim.release(vertex)));
    lead(&mut sim, 10, |_, _| ());
    let [free, held] = [0, 1].map(|group| sim.reactions().expect("measured").pins[group].linear);
    assert_eq!(free, DVec3::ZERO, "nobody holds these");
    assert!(held.y > 0.0, "the others carry {held}");
}

#[test]
fn a_timed_pin_that_is_let_go_does_not_come_back() {
    let scene = hanging("gravity = [0, -9.81, 0]")
        .replace("edge = \"left\" }", "edge = \"left\" }, until = 0.5")
        .replace("pin = [", "pin = [{ select = { vertices = [120] }, from = 0.05 }, ");
    let mut sim = kit::simulation(&scene, &[]);
    assert!(sim.release(120), "it would be held later");
    lead(&mut sim, 20, |_, _| ());
    assert!(sim.pins().held().all(|vertex| vertex != 120));
}

#[test]
fn nothing_is_attached_to_what_does_not_exist() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    assert_eq!(sim.attach(0, 3), Err(LiveError::NoCollider { collider: 3, count: 1 }));
    assert_eq!(sim.attach(999, 0), Err(LiveError::NoVertex { vertex: 999, count: 175 }));
}

/// What is thrown flies.
#[test]
fn a_vertex_that_is_let_go_keeps_its_velocity() {
    let still = ball("", "").replace("gravity = [0, -9.81, 0]", "");
    let velocity = DVec3::new(0.3, 2.0, -0.1);
    let mut sim = kit::simulation(&still, &[]);
    let count = sim.positions().len() as u32;
    let start = sim.collider_pose(0).expect("it exists").position;
    (0..count).for_each(|vertex| assert_eq!(sim.attach(vertex, 0), Ok(())));
    lead(&mut sim, 10, |sim, n| {
        let place = start + velocity * STEP * f64::from(n + 1);
        assert_eq!(sim.move_collider(0, Pose::at(place), STEP), Ok(()));
    });
    (0..count).for_each(|vertex| assert!(sim.release(vertex)));
    let mass: f64 = sim.scene().particles.masses.iter().sum();
    assert!(DVec3::from(sim.momentum()).distance(velocity * mass) < 1e-12, "{:?}", sim.momentum());
    let mut hand = kit::simulation(&still, &[]);
    let from = DVec3::from(hand.places_in_world().nth(7).expect("it exists"));
    lead(&mut hand, 5, |sim, n| {
        let place = from + velocity * STEP * f64::from(n + 1);
        assert_eq!(sim.move_to(7, place.into(), STEP), Ok(()));
    });
    assert!(hand.release(7));
    assert!(hand.velocities()[7].distance(velocity) < 1e-12, "{}", hand.velocities()[7]);
}

/// The manual advises it after a step that fails.
#[test]
fn a_vertex_that_was_dragged_into_a_collider_can_stay_or_be_let_go() {
    let mut start = kit::simulation(&ball("", ""), &[]);
    lead(&mut start, 10, |_, _| ());
    let place = start.places_in_world().nth(87).expect("a vertex in the middle");
    assert_eq!(start.move_to(87, [place[0], -0.12, place[2]], STEP), Ok(()));
    assert!(matches!(start.take_step().expect_err("the ball is there").cause, Cause::Contact { .. }));
    let mut stays = start.clone();
    assert_eq!(stays.move_to(87, place, STEP), Ok(()));
    stays.take_step().expect("it stays where it is");
    assert!(start.release(87));
    start.take_step().expect("it is free");
}

/// A host that judges the step of a run looks at pins that a collider carries, too.
#[test]
fn a_carried_vertex_curves_with_its_collider() {
    let mut sim =
        harness::kit::double::simulation(&super::ball("motion = { turn = { axis = [0, 1, 0], rate = 30 } }", ""), &[]);
    let before = sim.scene().largest_deviation(0.005, 1.0);
    assert_eq!(sim.attach(0, 0), Ok(()));
    // The vertex is farther from the axis than the ball reaches.
    assert!(sim.scene().largest_deviation(0.005, 1.0) > 2.0 * before, "{before}");
}
