//! Orders of convergence: p = log2(e(h) / e(h/2)) under repeated halving, on small nonlinear cloth against a
//! finer run of RK4, without contact. `muslin validate` tests chains, and sheets with pins at rest.
//!
//! Implicit methods keep their order when Newton's method converges. With one iteration (`newton = 1`) they
//! keep it with either Jacobian: the exact one, and the projected one under compression or with damping, whose
//! df/dx is omitted.

use glam::DVec3;
use harness::kit::double as kit;
use harness::net::{converged, linearised};
use harness::rng::Rng;
use muslin_core_f64::contact::NoContact;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::integrate::pins::{JumpSide, Key};
use muslin_core_f64::integrate::{IntegratorStatistics, Jacobian, Method, Scheme, StepInput};
use muslin_core_f64::response::ContactStatistics;
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::scratch::ScratchColumns;
use muslin_core_f64::simulation::Simulation;
use muslin_core_f64::step::{self, History, StepContact, Work};

/// Largest permitted difference between the measured order and the method's.
const BOUND: f64 = 0.05;
/// s; a few periods of the stiffest mode.
const DURATION: f64 = 0.02;
/// Newton's relative residual: far below every measured error.
const NEWTON: f64 = 1e-10;

fn order(method: Method) -> f64 {
    match method {
        Method::ExplicitEuler | Method::SymplecticEuler | Method::BackwardEuler => 1.0,
        Method::Midpoint | Method::ImplicitMidpoint | Method::Bdf2 => 2.0,
        Method::Rk4 => 4.0,
    }
}

/// Positions then velocities after `steps` steps of `duration / steps`.
fn run(built: &BuiltScene, scheme: Scheme, duration: f64, steps: u32) -> Vec<DVec3> {
    let mut sim = Simulation::from_columns(built.clone(), scheme, duration / f64::from(steps));
    for _ in 0..steps {
        sim.take_step().unwrap_or_else(|error| panic!("{} with {steps} steps {error}", scheme.method.name()));
    }
    [sim.positions(), sim.velocities()].concat()
}

/// Positions then velocities after `steps` units of time, by steps of one and of two units in turns.
fn run_unequal(built: &BuiltScene, scheme: Scheme, duration: f64, steps: u32) -> Vec<DVec3> {
    let unit = duration / f64::from(steps);
    let mut columns = ScratchColumns::build(built, &scheme);
    let (mut state, mut history) = (built.particles.clone(), History::Start);
    let (mut integrator, mut contact) = (IntegratorStatistics::default(), ContactStatistics::default());
    let (mut done, mut lengths) = (0, [1, 1, 2].into_iter().cycle());
    while done < steps {
        let length = lengths.next().unwrap_or(1);
        let mut particles = state.view();
        let input = StepInput {
            model: built.model.view(),
            pins: &built.pins.view(),
            masses: &built.particles.masses,
            inverse_masses: &built.particles.inverse_masses,
            time: f64::from(done) * unit,
            step: f64::from(length) * unit,
            scheme: &scheme,
            follows_contact: false,
            limit: None,
            has_contact: false,
            dispatch: &Serial,
        };
        let work = Work { integrator: &mut integrator, contact: &mut contact, searched: &mut 0, done: None };
        let none = None::<StepContact<'_, NoContact>>;
        let scratch = &mut columns.view();
        let taken = step::take(&input, &mut particles, scratch, none, &mut history, work);
        taken.unwrap_or_else(|obstacle| panic!("{} at {done} of {steps}: {obstacle:?}", scheme.method.name()));
        done += length;
    }
    [state.positions, state.velocities].concat()
}

fn distance(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum::<f64>().sqrt()
}

/// Checks the order `want` over `halvings` halvings, starting at `coarsest` steps.
fn check(what: &str, run: impl Fn(u32) -> Vec<DVec3>, truth: &[DVec3], coarsest: u32, halvings: u32, want: f64) {
    let errors: Vec<_> = (0..=halvings).map(|k| distance(&run(coarsest << k), truth)).collect();
    let orders: Vec<_> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    let (first, last) = (errors[0], errors[halvings as usize]);
    let measured = format!("{what}: orders {orders:.3?} from {coarsest} steps on, errors {first:.1e} to {last:.1e}");
    println!("{measured}");
    assert!(orders.iter().all(|p| (p - want).abs() <= BOUND), "{measured}; expected {want} within {BOUND}");
}

/// A deformed, moving sheet, `size` times its rest size, held at two corners.
fn cloth(material: &str, size: f64, pin: &str, air: &str) -> BuiltScene {
    let mut built = kit::build(&format!(
        r#"
        name = "orders"
        duration = 1.0
        gravity = [0.0, -9.81, 0.0]
        {air}
        [[cloth]]
        grid = {{ size = [0.3, 0.26], cells = [3, 3] }}
        density = 0.2
        {material}
        [[cloth.pin]]
        select = {{ corners = [0, 1] }}
        {pin}"#
    ));
    let mut rng = Rng::new(5);
    let particles = &mut built.particles;
    for (x, v) in particles.positions.iter_mut().zip(&mut particles.velocities) {
        *x = *x * size + rng.cube(0.004);
        *v = rng.cube(0.3);
    }
    for anchor in &mut built.pins.anchors {
        *anchor *= size;
    }
    built.pins.view().impose(0.0, JumpSide::After, &mut particles.positions, &mut particles.velocities);
    built
}

