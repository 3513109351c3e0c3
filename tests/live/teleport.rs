//! Cloth that appears elsewhere goes on as if nothing had happened.

use glam::{DQuat, DVec3};
use muslin_core_f64::error::LiveError;
use muslin_core_f64::kinematic::Pose;
use muslin_core_f64::live::Live as _;
use muslin_core_f64::simulation::Simulation;

use super::{ball, kit, lead};

/// About the vertical, so that gravity stays what it is.
fn elsewhere() -> Pose {
    Pose { position: DVec3::new(3.0, -1.0, 2.0), rotation: DQuat::from_rotation_y(1.1) }
}

/// The largest distance between vertices and where the motion would have put those of the other, m.
fn off(there: &Simulation, here: &Simulation, by: &Pose) -> f64 {
    let pairs = there.places_in_world().zip(here.places_in_world());
    pairs.map(|(there, here)| by.place(here.into()).distance(there.into())).fold(0.0, f64::max)
}

/// A sheet that is held by the scene, by the host, and by a collider that turns.
fn held(method: &str) -> Simulation {
    let text = ball("", "")
        .replace(
            "[[cloth]]",
            "[[cloth]]\npin = [{ select = { corners = [0] }, motion = { keys = [[0, 0, 0, 0], [0.5, 0, 0.1, 0]] } }]",
        )
        .replace("step = 0.005", &format!("method = \"{method}\", step = 0.001"));
    let mut sim = kit::simulation(&text, &[]);
    assert_eq!(sim.attach(160, 0), Ok(()));
    let from = DVec3::from(sim.places_in_world().nth(12).expect("it exists"));
    assert_eq!(sim.move_to(12, (from + DVec3::Y * 0.1).into(), 1.0), Ok(()));
    sim
}

fn turn(sim: &mut Simulation, by: &Pose, n: u32) {
    let own = Pose { position: DVec3::new(0.0, -0.12, 0.0), rotation: DQuat::from_rotation_x(0.002 * f64::from(n)) };
    assert_eq!(sim.move_collider(0, own.then(by), 0.001), Ok(()));
}

#[test]
fn it_goes_on_elsewhere_as_it_would_have_gone_on_here() {
    for method in ["backward-euler", "bdf2", "implicit-midpoint"] {
        let [mut here, mut there] = [(); 2].map(|()| held(method));
        for sim in [&mut here, &mut there] {
            lead(sim, 50, |sim, n| turn(sim, &Pose::IDENTITY, n));
        }
        let by = elsewhere();
        assert_eq!(there.teleport(by, &[0]), Ok(()));
        assert!(off(&there, &here, &by) < 1e-15 * 16.0, "at once: {} m off", off(&there, &here, &by));
        lead(&mut here, 50, |sim, n| turn(sim, &Pose::IDENTITY, 50 + n));
        lead(&mut there, 50, |sim, n| turn(sim, &by, 50 + n));
        assert!(off(&there, &here, &by) < 1e-8, "{method}: {} m off after 50 steps", off(&there, &here, &by));
    }
}

#[test]
fn a_teleport_gives_no_velocity() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    sim.measure_work(Default::default());
    lead(&mut sim, 8, |_, _| ());
    let (energy, momentum) = (sim.energy().kinetic, sim.momentum());
    let balance = sim.energy().total() - sim.work_done().from_outside();
    assert_eq!(sim.teleport(Pose::at([100.0, 50.0, 0.0]), &[0]), Ok(()));
    assert_eq!((sim.energy().kinetic, sim.momentum()), (energy, momentum));
    let after = sim.energy().total() - sim.work_done().from_outside();
    assert!((balance - after).abs() < 1e-12, "{balance} J became {after} J");
    lead(&mut sim, 1, |_, _| ());
    // It falls on as before.
    let gained = DVec3::from(sim.momentum()) - DVec3::from(momentum);
    let weight: f64 = sim.scene().particles.masses.iter().sum::<f64>() * 9.81 * 0.005;
    assert!(gained.distance(DVec3::NEG_Y * weight) < 1e-9, "{gained}");
}

