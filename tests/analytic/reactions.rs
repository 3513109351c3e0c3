//! Reactions of pins and colliders, and the balances of momentum and energy, for every method.

use glam::DVec3;
use harness::kit::double as kit;
use muslin_core_f64::forces::ModelColumns;
use muslin_core_f64::forces::gravity::GravityColumns;
use muslin_core_f64::forces::spring::{Spring, SpringColumns};
use muslin_core_f64::integrate::pins::{AT_REST, PinColumns};
use muslin_core_f64::integrate::{Method, Scheme};
use muslin_core_f64::particles::ParticleColumns;
use muslin_core_f64::reactions::{Impulse, PinGroup};
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::simulation::Simulation;
use muslin_core_f64::work_done::WorkDone;

const G: f64 = 9.81;

/// A sheet of 0.032 kg, softly damped.
const SHEET: &str = r#"
    name = "sheet"
    duration = 1.0
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.4, 0.4], cells = [6, 6] }
    position = [0.0, 0.003, 0.0]
    density = 0.2
    stretch = { model = "membrane", stiffness = 20.0, damping = 0.003 }
    shear = { stiffness = 5.0, damping = 0.003 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.01 }
"#;

/// A simulation that measures everything.
fn measured(text: &str, method: Method, step: f64, error: f64) -> Simulation {
    let mut scene = kit::scene(text);
    scene.integrator.method = method;
    scene.integrator.step = Some(step);
    scene.integrator.error = Some(error);
    let mut sim = Simulation::new(&scene, &[]).expect("the scene builds");
    sim.measure_work(WorkDone::default());
    sim.measure_reactions();
    sim
}

fn mass(sim: &Simulation) -> f64 {
    sim.scene().particles.masses.iter().sum()
}

/// Mean forces over some steps, N.
struct Means {
    pins: DVec3,
    colliders: DVec3,
    /// Of the whole change of momentum.
    change: DVec3,
}

/// Takes steps for so many seconds.
fn run(sim: &mut Simulation, seconds: f64) -> Means {
    let columns = sim.reactions_mut().expect("measured");
    columns.pins.iter_mut().chain(&mut columns.colliders).for_each(|sum| *sum = Impulse::default());
    let (steps, before) = ((seconds / sim.step_length()).round(), DVec3::from(sim.momentum()));
    for _ in 0..steps as u32 {
        sim.take_step().expect("finite");
    }
    let time = steps * sim.step_length();
    let columns = sim.reactions().expect("measured");
    let mean = |sums: &[Impulse]| sums.iter().map(|sum| sum.linear).sum::<DVec3>() / time;
    let change = (DVec3::from(sim.momentum()) - before) / time;
    Means { pins: mean(&columns.pins), colliders: mean(&columns.colliders), change }
}

/// Methods with their step, s, and largest error, m: explicit ones with a step that the sheet bears, implicit ones with
/// a usual one, with and without error control.
fn cases() -> impl Iterator<Item = (Method, f64, f64)> {
    let of = |method: Method| match method.is_implicit() {
        true => vec![(method, 1.0 / 120.0, 0.0), (method, 1.0 / 120.0, 1e-4)],
        false => vec![(method, 2e-4, 0.0)],
    };
    Method::ALL.into_iter().flat_map(of)
}

const CORNERS: &str = "\n[[cloth.pin]]\nselect = { corners = [0, 1] }\n";

/// The sheet hangs from two corners, in air that soon slows it down.
fn in_air() -> String {
    format!("drag = {{ linear = 2.0 }}\n{SHEET}{CORNERS}")
}

const FLOOR: &str = r#"
    [contact]
    thickness = 0.002
    friction = 0.3
    [[collider]]
    shape = "plane"
    point = [0, 0, 0]
    normal = [0, 1, 0]
"#;

/// Asserts that a value is within a tolerance, and prints it.
fn check(name: &str, (method, step, error): (Method, f64, f64), value: f64, tolerance: f64) {
    let which = format!("{name}: {} by {step:.1e} s, error {error:e} m", method.name());
    println!("{which}: {value:.2e}, at most {tolerance:.0e}");
    assert!(value.abs() <= tolerance, "{which}: {value:e}, expected at most {tolerance:e}");
}

#[test]
fn pins_carry_the_weight_of_a_sheet_at_rest() {
    for case @ (method, step, error) in cases() {
        let mut sim = measured(&in_air(), method, step, error);
        run(&mut sim, 6.0);
        let (weight, means) = (mass(&sim) * G, run(&mut sim, 0.1));
        check("weight", case, (means.pins - DVec3::Y * weight).length() / weight, 1e-3);
    }
}

