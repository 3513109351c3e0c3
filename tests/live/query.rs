//! What a host reads: contacts, points of the cloth, what a ray hits.

use glam::DVec3;
use muslin_core_f64::error::LiveError;
use muslin_core_f64::live::{Live as _, Side};

use super::{ball, kit, lead};

/// A damped sheet that has come to rest on a table: its contacts carry its weight.
#[test]
fn the_contacts_at_rest_carry_the_weight() {
    let table = r#"shape = "plane"
        point = [0, -0.003, 0]
        normal = [0, 1, 0]"#;
    let sphere = "shape = \"sphere\"\n        center = [0, -0.12, 0]\n        radius = 0.1";
    let mut sim = kit::simulation(&ball("", "").replace(sphere, table), &[]);
    lead(&mut sim, 200, |_, _| ());
    let mass: f64 = sim.scene().particles.masses.iter().sum();
    let (mut force, mut count) = (DVec3::ZERO, 0);
    for touch in sim.touches() {
        assert_eq!(touch.sides, [Side::Cloth(0), Side::Collider(0)]);
        assert!(DVec3::from(touch.normal).distance(DVec3::Y) < 1e-15);
        let at = DVec3::from(touch.position);
        assert!(at.y > -0.0031 && at.y < 0.002 && at.x.abs() < 0.26, "a contact is at {at}");
        force += DVec3::from(touch.force);
        count += 1;
    }
    assert!(count > 100, "{count} contacts");
    let weight = mass * 9.81;
    assert!(force.distance(DVec3::Y * weight) < 1e-4 * weight, "{force} N for a weight of {weight} N");
}

#[test]
fn a_contact_between_cloths_names_both() {
    let two = ball("", "")
        + "[[cloth]]\ngrid = { size = [0.3, 0.3], cells = [5, 5] }\nposition = [0, 0.02, 0]\n"
        + super::CLOTH;
    let mut sim = kit::simulation(&two, &[]);
    let mut met = false;
    lead(&mut sim, 40, |sim, _| {
        met |= sim.touches().any(|touch| {
            touch.sides == [Side::Cloth(1), Side::Cloth(0)] || touch.sides == [Side::Cloth(0), Side::Cloth(1)]
        });
    });
    assert!(met, "the upper sheet never touched the lower one");
}

#[test]
fn a_point_lies_in_its_triangle_and_moves_with_it() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    lead(&mut sim, 30, |_, _| ());
    let corners = sim.triangles()[40].map(|v| sim.positions()[v as usize]);
    let weights = [0.2, 0.3, 0.5];
    let point = sim.point(40, weights).expect("it exists");
    let place = corners[0] * 0.2 + corners[1] * 0.3 + corners[2] * 0.5;
    assert!(place.distance(point.position.into()) < 1e-15);
    let normal = DVec3::from(point.normal);
    assert!((normal.length() - 1.0).abs() < 1e-15 && normal.dot(corners[1] - corners[0]).abs() < 1e-15);
    lead(&mut sim, 1, |_, _| ());
    let next = sim.point(40, weights).expect("it exists");
    // Backward Euler moves with the velocity at the end of a step.
    let moved = (DVec3::from(next.position) - DVec3::from(point.position)) / 0.005;
    assert!(moved.distance(next.velocity.into()) < 1e-9, "{moved} m/s, told {:?}", next.velocity);
    let missing = LiveError::NoTriangle { triangle: 999, count: sim.triangles().len() as u32 };
    assert_eq!(sim.point(999, weights), Err(missing));
}

#[test]
fn a_ray_hits_what_is_in_front() {
    let sim = kit::simulation(&ball("", ""), &[]);
    let hit = sim.hit([0.03, 1.0, 0.11], [0.0, -2.0, 0.0]).expect("finite").expect("the sheet is below");
    assert!((hit.distance - 1.0).abs() < 1e-12, "{hit:?}");
    let place = sim.point(hit.triangle, hit.weights).expect("it exists").position;
    assert!(DVec3::from(place).distance(DVec3::new(0.03, 0.0, 0.11)) < 1e-12, "{place:?}");
    assert!(sim.hit([0.03, -1.0, 0.11], [0.0, 2.0, 0.0]).expect("finite").is_some(), "from below");
    for (origin, direction) in [
        ([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
        ([9.0, 1.0, 0.0], [0.0, -1.0, 0.0]),
        ([0.0, 1.0, 0.0], [0.0; 3]),
        ([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
    ] {
        assert_eq!(sim.hit(origin, direction), Ok(None), "from {origin:?} along {direction:?}");
    }
    assert_eq!(sim.hit([f64::NAN; 3], [0.0, 1.0, 0.0]), Err(LiveError::NotFinite { name: "a ray" }));
}

/// The sheet has no gaps: rays at its edges hit it.
#[test]
fn rays_do_not_slip_between_triangles() {
    let tilted = ball("", "").replace("[[cloth]]", "[[cloth]]\nrotation = [20, 31, 12]").replace("-0.12", "-9");
    let sim = kit::simulation(&tilted, &[]);
    let at = |v: u32| sim.positions()[v as usize];
    for corners in sim.triangles() {
        for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|k| at(corners[k]))) {
            let target = a + (b - a) * 0.37;
            // The rim may be missed.
            if target.abs().max_element() > 0.2 {
                continue;
            }
            let eye = DVec3::new(0.3, 2.0, -0.4);
            let hit = sim.hit(eye.into(), (target - eye).into()).expect("finite");
            assert!(hit.is_some_and(|hit| (hit.distance - eye.distance(target)).abs() < 1e-9), "{hit:?}");
        }
    }
    let scaled = [1e-200, 1e200].map(|size| sim.hit([0.0, 1.0, 0.0], [0.0, -size, 0.0]).expect("finite").is_some());
    assert_eq!(scaled, [true; 2]);
}
