//! Cloth in free fall and under linear drag, and two published scenes of a falling sheet.

use glam::{DQuat, DVec3};
use harness::kit::{double, single};
use harness::net::linearised;
use harness::soft::sheet;
use harness::worst::Worst;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

const G: f64 = 9.81;

fn cloth(method: Method, step: f64, linear: f64) -> Simulation {
    let scene = format!("gravity = [0.0, -{G}, 0.0]\ndrag = {{ linear = {linear} }}");
    let built = double::build(&sheet(&scene, "bend = { model = \"hinge\", rigidity = 1e-5 }"));
    Simulation::from_columns(built, linearised(method), step)
}

/// Distance that each method falls in n steps, in units of g h^2 / 2.
fn fallen(method: Method, n: f64) -> f64 {
    match method {
        Method::ExplicitEuler => n * (n - 1.0),
        Method::SymplecticEuler | Method::BackwardEuler => n * (n + 1.0),
        Method::Midpoint | Method::Rk4 | Method::ImplicitMidpoint | Method::Bdf2 => n * n,
    }
}

#[test]
fn free_fall_keeps_the_shape_and_the_closed_form() {
    for method in Method::ALL {
        let mut worst = Worst::new(format!("{}: free fall", method.name()), 1e-12);
        let mut sim = cloth(method, 0.002, 0.0);
        let start = sim.positions().to_vec();
        for n in 1..=100 {
            sim.take_step().expect("finite");
            let (h, n) = (sim.step_length(), f64::from(n));
            let (drop, speed) = (0.5 * G * h * h * fallen(method, n), G * h * n);
            for (i, (x, v)) in sim.positions().iter().zip(sim.velocities()).enumerate() {
                let want = start[i] + DVec3::NEG_Y * drop;
                worst.compare(1.0, &x.to_array(), &want.to_array(), || format!("vertex {i} after {n} steps"));
                worst.compare(1.0, &v.to_array(), &[0.0, -speed, 0.0], || format!("vertex {i} after {n} steps"));
            }
        }
        worst.check();
    }
}

/// Beside a large stiffness single precision loses masses. A motion as a whole does not see that: else this sheet would fall
/// 15 mm too far.
#[test]
fn a_stiff_sheet_falls_as_far_in_single_precision() {
    let text = "duration = 5.0\nframe_rate = 5.896\ngravity = [7.0, -5.0, -4.0]\n[[cloth]]\n\
                grid = { size = [0.25972346, 0.18551678], cells = [7, 5], pattern = \"equilateral\" }\n\
                rotation = [37, 0, -65]\ndensity = 0.10496901\nvelocity = [0.0259, -0.0219, 0.0572]\n\
                stretch = { model = \"spring\", stiffness = 3421.51 }\n\
                bend = { model = \"hinge\", rigidity = 0.022284929 }\n[integrator]\nmethod = \"bdf2\"\n\
                step = 0.028267614\nerror = 0.002\n";
    let (mut sim, mut exact) = (single::simulation(text, &[]), double::simulation(text, &[]));
    single::run(&mut sim, 5.0, |_| ());
    double::run(&mut exact, 5.0, |_| ());
    let centre = |places: Vec<DVec3>| places.iter().sum::<DVec3>() / places.len() as f64;
    let off = (centre(single::places(&sim, 0)) - centre(double::places(&exact, 0))).length();
    println!("off by {off:.1e} m");
    assert!(off < 1e-3, "off by {off} m");
}

