//! Stability: the steps at which explicit methods become unstable. `muslin validate` tests how the fastest
//! frequency grows with the mesh and how compression affects the implicit matrix.
//!
//! Run: `cargo test -p muslin-tests --test stability`; with `-- --nocapture` it prints the measured limits beside
//! the theory.

use glam::DVec3;
use harness::net::{Net, XYZ, linearised};
use harness::oscillator::{spectral_radius, stable_limit, update};
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::integrate::stability::{self, Mode};
use muslin_core_f64::integrate::{Jacobian, Method};
use muslin_core_f64::simulation::Simulation;
use muslin_core_f64::spectrum::{Tangent, fastest_modes};

const EXPLICIT: [Method; 4] = [Method::ExplicitEuler, Method::SymplecticEuler, Method::Midpoint, Method::Rk4];

/// Damping ratios, then the published limits on z = omega h for explicit Euler, symplectic Euler, midpoint and
/// RK4.
const RATIOS: [f64; 8] = [0.0, 0.01, 0.05, 0.1, 0.3, 0.5, 1.0, 2.0];
const LIMITS: [[f64; 8]; 4] = [
    [0.0, 0.02, 0.1, 0.2, 0.6, 1.0, 2.0, 0.536],
    [2.0, 1.980, 1.9025, 1.810, 1.488, 1.236, 0.828, 0.472],
    [0.0, 0.444, 0.800, 1.050, 1.647, 2.0, 2.0, 0.536],
    [2.828, 2.849, 2.910, 2.951, 2.835, 2.6225, 2.785, 0.746],
];

/// Rounding of the published table.
const DIGITS: f64 = 6e-4;

#[test]
fn limits_of_one_oscillator_are_the_published_table() {
    for (method, published) in EXPLICIT.into_iter().zip(LIMITS) {
        for (zeta, want) in RATIOS.into_iter().zip(published) {
            let limit = stable_limit(method, zeta);
            println!("{} at zeta {zeta}: limit {limit:.4}, published {want}", method.name());
            assert!(
                (limit - want).abs() <= DIGITS,
                "{} at zeta {zeta}: limit {limit}, published {want}",
                method.name()
            );
        }
    }
}

/// The core finds the limits in the complex plane of the eigenvalue, the harness from the matrix of a step.
#[test]
fn longest_steps_are_the_limits_of_one_oscillator() {
    let omega = 40.0;
    for (method, zeta) in EXPLICIT.into_iter().flat_map(|m| RATIOS.map(|zeta| (m, zeta))) {
        let mode = Mode { stiffness: omega * omega, damping: 2.0 * zeta * omega };
        let (step, want) = (mode.longest_step(method), stable_limit(method, zeta) / omega);
        let never = zeta == 0.0 && matches!(method, Method::ExplicitEuler | Method::Midpoint);
        let want = if never { 0.0 } else { want };
        let near = step.is_some_and(|step| (step - want).abs() <= 1e-6 * want);
        assert!(near, "{} at zeta {zeta}: longest step {step:?}, of the oscillator {want}", method.name());
    }
    for method in [Method::BackwardEuler, Method::ImplicitMidpoint, Method::Bdf2] {
        assert_eq!(Mode { stiffness: 1e9, damping: 0.0 }.longest_step(method), None, "{}", method.name());
    }
    let still = Mode { stiffness: 0.0, damping: 0.0 };
    assert!(EXPLICIT.iter().all(|&method| still.longest_step(method).is_none()), "nothing limits a mode at rest");
    let drag = Mode { stiffness: 0.0, damping: 50.0 };
    let longest = stability::longest_step(&[still, drag], Method::Rk4).expect("limited by drag");
    assert!((longest * 50.0 - 2.785_293_563_405).abs() < 1e-9, "RK4 reaches to -2.7853 on the real axis: {longest}");
}

/// Two masses on a spring: omega^2 = 2 k / m, or k / m if one mass is held; the damping has the same factors.
#[test]
fn fastest_modes_leave_out_what_is_held() {
    let (mass, stiffness, damper) = (0.3, 40.0, 0.8);
    let mut net = Net::chain(2, DVec3::X, mass, stiffness, damper);
    for (held, factor) in [(vec![], 2.0 / mass), (vec![(0, XYZ)], 1.0 / mass)] {
        net.held = held;
        for mode in fastest_modes(&net.build(), 1e-12, 10_000, &Serial) {
            let near = |got: f64, want: f64| (got / want - 1.0).abs() < 1e-9;
            let right = near(mode.stiffness, factor * stiffness) && near(mode.damping, factor * damper);
            assert!(right, "{mode:?}, expected {factor} of {stiffness} N/m and {damper} N s/m");
        }
    }
}

