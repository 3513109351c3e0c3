//! Newton's method on the implicit stage: every iteration decreases the objective, the converged step has no
//! residual, and the one-step variant differs from it by the predicted order.

use glam::DVec3;
use harness::kit::double as kit;
use harness::net::{converged, linearised};
use harness::rng::Rng;
use muslin_core_f64::diagnostics;
use muslin_core_f64::integrate::pins::JumpSide;
use muslin_core_f64::integrate::{Jacobian, Method, Scheme};
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::simulation::Simulation;

const MEMBRANE: &str = r#"
    stretch = { model = "membrane", stiffness = 300.0 }
    shear = { stiffness = 90.0 }
    bend = { model = "hinge", rigidity = 1e-3 }"#;
const SPRINGS: &str = r#"
    stretch = { model = "spring", stiffness = 200.0 }
    bend = { model = "spring", stiffness = 10.0 }"#;
const DAMPED: &str = r#"
    stretch = { model = "membrane", stiffness = 300.0, damping = 0.002 }
    shear = { stiffness = 90.0, damping = 0.002 }
    bend = { model = "hinge", rigidity = 1e-3, damping = 0.01 }"#;
const AIR: &str = "drag = { linear = 0.4, wind = { velocity = [1.0, 2.0, 3.0], normal = 0.6, tangential = 0.1 } }";

/// A crumpled, moving sheet, `size` times its rest size; one corner follows keys, the opposite one is held
/// along x and y.
fn crumpled(material: &str, air: &str, size: f64, noise: f64) -> BuiltScene {
    let mut built = kit::build(&format!(
        r#"
        name = "newton"
        duration = 1.0
        gravity = [0.0, -9.81, 0.0]
        {air}
        [[cloth]]
        grid = {{ size = [0.4, 0.35], cells = [4, 4] }}
        density = 0.2
        {material}
        [[cloth.pin]]
        select = {{ corners = [0] }}
        motion = {{ keys = [[0.0, 0, 0, 0], [1.0, 1.0, 0.5, 0]] }}
        [[cloth.pin]]
        select = {{ corners = [3] }}
        axes = "xy""#
    ));
    let mut rng = Rng::new(23);
    let particles = &mut built.particles;
    for (x, v) in particles.positions.iter_mut().zip(&mut particles.velocities) {
        *x = *x * size + rng.cube(noise);
        *v = rng.cube(2.0);
    }
    built.pins.anchors.iter_mut().for_each(|x| *x *= size);
    built.pins.view().impose(0.0, JumpSide::After, &mut particles.positions, &mut particles.velocities);
    built
}

/// Takes one step.
fn step(built: &BuiltScene, scheme: Scheme, h: f64) -> Simulation {
    let mut sim = Simulation::from_columns(built.clone(), scheme, h);
    sim.take_step().expect("finite");
    sim
}

/// The stage's velocity: displacement divided by the step, also for held axes, whose final velocity is
/// prescribed.
fn stage(built: &BuiltScene, sim: &Simulation) -> Vec<DVec3> {
    let moved = sim.positions().iter().zip(&built.particles.positions);
    moved.map(|(x1, x0)| (*x1 - *x0) / sim.step_length()).collect()
}

/// |v - v0|^2_M / 2 + E(x0 + h v), J.
fn objective(built: &BuiltScene, sim: &Simulation) -> f64 {
    let particles = &built.particles;
    let change: Vec<_> = stage(built, sim).iter().zip(&particles.velocities).map(|(v, v0)| *v - *v0).collect();
    diagnostics::energy(&sim.model(), &particles.masses, sim.positions().into(), &change).total()
}

#[test]
fn every_iteration_decreases_the_objective() {
    for (what, material) in [("membrane", MEMBRANE), ("springs", SPRINGS)] {
        for h in [0.005, 0.02, 0.1] {
            let built = crumpled(material, "", 0.9, 0.02);
            let (mut before, mut seen) = (f64::INFINITY, 0);
            // A step with at most k iterations stops at the k-th iterate.
            for newton in 2..=20 {
                let sim = step(&built, Scheme { newton, ..converged(Method::BackwardEuler, 1e-10) }, h);
                let (now, work) = (objective(&built, &sim), sim.statistics());
                assert_eq!(work.stalled_searches, 0, "{what}, h {h}, newton = {newton}");
                let iterated = work.newton_iterations > seen;
                assert!(
                    !iterated || now < before,
                    "{what}, h {h}, iteration {newton}: objective {now} J after {before} J"
                );
                (before, seen) = (now, work.newton_iterations);
            }
            println!("{what}, h {h}: objective {before:.6} J after {seen} iterations");
        }
    }
}

/// sqrt(sum |r|^2 / m) of r = M (v - v0) - h f(x0 + h v, v) over the free axes, m/s.
fn residual(built: &BuiltScene, sim: &Simulation) -> f64 {
    let (particles, h, v) = (&built.particles, sim.step_length(), stage(built, sim));
    let f = kit::forces(&sim.model(), &particles.masses, sim.positions(), &v);
    let columns = v.iter().zip(&particles.velocities).zip(&particles.masses).zip(&f);
    let mut r: Vec<_> = columns.map(|(((v, v0), &m), f)| (*v - *v0) * m - *f * h).collect();
    sim.pins().filter(&mut r);
    r.iter().zip(&particles.masses).map(|(r, m)| r.length_squared() / m).sum::<f64>().sqrt()
}

