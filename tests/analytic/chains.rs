//! Chains of masses and springs: longitudinal modes, static stretch, swinging rope. The catenary is tested by
//! `muslin validate`.

use std::f64::consts::PI;

use glam::DVec3;
use harness::net::{Net, XYZ, linearised, settle};
use harness::worst::Worst;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

const G: f64 = 9.81;

/// Follows every longitudinal mode of a chain with RK4 for a period: omega = 2 sqrt(k/m) sin(angle / 2), shape
/// sin(i angle).
fn modes(what: &str, masses: usize, free_end: bool) {
    const STIFFNESS: f64 = 30.0;
    const MASS: f64 = 0.02;
    const AMPLITUDE: f64 = 0.1;
    // The phase error of RK4 is (omega h)^4 / 120 of the phase: 5e-10 after a period.
    const STEPS: u32 = 628;
    let vertices = if free_end { masses + 1 } else { masses + 2 };
    let mut net = Net::chain(vertices, DVec3::X, MASS, STIFFNESS, 0.0);
    net.held = if free_end { vec![(0, XYZ)] } else { vec![(0, XYZ), (masses as u32 + 1, XYZ)] };
    let mut worst = Worst::new(format!("{what}: positions over a period"), 1e-9);
    for n in 1..=masses {
        let angle = match free_end {
            true => (2 * n - 1) as f64 * PI / (2 * masses + 1) as f64,
            false => n as f64 * PI / (masses + 1) as f64,
        };
        let omega = 2.0 * (STIFFNESS / MASS).sqrt() * (angle / 2.0).sin();
        let place = |i: usize, t: f64| i as f64 + AMPLITUDE * (i as f64 * angle).sin() * (omega * t).cos();
        let mut built = net.build();
        let free = 1..=masses;
        for i in free.clone() {
            built.particles.positions[i].x = place(i, 0.0);
        }
        let mut sim = Simulation::from_columns(built, linearised(Method::Rk4), 2.0 * PI / omega / f64::from(STEPS));
        for _ in 0..STEPS {
            sim.take_step().expect("stable");
            let (x, t) = (sim.positions(), sim.time());
            free.clone().for_each(|i| {
                worst.compare(AMPLITUDE, &x[i].to_array(), &[place(i, t), 0.0, 0.0], || {
                    format!("mode {n}, mass {i}, time {t}")
                });
            });
        }
    }
    worst.check();
}

#[test]
fn modes_of_a_chain_held_at_both_ends() {
    modes("fixed-fixed", 12, false);
}

#[test]
fn modes_of_a_chain_held_at_one_end() {
    modes("fixed-free", 12, true);
}

#[test]
fn hanging_chain_stretches_by_the_closed_form() {
    const MASSES: usize = 20;
    let (mass, stiffness) = (0.05, 80.0);
    let mut net = Net::chain(MASSES + 1, DVec3::NEG_Y, mass, stiffness, 0.0);
    net.held = vec![(0, XYZ)];
    net.gravity = Some(DVec3::NEG_Y * G);
    let mut sim = Simulation::from_columns(net.build(), linearised(Method::BackwardEuler), 10.0);
    settle(&mut sim, 1e-14, 30);
    let mut worst = Worst::new("hanging chain: u_i = (m g / k) (i N - i (i - 1) / 2)", 1e-12);
    for (i, x) in sim.positions().iter().enumerate() {
        let (n, i) = (MASSES as f64, i as f64);
        let stretched = i + mass * G / stiffness * (i * n - i * (i - 1.0) / 2.0);
        worst.compare(stretched.max(1.0), &x.to_array(), &[0.0, -stretched, 0.0], || format!("mass {i}"));
    }
    worst.check();
}

/// Checks that the error falls with the square of the number of links.
fn second_order(what: &str, error: impl Fn(usize) -> f64) {
    let errors = [16, 32, 64].map(error);
    let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
    println!("{what}: orders {orders:.3?}, errors {errors:?}");
    assert!(
        orders.iter().all(|p| (p - 2.0).abs() <= 0.05),
        "{what}: orders {orders:.3?}, expected 2; errors {errors:?}"
    );
}

/// The slowest mode of a hanging rope is J0(2 omega sqrt(s / g)) at the height s above its free end.
#[test]
fn rope_swings_at_the_root_of_the_bessel_function() {
    const FREQUENCY: f64 = 1.2024128;
    let measured = |links: usize| {
        let mass = 0.3 / links as f64;
        let rest = 1.0 / links as f64;
        let mut net = Net::chain(links + 1, DVec3::NEG_Y * rest, mass, 1e6 * 0.3 * G / rest, 0.0);
        net.masses[links] *= 0.5;
        net.held = vec![(0, XYZ)];
        net.gravity = Some(DVec3::NEG_Y * G);
        let mut sim = Simulation::from_columns(net.build(), linearised(Method::BackwardEuler), 10.0);
        settle(&mut sim, 1e-13, 30);
        let shape: Vec<_> = (0..=links).map(|i| bessel(FREQUENCY * FREQUENCY * (1.0 - i as f64 * rest))).collect();
        // The amplitude is small, so that the swing is linear: the links, a million times stiffer than the
        // weight, strain by at most 1e-6.
        let built = {
            let mut built = sim.scene().clone();
            built.particles.velocities.fill(DVec3::ZERO);
            (1..=links).for_each(|i| built.particles.positions[i].x = 1e-6 * shape[i]);
            built
        };
        let h = 0.005;
        let mut sim = Simulation::from_columns(built, linearised(Method::ImplicitMidpoint), h);
        let mut swing = || -> f64 {
            sim.take_step().expect("finite");
            sim.positions().iter().zip(&shape).zip(&net.masses).map(|((x, s), m)| x.x * s * m).sum()
        };
        // Times at which the amplitude of the mode changes its sign: they are half a period apart.
        let (mut before, mut time, mut roots) = (1.0, 0.0, Vec::new());
        while roots.len() < 2 {
            let now = swing();
            if before * now < 0.0 {
                roots.push(time + h * before / (before - now));
            }
            (before, time) = (now, time + h);
        }
        let turned = PI / (roots[1] - roots[0]);
        // Implicit midpoint turns the phase by 2 atan(omega h / 2) per step.
        2.0 / h * (turned * h / 2.0).tan() / G.sqrt()
    };
    second_order("frequency of a swinging rope over sqrt(g / L)", |links| measured(links) - FREQUENCY);
    let (coarse, fine) = (measured(16), measured(32));
    let extrapolated = fine + (fine - coarse) / 3.0;
    println!("frequency extrapolated to no links: {extrapolated:.7}, expected {FREQUENCY}");
    assert!((extrapolated - FREQUENCY).abs() <= 1e-5, "extrapolated {extrapolated:.7}, expected {FREQUENCY}");
}

/// J0(2 sqrt(u)).
fn bessel(u: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..20 {
        term *= -u / f64::from(k * k);
        sum += term;
    }
    sum
}
