//! A sheet in free fall and with linear drag, by every method.

use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

use super::check::Check;
use super::lab::{self, Lab, Miss, centre, drift, linearised};
use super::net::GRAVITY;

/// Description in the report.
pub const ABOUT: &str = "how far a sheet falls in 100 steps of 2 ms, by the closed form of each method, and the speed \
                         at which drag holds it, density g / c";

/// Density, kg/m^2, and drag, N s/m^3.
const DENSITY: f64 = 0.2;
const DRAG: f64 = 4.0;

const STEPS: u32 = 100;
const STEP: f64 = 0.002;

/// All checks.
pub fn checks() -> Vec<Check> {
    let each = Method::ALL.into_iter().flat_map(|method| {
        let drop = 0.5 * GRAVITY * STEP * STEP * fallen(method, f64::from(STEPS));
        [
            Check::relative(format!("{}, free fall", method.name()), drop, 1e-12, move |lab| fall(lab, method))
                .in_unit("m"),
            Check::relative(
                format!("{}, terminal velocity", method.name()),
                DENSITY * GRAVITY / DRAG,
                1e-10,
                move |lab| terminal(lab, method),
            )
            .in_unit("m/s"),
        ]
    });
    each.collect()
}

/// The fall after n steps, in units of g h^2 / 2.
fn fallen(method: Method, n: f64) -> f64 {
    match method {
        Method::ExplicitEuler => n * (n - 1.0),
        Method::SymplecticEuler | Method::BackwardEuler => n * (n + 1.0),
        Method::Midpoint | Method::Rk4 | Method::ImplicitMidpoint | Method::Bdf2 => n * n,
    }
}

/// A sheet that is so soft that explicit Euler, whose modes grow, does not amplify rounding.
fn sheet(method: Method, step: f64, drag: f64) -> Result<Simulation, Miss> {
    let text = format!(
        r#"
        name = "fall"
        duration = 1.0
        gravity = [0.0, -{GRAVITY:?}, 0.0]
        drag = {{ linear = {drag:?} }}
        [[cloth]]
        grid = {{ size = [0.4, 0.35], cells = [4, 4] }}
        density = {DENSITY:?}
        stretch = {{ model = "membrane", stiffness = 0.1 }}
        shear = {{ stiffness = 0.05 }}
        bend = {{ model = "hinge", rigidity = 1e-5 }}"#
    );
    Ok(Simulation::from_columns(lab::columns(&text, &[])?, linearised(method), step))
}

fn fall(lab: &Lab, method: Method) -> Result<f64, Miss> {
    let mut sim = sheet(method, STEP, 0.0)?;
    lab.steps(&mut sim, STEPS)?;
    Ok(-centre(&sim).y)
}

/// The terminal speed, m/s: after this time, exp(-25) of the initial difference is left.
fn terminal(lab: &Lab, method: Method) -> Result<f64, Miss> {
    let mut sim = sheet(method, 0.005, DRAG)?;
    lab.run(&mut sim, 1.25)?;
    Ok(-drift(&sim).y)
}
