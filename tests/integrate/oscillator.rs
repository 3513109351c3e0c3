//! One mass on a spring, x'' = -w^2 x - 2 zeta w x' with w = 1, so that z = h. The spring's force is linear
//! along its axis, so every method must follow its closed form at any amplitude.

use glam::{DVec2, DVec3};
use harness::net::{Net, XYZ, linearised};
use harness::oscillator::update;
use harness::worst::Worst;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::{Simulation, State};

/// Bound on the error of energies and amplitudes after one step; rounding is 1e-14.
const STEP: f64 = 1e-10;
/// Long enough that no stage passes through the held end; RK4 at z = 1.9, zeta = 2 has the largest stages.
const LENGTH: f64 = 4.0;
const AMPLITUDE: f64 = 0.25;
const SPANS: [f64; 6] = [0.01, 0.05, 0.1, 0.5, 1.0, 1.9];
const LARGE_SPANS: [f64; 2] = [5.0, 100.0];
const DAMPING_RATIOS: [f64; 6] = [0.0, 0.01, 0.1, 0.5, 1.0, 2.0];
const ONE_STEP: [Method; 6] = [
    Method::ExplicitEuler,
    Method::SymplecticEuler,
    Method::Midpoint,
    Method::Rk4,
    Method::BackwardEuler,
    Method::ImplicitMidpoint,
];

/// Vertex 1 on a spring along x; vertex 0 is held.
fn oscillator(method: Method, z: f64, zeta: f64) -> Simulation {
    let mut net = Net::chain(2, DVec3::X * LENGTH, 1.0, 1.0, 2.0 * zeta);
    net.held = vec![(0, XYZ)];
    Simulation::from_columns(net.build(), linearised(method), z)
}

fn set(sim: &mut Simulation, state: DVec2) {
    let (x, v) = sim.state_mut();
    x[1] = DVec3::X * (LENGTH + state.x);
    v[1] = DVec3::X * state.y;
}

/// Displacement and velocity.
fn get(sim: &Simulation) -> DVec2 {
    DVec2::new(sim.positions()[1].x - LENGTH, sim.velocities()[1].x)
}

fn step(sim: &mut Simulation) {
    sim.take_step().expect("an oscillator stays finite");
}

fn energy(state: DVec2) -> f64 {
    0.5 * state.length_squared()
}

/// States on a circle in phase space.
fn starts() -> impl Iterator<Item = DVec2> {
    (0..7).map(|i| DVec2::from_angle(0.9 * f64::from(i)) * AMPLITUDE)
}

fn spans(method: Method) -> impl Iterator<Item = f64> {
    SPANS.into_iter().chain(LARGE_SPANS.into_iter().filter(move |_| method.is_implicit()))
}

fn damping_ratios(method: Method, z: f64) -> impl Iterator<Item = f64> {
    DAMPING_RATIOS.into_iter().filter(move |zeta| method.is_implicit() || zeta * z <= 2.0)
}

#[test]
fn one_step_methods_multiply_by_their_matrix() {
    for method in ONE_STEP {
        let mut worst = Worst::new(format!("{}: one step", method.name()), STEP);
        for z in spans(method) {
            for zeta in damping_ratios(method, z) {
                let mut sim = oscillator(method, z, zeta);
                for start in starts() {
                    set(&mut sim, start);
                    step(&mut sim);
                    let want = update(method, z, zeta) * start;
                    let place = || format!("z {z}, zeta {zeta}, start {start}");
                    worst.compare(AMPLITUDE, &get(&sim).to_array(), &want.to_array(), place);
                }
            }
        }
        worst.check();
    }
}

#[test]
fn undamped_energy_factors_are_the_closed_forms() {
    let factors = [
        (Method::ExplicitEuler, (|z| 1.0 + z.powi(2)) as fn(f64) -> f64),
        (Method::Midpoint, |z| 1.0 + z.powi(4) / 4.0),
        (Method::Rk4, |z| 1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0),
        (Method::BackwardEuler, |z| 1.0 / (1.0 + z.powi(2))),
        (Method::ImplicitMidpoint, |_| 1.0),
    ];
    for (method, factor) in factors {
        let mut worst = Worst::new(format!("{}: energy factor of a step", method.name()), STEP);
        for z in spans(method) {
            let mut sim = oscillator(method, z, 0.0);
            for start in starts() {
                set(&mut sim, start);
                step(&mut sim);
                let (got, core) = (energy(get(&sim)) / energy(start), sim.energy().total() / energy(start));
                worst.compare(1.0, &[got, core], &[factor(z); 2], || format!("z {z}, start {start}"));
            }
        }
        worst.check();
    }
}

#[test]
fn symplectic_euler_conserves_its_own_energy() {
    let mut worst = Worst::new("symplectic-euler: v^2/2 + x^2/2 - h x v/2 over 1000 steps", STEP);
    for z in SPANS {
        let invariant = |s: DVec2| energy(s) - 0.5 * z * s.x * s.y;
        let mut sim = oscillator(Method::SymplecticEuler, z, 0.0);
        for start in starts() {
            set(&mut sim, start);
            for n in 0..1000 {
                step(&mut sim);
                let place = || format!("z {z}, start {start}, step {n}");
                worst.compare(energy(start), &[invariant(get(&sim))], &[invariant(start)], place);
            }
        }
    }
    worst.check();
}

