//! Chains of masses and springs: longitudinal modes, static stretch, and the swing of a hanging rope.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

use super::check::Check;
use super::lab::{Lab, Miss, linearised};
use super::net::{GRAVITY, Net};

/// Description in the report.
pub const ABOUT: &str = "frequencies of 12 masses on springs, 2 sqrt(k/m) sin(angle / 2); the stretch of a hanging \
                         chain; the slowest swing of a rope, over sqrt(g / L)";

const MASSES: usize = 12;

/// Stiffness of a spring, N/m, and mass, kg.
const STIFFNESS: f64 = 30.0;
const MASS: f64 = 0.02;

/// Frequency f of the slowest swing of a rope, over sqrt(g / L): J0(2 f) = 0.
const SWING: f64 = 1.202_412_8;

/// All checks.
pub fn checks() -> Vec<Check> {
    let ends = [("both ends", false), ("one end", true)];
    let modes = ends.into_iter().flat_map(|(held, free)| {
        [1, 2, 3, 6, 9, 12].map(|number| {
            let angle = angle(number, free);
            let omega = 2.0 * (STIFFNESS / MASS).sqrt() * (0.5 * angle).sin();
            let name = format!("held at {held}, mode {number}");
            Check::relative(name, omega, 1e-9, move |lab| frequency(lab, angle, omega, free)).in_unit("rad/s")
        })
    });
    let tip = MASS * GRAVITY * (MASSES * (MASSES + 1)) as f64 / (2.0 * STIFFNESS);
    let hanging = Check::relative("hanging, stretch of the whole", tip, 1e-12, stretch).in_unit("m");
    let swing = Check::absolute("rope, slowest swing, links led on to none", SWING, 1e-5, |lab| {
        let (coarse, fine) = (swing(lab, 16)?, swing(lab, 32)?);
        Ok(fine + (fine - coarse) / 3.0)
    });
    modes.chain([hanging, swing]).collect()
}

/// Phase difference between neighbours in a mode.
fn angle(number: u32, free_end: bool) -> f64 {
    let (number, masses) = (f64::from(number), MASSES as f64);
    if free_end { (2.0 * number - 1.0) * PI / (2.0 * masses + 1.0) } else { number * PI / (masses + 1.0) }
}

/// The frequency of a mode, rad/s, from its phase after one expected period with RK4.
fn frequency(lab: &Lab, angle: f64, omega: f64, free_end: bool) -> Result<f64, Miss> {
    // The phase error of RK4 is (omega h)^4 / 120 of the phase: 8e-11.
    const STEPS: u32 = 628;
    let vertices = if free_end { MASSES + 1 } else { MASSES + 2 };
    let mut net = Net::chain(vertices, DVec3::X, MASS, STIFFNESS);
    net.held = if free_end { vec![0] } else { vec![0, MASSES as u32 + 1] };
    let mut built = net.build();
    let shape = |i: usize| (i as f64 * angle).sin();
    (1..=MASSES).for_each(|i| built.particles.positions[i].x += 0.1 * shape(i));
    let mut sim = Simulation::from_columns(built, linearised(Method::Rk4), TAU / omega / f64::from(STEPS));
    lab.steps(&mut sim, STEPS)?;
    // The amplitude of the mode in a state.
    let part = |column: &dyn Fn(usize) -> f64| (1..=MASSES).map(|i| shape(i) * column(i)).sum::<f64>();
    let place = part(&|i| sim.positions()[i].x - i as f64);
    let speed = part(&|i| sim.velocities()[i].x);
    Ok(omega * (1.0 + (-speed / omega).atan2(place) / TAU))
}

fn hung(vertices: usize, step: DVec3, mass: f64, stiffness: f64) -> Net {
    Net { held: vec![0], heavy: true, ..Net::chain(vertices, step, mass, stiffness) }
}

/// How far the end of a hanging chain sinks, m.
fn stretch(lab: &Lab) -> Result<f64, Miss> {
    let net = hung(MASSES + 1, DVec3::NEG_Y, MASS, STIFFNESS);
    let mut sim = Simulation::from_columns(net.build(), linearised(Method::BackwardEuler), 10.0);
    lab.settle(&mut sim, 1e-14, 30)?;
    Ok(-sim.positions()[MASSES].y - MASSES as f64)
}

/// Frequency of a rope with `links` links, over sqrt(g / L), from the half period of the mode J0(2 omega sqrt(s /
/// g)); s is the height over the free end.
fn swing(lab: &Lab, links: usize) -> Result<f64, Miss> {
    const STEP: f64 = 0.005;
    let rest = 1.0 / links as f64;
    let mut net = hung(links + 1, DVec3::NEG_Y * rest, 0.3 * rest, 1e6 * 0.3 * GRAVITY / rest);
    net.masses[links] *= 0.5;
    let mut sim = Simulation::from_columns(net.build(), linearised(Method::BackwardEuler), 10.0);
    lab.settle(&mut sim, 1e-13, 30)?;
    let shape: Vec<_> = (0..=links).map(|i| bessel(SWING * SWING * (1.0 - i as f64 * rest))).collect();
    let mut built = sim.scene().clone();
    built.particles.velocities.fill(DVec3::ZERO);
    // The amplitude is so small that the swing is linear.
    (1..=links).for_each(|i| built.particles.positions[i].x = 1e-6 * shape[i]);
    let mut sim = Simulation::from_columns(built, linearised(Method::ImplicitMidpoint), STEP);
    // Times at which the amplitude of the mode changes its sign.
    let (mut before, mut roots) = (1.0, Vec::new());
    while roots.len() < 2 {
        let time = sim.time();
        lab.steps(&mut sim, 1)?;
        let parts = sim.positions().iter().zip(&shape).zip(&net.masses).map(|((x, shape), m)| x.x * shape * m);
        let now: f64 = parts.sum();
        if before * now < 0.0 {
            roots.push(time + STEP * before / (before - now));
        }
        before = now;
    }
    let omega = PI / (roots[1] - roots[0]);
    // Implicit midpoint advances the phase by 2 atan(omega h / 2) per step.
    Ok(2.0 / STEP * (omega * STEP / 2.0).tan() / GRAVITY.sqrt())
}

/// The Bessel function J0(2 sqrt(u)).
fn bessel(u: f64) -> f64 {
    let mut term = 1.0;
    let terms = (1..20).map(|k| {
        term *= -u / f64::from(k * k);
        term
    });
    1.0 + terms.sum::<f64>()
}
