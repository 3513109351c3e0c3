//! The longest stable step of explicit methods: a lattice of 16x16 masses, with steps around the theoretical limit.

use glam::DVec3;
use muslin_core_f64::integrate::stability::Mode;
use muslin_core_f64::integrate::{Jacobian, Method};
use muslin_core_f64::simulation::Simulation;
use muslin_core_f64::spectrum::Tangent;

use super::bisect::threshold;
use super::check::Check;
use super::lab::{Lab, Miss, linearised};
use super::net::Net;

/// Description in the report.
pub const ABOUT: &str = "16x16 masses on structural, shear and bending springs: the largest eigenvalue, and the step \
                         from which energy grows tenfold within 2000 steps over the theoretical limit, by damping ratio";

/// Vertices along a side.
const SIDE: u32 = 16;

/// Structural, shear and bending springs, N/m, on masses of 1 kg.
const SPRINGS: [f64; 3] = [1.0, 0.5, 0.1];

/// Largest eigenvalues of free lattices with these springs, to the published digits.
const EIGENVALUES: [([f64; 3], f64); 4] =
    [([1.0, 0.0, 0.0], 3.962), ([1.0, 1.0, 0.0], 7.886), (SPRINGS, 5.936), ([1.0, 1.0, 1.0], 9.913)];

/// Methods with a longest stable step.
const EXPLICIT: [Method; 4] = [Method::ExplicitEuler, Method::SymplecticEuler, Method::Midpoint, Method::Rk4];

/// Damping ratios, and the longest stable step times the frequency for each method of [`EXPLICIT`], to the
/// published digits.
const RATIOS: [f64; 8] = [0.0, 0.01, 0.05, 0.1, 0.3, 0.5, 1.0, 2.0];
const LIMITS: [[f64; 8]; 4] = [
    [0.0, 0.02, 0.1, 0.2, 0.6, 1.0, 2.0, 0.536],
    [2.0, 1.980, 1.9025, 1.810, 1.488, 1.236, 0.828, 0.472],
    [0.0, 0.444, 0.800, 1.050, 1.647, 2.0, 2.0, 0.536],
    [2.828, 2.849, 2.910, 2.951, 2.835, 2.6225, 2.785, 0.746],
];

/// Slightly more than half of the last published digit.
const DIGITS: f64 = 6e-4;

/// A mode with a frequency and a damping ratio.
fn mode(omega: f64, zeta: f64) -> Mode {
    Mode { stiffness: omega * omega, damping: 2.0 * zeta * omega }
}

/// The longest stable step by theory; 0 if every step amplifies.
fn theory(method: Method, mode: Mode) -> Result<f64, Miss> {
    mode.longest_step(method).ok_or_else(|| Miss::Why("theory knows no limit".into()))
}

fn fastest_mode(lab: &Lab, springs: [f64; 3]) -> (f64, Vec<DVec3>) {
    let built = Net::lattice(SIDE, springs, 0.0).build();
    Tangent::of(&built, 1.0, 0.0, Jacobian::Exact, lab).fastest_mode(1e-12, 100_000, lab)
}

/// All checks.
pub fn checks() -> Vec<Check> {
    let eigenvalues = EIGENVALUES.into_iter().map(|(springs, lambda)| {
        let measure = move |lab: &Lab| Ok(fastest_mode(lab, springs).0);
        Check::absolute(format!("springs {springs:?}, largest eigenvalue"), lambda, 5e-4, measure).in_unit("1/s^2")
    });
    let limits = EXPLICIT.into_iter().zip(LIMITS).flat_map(|(method, limits)| {
        RATIOS.into_iter().zip(limits).map(move |(zeta, limit)| {
            let name = format!("{}, damping ratio {zeta}, theoretical limit x frequency", method.name());
            Check::absolute(name, limit, DIGITS, move |_| theory(method, mode(1.0, zeta)))
        })
    });
    let ratios = EXPLICIT.into_iter().flat_map(|method| {
        // Without damping these two are never stable.
        let never = matches!(method, Method::ExplicitEuler | Method::Midpoint);
        let zetas = [0.0, 0.3, 0.5, 0.7].into_iter().filter(move |&zeta| zeta > 0.0 || !never);
        zetas.map(move |zeta| {
            let name = format!("{}, damping ratio {zeta}, limit over theory", method.name());
            Check::relative(name, 1.0, 5e-3, move |lab| limit(lab, method, zeta))
        })
    });
    eigenvalues.chain(limits).chain(ratios).collect()
}

/// The shortest unstable step over the theoretical limit.
fn limit(lab: &Lab, method: Method, zeta: f64) -> Result<f64, Miss> {
    let (lambda, shape) = fastest_mode(lab, SPRINGS);
    let omega = lambda.sqrt();
    let theory = theory(method, mode(omega, zeta))?;
    let blows_up = |ratio: f64| blows_up(lab, method, omega, &shape, 2.0 * zeta / omega, ratio * theory);
    threshold([0.9, 1.1], 1e-3, blows_up)
}

/// Whether the energy grows tenfold within 2000 steps.
fn blows_up(lab: &Lab, method: Method, omega: f64, shape: &[DVec3], damping: f64, step: f64) -> Result<bool, Miss> {
    let mut built = Net::lattice(SIDE, SPRINGS, damping).build();
    let particles = &mut built.particles;
    for ((x, v), &e) in particles.positions.iter_mut().zip(&mut particles.velocities).zip(shape) {
        // The amplitude is so small that the springs stay linear. Position and velocity start in phase, where a
        // stable orbit of symplectic Euler has its largest energy: from another start the energy would first grow
        // to it.
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
        // The rest of the motion is rounding.
        if energy < 1e-9 * start {
            return Ok(false);
        }
    }
    Ok(false)
}
