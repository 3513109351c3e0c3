//! The constrained solve against dense LU of the same system, which is assembled from the core's forces,
//! matrix, masses and pins. A backward Euler or implicit midpoint stage of length g from (x, v), linearised at
//! (x + g w, w), is `(M + S) y = M v + g f(x + g w, w) + S w` with `S = -(g^2 Kx + g Kv)` at that state and the
//! held axes of y given. The velocities w of a free sheet in a step of backward Euler are those at the start, turned with it.

use glam::{DMat3, DQuat, DVec3};
use harness::kit::double as kit;
use harness::net::linearised;
use harness::rng::Rng;
use harness::worst::Worst;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::forces::strain_rate;
use muslin_core_f64::integrate::pins::JumpSide;
use muslin_core_f64::integrate::{Jacobian, Method, Preconditioner, Scheme};
use muslin_core_f64::simulation::Simulation;
use muslin_core_f64::spectrum::Tangent;
use nalgebra::DMatrix;

/// Relative to the fastest vertex; the solver's tolerance is 1e-14.
const BOUND: f64 = 1e-10;
/// Step lengths, s. A large step, so that the matrix differs much from the masses; for the exact Jacobian, a
/// step at which the matrix stays definite despite the compressed elements.
const STEPS: [(Jacobian, f64); 2] = [(Jacobian::Projected, 0.02), (Jacobian::Exact, 0.001)];

const SHEETS: [(&str, &str); 3] = [
    (
        "springs and bending springs",
        r#"
        stretch = { model = "spring", stiffness = 200.0, damping = 0.002 }
        bend = { model = "spring", stiffness = 10.0, damping = 0.002 }"#,
    ),
    (
        "membrane and hinges",
        r#"
        stretch = { model = "membrane", stiffness = 300.0, damping = 0.002 }
        shear = { stiffness = 90.0, damping = 0.001 }
        bend = { model = "hinge", rigidity = 1e-3, damping = 0.01 }"#,
    ),
    (
        "membrane, hinges and seams",
        r#"
        stretch = { model = "membrane", stiffness = 300.0, weft = 100.0 }
        bend = { model = "hinge", rigidity = 1e-3 }
        seam = [{ pairs = [[0, 21], [4, 16]], stiffness = 50.0, damping = 0.01 }]"#,
    ),
];

const PINS: [(&str, &str); 4] = [
    ("free", ""),
    ("held corners", "pin = [{ select = { corners = [0, 1] } }]"),
    (
        "axes held one by one",
        r#"pin = [
        { select = { edge = "left" }, axes = "xz" },
        { select = { corners = [3] }, axes = "y" },
        { select = { vertices = [7] } },
        { select = { vertices = [7, 8] }, axes = "z" }]"#,
    ),
    (
        "moving",
        r#"pin = [
        { select = { edge = "back" }, motion = { keys = [[0.0, 0, 0, 0], [1.0, 1.0, 2.0, -0.5]], turn = { axis = [1, 2, 0], rate = 3.0 } } },
        { select = { corners = [2] }, axes = "yz", motion = { keys = [[0.0, 0, 0, 0], [0.1, 0.0, 0.1, 0.1]] } }]"#,
    ),
];

fn simulation(cells: u32, sheet: &str, pins: &str, scheme: Scheme, step: f64) -> Simulation {
    let mut built = kit::build(&format!(
        r#"
        name = "solver"
        duration = 1.0
        gravity = [0.0, -9.81, 0.0]
        drag = {{ linear = 0.4, wind = {{ velocity = [1.0, 2.0, 3.0], normal = 0.6, tangential = 0.1 }} }}
        [[cloth]]
        grid = {{ size = [{}, {}], cells = [{cells}, {cells}] }}
        density = 0.2
        {sheet}
        {pins}"#,
        0.1 * f64::from(cells),
        0.0875 * f64::from(cells)
    ));
    let mut rng = Rng::new(11);
    let particles = &mut built.particles;
    for (x, v) in particles.positions.iter_mut().zip(&mut particles.velocities) {
        *x += rng.cube(0.008);
        *v = rng.cube(1.0);
    }
    built.pins.view().impose(0.0, JumpSide::After, &mut particles.positions, &mut particles.velocities);
    Simulation::from_columns(built, scheme, step)
}

/// The mean velocity of each pin over the step, m/s, with its vertex and axes.
fn rates(sim: &Simulation) -> Vec<(usize, DVec3, u8)> {
    let (pins, step) = (sim.pins(), sim.step_length());
    let rate = |pin: usize, vertex: u32| {
        let vertex = vertex as usize;
        (
            vertex,
            (pins.target(pin, sim.time() + step, JumpSide::After).0 - sim.positions()[vertex]) / step,
            pins.axes[pin],
        )
    };
    pins.vertices.iter().enumerate().map(|(pin, &vertex)| rate(pin, vertex)).collect()
}

/// The velocities of the sheet, turned about its centre of mass for a time as a rigid body.
fn turned(sim: &Simulation, time: f64) -> Vec<DVec3> {
    let particles = || sim.scene().particles.masses.iter().zip(sim.positions().iter().zip(sim.velocities()));
    let mass: f64 = particles().map(|(m, _)| m).sum();
    let centre = particles().map(|(&m, (&x, _))| x * m).sum::<DVec3>() / mass;
    let drift = particles().map(|(&m, (_, &v))| v * m).sum::<DVec3>() / mass;
    let momentum: DVec3 = particles().map(|(&m, (&x, &v))| (x - centre).cross(v) * m).sum();
    let inertia: DMat3 = particles()
        .map(|(&m, (&x, _))| {
            let arm = x - centre;
            let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
            (DMat3::IDENTITY * arm.length_squared() - outer) * m
        })
        .fold(DMat3::ZERO, |sum, part| sum + part);
    let turn = DQuat::from_scaled_axis(inertia.inverse() * momentum * time);
    sim.velocities().iter().map(|&v| drift + turn * (v - drift)).collect()
}

