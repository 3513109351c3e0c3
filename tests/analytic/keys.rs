//! Gravity, wind and loads that change with time, against closed forms, by every method.

use glam::DVec3;
use harness::kit::{double, single};
use harness::net::linearised;
use harness::soft::sheet;
use harness::worst::Worst;
use muslin_core_f64::integrate::{Method, Scheme};
use muslin_core_f64::simulation::Simulation;
use muslin_core_f64::work_done::WorkDone;

fn run(text: &str, scheme: Scheme, step: f64, steps: u32) -> Simulation {
    let mut sim = Simulation::from_columns(double::build(text), scheme, step);
    for _ in 0..steps {
        sim.take_step().unwrap_or_else(|error| panic!("{}: {error}", scheme.method.name()));
    }
    sim
}

/// Within an interval of keys gravity is linear, so the velocity is a sum of an arithmetic series; methods of second
/// order integrate it exactly, and RK4 the position too.
#[test]
fn a_sheet_falls_under_gravity_that_grows() {
    const GROWTH: f64 = 40.0;
    let text = sheet("gravity = { keys = [[0.0, 0, 0, 0], [1.0, 0, -40.0, 0]] }", "");
    for method in Method::ALL {
        let (h, n) = (0.002, 100);
        let sim = run(&text, linearised(method), h, n);
        let n = f64::from(n);
        let pairs = match method {
            Method::ExplicitEuler | Method::SymplecticEuler => n * (n - 1.0),
            Method::BackwardEuler => n * (n + 1.0),
            Method::Midpoint | Method::Rk4 | Method::ImplicitMidpoint | Method::Bdf2 => n * n,
        };
        let speed = 0.5 * GROWTH * h * h * pairs;
        let mut worst = Worst::new(format!("{}: growing gravity", method.name()), 1e-12);
        for (i, v) in sim.velocities().iter().enumerate() {
            worst.compare(1.0, &v.to_array(), &[0.0, -speed, 0.0], || format!("velocity of vertex {i}"));
        }
        if method == Method::Rk4 {
            let fallen = GROWTH * sim.time().powi(3) / 6.0;
            for (i, x) in sim.positions().iter().enumerate() {
                worst.compare(1.0, &[x.y], &[-fallen], || format!("position of vertex {i}"));
            }
        }
        worst.check();
    }
}

/// The gust begins and ends between two steps, or within one substep of a step under error control.
#[test]
fn a_gust_that_is_shorter_than_a_step_gives_its_impulse() {
    let text = sheet("gravity = { keys = [[0.112, 0, 0, 0], [0.1125, 100, 0, 0], [0.113, 0, 0, 0]] }", "");
    for (method, error) in Method::ALL.into_iter().flat_map(|method| [(method, None), (method, Some(1e-3))]) {
        if error.is_some() && !method.is_implicit() {
            continue;
        }
        let sim = run(&text, Scheme { error, ..linearised(method) }, 0.01, 60);
        let mut worst = Worst::new(format!("{}, error {error:?}: speed by a gust", method.name()), 1e-12);
        for (i, v) in sim.velocities().iter().enumerate() {
            worst.compare(1.0, &v.to_array(), &[0.05, 0.0, 0.0], || format!("vertex {i}"));
        }
        worst.check();
    }
}

/// A sheet that faces a rising wind: its velocity rises as fast, later by density over the coefficient of the wind.
#[test]
fn a_sheet_follows_a_rising_wind() {
    let text = sheet(
        "drag = { wind = { velocity = { keys = [[0.0, 0, 0, 0], [4.0, 0, 8.0, 0]] }, normal = 4.0, tangential = 4.0 } }",
        "",
    );
    for method in Method::ALL {
        // The start has decayed to exp(-25).
        let sim = run(&text, linearised(method), 0.005, 250);
        let speed = 2.0 * (sim.time() - 0.2 / 4.0);
        let mut worst = Worst::new(format!("{}: velocity in a rising wind", method.name()), 1e-9);
        for (i, v) in sim.velocities().iter().enumerate() {
            worst.compare(1.0, &v.to_array(), &[0.0, speed, 0.0], || format!("vertex {i}"));
        }
        worst.check();
    }
}