/// A thrown sheet that turns: its centre of mass follows the parabola, its angular momentum stays, and it is a rigid
/// motion at the start.
#[test]
fn a_thrown_sheet_follows_the_parabola() {
    let built = double::build(&format!(
        r#"
        name = "thrown"
        duration = 1.0
        gravity = [0.0, -{G}, 0.0]
        [[cloth]]
        grid = {{ size = [0.4, 0.35], cells = [4, 4] }}
        position = [1.0, 2.0, -3.0]
        density = 0.2
        stretch = {{ model = "membrane", stiffness = 20.0 }}
        shear = {{ stiffness = 5.0 }}
        velocity = [3.0, 4.0, 0.5]
        spin = {{ axis = [0.0, 2.0, 0.0], rate = 1.5 }}
        mass = [{{ select = {{ corners = [0] }}, mass = 0.004 }}]"#
    ));
    let (masses, thrown) = (built.particles.masses.clone(), DVec3::new(3.0, 4.0, 0.5));
    let total: f64 = masses.iter().sum();
    let centre = |x: &[DVec3]| masses.iter().zip(x).map(|(&m, &x)| x * m).sum::<DVec3>() / total;
    let mut sim = Simulation::from_columns(built, linearised(Method::Rk4), 0.001);
    let start = centre(sim.positions());
    let turning = |sim: &Simulation| {
        let (x, v) = (sim.positions(), sim.velocities());
        let (centre, drift) = (centre(x), centre(v));
        (0..x.len()).map(|i| (x[i] - centre).cross(v[i] - drift) * masses[i]).sum::<DVec3>()
    };
    let mut worst = Worst::new("a thrown sheet", 1e-12);
    for (i, (&x, v)) in sim.positions().iter().zip(sim.velocities()).enumerate() {
        let want = thrown + (DVec3::Y * 1.5).cross(x - start);
        worst.compare(1.0, &v.to_array(), &want.to_array(), || format!("velocity of vertex {i} at the start"));
    }
    let turned = turning(&sim);
    for _ in 0..300 {
        sim.take_step().expect("finite");
    }
    let time = sim.time();
    let want = start + thrown * time - DVec3::Y * (0.5 * G * time * time);
    worst.compare(1.0, &centre(sim.positions()).to_array(), &want.to_array(), || "centre of mass".into());
    worst.compare(1.0, &turning(&sim).to_array(), &turned.to_array(), || "angular momentum".into());
    worst.check();
}

/// Pins on all vertices hold for a time. Before and after it the sheet falls, and where they take it, it stays.
#[test]
fn pins_release_and_take_cloth_at_their_times() {
    // BDF2 continues with a step of backward Euler, whose fall is another one.
    for method in Method::ALL.into_iter().filter(|&method| method != Method::Bdf2) {
        let mut desc = double::scene(&sheet(
            &format!("gravity = [0.0, -{G}, 0.0]"),
            "pin = [{ select = { box = [[-1, -1, -1], [1, 1, 1]] }, until = 0.1 },
                    { select = { box = [[-1, -1, -1], [1, 1, 1]] }, from = 0.2, until = 0.25 },
                    { select = { box = [[-1, -1, -1], [1, 1, 1]] }, from = 0.3,
                      motion = { keys = [[0.0, 0, 0, 0], [1.0, 0, 2, 0]] } }]",
        ));
        (desc.integrator.method, desc.integrator.step, desc.frame_rate) = (method, Some(0.002), 500.0);
        desc.integrator.tolerance = Some(1e-14);
        let mut sim = Simulation::new(&desc, &[]).expect("builds");
        let (start, h) = (sim.positions().to_vec(), 0.002);
        let mut worst = Worst::new(format!("{}: released and taken", method.name()), 1e-12);
        let fall = |n: f64| 0.5 * G * h * h * fallen(method, n.max(0.0));
        for n in 1..=200 {
            sim.take_step().expect("finite");
            let n = f64::from(n);
            // Two falls of 0.1 s and 0.05 s, then it is lifted at 2 m/s.
            let height = 2.0 * h * (n - 150.0).max(0.0) - fall(n.min(100.0) - 50.0) - fall(n.min(150.0) - 125.0);
            let want = start.iter().map(|&x| x + DVec3::Y * height);
            for (i, (x, want)) in sim.positions().iter().zip(want).enumerate() {
                worst.compare(1.0, &x.to_array(), &want.to_array(), || format!("vertex {i} after {n} steps"));
            }
        }
        worst.check();
    }
}