/// The velocities w at which the stage is linearised: the current velocities, turned with a free sheet by backward Euler,
/// with the pins' rates on held axes, scaled down so that the strain over the stage is at most one half.
fn ahead(sim: &Simulation, stage: f64) -> Vec<DVec3> {
    let turns = sim.pins().vertices.is_empty() && sim.scheme().method == Method::BackwardEuler;
    let mut v = if turns { turned(sim, stage) } else { sim.velocities().to_vec() };
    for (vertex, rate, axes) in rates(sim) {
        (0..3).filter(|axis| axes >> axis & 1 == 1).for_each(|axis| v[vertex][axis] = rate[axis]);
    }
    let part = (0.5 / (stage * strain_rate(&sim.model(), &v))).min(1.0);
    v.iter().map(|&v| v * part).collect()
}

/// The stage's velocities by LU; each coordinate is one row.
fn dense(sim: &Simulation, stage: f64) -> Vec<DVec3> {
    let (x, v, masses) = (sim.positions(), sim.velocities(), &sim.scene().particles.masses);
    let size = 3 * x.len();
    let ahead = ahead(sim, stage);
    let mut there = sim.scene().clone();
    there.particles.positions.iter_mut().zip(&ahead).for_each(|(x, &v)| *x += v * stage);
    let mut tangent = Tangent::of(&there, stage * stage, stage, sim.scheme().jacobian, &Serial);
    let (mut unit, mut column) = (vec![DVec3::ZERO; x.len()], vec![DVec3::ZERO; x.len()]);
    let mut matrix = DMatrix::<f64>::zeros(size, size);
    for k in 0..size {
        unit[k / 3][k % 3] = 1.0;
        tangent.multiply(1.0, &unit, &mut column, &Serial);
        unit[k / 3][k % 3] = 0.0;
        (0..size).for_each(|i| matrix[(i, k)] = column[i / 3][i % 3]);
    }
    let f = kit::forces(&sim.model(), masses, &there.particles.positions, &ahead);
    tangent.multiply(0.0, &ahead, &mut column, &Serial);
    let force = |i: usize| v[i] * masses[i] + f[i] * stage + column[i];
    let mut right = DMatrix::<f64>::from_fn(size, 1, |i, _| force(i / 3)[i % 3]);
    // A held axis covers its prescribed displacement at a constant rate.
    for (vertex, rate, axes) in rates(sim) {
        for axis in (0..3).filter(|axis| axes >> axis & 1 == 1) {
            let row = 3 * vertex + axis;
            (0..size).for_each(|k| matrix[(row, k)] = f64::from(u8::from(k == row)));
            right[(row, 0)] = rate[axis];
        }
    }
    let solution = matrix.lu().solve(&right).expect("the matrix is regular");
    (0..x.len()).map(|i| DVec3::from_array(std::array::from_fn(|axis| solution[(3 * i + axis, 0)]))).collect()
}

fn check(what: String, mut sim: Simulation) {
    let (x0, v0, h) = (sim.positions().to_vec(), sim.velocities().to_vec(), sim.step_length());
    let midpoint = sim.scheme().method == Method::ImplicitMidpoint;
    let stage = dense(&sim, if midpoint { 0.5 * h } else { h });
    sim.take_step().expect("finite");
    assert_eq!((sim.statistics().unconverged, sim.statistics().negative_curvature), (0, 0), "{what}");
    let mut worst = Worst::new(what, BOUND);
    let scale = v0.iter().chain(&stage).map(|v| v.length()).fold(0.0, f64::max);
    for (i, &y) in stage.iter().enumerate() {
        let (x, v) = (sim.positions()[i], sim.velocities()[i]);
        let (x1, v1) = (x0[i] + y * h, if midpoint { y * 2.0 - v0[i] } else { y });
        worst.compare(scale * h, &x.to_array(), &x1.to_array(), || format!("position {i}"));
        // The velocity of a held axis is prescribed, so it is not compared.
        if !sim.pins().vertices.contains(&(i as u32)) {
            worst.compare(scale, &v.to_array(), &v1.to_array(), || format!("velocity {i}"));
        }
    }
    worst.check();
}

#[test]
fn constrained_solve_is_the_dense_one() {
    for method in [Method::BackwardEuler, Method::ImplicitMidpoint] {
        for (jacobian, step) in STEPS {
            for ((sheet, material), (pins, pin)) in SHEETS.into_iter().flat_map(|s| PINS.map(|p| (s, p))) {
                for preconditioner in [Preconditioner::BlockJacobi, Preconditioner::TwoLevel] {
                    let what = format!("{}, {jacobian:?}, {preconditioner:?}: {sheet}, {pins}", method.name());
                    let scheme = Scheme { jacobian, preconditioner, ..linearised(method) };
                    check(what, simulation(4, material, pin, scheme, step));
                }
            }
        }
    }
}

/// A sheet that spans several patches of the preconditioner.
#[test]
fn constrained_solve_of_a_larger_sheet_is_the_dense_one() {
    let ((sheet, material), (pins, pin)) = (SHEETS[1], PINS[3]);
    for preconditioner in [Preconditioner::BlockJacobi, Preconditioner::TwoLevel] {
        let scheme = Scheme { preconditioner, ..linearised(Method::BackwardEuler) };
        let sim = simulation(12, material, pin, scheme, 0.02);
        check(format!("backward-euler, {preconditioner:?}: 13 rows of {sheet}, {pins}"), sim);
    }
}
