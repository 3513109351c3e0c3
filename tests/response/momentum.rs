//! Two free sheets that collide: what momentum and energy do through the impact.
//!
//! Run: `cargo test -p muslin-tests --test response momentum`.

use glam::DVec3;
use harness::kit::double as kit;
use muslin_core_f64::simulation::Simulation;

/// kg/m^2 of both sheets.
const DENSITY: [f64; 2] = [0.2, 0.5];

/// Two sheets 4 mm apart; the first is cut otherwise, turned a little and comes down.
fn sheets(material: &str, friction: f64, method: &str, step: f64) -> Simulation {
    let text = format!(
        r#"
        name = "collision"
        duration = 1.0
        frame_rate = 10
        [[cloth]]
        grid = {{ size = [0.2, 0.2], cells = [8, 9] }}
        density = {:?}
        position = [0.02, 0.004, 0.03]
        rotation = [1.0, 20.0, 0.5]
        {material}
        [[cloth]]
        grid = {{ size = [0.25, 0.25], cells = [7, 7], pattern = "alternating" }}
        density = {:?}
        {material}
        [contact]
        thickness = 0.001
        friction = {friction:?}
        [integrator]
        method = "{method}"
        step = {step:?}
        tolerance = 1e-14
        "#,
        DENSITY[0], DENSITY[1]
    );
    kit::simulation(&text, &[])
}

const CLOTH: &str = r#"
    stretch = { model = "membrane", stiffness = 50.0 }
    shear = { stiffness = 20.0 }
    bend = { model = "hinge", rigidity = 1e-6 }"#;

const METHODS: [&str; 5] = ["symplectic-euler", "rk4", "backward-euler", "bdf2", "implicit-midpoint"];
const HEAD_ON: DVec3 = DVec3::new(0.0, -2.0, 0.0);
const OBLIQUE: DVec3 = DVec3::new(1.5, -2.0, 0.7);

/// The largest change of momentum in a flight through the impact, of the sum of all |momenta|.
fn drift(friction: f64, method: &str, velocity: DVec3) -> f64 {
    let mut sim = sheets(CLOTH, friction, method, 2e-4);
    kit::throw(&mut sim, 0, velocity);
    let before = DVec3::from(sim.momentum());
    let mut worst: f64 = 0.0;
    kit::run(&mut sim, 0.02, |sim| worst = worst.max((DVec3::from(sim.momentum()) - before).length()));
    assert!(sim.contact_statistics().proximity > 100, "the sheets hardly touch: {:?}", sim.contact_statistics());
    worst / before.length()
}

#[test]
fn contact_keeps_momentum() {
    for method in METHODS {
        for friction in [0.0, 0.5] {
            for (name, velocity) in [("head-on", HEAD_ON), ("oblique", OBLIQUE)] {
                let drift = drift(friction, method, velocity);
                let what = format!("{method}, friction {friction}, {name}: momentum changes by {drift:.1e}");
                println!("{what}, bound 1e-12");
                assert!(drift <= 1e-12, "{what}, expected at most 1e-12: impulses are not equal and opposite");
            }
        }
    }
}

/// The largest change of angular momentum in a flight through the impact by steps of 1 ms, of the momentum at the start
/// times a lever of 5 cm.
fn angular_drift(friction: f64, method: &str, velocity: DVec3) -> f64 {
    let mut sim = sheets(CLOTH, friction, method, 1e-3);
    kit::throw(&mut sim, 0, velocity);
    let momentum = DVec3::from(sim.momentum()).length();
    let before = angular_momentum(&sim);
    let mut worst: f64 = 0.0;
    kit::run(&mut sim, 0.02, |sim| worst = worst.max((angular_momentum(sim) - before).length()));
    worst / (0.05 * momentum)
}

fn angular_momentum(sim: &Simulation) -> DVec3 {
    let masses = &sim.scene().particles.masses;
    sim.positions().iter().zip(sim.velocities()).zip(masses).map(|((x, v), m)| x.cross(*v) * *m).sum()
}

/// Friction impulses are equal and opposite but act a thickness apart: every method changes angular momentum by them.
#[test]
fn an_implicit_step_with_contact_keeps_angular_momentum_as_an_explicit_one_does() {
    for friction in [0.0, 0.5] {
        for (name, velocity) in [("head-on", HEAD_ON), ("oblique", OBLIQUE)] {
            let explicit = angular_drift(friction, "rk4", velocity);
            for method in ["backward-euler", "bdf2", "implicit-midpoint"] {
                let drift = angular_drift(friction, method, velocity);
                let bound = 1.25 * explicit + 6e-4;
                let what = format!("{method}, friction {friction}, {name}: angular momentum changes by {drift:.1e}");
                println!("{what}, by RK4 {explicit:.1e}, bound {bound:.1e}");
                assert!(drift <= bound, "{what}, by RK4 {explicit:.1e}, expected at most {bound:.1e}");
            }
        }
    }
}