const TURNING: &str = "motion = { turn = { axis = [0.3, 1.0, 0.2], rate = 5.0 } }";
const AIR: &str = "drag = { linear = 0.5, wind = { velocity = [2.0, 1.0, 3.0], normal = 0.6, tangential = 0.1 } }";
const MEMBRANE: &str = r#"
    stretch = { model = "membrane", stiffness = 50.0, damping = 0.0002 }
    shear = { stiffness = 20.0, damping = 0.0002 }
    bend = { model = "hinge", rigidity = 1e-4, damping = 0.0002 }"#;
const SPRINGS: &str = r#"
    stretch = { model = "spring", stiffness = 50.0, damping = 0.0002 }
    bend = { model = "spring", stiffness = 5.0, damping = 0.0002 }"#;

fn without_damping(material: &str) -> String {
    material.replace(", damping = 0.0002", "")
}

fn all_methods(what: &str, built: &BuiltScene) {
    let truth = run(built, linearised(Method::Rk4), DURATION, 8192);
    for method in Method::ALL {
        let what = format!("{what}, {}", method.name());
        // The next term of the error is small enough from this number of steps on.
        let coarsest = [512, 128, 0, 128][order(method) as usize - 1];
        let run = |steps| run(built, converged(method, NEWTON), DURATION, steps);
        check(&what, run, &truth, coarsest, 4, order(method));
    }
}

/// The pins also prescribe the motion at the stages inside a step; wind has no potential.
#[test]
fn turning_pins_in_the_wind() {
    all_methods("turning pins in the wind", &cloth(MEMBRANE, 1.0, TURNING, AIR));
}

/// The pins start with a velocity jump, and jump again at the end of a step in the middle of the motion.
/// Damping depends on the velocities at both ends of a step, each taken from its own side.
#[test]
fn pins_that_jump_at_the_end_of_a_step() {
    const KEYS: &str = "motion = { keys = [[0.0, 0, 0, 0], [0.005, 0.01, 0, -0.005], [0.015, -0.01, 0.005, 0]] }";
    // Stiff enough that the error of RK4 is above rounding.
    let damped = SPRINGS.replace("0.0002", "0.002").replace("stiffness = 50.0", "stiffness = 100.0");
    let mut built = cloth(&damped, 1.0, KEYS, "");
    // The vertices start at rest, as in a scene.
    for &pin in &built.pins.vertices {
        built.particles.velocities[pin as usize] = DVec3::ZERO;
    }
    all_methods("pins that jump", &built);
}

/// Gravity, wind and a load grow and turn within one interval of their keys.
#[test]
fn forces_that_change_with_time() {
    const GROWING: &str = "drag = { wind = { velocity = { keys = [[0, 2, 1, 3], [0.02, -9, 4, 20]] }, normal = 0.6 } }";
    const LOAD: &str =
        "load = [{ select = { corners = [3] }, force = { keys = [[0, 0, 0, 0], [0.02, 0, 0.3, -0.2]] } }]";
    let mut built = cloth(&format!("{MEMBRANE}\n{LOAD}"), 1.0, "", GROWING);
    let keys = [(0.0, DVec3::NEG_Y * 9.81), (DURATION, DVec3::new(60.0, 40.0, 0.0))];
    built.model.gravity.as_mut().expect("gravity").keys = keys.map(|(time, value)| Key { time, value }).to_vec();
    all_methods("forces that change", &built);
}

#[test]
fn methods_of_second_order_keep_it_when_steps_vary() {
    let built = cloth(MEMBRANE, 1.0, "", "");
    let truth = run(&built, linearised(Method::Rk4), DURATION, 8192);
    for method in [Method::ImplicitMidpoint, Method::Bdf2] {
        let what = format!("unequal steps, {}", method.name());
        let run = |steps| run_unequal(&built, converged(method, NEWTON), DURATION, steps);
        check(&what, run, &truth, 256, 3, 2.0);
    }
}

#[test]
fn one_newton_step_keeps_second_order() {
    let undamped = [MEMBRANE, SPRINGS].map(without_damping);
    let damped = [MEMBRANE, SPRINGS].map(|material| material.replace("0.0002", "0.002"));
    let cases =
        undamped.iter().map(|m| ("compressed, undamped", m, 0.6)).chain(damped.iter().map(|m| ("damped", m, 1.0)));
    for (what, material, size) in cases {
        let built = cloth(material, size, "", "");
        let truth = run(&built, linearised(Method::Rk4), DURATION, 8192);
        for (jacobian, method) in [Jacobian::Exact, Jacobian::Projected]
            .into_iter()
            .flat_map(|jacobian| [Method::ImplicitMidpoint, Method::Bdf2].map(|method| (jacobian, method)))
        {
            let scheme = Scheme { jacobian, ..linearised(method) };
            let what = format!("{what}, {jacobian:?} Jacobian, {} with newton = 1", method.name());
            check(&what, |steps| run(&built, scheme, DURATION, steps), &truth, 1024, 2, 2.0);
        }
    }
}
