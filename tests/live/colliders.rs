//! Colliders that the host moves, deforms and switches.

use glam::{DQuat, DVec3};
use harness::both_precisions;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::error::LiveError;
use muslin_core_f64::kinematic::Pose;
use muslin_core_f64::live::Live as _;
use muslin_core_f64::scene::{Content, PointCache};

use super::{apart, ball, kit, lead};

const STEP: f64 = 0.005;

#[test]
fn a_collider_that_the_host_moves_is_one_that_the_scene_moves() {
    let to = DVec3::new(0.06, 0.03, -0.02);
    let keys = format!("motion = {{ keys = [[0, 0, 0, 0], [0.2, {}, {}, {}]] }}", to.x, to.y, to.z);
    let mut scripted = kit::simulation(&ball(&keys, ""), &[]);
    let mut led = kit::simulation(&ball("", ""), &[]);
    let start = led.collider_pose(0).expect("it exists").position;
    for n in 1..=40 {
        let next = Pose::at(start + to * f64::from(n) / 40.0);
        assert_eq!(led.move_collider(0, next, STEP), Ok(()));
        lead(&mut led, 1, |_, _| ());
        lead(&mut scripted, 1, |_, _| ());
        let [one, other] = [&scripted, &led].map(|sim| sim.collider_positions()[0]);
        assert!(one.distance(other) < 1e-15, "step {n}: the centres are {one} and {other}");
        // Places that differ by rounding give contacts that do, too.
        assert!(n > 20 || apart(&scripted, &led) < 1e-12, "step {n}: {} m apart", apart(&scripted, &led));
    }
    assert!(scripted.contact_statistics().proximity > 100, "hardly anything touches");
}

#[test]
fn a_box_turns_as_that_of_a_scene() {
    let shape = r#"shape = "box"
        center = [0.1, -0.3, 0.05]
        half = [0.1, 0.2, 0.1]"#;
    let scene = |motion: &str| {
        let sphere = "shape = \"sphere\"\n        center = [0, -0.12, 0]\n        radius = 0.1";
        kit::simulation(&ball(motion, "").replace(sphere, shape), &[])
    };
    let mut scripted = scene("motion = { turn = { axis = [0, 1, 0], rate = 5.0 } }");
    let mut led = scene("");
    let centre = led.collider_pose(0).expect("it exists").position;
    for n in 1..=20 {
        let pose = Pose { position: centre, rotation: DQuat::from_rotation_y(5.0 * STEP * f64::from(n)) };
        assert_eq!(led.move_collider(0, pose, STEP), Ok(()));
        lead(&mut led, 1, |_, _| ());
        lead(&mut scripted, 1, |_, _| ());
        let told = [&scripted, &led].map(|sim| sim.collider_pose(0).expect("it exists"));
        for told in told {
            assert!(told.position.distance(centre) < 1e-15 && told.rotation.dot(pose.rotation).abs() > 1.0 - 1e-14);
        }
        assert!(apart(&scripted, &led) < 1e-12, "step {n}: {} m apart", apart(&scripted, &led));
    }
}

#[test]
fn a_move_ends_where_it_should_and_can_take_many_steps() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    let start = sim.collider_pose(0).expect("it exists").position;
    let to = Pose { position: start - DVec3::Y, rotation: DQuat::from_axis_angle(DVec3::X, 2.0) };
    assert_eq!(sim.move_collider(0, to, 10.0 * STEP), Ok(()));
    lead(&mut sim, 5, |_, _| ());
    let half = sim.collider_pose(0).expect("it exists");
    assert!((half.position.distance(start) - 0.5).abs() < 1e-12, "half way it is at {half:?}");
    assert!((half.rotation.to_axis_angle().1 - 1.0).abs() < 1e-12, "half way it is turned {half:?}");
    lead(&mut sim, 15, |_, _| ());
    assert_eq!(sim.collider_pose(0), Ok(to));
}