/// Pins on all vertices take a flying sheet, and turn it about the mean of the places where they take it.
#[test]
fn pins_turn_cloth_where_they_take_it() {
    let mut sim = double::simulation(
        &sheet(
            "integrator = { step = 0.002 }",
            "velocity = [1, 0.5, 0]\npin = [{ select = { box = [[-1, -1, -1], [1, 1, 1]] }, from = 0.1,
              motion = { keys = [[0.0, 0, 0, 0], [1.0, 0, 2, 0]], turn = { axis = [0, 0, 1], rate = 3.0 } } }]",
        ),
        &[],
    );
    double::run(&mut sim, 0.1, |_| ());
    let taken = sim.positions().to_vec();
    let centre = taken.iter().sum::<DVec3>() / taken.len() as f64;
    let mut worst = Worst::new("turned where they are taken", 1e-12);
    double::run(&mut sim, 0.2, |_| ());
    for (x, taken) in sim.positions().iter().zip(taken) {
        let want = centre + DVec3::Y * 0.4 + DQuat::from_rotation_z(0.6) * (taken - centre);
        worst.compare(1.0, &x.to_array(), &want.to_array(), || "vertex".into());
    }
    worst.check();
}

/// The terminal velocity is v = density g / c for every mesh and method.
#[test]
fn drag_limits_the_speed_of_fall() {
    for method in Method::ALL {
        let mut worst = Worst::new(format!("{}: terminal velocity, relative", method.name()), 1e-10);
        let linear = 4.0;
        let mut sim = cloth(method, 0.005, linear);
        // The deviation from the terminal velocity has decayed to exp(-25) of its initial value.
        for _ in 0..250 {
            sim.take_step().expect("finite");
        }
        let speed = 0.2 * G / linear;
        for (i, v) in sim.velocities().iter().enumerate() {
            worst.compare(speed, &v.to_array(), &[0.0, -speed, 0.0], || format!("vertex {i}"));
        }
        worst.check();
    }
}

/// Runs a built-in scene in f32, as published, up to `duration`; calls `see` after every step.
fn built_in(name: &str, duration: f64, mut see: impl FnMut(&muslin_core::simulation::Simulation)) {
    let (_, text) = muslin_core::scene::BUILT_IN.iter().find(|(known, _)| *known == name).expect("built in");
    let mut sim = muslin_core::simulation::Simulation::new(&single::scene(text), &[]).expect("a valid scene");
    while sim.time() < duration - 1e-6 {
        sim.take_step().unwrap_or_else(|error| panic!("{name} {error}"));
        see(&sim);
    }
}

fn centre_of_mass(sim: &muslin_core::simulation::Simulation) -> DVec3 {
    let (mut sum, mut mass) = (DVec3::ZERO, 0.0);
    for (x, &m) in sim.positions().iter().zip(&sim.scene().particles.masses) {
        sum += x.as_dvec3() * f64::from(m);
        mass += f64::from(m);
    }
    sum / mass
}

#[test]
fn swing_drops_its_centre_of_mass_as_published() {
    let mut last = (0.0, DVec3::ZERO);
    built_in("swing", 0.5, |sim| last = (sim.time(), centre_of_mass(sim)));
    // The sheet starts upright, centred on the origin.
    let drop = -last.1.y;
    println!("swing: dropped {drop:.4} m at {:.4} s, expected 0.207 +- 0.01", last.0);
    assert!(
        (last.0 - 0.5).abs() < 1e-6 && (drop - 0.207).abs() <= 0.01,
        "swing: dropped {drop} m at {} s, expected 0.207 +- 0.01",
        last.0
    );
}

#[test]
fn hanging_stretches_by_less_than_a_hundredth() {
    let mut worst = (0.0, 0.0);
    built_in("hanging", 2.0, |sim| {
        let stretch = sim.stretch().max;
        if stretch > worst.0 {
            worst = (stretch, sim.time())
        }
    });
    println!("hanging: largest stretch {:.5} at {:.4} s", worst.0, worst.1);
    assert!(
        worst.0 < 1.01,
        "hanging: an edge is {} times its rest length at {} s, expected below 1.01",
        worst.0,
        worst.1
    );
}
