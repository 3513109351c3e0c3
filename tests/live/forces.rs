//! Forces and materials that the host changes.

use glam::DVec3;
use muslin_core_f64::error::LiveError;
use muslin_core_f64::live::Live as _;
use muslin_core_f64::simulation::MaterialError;
use muslin_core_f64::work_done::WorkDone;

use super::{ball, hanging, kit, lead};

const GRAVITY: &str = "gravity = [0.0, -9.81, 0.0]";
const FINE: &str = "integrator = { method = \"implicit-midpoint\", step = 0.0005, tolerance = 1e-12 }";

#[test]
fn forces_that_the_host_sets_are_those_of_a_scene() {
    let wind = |x: f64| format!("{GRAVITY}\n[drag.wind]\nvelocity = [{x}, 0, 1]\nnormal = 1.5\ntangential = 0.2");
    let load = "load = [{ select = { vertices = [60] }, force = [0, 0.3, 0.1] }]\ndensity";
    for (what, before, after) in [
        ("gravity", hanging(""), hanging(GRAVITY)),
        ("wind", hanging(&wind(0.0)), hanging(&wind(3.0))),
        ("load", hanging(GRAVITY), hanging(GRAVITY).replace("density", load)),
    ] {
        let [mut led, mut scene] = [&before, &after].map(|text| kit::simulation(text, &[]));
        let done = match what {
            "gravity" => led.set_gravity([0.0, -9.81, 0.0]),
            "wind" => led.set_wind([3.0, 0.0, 1.0]),
            _ => led.set_force(60, [1.0, 1.0, 1.0]).and_then(|()| led.set_force(60, [0.0, 0.3, 0.1])),
        };
        assert_eq!(done, Ok(()), "{what}");
        for sim in [&mut led, &mut scene] {
            lead(sim, 40, |_, _| ());
        }
        assert_eq!(led.positions(), scene.positions(), "{what}");
    }
    let mut calm = kit::simulation(&hanging(GRAVITY), &[]);
    assert_eq!(calm.set_wind([1.0, 0.0, 0.0]), Err(LiveError::NoWind));
}

#[test]
fn a_force_can_be_taken_back() {
    let [mut led, mut scene] = [(); 2].map(|()| kit::simulation(&hanging(GRAVITY), &[]));
    assert_eq!(led.set_force(60, [5.0, 0.0, 0.0]).and(led.set_force(60, [0.0; 3])), Ok(()));
    for sim in [&mut led, &mut scene] {
        lead(sim, 20, |_, _| ());
    }
    assert_eq!(led.positions(), scene.positions());
}

#[test]
fn a_push_changes_the_momentum_by_itself() {
    let mut sim = kit::simulation(&ball("", ""), &[]);
    let before = DVec3::from(sim.momentum());
    let impulse = DVec3::new(0.001, 0.002, -0.003);
    assert_eq!(sim.push(30, impulse.into()), Ok(()));
    let gained = DVec3::from(sim.momentum()) - before;
    assert!(gained.distance(impulse) < 1e-17, "{gained}");
    // The edge of a hanging sheet is held.
    let mut held = kit::simulation(&hanging(GRAVITY), &[]);
    let corner = held.pins().held().next().expect("an edge is held");
    assert_eq!(held.push(corner, [1.0; 3]), Ok(()));
    assert_eq!(held.momentum(), [0.0; 3]);
}

#[test]
fn materials_are_those_of_the_other_scene() {
    let soft = hanging(GRAVITY);
    let stiff = soft
        .replace("stiffness = 1000.0", "stiffness = 3000.0")
        .replace("rigidity = 1e-5", "rigidity = 4e-5")
        .replace("density = 0.2", "density = 0.3");
    let [mut led, mut scene] = [&soft, &stiff].map(|text| kit::simulation(text, &[]));
    assert_eq!(led.set_materials(&kit::scene(&stiff), &[]), Ok(()));
    for sim in [&mut led, &mut scene] {
        lead(sim, 40, |_, _| ());
    }
    assert_eq!(led.positions(), scene.positions());
    for other in [
        soft.replace("cells = [10, 10]", "cells = [10, 11]"),
        soft.replace("shear = { stiffness = 300.0 }", "").replace("bend", "# bend"),
        soft.replace("name =", "contact = { thickness = 0.001 }\nname ="),
    ] {
        let refused = led.set_materials(&kit::scene(&other), &[]);
        assert_eq!(refused, Err(MaterialError::Live(LiveError::OtherScene)), "{other}");
    }
}

#[test]
fn a_change_keeps_the_forces_of_the_host() {
    let text = hanging(GRAVITY);
    let [mut led, mut scene] = [(); 2].map(|()| kit::simulation(&text, &[]));
    for sim in [&mut led, &mut scene] {
        assert_eq!(sim.set_force(60, [0.1, 0.0, 0.0]), Ok(()));
    }
    assert_eq!(led.set_materials(&kit::scene(&text), &[]), Ok(()));
    for sim in [&mut led, &mut scene] {
        lead(sim, 20, |_, _| ());
    }
    assert_eq!(led.positions(), scene.positions());
}

/// The energy less the work is what the method loses, whatever the host does: it stays as small as without the host.
#[test]
fn what_the_host_does_is_in_the_balance_of_energy() {
    let text = hanging(&format!("{GRAVITY}\n{FINE}"));
    let undamped = text.replace(", damping = 0.0005", "").replace(", damping = 0.001", "");
    let mut sim = kit::simulation(&undamped, &[]);
    sim.measure_work(WorkDone::default());
    let stiffer = kit::scene(&undamped.replace("stiffness = 1000.0", "stiffness = 1200.0"));
    let balance = |sim: &muslin_core_f64::simulation::Simulation| sim.energy().total() - sim.work_done().from_outside();
    lead(&mut sim, 100, |_, _| ());
    let before = balance(&sim);
    assert_eq!(sim.set_gravity([2.0, -5.0, 1.0]), Ok(()));
    assert_eq!(sim.set_force(60, [0.0, 0.1, 0.0]), Ok(()));
    assert_eq!(sim.push(110, [0.0, 0.0, 0.0005]), Ok(()));
    assert_eq!(sim.set_materials(&stiffer, &[]), Ok(()));
    // The scene's gravity is back.
    let at_once = balance(&sim);
    assert!((at_once - before).abs() < 1e-12, "{before} J became {at_once} J");
    lead(&mut sim, 100, |_, _| ());
    let (after, kinetic) = (balance(&sim), sim.energy().kinetic);
    assert!((after - before).abs() < 0.02 * kinetic, "{before} J became {after} J, of {kinetic} J kinetic");
}