#[test]
fn a_mesh_that_the_host_deforms_is_one_of_a_point_cache() {
    let places = |part: f64| -> Vec<[f32; 3]> {
        let corner = |x: f64, z: f64| [x as f32, (-0.05 + part * 0.1 * (x + z)) as f32, z as f32];
        vec![corner(-0.4, -0.4), corner(0.4, -0.4), corner(0.4, 0.4), corner(-0.4, 0.4)]
    };
    let wide = |places: Vec<[f32; 3]>| places.into_iter().map(|x| x.map(f64::from)).collect::<Vec<_>>();
    let (positions, triangles) = (wide(places(0.0)), vec![[0, 2, 1], [0, 3, 2]]);
    let mesh = harness::belt::Mesh { positions, uvs: Vec::new(), triangles };
    let cache = PointCache { points: 4, positions: (0..=10).flat_map(|n| places(f64::from(n) / 10.0)).collect() };
    let resources = [kit::resource("floor", mesh), ("moves".into(), Content::Cache(cache))];
    let scene = |motion: &str| {
        let floor = format!("[[collider]]\nshape = \"mesh\"\nfile = \"floor\"\n{motion}");
        let sphere = "shape = \"sphere\"\n        center = [0, -0.12, 0]";
        kit::simulation(&ball("", &floor).replace(sphere, &sphere.replace("-0.12", "-9.0")), &resources)
    };
    let mut scripted = scene("motion = \"moves\"\nmotion_rate = 200");
    let mut led = scene("");
    for n in 1..=20 {
        if n <= 10 {
            assert_eq!(led.deform_collider(1, &wide(places(f64::from(n) / 10.0)), STEP), Ok(()));
        }
        lead(&mut led, 1, |_, _| ());
        lead(&mut scripted, 1, |_, _| ());
        assert!(apart(&scripted, &led) < 1e-9, "step {n}: {} m apart", apart(&scripted, &led));
    }
    assert!(led.contact_statistics().proximity > 100, "hardly anything touches");
}

#[test]
fn a_collider_that_is_off_is_not_there() {
    let mut off = kit::simulation(&ball("", ""), &[]);
    assert_eq!(off.switch_off(0), Ok(()));
    let sphere = "center = [0, -0.12, 0]";
    let mut away = kit::simulation(&ball("", "").replace(sphere, "center = [0, -50, 0]"), &[]);
    for n in 0..40 {
        lead(&mut off, 1, |_, _| ());
        lead(&mut away, 1, |_, _| ());
        assert_eq!(off.positions(), away.positions(), "step {n}");
    }
    // It fell 4 cm of the 12: it is inside.
    assert!(off.switch_on(0).is_err(), "cloth is inside the sphere");
    lead(&mut off, 60, |_, _| ());
    assert_eq!(off.switch_on(0), Ok(()), "it has fallen through");
}

#[test]
fn switching_works_in_the_middle_of_contact() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    lead(&mut sim, 60, |_, _| ());
    assert!(sim.touches().count() > 5, "it lies on the ball");
    let top = sim.places_in_world().map(|x| x[1]).fold(f64::MIN, f64::max);
    assert_eq!(sim.switch_off(0), Ok(()));
    lead(&mut sim, 40, |_, _| ());
    assert_eq!(sim.touches().count(), 0);
    let fallen = top - sim.places_in_world().map(|x| x[1]).fold(f64::MIN, f64::max);
    assert!(fallen > 0.15, "without the ball it fell by {fallen} m only");
}

/// A sheet held at its corners, and a ball that the host moves up through it and down again.
fn pierced() -> String {
    ball("", "").replace("[[cloth]]", "[[cloth]]\n        pin = [{ select = { corners = [0, 1, 2, 3] } }]")
}

both_precisions! {
    use glam::DVec3;
    use muslin::live::Live as _;
    use muslin::dispatch::Serial;
    use muslin::kinematic::Pose;

    #[test]
    fn nothing_sinks_in_at_any_speed() {
        for speed in [0.1_f64, 0.5, 1.0, 2.0, 5.0] {
            let mut sim = kit::simulation(&super::pierced(), &[]);
            let start = sim.collider_pose(0).expect("it exists").position;
            let step = f64::from(sim.step_length());
            let rise = 0.2_f64;
            let steps = (rise / (speed * step)).ceil() as u32;
            let mut deepest = 0.0_f64;
            for n in 1..=2 * steps {
                let way = speed * step * f64::from(n.min(2 * steps - n));
                assert_eq!(sim.move_collider(0, Pose::at(start + DVec3::Y * way), step), Ok(()));
                sim.take_step().unwrap_or_else(|failed| panic!("{speed} m/s, step {n}: {failed}"));
                assert_eq!(sim.crossings(&Serial), 0, "{speed} m/s, step {n}");
                deepest = deepest.max(sim.penetration().expect("there is a sphere").into());
            }
            assert!(deepest < 1e-6, "{} {speed} m/s: {deepest} m inside", muslin::real::NAME);
            assert!(sim.contact_statistics().proximity > 100, "{speed} m/s: hardly anything touches");
        }
    }
}

