//! Orders of convergence of every method: the power of the step with which its error falls.

use std::f64::consts::PI;

use glam::DVec3;
use muslin_core_f64::integrate::pins::JumpSide;
use muslin_core_f64::integrate::{Method, Scheme};
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::simulation::Simulation;

use super::check::Check;
use super::lab::{self, Lab, Miss, converged, linearised, scatter3};
use super::net::Net;

/// Description in the report.
pub const ABOUT: &str = "the order of every method over four halvings of the step, the one farthest off: of a linear \
                         chain against its closed form, of small sheets against RK4 by 8192 steps";

const BOUND: f64 = 0.05;

const HALVINGS: u32 = 4;

const MATERIALS: [(&str, &str); 2] = [
    (
        "membrane and hinges",
        r#"
        stretch = { model = "membrane", stiffness = 50.0, damping = 0.0002 }
        shear = { stiffness = 20.0, damping = 0.0002 }
        bend = { model = "hinge", rigidity = 1e-4, damping = 0.0002 }"#,
    ),
    (
        "springs",
        r#"
        stretch = { model = "spring", stiffness = 50.0, damping = 0.0002 }
        bend = { model = "spring", stiffness = 5.0, damping = 0.0002 }"#,
    ),
];

/// All checks.
pub fn checks() -> Vec<Check> {
    let each = Method::ALL.into_iter().flat_map(|method| {
        let chain = Check::absolute(format!("{}, linear chain", method.name()), order(method), BOUND, move |lab| {
            of_chain(lab, method)
        });
        let sheets = MATERIALS.map(|(name, material)| {
            let name = format!("{}, {name}", method.name());
            Check::absolute(name, order(method), BOUND, move |lab| of_sheet(lab, method, material))
        });
        [chain].into_iter().chain(sheets)
    });
    each.collect()
}

fn order(method: Method) -> f64 {
    match method {
        Method::ExplicitEuler | Method::SymplecticEuler | Method::BackwardEuler => 1.0,
        Method::Midpoint | Method::ImplicitMidpoint | Method::Bdf2 => 2.0,
        Method::Rk4 => 4.0,
    }
}

/// Positions followed by velocities after `steps` steps of `duration / steps`.
fn run(lab: &Lab, built: &BuiltScene, scheme: Scheme, duration: f64, steps: u32) -> Result<Vec<DVec3>, Miss> {
    let mut sim = Simulation::from_columns(built.clone(), scheme, duration / f64::from(steps));
    lab.steps(&mut sim, steps)?;
    Ok([sim.positions(), sim.velocities()].concat())
}

/// The measured order that differs most from the method's, over all halvings of the step from `coarsest` steps on.
fn worst(
    method: Method,
    coarsest: u32,
    truth: &[DVec3],
    run: impl Fn(u32) -> Result<Vec<DVec3>, Miss>,
) -> Result<f64, Miss> {
    let error = |steps: u32| {
        let squares = run(steps)?.into_iter().zip(truth).map(|(a, b)| a.distance_squared(*b)).sum::<f64>();
        Ok::<_, Miss>(squares.sqrt())
    };
    let errors = (0..=HALVINGS).map(|k| error(coarsest << k)).collect::<Result<Vec<_>, _>>()?;
    let off = |p: &f64| (p - order(method)).abs();
    let orders = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2());
    Ok(orders.max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(f64::NAN))
}

/// The order on a chain of eight masses with fixed ends, which swings in three of its modes.
fn of_chain(lab: &Lab, method: Method) -> Result<f64, Miss> {
    const LINKS: f64 = 7.0;
    const DURATION: f64 = 2.0;
    /// Number and amplitude of each mode.
    const MODES: [(f64, f64); 3] = [(1.0, 0.1), (3.0, -0.05), (6.0, 0.03)];
    let state = |i: usize, t: f64| {
        let mode = |(n, a): (f64, f64)| {
            let (shape, omega) = (a * (n * PI * i as f64 / LINKS).sin(), 2.0 * (n * PI / (2.0 * LINKS)).sin());
            (shape * (omega * t).cos(), -shape * omega * (omega * t).sin())
        };
        MODES.into_iter().map(mode).fold((i as f64, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1))
    };
    let mut net = Net::chain(8, DVec3::X, 1.0, 1.0);
    net.held = vec![0, 7];
    let mut built = net.build();
    built.particles.positions = (0..8).map(|i| DVec3::X * state(i, 0.0).0).collect();
    let end = || (0..8).map(|i| state(i, DURATION));
    let truth: Vec<_> = end().map(|s| s.0).chain(end().map(|s| s.1)).map(|x| DVec3::X * x).collect();
    let coarsest = if order(method) == 1.0 { 256 } else { 64 };
    worst(method, coarsest, &truth, |steps| run(lab, &built, linearised(method), DURATION, steps))
}

/// The order on a small sheet that is deformed and moving, and pinned at two corners.
fn of_sheet(lab: &Lab, method: Method, material: &str) -> Result<f64, Miss> {
    /// Duration, s: a few oscillations of the stiffest mode.
    const DURATION: f64 = 0.02;
    let text = format!(
        r#"
        name = "orders"
        duration = 1.0
        gravity = [0.0, -9.81, 0.0]
        [[cloth]]
        grid = {{ size = [0.3, 0.26], cells = [3, 3] }}
        density = 0.2
        {material}
        pin = [{{ select = {{ corners = [0, 1] }} }}]"#
    );
    let mut built = lab::columns(&text, &[])?;
    let particles = &mut built.particles;
    for (place, (x, v)) in particles.positions.iter_mut().zip(&mut particles.velocities).enumerate() {
        *x += scatter3(place) * 0.004;
        *v = scatter3(place + 100) * 0.3;
    }
    built.pins.view().impose(0.0, JumpSide::After, &mut particles.positions, &mut particles.velocities);
    let truth = run(lab, &built, linearised(Method::Rk4), DURATION, 8192)?;
    // From this number of steps on, the next term of the error is small enough.
    let coarsest = if order(method) == 1.0 { 512 } else { 128 };
    worst(method, coarsest, &truth, |steps| run(lab, &built, converged(method, 1e-10), DURATION, steps))
}