#[test]
fn a_sheet_at_rest_presses_on_a_plane_with_its_weight() {
    for case @ (method, step, error) in cases() {
        let mut sim = measured(&format!("{SHEET}{FLOOR}"), method, step, error);
        run(&mut sim, 0.5);
        let (weight, means) = (mass(&sim) * G, run(&mut sim, 0.1));
        check("weight", case, (means.colliders - DVec3::Y * weight).length() / weight, 1e-4);
    }
}

#[test]
fn in_free_fall_nothing_reacts_and_the_balances_close() {
    for case @ (method, step, error) in cases() {
        let mut sim = measured(SHEET, method, step, error);
        let (weight, means) = (mass(&sim) * G, run(&mut sim, 0.2));
        assert_eq!((means.pins, means.colliders), (DVec3::ZERO, DVec3::ZERO));
        let tolerance = if method.is_implicit() { 5e-6 } else { 1e-12 };
        check("momentum", case, (means.change + DVec3::Y * weight).length() / weight, tolerance);
    }
}

/// Pins pull with the forces in the middle of the steps. A method of first order takes those at the start or the end of
/// a step: half a step of a force that changes by up to twice the weight is left.
#[test]
fn the_balance_of_momentum_closes_for_a_sheet_that_swings() {
    for case @ (method, step, error) in cases() {
        let mut sim = measured(&format!("{SHEET}{CORNERS}"), method, step, error);
        let (weight, means) = (mass(&sim) * G, run(&mut sim, 0.2));
        let left = means.change - means.pins + DVec3::Y * weight;
        let is_second = matches!(method, Method::Midpoint | Method::Rk4 | Method::ImplicitMidpoint);
        let tolerance = if is_second { 2e-3 } else { step / 0.2 };
        check("momentum", case, left.length() / weight, tolerance);
    }
}

#[test]
fn the_balance_of_momentum_closes_for_a_sheet_that_lands() {
    for case @ (method, step, error) in cases() {
        let mut sim = measured(&format!("{SHEET}{FLOOR}"), method, step, error);
        let (weight, means) = (mass(&sim) * G, run(&mut sim, 0.1));
        let left = means.change - means.colliders + DVec3::Y * weight;
        // BDF2 carries a third of the last change of velocity into a step, but not beyond a contact: so a third of the
        // weight of one step may be missing.
        let tolerance = match method {
            Method::Bdf2 => step / 3.0 / 0.1,
            _ => 1e-5,
        };
        check("momentum", case, left.length() / weight, tolerance);
    }
}

#[test]
fn backward_euler_loses_energy_and_implicit_midpoint_keeps_it() {
    let undamped = SHEET.replace("0.003 }", "0.0 }").replace("0.01 }", "0.0 }");
    let text = format!("{undamped}{CORNERS}");
    for method in [Method::BackwardEuler, Method::ImplicitMidpoint] {
        let case = (method, 1e-3, 0.0);
        let mut sim = measured(&text, method, 1e-3, 0.0);
        let start = sim.energy();
        let mut kinetic: f64 = 0.0;
        for _ in 0..20 {
            run(&mut sim, 0.02);
            kinetic = kinetic.max(sim.energy().kinetic);
            let work = sim.work_done();
            assert_eq!(work, WorkDone::default(), "nothing moves and nothing damps");
            let by_method = (sim.energy().total() - start.total()) / kinetic;
            match method {
                Method::BackwardEuler => assert!(by_method < 0.0, "backward Euler added {by_method} of the energy"),
                _ => check("energy", case, by_method, 1e-4),
            }
        }
    }
}

#[test]
fn works_of_damping_and_of_moving_pins_close_the_balance_of_energy() {
    let motion = "motion = { keys = [[0.0, 0, 0, 0], [0.2, 0, 0.1, 0], [0.4, 0.1, 0.1, 0]] }";
    for method in [Method::Midpoint, Method::Rk4, Method::ImplicitMidpoint] {
        let case = (method, 2e-4, 0.0);
        let mut sim = measured(&format!("{}{motion}", in_air()), method, 2e-4, 0.0);
        let start = sim.energy().total();
        run(&mut sim, 0.4);
        let WorkDone { pins, damping, .. } = sim.work_done();
        let by_method = sim.energy().total() - start - pins - damping;
        assert!(damping < 0.0 && pins > 0.0, "damping {damping} J, pins {pins} J");
        check("energy", case, by_method / pins, 1e-5);
    }
}

