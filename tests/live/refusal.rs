//! What cannot be is refused, in words, and changes nothing.

use glam::{DQuat, DVec3};
use muslin_core_f64::error::LiveError;
use muslin_core_f64::kinematic::Pose;
use muslin_core_f64::live::Live as _;
use muslin_core_f64::simulation::Simulation;

use super::{ball, kit, lead};

const PLANE: &str = "[[collider]]\nshape = \"plane\"\npoint = [0, -1, 0]\nnormal = [0, 1, 0]";

type Ask = fn(&mut Simulation) -> Result<(), LiveError>;

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let asks: [(&str, Ask); 20] = [
        ("there is no collider 2: the last one is 1", |sim| sim.move_collider(2, Pose::IDENTITY, 1.0)),
        ("the pose must be finite", |sim| sim.move_collider(0, Pose::at([f64::NAN, 0.0, 0.0]), 1.0)),
        ("the pose must be finite", |sim| {
            sim.move_collider(0, Pose { rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..Pose::IDENTITY }, 1.0)
        }),
        ("at least a thousandth of a step, or the collider would jump", |sim| {
            sim.move_collider(0, Pose::IDENTITY, 0.0)
        }),
        ("at least", |sim| sim.move_collider(0, Pose::IDENTITY, 1e-17)),
        ("the impulse must be finite", |sim| sim.push(0, [0.0, f64::INFINITY, 0.0])),
        ("only a mesh changes its shape", |sim| sim.deform_collider(1, &[[0.0; 3]], 1.0)),
        ("must be finite and at least", |sim| sim.move_collider(0, Pose::IDENTITY, f64::NAN)),
        ("a plane cannot turn", |sim| {
            sim.move_collider(1, Pose { rotation: DQuat::from_rotation_x(0.1), ..Pose::IDENTITY }, 1.0)
        }),
        ("only a mesh changes its shape", |sim| sim.deform_collider(0, &[[0.0; 3]], 1.0)),
        ("there is no collider 9", |sim| sim.switch_off(9)),
        ("there is no vertex 175: the last one is 174", |sim| sim.move_to(175, [0.0; 3], 1.0)),
        ("the place must be finite", |sim| sim.move_to(1, [0.0, f64::INFINITY, 0.0], 1.0)),
        ("must be finite and not negative", |sim| sim.move_to(1, [0.0; 3], -1.0)),
        ("there is no vertex 200", |sim| sim.push(200, [0.0; 3])),
        ("the impulse must be finite", |sim| sim.push(0, [f64::NAN; 3])),
        ("gravity must be finite", |sim| sim.set_gravity([f64::INFINITY; 3])),
        ("the scene has no wind", |sim| sim.set_wind([1.0; 3])),
        ("the force must be finite", |sim| sim.set_force(0, [f64::NAN; 3])),
        ("cloth would intersect collider 1", |sim| sim.teleport(Pose::at(DVec3::NEG_Y * 0.95), &[])),
    ];
    let mut sim = kit::simulation(&ball("", PLANE), &[]);
    lead(&mut sim, 30, |_, _| ());
    for (words, ask) in asks {
        let before = format!("{:?}", sim.snapshot());
        let refused = ask(&mut sim).expect_err(words);
        assert!(refused.to_string().contains(words), "{refused}, not {words}");
        assert!(format!("{:?}", sim.snapshot()) == before, "{words}: the state changed");
    }
}

#[test]
fn a_scene_without_contact_has_no_colliders() {
    let mut sim = kit::simulation(&super::hanging(""), &[]);
    let missing = LiveError::NoCollider { collider: 0, count: 0 };
    assert_eq!(sim.move_collider(0, Pose::IDENTITY, 1.0), Err(missing));
    assert_eq!(missing.to_string(), "there is no collider 0: the scene has no collider");
    assert_eq!(sim.touches().count(), 0);
}

/// Numbers that a column in single precision cannot hold.
#[test]
fn what_single_precision_cannot_hold_is_refused() {
    use muslin_core::live::Live as _;
    let mut sim = harness::kit::single::simulation(&ball("", ""), &[]);
    assert!(sim.push(60, [1e39, 0.0, 0.0]).is_err());
    assert!(sim.set_gravity([0.0, 1e39, 0.0]).is_err());
    assert!(sim.set_force(60, [0.0, 1e39, 0.0]).is_err());
    assert!(sim.velocities().iter().all(|v| v.is_finite()));
}