#[test]
fn crossings_do_not_count_colliders_that_are_off() {
    let mut sim = kit::simulation(&ball("", "").replace("center = [0, -0.12, 0]", "center = [0, -0.2, 0]"), &[]);
    assert_eq!(sim.switch_off(0), Ok(()));
    lead(&mut sim, 45, |_, _| ());
    assert_eq!((sim.crossings(&Serial), sim.penetration()), (0, Some(0.0)));
}

#[test]
fn a_collider_that_is_on_stays_on() {
    let mut sim = kit::simulation(&pierced(), &[]);
    assert_eq!(sim.switch_on(0), Ok(()));
    lead(&mut sim, 1, |_, _| ());
    assert!(!sim.colliders().bodies[0].is_off());
}

#[test]
fn cloth_may_be_put_where_a_collider_is_off() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    let into = Pose::at(DVec3::NEG_Y * 0.12);
    assert_eq!(sim.teleport(into, &[]), Err(LiveError::Overlaps { collider: 0 }));
    assert_eq!(sim.switch_off(0), Ok(()));
    assert_eq!(sim.teleport(into, &[]), Ok(()));
}

#[test]
fn no_call_makes_a_number_that_the_columns_cannot_hold() {
    use muslin_core::kinematic::Pose;
    use muslin_core::live::Live as _;
    let mut sim = harness::kit::single::simulation(&ball("", ""), &[]);
    let before = format!("{:?}", sim.snapshot());
    assert!(sim.teleport(Pose::at([1e39, 0.0, 0.0]), &[0]).is_err());
    assert!(sim.move_to(60, [0.1, 0.0, 0.0], 1e-300).is_err());
    assert!(sim.push(60, [1e38, 0.0, 0.0]).is_err());
    assert!(sim.move_collider(0, Pose::at([1e38, 0.0, 0.0]), 0.005).is_err());
    assert!(format!("{:?}", sim.snapshot()) == before, "the state changed");
}

/// A small ball in the middle of a large triangle touches none of its vertices and edges.
#[test]
fn a_ball_within_a_triangle_is_not_switched_on() {
    let small = ball("", "").replace("radius = 0.1", "radius = 0.005").replace("[12, 12]", "[2, 2]");
    let mut sim = kit::simulation(&small.replace("gravity = [0, -9.81, 0]", ""), &[]);
    let corners = sim.triangles()[0].map(|v| sim.positions()[v as usize]);
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    assert_eq!(sim.switch_off(0), Ok(()));
    assert_eq!(sim.move_collider(0, Pose::at(middle), STEP), Ok(()));
    lead(&mut sim, 1, |_, _| ());
    assert_eq!(sim.switch_on(0), Err(LiveError::Overlaps { collider: 0 }));
    assert_eq!(sim.move_collider(0, Pose::at(middle + 0.01 * DVec3::Y), STEP), Ok(()));
    lead(&mut sim, 1, |_, _| ());
    assert_eq!(sim.switch_on(0), Ok(()));
}

fn table(y: f64) -> [muslin_core_f64::scene::Resource; 1] {
    let positions = vec![[-0.4, y, -0.4], [0.4, y, -0.4], [0.4, y, 0.4], [-0.4, y, 0.4]];
    let mesh = harness::belt::Mesh { positions, uvs: Vec::new(), triangles: vec![[0, 2, 1], [0, 3, 2]] };
    [kit::resource("table", mesh)]
}

const TABLE: &str = "[[collider]]\nshape = \"mesh\"\nfile = \"table\"";