#[test]
fn a_teleport_into_a_collider_or_without_what_it_needs_is_refused() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    assert_eq!(sim.teleport(Pose::at([0.0, -0.12, 0.0]), &[]), Err(LiveError::Overlaps { collider: 0 }));
    assert_eq!(sim.attach(5, 0), Ok(()));
    assert_eq!(sim.teleport(Pose::at([0.0, 1.0, 0.0]), &[]), Err(LiveError::Held { vertex: 5 }));
    let moving = "motion = { keys = [[0, 0, 0, 0], [1, 1, 0, 0]] }";
    let mut scripted = kit::simulation(&ball(moving, ""), &[]);
    assert_eq!(scripted.teleport(Pose::at([0.0, 1.0, 0.0]), &[0]), Err(LiveError::Scripted { collider: 0 }));
    assert_eq!(scripted.teleport(Pose::at([0.0, 1.0, 0.0]), &[]), Ok(()), "the sheet alone");
}

#[test]
fn a_collider_that_is_named_twice_moves_once() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    let before = sim.collider_pose(0).expect("it exists").position;
    assert_eq!(sim.teleport(Pose::at([10.0, 0.0, 0.0]), &[0, 0]), Ok(()));
    assert!((sim.collider_pose(0).expect("it exists").position - before).distance(DVec3::X * 10.0) < 1e-14);
    let missing = LiveError::NoCollider { collider: 7, count: 1 };
    assert_eq!(sim.teleport(Pose::IDENTITY, &[7]), Err(missing));
}

/// What overlaps already may come along, however it turns.
#[test]
fn an_overlap_that_comes_along_is_no_reason_to_refuse() {
    let pinned = ball("", "").replace("[[cloth]]", "[[cloth]]\npin = [{ select = { vertices = [87] } }]");
    let sunk = pinned.replace("center = [0, -0.12, 0]", "center = [0, -0.07, 0]");
    for n in 0..20 {
        let mut sim = kit::simulation(&sunk, &[]);
        let rotation = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.3 * f64::from(n));
        let by = Pose { position: DVec3::new(1.0, 2.0, 0.3), rotation };
        assert_eq!(sim.teleport(by, &[0]), Ok(()), "turn {n}");
    }
}

#[test]
fn a_pin_that_will_hold_a_single_axis_cannot_turn() {
    let later = "[[cloth]]\npin = [{ select = { vertices = [3] }, axes = \"x\", from = 0.5 }]";
    let mut sim = kit::simulation(&ball("", "").replace("[[cloth]]", later), &[]);
    assert_eq!(sim.teleport(elsewhere(), &[0]), Err(LiveError::Held { vertex: 3 }));
    assert_eq!(sim.teleport(Pose::at([1.0, 0.0, 0.0]), &[0]), Ok(()), "without a turn");
}

#[test]
fn a_pin_that_has_ended_hinders_nothing() {
    let ended = "[[cloth]]\npin = [{ select = { vertices = [3] }, axes = \"x\", until = 0.05 }]";
    let mut sim = kit::simulation(&ball("", "").replace("[[cloth]]", ended), &[]);
    assert_eq!(sim.teleport(elsewhere(), &[0]), Err(LiveError::Held { vertex: 3 }));
    lead(&mut sim, 20, |_, _| ());
    assert!(sim.pins().held().next().is_none(), "it has ended");
    assert!(!sim.release(3), "nothing is left to let go");
    assert_eq!(sim.teleport(elsewhere(), &[0]), Ok(()));
}

/// A figure that has been deformed and rests.
#[test]
fn a_mesh_that_was_deformed_comes_along() {
    let mesh = harness::belt::Mesh {
        positions: vec![[-0.4, -0.3, -0.4], [0.4, -0.3, -0.4], [0.4, -0.3, 0.4], [-0.4, -0.3, 0.4]],
        uvs: Vec::new(),
        triangles: vec![[0, 2, 1], [0, 3, 2]],
    };
    let floor = "[[collider]]\nshape = \"mesh\"\nfile = \"floor\"";
    let mut sim = kit::simulation(&ball("", floor), &[kit::resource("floor", mesh)]);
    let to: Vec<[f64; 3]> = (0..4).map(|k| [0.1 * f64::from(k), -0.5, 0.2 * f64::from(k * k)]).collect();
    assert_eq!(sim.deform_collider(1, &to, 0.01), Ok(()));
    assert_eq!(sim.teleport(Pose::at([1.0, 0.0, 0.0]), &[0, 1]), Err(LiveError::Scripted { collider: 1 }));
    lead(&mut sim, 2, |_, _| ());
    assert_eq!(sim.teleport(Pose::at([1.0, 0.0, 0.0]), &[0, 1]), Ok(()));
    let places: Vec<_> = sim.colliders_in_world().skip(1).collect();
    for (now, was) in places.iter().zip(&to) {
        assert!(DVec3::from(*now).distance(DVec3::from(*was) + DVec3::X) < 1e-12, "{now:?} from {was:?}");
    }
}
