//! Conservation of momentum of free sheets: explicit methods conserve it to rounding, implicit ones to the residual
//! of their solves.

use glam::DVec3;
use muslin_core_f64::integrate::{Jacobian, Method, Scheme, Tolerance};
use muslin_core_f64::simulation::Simulation;
use muslin_core_f64::spectrum::Tangent;

use super::check::Check;
use super::lab::{self, Lab, Miss, linearised, scatter3};

/// Description in the report.
pub const ABOUT: &str = "two sewn sheets, thrown and spinning: drift of their momentum over the sum of its parts, after \
                         10,000 steps of explicit methods and 200 of implicit ones solved to 1e-13; what one step of \
                         backward Euler gains by a poor solve, and the sum of what that leaves";

const SHEETS: &str = r#"
    name = "thrown"
    duration = 1.0
    [[cloth]]
    grid = { size = [0.3, 0.26], cells = [3, 3] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 20.0, damping = 0.004 }
    shear = { stiffness = 8.0, damping = 0.004 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.004 }
    seam = [{ pairs = [[0, 14], [3, 17]], stiffness = 0.5 }]
    [[cloth]]
    grid = { size = [0.3, 0.26], cells = [3, 3] }
    density = 0.2
    stretch = { model = "spring", stiffness = 20.0, damping = 0.004 }
    bend = { model = "spring", stiffness = 1.0, damping = 0.004 }"#;

/// All checks.
pub fn checks() -> Vec<Check> {
    let drifts = Method::ALL
        .into_iter()
        .map(|method| Check::absolute(format!("{}, drift", method.name()), 0.0, 1e-12, move |lab| drift(lab, method)));
    let residual = Check::absolute("backward-euler, gain and the sum of the residual", 0.0, 1e-13, residual);
    drifts.chain([residual]).collect()
}

fn thrown(method: Method, tolerance: f64, step: f64) -> Result<Simulation, Miss> {
    let mut built = lab::columns(SHEETS, &[])?;
    let (throw, spin) = (DVec3::new(0.3, 0.5, -0.2), DVec3::new(1.0, 3.0, -2.0));
    let particles = &mut built.particles;
    for (place, (x, v)) in particles.positions.iter_mut().zip(&mut particles.velocities).enumerate() {
        *x += scatter3(place) * 0.005;
        *v = throw + spin.cross(*x) + scatter3(place + 100) * 0.3;
    }
    Ok(Simulation::from_columns(
        built,
        Scheme { tolerance: Tolerance::Residual(tolerance), ..linearised(method) },
        step,
    ))
}

/// The sum of the magnitudes of all momenta, kg m/s.
fn size(sim: &Simulation) -> f64 {
    sim.velocities().iter().zip(&sim.scene().particles.masses).map(|(v, m)| (*v * *m).length()).sum()
}

fn drift(lab: &Lab, method: Method) -> Result<f64, Miss> {
    let (step, steps) = if method.is_implicit() { (5e-3, 200) } else { (2e-4, 10_000) };
    let mut sim = thrown(method, 1e-13, step)?;
    let (start, before) = (DVec3::from(sim.momentum()), size(&sim));
    lab.steps(&mut sim, steps)?;
    Ok((DVec3::from(sim.momentum()) - start).length() / before.max(size(&sim)))
}

/// The gain of momentum plus the sum of the residual r, over the sum of the magnitudes. M (v1 - v0) = h f(x0) - S
/// v1 - r, where forces and the columns of S sum to zero: the gain must be minus the sum of r.
fn residual(lab: &Lab) -> Result<f64, Miss> {
    let mut sim = thrown(Method::BackwardEuler, 1e-2, 5e-3)?;
    let h = sim.step_length();
    let (start, v0) = (sim.scene().clone(), sim.velocities().to_vec());
    let (f, before) = (lab::forces(&start, sim.positions()), DVec3::from(sim.momentum()));
    lab.steps(&mut sim, 1)?;
    let mut product = vec![DVec3::ZERO; v0.len()];
    let mut tangent = Tangent::of(&start, h * h, h, Jacobian::Projected, lab);
    tangent.multiply(1.0, sim.velocities(), &mut product, lab);
    let masses = &start.particles.masses;
    let left: DVec3 = (0..v0.len()).map(|i| v0[i] * masses[i] + f[i] * h - product[i]).sum();
    Ok((DVec3::from(sim.momentum()) - before + left).length() / size(&sim))
}
