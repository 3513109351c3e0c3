//! The energy of one undamped oscillator, for every method with a closed form.

use std::f64::consts::TAU;

use glam::DVec3;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

use super::check::Check;
use super::lab::{Lab, Miss, linearised};
use super::net::Net;

/// Description in the report.
pub const ABOUT: &str = "energy that an undamped oscillator keeps in a period, by z = step x frequency; what symplectic \
                         Euler conserves, v^2/2 + x^2/2 - z x v/2, after 1000 steps";

/// Values of z.
const SPANS: [f64; 5] = [0.01, 0.05, 0.1, 0.5, 1.0];

/// Rest length and amplitude, m: the spring is so long that no stage of a step passes through the fixed end.
const LENGTH: f64 = 4.0;
const AMPLITUDE: f64 = 0.25;

/// Relative tolerance; rounding adds up over a period.
const BOUND: f64 = 1e-10;

/// A method, and the factor of the energy in one step.
type Factor = (Method, fn(f64) -> f64);

const FACTORS: [Factor; 5] = [
    (Method::ExplicitEuler, |z| 1.0 + z.powi(2)),
    (Method::Midpoint, |z| 1.0 + z.powi(4) / 4.0),
    (Method::Rk4, |z| 1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0),
    (Method::BackwardEuler, |z| 1.0 / (1.0 + z.powi(2))),
    (Method::ImplicitMidpoint, |_| 1.0),
];

/// All checks.
pub fn checks() -> Vec<Check> {
    let kept = FACTORS.into_iter().flat_map(|(method, factor)| {
        SPANS.map(|z| {
            let name = format!("{}, z {z}, kept in a period", method.name());
            Check::relative(name, factor(z).powf(TAU / z), BOUND, move |lab| kept(lab, method, z))
        })
    });
    let conserved = SPANS.map(|z| {
        let name = format!("symplectic-euler, z {z}, its own energy after 1000 steps");
        Check::relative(name, 1.0, BOUND, move |lab| conserved(lab, z))
    });
    kept.chain(conserved).collect()
}

/// A mass on a spring along x with frequency 1, released from rest.
fn oscillator(method: Method, z: f64) -> Simulation {
    let mut net = Net::chain(2, DVec3::X * LENGTH, 1.0, 1.0);
    net.held = vec![0];
    let mut built = net.build();
    built.particles.positions[1].x += AMPLITUDE;
    Simulation::from_columns(built, linearised(method), z)
}

/// The part of the energy that is left after a period. The steps do not have to fit the period, since every step
/// has the same factor.
fn kept(lab: &Lab, method: Method, z: f64) -> Result<f64, Miss> {
    let mut sim = oscillator(method, z);
    let (start, steps) = (sim.energy().total(), (TAU / z).ceil());
    lab.steps(&mut sim, steps as u32)?;
    Ok((sim.energy().total() / start).powf(TAU / z / steps))
}

fn conserved(lab: &Lab, z: f64) -> Result<f64, Miss> {
    let own = |sim: &Simulation| {
        let (x, v) = (sim.positions()[1].x - LENGTH, sim.velocities()[1].x);
        0.5 * (x * x + v * v - z * x * v)
    };
    let mut sim = oscillator(Method::SymplecticEuler, z);
    let start = own(&sim);
    lab.steps(&mut sim, 1000)?;
    Ok(own(&sim) / start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_table_is_met() {
        let table = [
            (Method::BackwardEuler, [0.9391, 0.7307, 0.5352, 0.0606, 0.0128], [5e-5; 5]),
            (Method::Midpoint, [1.0 + 1.57e-6, 1.0 + 1.96e-4, 1.00157, 1.215, 4.06], [5e-9, 5e-7, 5e-6, 5e-4, 5e-3]),
            (
                Method::Rk4,
                [1.0 - 8.7e-12, 1.0 - 2.7e-8, 1.0 - 8.7e-7, 0.99736, 0.9261],
                [3e-13, 5e-10, 5e-9, 5e-6, 5e-5],
            ),
        ];
        for (method, published, digits) in table {
            let (_, factor) = FACTORS.into_iter().find(|(known, _)| *known == method).unwrap();
            for ((z, want), digit) in SPANS.into_iter().zip(published).zip(digits) {
                let got = factor(z).powf(TAU / z);
                assert!((got - want).abs() <= digit, "{} at {z}: {got}, published {want}", method.name());
            }
        }
    }
}
