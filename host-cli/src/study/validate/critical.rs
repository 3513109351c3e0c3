//! Where explicit methods blow up: a lattice of 16x16 masses by steps around the limit of theory.

use glam::DVec3;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

use super::bisect::threshold;
use super::check::Check;
use super::lab::{Lab, Miss, linearised};
use super::net::Net;
use super::oscillator::{EXPLICIT, Explicit};
use super::spectrum::fastest_mode;

/// For the report.
pub const ABOUT: &str = "16x16 masses on structural, shear and bending springs: the largest eigenvalue, and the step \
                         from which energy grows tenfold within 2000 steps over the limit of theory, by damping ratio";

/// Vertices along a side.
const SIDE: u32 = 16;

/// Structural, shear and bending springs, N/m, on masses of 1 kg.
const SPRINGS: [f64; 3] = [1.0, 0.5, 0.1];

/// Largest eigenvalues of free lattices by their springs, to the digits that are published.
const EIGENVALUES: [([f64; 3], f64); 4] =
    [([1.0, 0.0, 0.0], 3.962), ([1.0, 1.0, 0.0], 7.886), (SPRINGS, 5.936), ([1.0, 1.0, 1.0], 9.913)];

/// All checks.
pub fn checks() -> Vec<Check> {
    let eigenvalues = EIGENVALUES.into_iter().map(|(springs, lambda)| {
        let measure = move |_: &Lab| Ok(fastest_mode(&Net::lattice(SIDE, springs, 0.0).build()).0);
        Check::absolute(format!("springs {springs:?}, largest eigenvalue"), lambda, 5e-4, measure).in_unit("1/s^2")
    });
    let ratios = EXPLICIT.iter().flat_map(|method| {
        // Without damping these two are never stable.
        let never = matches!(method.method, Method::ExplicitEuler | Method::Midpoint);
        let zetas = [0.0, 0.3, 0.5, 0.7].into_iter().filter(move |&zeta| zeta > 0.0 || !never);
        zetas.map(move |zeta| {
            let name = format!("{}, damping ratio {zeta}, limit over theory", method.method.name());
            Check::relative(name, 1.0, 5e-3, move |lab| limit(lab, method, zeta))
        })
    });
    eigenvalues.chain(ratios).collect()
}

/// The least step that blows up over that of theory.
fn limit(lab: &Lab, method: &Explicit, zeta: f64) -> Result<f64, Miss> {
    let (lambda, mode) = fastest_mode(&Net::lattice(SIDE, SPRINGS, 0.0).build());
    let omega = lambda.sqrt();
    let theory = method.limit(zeta) / omega;
    let blows_up = |ratio: f64| blows_up(lab, method.method, omega, &mode, 2.0 * zeta / omega, ratio * theory);
    threshold([0.9, 1.1], 1e-3, blows_up)
}

/// Whether the energy grows tenfold within 2000 steps.
fn blows_up(lab: &Lab, method: Method, omega: f64, mode: &[DVec3], damping: f64, step: f64) -> Result<bool, Miss> {
    let mut built = Net::lattice(SIDE, SPRINGS, damping).build();
    let particles = &mut built.particles;
    for ((x, v), &e) in particles.positions.iter_mut().zip(&mut particles.velocities).zip(mode) {
        // So small that springs stay linear; in phase, where a stable symplectic orbit has most energy,
        // which it would else find later.
        *x += e * 1e-5;
        *v += e * 1e-5 * omega;
    }
    let mut sim = Simulation::from_columns(built, linearised(method), step);
    let start = sim.energy().total();
    for _ in 0..2000 {
        lab.steps(&mut sim, 1)?;
        let energy = sim.energy().total();
        if energy > 10.0 * start {
            return Ok(true);
        }
        // What is left is rounding.
        if energy < 1e-9 * start {
            return Ok(false);
        }
    }
    Ok(false)
}