/// A sheet spins on a plane without friction, and nothing brakes it but backward Euler. Linearised at the start of a step,
/// forces would stretch and brake it: after a sixth of a second 0.14 of its angular momentum were left.
#[test]
fn a_sheet_that_spins_on_a_plane_keeps_its_angular_momentum_as_in_the_air() {
    let left = |plane: &str| {
        let mut sim = kit::simulation(
            &format!(
                r#"
                name = "spinning"
                duration = 0.2
                gravity = [0.0, {}, 0.0]
                [[cloth]]
                grid = {{ size = [0.2, 0.2], cells = [10, 10] }}
                position = [0.0, 0.002, 0.0]
                spin = {{ axis = [0, 1, 0], rate = 6.0 }}
                density = 0.3
                stretch = {{ model = "membrane", stiffness = 5000.0 }}
                shear = {{ stiffness = 1000.0 }}
                bend = {{ model = "hinge", rigidity = 1e-5 }}
                {plane}
                "#,
                if plane.is_empty() { "0.0" } else { "-9.81" }
            ),
            &[],
        );
        let before = angular_momentum(&sim).y;
        kit::run(&mut sim, 1.0 / 6.0, |_| ());
        angular_momentum(&sim).y / before
    };
    let plane = "[[collider]]\nshape = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n\
                    [contact]\nthickness = 0.002\nfriction = 0.0";
    let (lying, flying) = (left(plane), left(""));
    println!("{lying:.3} of the angular momentum are left on the plane, {flying:.3} in the air");
    assert!((lying - flying).abs() < 0.02, "{lying} of the angular momentum are left, in the air {flying}");
}

/// Growth of the energy in the worst step, of the energy at the start, and what is left of it.
fn growth(mut sim: Simulation, velocity: DVec3) -> [f64; 2] {
    kit::throw(&mut sim, 0, velocity);
    let start = sim.energy().total();
    let (mut before, mut worst) = (start, f64::NEG_INFINITY);
    kit::run(&mut sim, 0.02, |sim| {
        let now = sim.energy().total();
        worst = worst.max((now - before) / start);
        before = now;
    });
    [worst, before / start]
}

/// Without forces the response alone changes the energy.
#[test]
fn no_impact_adds_kinetic_energy() {
    for friction in [0.0, 0.5] {
        for (name, velocity) in [("head-on", HEAD_ON), ("oblique", OBLIQUE), ("fast", 40.0 * HEAD_ON)] {
            let [growth, left] = growth(sheets("", friction, "symplectic-euler", 1e-3), velocity);
            let what = format!("{name}, friction {friction}: in the worst step the energy grows by {growth:.1e}");
            println!("{what}, bound 1e-12; {left:.3} of it is left");
            assert!(growth <= 1e-12, "{what} of its start, expected at most 1e-12");
            assert!(left < 0.8, "{name}: {left} of the energy is left, the sheets missed one another");
        }
    }
}

/// At this step RK4 by itself changes the energy by less than the bound.
#[test]
fn no_impact_adds_energy_to_elastic_sheets() {
    for friction in [0.0, 0.5] {
        for (name, velocity) in [("head-on", HEAD_ON), ("oblique", OBLIQUE)] {
            let [growth, left] = growth(sheets(CLOTH, friction, "rk4", 5e-5), velocity);
            let what = format!("{name}, friction {friction}: in the worst step the energy grows by {growth:.1e}");
            println!("{what}, bound 1e-6; {left:.3} of it is left");
            assert!(growth <= 1e-6, "{what} of its start, expected at most 1e-6");
        }
    }
}

/// The speed at which the second sheet comes nearer to the first below those vertices that touch it,
/// m/s.
fn approach(sim: &Simulation) -> f64 {
    let (upper, lower) = (sim.scene().cloths[0].vertices.clone(), sim.scene().cloths[1].vertices.clone());
    let state = |v: u32| (sim.positions()[v as usize], sim.velocities()[v as usize]);
    let below = upper.flat_map(|v| {
        let (at, velocity) = state(v);
        sim.triangles().iter().filter(|t| lower.contains(&t[0])).filter_map(move |t| {
            let [a, b, c] = t.map(|v| state(v).0 - at);
            let turn = |p: DVec3, q: DVec3| p.x * q.z - p.z * q.x;
            let weights =
                [turn(b, c), turn(c, a), turn(a, b)].map(|part| part / (turn(b, c) + turn(c, a) + turn(a, b)));
            let normal = (b - a).cross(c - a).normalize();
            let normal = if normal.dot(a) < 0.0 { -normal } else { normal };
            let there: DVec3 = weights.iter().zip(t).map(|(w, &v)| state(v).1 * *w).sum();
            let touches = weights.iter().all(|w| *w > 0.0) && normal.dot(a) < 1.02e-3;
            touches.then(|| (velocity - there).dot(normal))
        })
    });
    below.fold(0.0, f64::max)
}

/// Within the bound is what sweeps over the contacts leave, some parts in a thousand of the thickness
/// a step.
#[test]
fn after_an_impact_nothing_approaches() {
    for friction in [0.0, 0.5] {
        let mut sim = sheets("", friction, "symplectic-euler", 1e-3);
        kit::throw(&mut sim, 0, HEAD_ON);
        kit::run(&mut sim, 0.02, |_| ());
        let approach = approach(&sim);
        println!("friction {friction}: what touches approaches at {approach:.1e} m/s, bound 5e-3");
        assert!(approach <= 5e-3, "friction {friction}: what touches still approaches at {approach} m/s");
    }
}