/// A load is ramped on a strip: on the ramp and after it, the pins hold as much as the load at the times of the stages.
#[test]
fn pins_hold_a_load_that_is_ramped() {
    let text = r#"
        name = "ramp"
        duration = 1.0
        [[cloth]]
        grid = { size = [0.1, 0.3], cells = [2, 6] }
        density = 0.2
        stretch = { model = "membrane", stiffness = 100.0, damping = 0.01 }
        shear = { stiffness = 50.0, damping = 0.01 }
        pin = [{ select = { edge = "back" } }]
        load = [{ select = { edge = "front" }, force = { keys = [[0.1, 0, 0, 0], [1.1, 0, 0, 1.5]] }, share = "length" }]"#;
    for method in Method::ALL.into_iter().filter(|method| method.is_implicit()) {
        let mut sim = Simulation::from_columns(double::build(text), linearised(method), 0.01);
        sim.measure_work(WorkDone::default());
        sim.measure_reactions();
        let mut worst = Worst::new(format!("{}: reaction to a ramped load", method.name()), 1e-3);
        let later = if method == Method::ImplicitMidpoint { 0.0 } else { 0.005 };
        for (until, load) in [(0.6, 0.0), (0.7, 1.5 * (0.55 + later)), (1.5, 0.0), (1.6, 1.5)] {
            sim.reactions_mut().expect("measured").pins.fill_with(Default::default);
            while sim.time() < until - 1e-9 {
                sim.take_step().expect("finite");
            }
            if load > 0.0 {
                let force = sim.reactions().expect("measured").pins[0].linear / 0.1;
                worst.compare(1.5, &force.to_array(), &[0.0, 0.0, -load], || format!("until {until} s"));
            }
        }
        worst.check();
    }
}

/// Gravity and a load swing, far from the world's origin. The energy of the sheet is that of the start and the work.
#[test]
fn work_of_gravity_and_loads_that_change_closes_the_balance_of_energy() {
    let text = sheet(
        "gravity = { keys = [[0.0, 0, -9.81, 0], [0.1033, 0, 5, 1], [0.2, 3, -20, 0]] }",
        "position = [10.0, 5000.0, 0.0]\n\
         load = [{ select = { box = [[0, 4000, -9], [20, 6000, 9]] }, force = [0.1, 0, 0], share = \"area\" },\n\
                 { select = { box = [[0, 4000, -9], [20, 6000, 9]] }, share = \"area\",\n\
                   force = { keys = [[0.05, 0, 0.1, 0], [0.1, 0, 2, 0]] } }]",
    );
    let mut sim = Simulation::from_columns(double::build(&text), linearised(Method::ImplicitMidpoint), 0.002);
    sim.measure_work(WorkDone::default());
    let (start, mass) = (sim.energy().total(), sim.scene().particles.masses.iter().sum::<f64>());
    for _ in 0..130 {
        sim.take_step().expect("finite");
        let (energy, work) = (sim.energy(), sim.work_done());
        let left = (energy.total() - start - work.gravity) / (energy.kinetic + 1e-3);
        assert!(left.abs() < 1e-9, "at {} s: {left} of {energy:?}, work {work:?}", sim.time());
        assert_eq!(work.exchanged, 0.0, "nothing else works");
    }
    assert!(sim.work_done().gravity > 9.0 * 5000.0 * mass, "a heavier sheet has more potential energy: {sim:?}");
}

/// Single precision goes the same way, and a constant vector that is written as one key, or as two, as the constant.
#[test]
fn keys_mean_the_same_in_both_precisions_and_as_a_constant() {
    let scene = |gravity: &str, velocity: &str, force: &str| {
        sheet(
            &format!("gravity = {gravity}\ndrag = {{ wind = {{ velocity = {velocity}, normal = 0.5 }} }}"),
            &format!(
                "pin = [{{ select = {{ corners = [0] }} }}]\nload = [{{ select = {{ corners = [3] }}, force = {force} }}]"
            ),
        )
    };
    let changing = scene(
        "{ keys = [[0.0, 0, -9.81, 0], [0.1, 0, -2, 3]] }",
        "{ keys = [[0.03, 1, 0, 0], [0.2, 4, 1, 0]] }",
        "{ keys = [[0.0, 0, 0, 0], [0.07, 0.02, 0, 0], [0.1, 0, 0, 0]] }",
    );
    let far = run(&changing, linearised(Method::Bdf2), 0.002, 100);
    let scheme = muslin_core::integrate::Scheme::fixed(muslin_core::integrate::Method::Bdf2, 1e-6);
    let mut near = muslin_core::simulation::Simulation::from_columns(single::build(&changing), scheme, 0.002);
    for _ in 0..100 {
        near.take_step().expect("finite");
    }
    let mut worst = Worst::new("keys in f32 against f64", 1e-4);
    for (i, (x, want)) in near.positions().iter().zip(far.positions()).enumerate() {
        worst.compare(0.4, &x.as_dvec3().to_array(), &want.to_array(), || format!("vertex {i}"));
    }
    worst.check();
    let end = |[a, b, c]: [&str; 3]| run(&scene(a, b, c), linearised(Method::Rk4), 0.002, 100).positions().to_vec();
    let constant: Vec<DVec3> = end(["[0, -9.81, 0]", "[1, 0, 0]", "[0.02, 0, 0]"]);
    let one = "{ keys = [[0.05, 0, -9.81, 0]] }";
    assert_eq!(constant, end([one, "{ keys = [[9, 1, 0, 0]] }", "{ keys = [[-1, 0.02, 0, 0]] }"]), "one key");
    assert_eq!(
        constant,
        end([&one.replace("]] }", "], [0.5, 0, -9.81, 0]] }"), "[1, 0, 0]", "[0.02, 0, 0]"]),
        "two keys"
    );
}