/// A mass on a stiff spring, let go level with its pin.
#[test]
fn a_pendulum_pulls_with_its_weight_and_what_bends_its_path() {
    for method in Method::ALL {
        let case = (method, 1e-4, 0.0);
        let spring = Spring { rest: 1.0, stiffness: 1e4, damping: 10.0 };
        let masses = [1e-6, 0.5];
        let built = BuiltScene {
            particles: ParticleColumns::at_rest(
                vec![DVec3::ZERO, DVec3::X],
                masses.to_vec(),
                masses.map(|m| 1.0 / m).to_vec(),
            ),
            model: ModelColumns {
                gravity: Some(GravityColumns::constant(DVec3::NEG_Y * G)),
                stretch_springs: Some(SpringColumns::build(2, &[([0, 1], spring)])),
                ..ModelColumns::default()
            },
            pins: PinColumns {
                vertices: vec![0],
                axes: vec![7],
                anchors: vec![DVec3::ZERO],
                motions: vec![AT_REST],
                ..PinColumns::default()
            },
            pin_groups: vec![PinGroup { cloth: 0, number: 0, pins: 0..1 }],
            ..BuiltScene::default()
        };
        let mut sim = Simulation::from_columns(built, Scheme::fixed(method, 1e-12), 1e-4);
        sim.measure_work(WorkDone::default());
        sim.measure_reactions();
        for _ in 0..8 {
            run(&mut sim, 0.1);
            let pins = run(&mut sim, 1e-4).pins;
            let (x, v) = (sim.positions()[1], sim.velocities()[1]);
            let (length, along) = (x.length(), x.normalize());
            let pull = masses[1] * (v.length_squared() / length - G * along.y);
            check("pull", case, (pins + along * pull).length() / (masses[1] * G), 1e-2);
        }
    }
}

/// A sheet falls 0.34 m, with friction. Floor and gravity give it its change of momentum, by steps of one length.
#[test]
fn impulses_of_an_impact_equal_the_change_of_momentum() {
    let text = r#"
        name = "landing"
        duration = 0.6
        gravity = [0, -9.81, 0]
        [[cloth]]
        grid = { size = [0.677, 0.677], cells = [10, 11] }
        position = [0, 0.338, 0]
        density = 0.49
        stretch = { model = "membrane", stiffness = 3000.0, damping = 0.001 }
        shear = { stiffness = 600.0, damping = 0.001 }
        bend = { model = "hinge", rigidity = 2e-5, damping = 0.001 }
        [[collider]]
        shape = "plane"
        point = [0, 0, 0]
        normal = [0, 1, 0]
        [contact]
        thickness = 0.017
        friction = 0.2
    "#;
    for method in [Method::BackwardEuler, Method::ImplicitMidpoint, Method::Bdf2] {
        let mut sim = measured(text, method, 2e-3, 0.0);
        let (means, weight) = (run(&mut sim, 0.6), mass(&sim) * G);
        let given = means.change.y + weight;
        assert!(given > 0.5 * weight, "the sheet does not land");
        check("impulse", (method, 2e-3, 0.0), means.colliders.y / given - 1.0, 1e-5);
    }
}

harness::both_precisions! {
    use harness::stiff::{STIFF, SWINGING};
    use glam::DVec3;

    fn check(text: &str, seconds: f64, most: f64) {
        let [pins, needed] = kit::impulses(text, seconds);
        println!("{}: pins {pins:.5}, needed {needed:.5}", muslin::real::NAME);
        let off = DVec3::distance(pins, needed) / needed.length();
        assert!(off < most, "{}: the pins give {pins}, and the momentum needs {needed}", muslin::real::NAME);
    }

    /// Edges that turn are shorter between the ends of a step, so forces there are no measure of those in the step.
    #[test]
    fn pins_of_stiff_cloth_that_swings_give_its_momentum() {
        for (method, newton) in [("backward-euler", 1), ("implicit-midpoint", 1), ("backward-euler", 20)] {
            check(&format!("{SWINGING}[integrator]\nmethod = \"{method}\"\nnewton = {newton}"), 1.0, 1e-3);
        }
    }

    #[test]
    fn a_pin_that_takes_moving_vertices_stops_them_by_an_impulse() {
        let pin = "pin = [{ select = { box = [[-9, -9, -9], [9, 9, 9]] }, from = 0.1 }]\n";
        check(&format!("{STIFF}{pin}[integrator]\nstep = 0.001\nerror = 0.0\n"), 0.2, 2e-3);
    }
}