#[test]
fn converged_step_leaves_no_residual() {
    let sheets = [("membrane", MEMBRANE, ""), ("springs", SPRINGS, ""), ("damped, in the wind", DAMPED, AIR)];
    for (what, material, air) in sheets {
        // At the largest step, a hundred iterations do not reach the strictest tolerances.
        for (h, tolerances) in [(0.005, [1e-3, 1e-6, 1e-9]), (0.02, [1e-3, 1e-6, 1e-9]), (0.1, [1e-3, 1e-4, 1e-5])] {
            let built = crumpled(material, air, 0.9, 0.02);
            // A step with an enormous tolerance ends at Newton's initial guess.
            let start = residual(&built, &step(&built, converged(Method::BackwardEuler, 1e9), h));
            let mass: f64 = built.particles.masses.iter().sum();
            let scale = start.max(9.81 * h * mass.sqrt());
            for tolerance in tolerances {
                let sim = step(&built, converged(Method::BackwardEuler, tolerance), h);
                let left = residual(&built, &sim) / scale;
                println!(
                    "{what}, h {h}: residual {left:.1e} of its start, asked {tolerance:.0e}, {:?}",
                    sim.statistics()
                );
                assert!(
                    left <= tolerance * (1.0 + 1e-6),
                    "{what}, h {h}: residual {left:e} of its start, expected {tolerance:e}"
                );
            }
        }
    }
}

/// One Newton step adds the change due to the forces, which is O(h). With the exact Jacobian its error is h f''
/// (h h)^2 / 2. Where the projected Jacobian differs, or with damping, whose df/dx is omitted, the error is h^2
/// times that change.
#[test]
fn one_newton_step_differs_from_the_converged_one_as_theory_says() {
    for (what, material, size, jacobian, h, order) in [
        ("springs", SPRINGS, 1.0, Jacobian::Exact, 1e-4, 5.0),
        ("membrane", MEMBRANE, 1.0, Jacobian::Exact, 1e-4, 5.0),
        ("compressed springs", SPRINGS, 0.9, Jacobian::Projected, 1e-4, 3.0),
        ("compressed membrane", MEMBRANE, 0.9, Jacobian::Projected, 1e-4, 3.0),
        ("damped membrane", DAMPED, 1.0, Jacobian::Exact, 5e-6, 3.0),
    ] {
        let built = crumpled(material, "", size, 0.002);
        let difference = |h: f64| {
            let one = step(&built, Scheme { jacobian, ..linearised(Method::BackwardEuler) }, h);
            let all = step(&built, converged(Method::BackwardEuler, 1e-12), h);
            let (one, all) = (stage(&built, &one), stage(&built, &all));
            one.iter().zip(&all).map(|(a, b)| a.distance_squared(*b)).sum::<f64>().sqrt()
        };
        let differences = [h, h / 2.0, h / 4.0, h / 8.0].map(difference);
        let orders: Vec<_> = differences.windows(2).map(|d| (d[0] / d[1]).log2()).collect();
        let measured = format!("{what}, {jacobian:?} Jacobian: difference falls with orders {orders:.3?}");
        println!("{measured}");
        assert!(orders.iter().all(|p| (p - order).abs() <= 0.1), "{measured}, expected {order}: {differences:?}");
    }
}

/// Largest stretch during one second of a sheet that is released level at two pinned corners, and whether its
/// energy ever exceeded the initial energy.
fn released(newton: u32, h: f64) -> (f64, bool) {
    let built = kit::build(
        r#"
        name = "released"
        duration = 1.0
        gravity = [0.0, -9.81, 0.0]
        [[cloth]]
        grid = { size = [1.0, 1.0], cells = [10, 10], pattern = "alternating" }
        density = 0.2
        stretch = { model = "membrane", stiffness = 2000.0 }
        shear = { stiffness = 500.0 }
        bend = { model = "hinge", rigidity = 2e-5 }
        pin = [{ select = { corners = [0, 1] } }]"#,
    );
    let mut sim = Simulation::from_columns(built, Scheme { newton, ..converged(Method::BackwardEuler, 1e-4) }, h);
    let start = sim.energy().total();
    let (mut stretch, mut grew) = (1.0, false);
    while sim.time() < 1.0 {
        sim.take_step().expect("finite");
        stretch = sim.stretch().max.max(stretch);
        grew |= sim.energy().total() > start + 1e-9;
    }
    (stretch, grew)
}

/// The weight stretches the sheet by 1 to 2 %. One linear solve is as good while rotations per step are small;
/// for a step of 0.1 s see `known_issues.rs`.
#[test]
fn newtons_method_keeps_large_steps_from_stretching() {
    for (h, one_solve) in [(1.0 / 30.0, Some(1.02)), (0.1, None)] {
        let (one, all) = (released(1, h), released(50, h));
        println!("h {h:.4}: stretch {:.4} with newton = 1, {:.4} converged", one.0, all.0);
        assert!(all.0 < 1.02 && !all.1, "backward-euler converged, h {h}: stretch {}, gained energy: {}", all.0, all.1);
        if let Some(most) = one_solve {
            assert!(one.0 < most, "backward-euler with newton = 1, h {h}: stretch {}, bound {most}", one.0);
        }
    }
}