#[test]
fn a_mesh_that_deforms_while_it_is_off_keeps_its_size() {
    let mut sim = kit::simulation(&ball("", TABLE), &table(-0.5));
    assert_eq!(sim.switch_off(1), Ok(()));
    let to = [[-0.4, -0.6, -0.4], [0.4, -0.6, -0.4], [0.4, -0.6, 0.4], [-0.4, -0.6, 0.4]];
    assert_eq!(sim.deform_collider(1, &to, 4.0 * STEP), Ok(()));
    lead(&mut sim, 2, |_, _| ());
    assert_eq!(sim.switch_on(1), Ok(()));
    let corner = sim.colliders_in_world().nth(2).expect("it has four");
    assert!(DVec3::from(corner).distance(DVec3::new(0.4, -0.55, -0.4)) < 1e-12, "{corner:?}");
}

#[test]
fn a_mesh_deforms_again_once_its_vertices_are_released() {
    let mut sim = kit::simulation(&ball("", TABLE), &table(-0.5));
    let to = [[-0.4, -0.6, -0.4], [0.4, -0.6, -0.4], [0.4, -0.6, 0.4], [-0.4, -0.6, 0.4]];
    assert_eq!(sim.attach(5, 1), Ok(()));
    assert_eq!(sim.deform_collider(1, &to, STEP), Err(LiveError::Carries { collider: 1, vertex: 5 }));
    assert!(sim.release(5));
    assert_eq!(sim.deform_collider(1, &to[..3], STEP), Err(LiveError::Points { collider: 1, expected: 4, found: 3 }));
    assert_eq!(sim.deform_collider(1, &to, STEP), Ok(()));
    for refused in [sim.attach(5, 1), sim.move_collider(1, Pose::IDENTITY, STEP)] {
        assert_eq!(refused, Err(LiveError::Deforms { collider: 1 }));
    }
}

/// A mesh turns about the middle of its vertices, however far its zero is: on its way it does not swing aside.
#[test]
fn a_mesh_far_from_its_zero_turns_on_the_spot() {
    let far = ball("", TABLE)
        .replace("[[cloth]]", "[[cloth]]\nposition = [100, 0, 0]")
        .replace("[0, -0.12, 0]", "[100, -9, 0]");
    let mut resources = table(-0.5);
    if let muslin_core_f64::scene::Content::Mesh(mesh) = &mut resources[0].1 {
        mesh.positions.iter_mut().for_each(|x| x[0] += 100.0);
    }
    let mut sim = kit::simulation(&far, &resources);
    let spot = DVec3::new(100.0, -0.5, 0.0);
    let rotation = DQuat::from_rotation_y(1.0);
    let to = Pose { position: spot - rotation * spot, rotation };
    assert_eq!(sim.move_collider(1, to, 10.0 * STEP), Ok(()));
    for n in 1..=10 {
        lead(&mut sim, 1, |_, _| ());
        let places: Vec<_> = sim.colliders_in_world().skip(1).map(DVec3::from).collect();
        let middle = places.iter().sum::<DVec3>() / 4.0;
        assert!(middle.distance(spot) < 1e-11, "step {n}: the middle is at {middle}");
    }
    let told = sim.collider_pose(1).expect("it exists");
    assert!(told.position.distance(to.position) < 1e-11 && told.rotation.dot(to.rotation).abs() > 1.0 - 1e-14);
}

/// After hours of simulated time too.
#[test]
fn a_collider_is_swept_late_in_a_run() {
    use harness::kit::single as kit;
    use muslin_core::kinematic::Pose;
    use muslin_core::live::Live as _;
    let mut sim = kit::simulation(&pierced(), &[]);
    let start = sim.clone();
    let state = muslin_core::simulation::State { steps: 20_000_000, ..start.state() };
    assert!(sim.restore(&state, Default::default(), Default::default()));
    let start = sim.collider_pose(0).expect("it exists").position;
    assert_eq!(sim.move_collider(0, Pose::at(start + DVec3::Y * 0.1), sim.step_length().into()), Ok(()));
    assert_eq!(sim.collider_pose(0).expect("it exists").position, start, "before the step it has not moved");
}
