//! Loads against statics and energy.

use glam::DVec3;
use harness::kit::double as kit;
use harness::net::{converged, linearised, settle};
use harness::worst::Worst;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

use crate::cantilever::{LENGTH, Strip};

/// Drop and reach of the tip of a clamped strip, divided by its free length. P is the load on the tip, P L^2 / D =
/// `load`.
fn tip(load: f64, cells: u32) -> [f64; 2] {
    let (strip, per_width) = (Strip::new(cells), load / (LENGTH * LENGTH));
    let force = per_width * strip.wide;
    let pulled =
        format!("load = [{{ select = {{ edge = \"right\" }}, force = [0, -{force:?}, 0], share = \"length\" }}]");
    let built = strip.build(1.0, 2e5 * per_width, "", &pulled);
    let loaded = built.model.loads.as_ref().expect("loaded").vertices.clone();
    let mut sim = Simulation::from_columns(built, converged(Method::BackwardEuler, 1e-6), 0.2);
    settle(&mut sim, 1e-6, 200);
    let end = loaded.iter().map(|&i| sim.positions()[i as usize]).sum::<DVec3>() / loaded.len() as f64;
    strip.shape(end)
}

/// P L^2 / D, then drop and reach of the tip over the length [Bisshopp 1945, Mattiasson 1981].
const ELASTICA: [(f64, [f64; 2]); 3] =
    [(2.0, [0.49345748, 0.83935828]), (5.0, [0.71379152, 0.61237164]), (10.0, [0.81060902, 0.44500440])];

#[test]
fn a_load_on_the_tip_bends_a_strip_into_the_elastica() {
    for (load, truth) in ELASTICA {
        let shape = tip(load, 75);
        for (what, got, want) in [("drop", shape[0], truth[0]), ("reach", shape[1], truth[1])] {
            let error = got / want - 1.0;
            println!("P L^2 / D = {load}: {what} {got:.6}, expected {want:.6}, error {:.3} %", 100.0 * error);
            assert!(error.abs() <= 0.005, "P L^2 / D = {load}: {what} is {got}, expected {want} within 0.5 %");
        }
    }
}

/// A load that is shared by length along an edge stretches a sheet uniformly, by force over width and stiffness. All of
/// it reaches the pins.
#[test]
fn a_load_along_an_edge_stretches_evenly() {
    let built = kit::build(
        r#"
        name = "pulled"
        duration = 1.0
        [[cloth]]
        grid = { size = [0.3, 0.5], cells = [3, 5] }
        density = 0.2
        stretch = { model = "membrane", stiffness = 100.0 }
        shear = { stiffness = 50.0 }
        pin = [{ select = { edge = "back" } }]
        load = [{ select = { edge = "front" }, force = [0.0, 0.0, 1.5], share = "length" }]
        "#,
    );
    let rest = kit::positions(&built);
    let mut sim = Simulation::from_columns(built, converged(Method::BackwardEuler, 1e-12), 0.2);
    settle(&mut sim, 1e-12, 200);
    let strain = 1.5 / 0.3 / 100.0;
    let mut worst = Worst::new("positions of the evenly stretched sheet", 1e-10);
    for (vertex, (x, rest)) in sim.positions().iter().zip(&rest).enumerate() {
        let want = DVec3::new(rest.x, 0.0, rest.z + strain * (rest.z + 0.25));
        worst.compare(0.5, &x.to_array(), &want.to_array(), || format!("vertex {vertex}"));
    }
    worst.check();
}

/// A free sheet that is loaded by area moves like a point. Its load loses the energy that it gains.
#[test]
fn the_energy_of_a_load_becomes_kinetic() {
    let built = kit::build(
        r#"
        name = "thrust"
        duration = 1.0
        [[cloth]]
        grid = { size = [0.4, 0.35], cells = [4, 4] }
        position = [0.0, 1.0, 0.0]
        density = 0.2
        stretch = { model = "membrane", stiffness = 10.0 }
        shear = { stiffness = 5.0 }
        load = [{ select = { border = true }, force = [0.0, 0.0, 0.5] },
                { select = { box = [[-1, -1, -1], [1, 2, 1]] }, force = [0.0, 0.3, 0.0], share = "area" }]
        "#,
    );
    let mass: f64 = built.particles.masses.iter().sum();
    let mut sim = Simulation::from_columns(built, linearised(Method::Rk4), 0.00025);
    assert_eq!(sim.energy().gravity, 0.0, "at the start");
    for _ in 0..800 {
        sim.take_step().expect("finite");
    }
    let (energy, momentum) = (sim.energy(), sim.momentum());
    let impulse = [0.0, 0.3, 0.5].map(|force| force * sim.time());
    let mut worst = Worst::new("momentum and energy under loads", 1e-8);
    worst.compare(0.1, &momentum, &impulse, || "momentum".into());
    worst.compare(energy.kinetic, &[energy.total()], &[0.0], || "energy".into());
    worst.check();
    let carried = 0.5 * impulse.iter().map(|p| p * p).sum::<f64>() / mass;
    assert!(energy.kinetic >= carried && energy.gravity < -carried, "{energy:?}, as a whole {carried}");
}