/// A stiff spring without a damper and, beyond a held mass, a soft spring with a strong damper: the damper
/// limits the step.
#[test]
fn the_most_damped_mode_limits_steps_too() {
    let mut net = Net::chain(3, DVec3::X, 1.0, 100.0, 0.0);
    net.held = vec![(1, XYZ)];
    net.springs[1].1.stiffness = 1e-6;
    net.springs[1].1.damping = 500.0;
    let modes = fastest_modes(&net.build(), 1e-12, 10_000, &Serial);
    assert!((modes[0].stiffness - 100.0).abs() < 1e-9 && modes[0].damping == 0.0, "the stiff one: {:?}", modes[0]);
    assert!((modes[1].damping - 500.0).abs() < 1e-9, "the damped one: {:?}", modes[1]);
    let longest = stability::longest_step(&modes, Method::SymplecticEuler).expect("limited");
    assert!((longest - 2.0 / 500.0).abs() < 1e-9, "2 / 500 s, got {longest} s");
}

/// Vertices along a side of the cloth.
const SIDE: u32 = 16;
/// Structural, shear and bending springs, N/m, on masses of 1 kg.
const SPRINGS: [f64; 3] = [1.0, 0.5, 0.1];

/// Whether the energy grows tenfold within 2000 steps.
fn blows_up(method: Method, omega: f64, mode: &[DVec3], damping: f64, step: f64) -> bool {
    let mut built = Net::lattice(SIDE, SPRINGS, damping).build();
    let particles = &mut built.particles;
    for ((x, v), &e) in particles.positions.iter_mut().zip(&mut particles.velocities).zip(mode) {
        // Small, so that springs stay linear. Displacement and velocity are in phase: there a stable symplectic
        // orbit has its largest energy, so that the energy cannot grow later.
        *x += e * 1e-5;
        *v += e * 1e-5 * omega;
    }
    let mut sim = Simulation::from_columns(built, linearised(method), step);
    let start = sim.energy().total();
    for _ in 0..2000 {
        sim.take_step().expect("finite below tenfold energy");
        let energy = sim.energy().total();
        if energy > 10.0 * start {
            return true;
        }
        // The rest is rounding.
        if energy < 1e-9 * start {
            return false;
        }
    }
    false
}

#[test]
fn critical_steps_are_those_of_theory() {
    let undamped = Net::lattice(SIDE, SPRINGS, 0.0).build();
    let (lambda, mode) =
        Tangent::of(&undamped, 1.0, 0.0, Jacobian::Exact, &Serial).fastest_mode(1e-12, 100_000, &Serial);
    let omega = lambda.sqrt();
    for method in EXPLICIT {
        for zeta in [0.0, 0.3, 0.5, 0.7] {
            // These are never stable: see `undamped_growth_is_exact`.
            if zeta == 0.0 && matches!(method, Method::ExplicitEuler | Method::Midpoint) {
                continue;
            }
            let theory = stable_limit(method, zeta) / omega;
            let damping = 2.0 * zeta / omega;
            let blows_up = |ratio: f64| blows_up(method, omega, &mode, damping, ratio * theory);
            let what = format!("{} at zeta {zeta}: critical step over theory", method.name());
            let (mut low, mut high) = (0.9, 1.1);
            assert!(!blows_up(low), "{what}: below 0.9");
            assert!(blows_up(high), "{what}: above 1.1");
            while high - low > 1e-3 {
                let middle = 0.5 * (low + high);
                if blows_up(middle) { high = middle } else { low = middle }
            }
            println!("{what}: {low:.4} to {high:.4}");
            assert!(low >= 0.995 && high <= 1.005, "{what}: between {low} and {high}, expected 1 within 0.5 %");
        }
    }
}

/// Without damping, explicit Euler and midpoint have no stable step: the energy of the fastest mode grows by
/// the factor 1 + z^2 or 1 + z^4 / 4 in each step, at any z.
#[test]
fn undamped_growth_is_exact() {
    let undamped = Net::lattice(SIDE, SPRINGS, 0.0).build();
    let (lambda, mode) =
        Tangent::of(&undamped, 1.0, 0.0, Jacobian::Exact, &Serial).fastest_mode(1e-12, 100_000, &Serial);
    let spans = [0.05, 0.5, 1.0];
    for (method, z) in [Method::ExplicitEuler, Method::Midpoint].into_iter().flat_map(|m| spans.map(|z| (m, z))) {
        let want = spectral_radius(update(method, z, 0.0)).powi(2);
        let mut built = undamped.clone();
        built.particles.positions.iter_mut().zip(&mode).for_each(|(x, &e)| *x += e * 1e-5);
        let mut sim = Simulation::from_columns(built, linearised(method), z / lambda.sqrt());
        for n in 0..20 {
            let before = sim.energy().total();
            sim.take_step().expect("finite");
            let factor = sim.energy().total() / before;
            // The mode's vector is accurate to 1e-6, so other modes contribute 1e-12 of the energy.
            assert!(
                (factor - want).abs() <= 1e-5,
                "{} at z {z}, step {n}: energy factor {factor}, expected {want}",
                method.name()
            );
        }
    }
}