#[test]
fn backward_euler_damps_by_its_closed_form() {
    let mut worst = Worst::new("backward-euler: squared amplification 1 / (1 + 2 zeta z + z^2)", STEP);
    for z in spans(Method::BackwardEuler) {
        for zeta in DAMPING_RATIOS.into_iter().filter(|&zeta| zeta < 1.0) {
            let mut sim = oscillator(Method::BackwardEuler, z, zeta);
            // |v - conj(lambda) x|^2 with |lambda| = 1, Re lambda = -zeta: the squared amplitude of one mode.
            let amplitude = |s: DVec2| s.length_squared() + 2.0 * zeta * s.x * s.y;
            for start in starts() {
                set(&mut sim, start);
                step(&mut sim);
                let want = 1.0 / (1.0 + 2.0 * zeta * z + z * z);
                let got = amplitude(get(&sim)) / amplitude(start);
                worst.compare(1.0, &[got], &[want], || format!("z {z}, zeta {zeta}, start {start}"));
            }
        }
    }
    worst.check();
}

/// y = x - i v turns as y' = i y, so a step of BDF2 multiplies it by a root of
/// (3/2 - i z) xi^2 - 2 xi + 1/2 = 0.
#[test]
fn bdf2_follows_its_characteristic_polynomial() {
    let mut worst = Worst::new("bdf2: amplification over 3 steps", STEP);
    for z in spans(Method::Bdf2) {
        // The principal root; the other root decays at least by half per step.
        let (a, turn) = (DVec2::new(1.5, -z), complex_root(DVec2::new(1.0, 2.0 * z)));
        let root = divide(DVec2::new(2.0, 0.0) + turn, a * 2.0);
        let mut sim = oscillator(Method::Bdf2, z, 0.0);
        for start in starts() {
            let mut y = DVec2::new(start.x, -start.y);
            let changed = y - divide(y, root);
            let (held, low) = (DVec3::ZERO, [DVec3::ZERO; 2]);
            let (x, v) = ([held, DVec3::X * (LENGTH + y.x)], [held, DVec3::X * -y.y]);
            let (displacements, velocity_changes) = ([held, DVec3::X * changed.x], [held, DVec3::X * -changed.y]);
            let state = State {
                steps: 1,
                origin: [0.0; 3],
                positions: &x,
                velocities: &v,
                low: [&low; 2],
                previous: [&displacements, &velocity_changes],
                last_step: z,
                halvings: 0,
                after_contact: false,
                multipliers: &[],
                anchors: &[],
            };
            assert!(sim.restore(&state, sim.statistics(), sim.contact_statistics()));
            for n in 0..3 {
                step(&mut sim);
                y = root.rotate(y);
                let (got, want) = (get(&sim), DVec2::new(y.x, -y.y));
                let place = || format!("z {z}, start {start}, step {n}, root {root}");
                worst.compare(AMPLITUDE, &got.to_array(), &want.to_array(), place);
            }
        }
    }
    worst.check();
}

fn divide(a: DVec2, b: DVec2) -> DVec2 {
    DVec2::new(b.x, -b.y).rotate(a) / b.length_squared()
}

/// The root with positive real part; `y` must not be negative.
fn complex_root(a: DVec2) -> DVec2 {
    let r = a.length();
    DVec2::new(((r + a.x) / 2.0).sqrt(), ((r - a.x) / 2.0).sqrt())
}

/// The first BDF2 step has no history and is implicit midpoint: it keeps the energy.
#[test]
fn bdf2_starts_with_implicit_midpoint() {
    for z in SPANS {
        let (mut a, mut b) = (oscillator(Method::Bdf2, z, 0.1), oscillator(Method::ImplicitMidpoint, z, 0.1));
        set(&mut a, DVec2::X * AMPLITUDE);
        set(&mut b, DVec2::X * AMPLITUDE);
        step(&mut a);
        step(&mut b);
        assert_eq!(get(&a), get(&b), "bdf2: first step at z {z} against implicit midpoint");
    }
}

/// The published table of energies after a period 2 pi / w, to the published digits.
#[test]
fn energy_kept_per_period_is_the_published_table() {
    let z = [0.01, 0.05, 0.1, 0.5, 1.0];
    let table = [
        (Method::BackwardEuler, [0.9391, 0.7307, 0.5352, 0.0606, 0.0128], [5e-5; 5]),
        (Method::Midpoint, [1.57e-6, 1.96e-4, 1.57e-3, 0.215, 3.06], [5e-9, 5e-7, 5e-6, 5e-4, 5e-3]),
        (Method::Rk4, [-8.7e-12, -2.7e-8, -8.7e-7, -0.00264, -0.0739], [3e-13, 5e-10, 5e-9, 5e-6, 5e-5]),
        (Method::ImplicitMidpoint, [1.0; 5], [1e-10; 5]),
    ];
    for (method, published, rounding) in table {
        // Where the published value is the growth, it is the energy minus 1.
        let offset = if published[0] < 0.5 { 1.0 } else { 0.0 };
        for ((z, want), rounding) in z.into_iter().zip(published).zip(rounding) {
            let mut sim = oscillator(method, z, 0.0);
            set(&mut sim, DVec2::X * AMPLITUDE);
            let period = std::f64::consts::TAU / z;
            let steps = period.ceil();
            for _ in 0..steps as u32 {
                step(&mut sim);
            }
            // A period is not a whole number of steps, but every step has the same factor.
            let kept = (energy(get(&sim)) / energy(DVec2::X * AMPLITUDE)).powf(period / steps) - offset;
            println!("{} z {z}: kept {kept:.6e} beyond {offset}, published {want:e}", method.name());
            assert!(
                (kept - want).abs() <= rounding,
                "{} at z {z}: energy per period beyond {offset} is {kept:e}, expected {want:e}",
                method.name()
            );
        }
    }
}
