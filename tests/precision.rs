//! The f32 core follows the f64 core: forces, energies and Jacobians of the same states, which are exact in
//! both, agree within a few roundings of the terms that they are computed from.
//!
//! Run: `cargo test -p muslin-tests --test precision`; with `-- --nocapture` it prints the worst difference of
//! every comparison, relative to the largest of: the value; stiffness x size, because a force near rest is a small
//! difference of terms of that size; and the Jacobian times the velocities, because a damping force sums such terms.
//! A failure names the element, the component and both values.

use std::fmt::Debug;

use glam::{DMat3, DVec3};
use harness::dense::{Dense, from_blocks, size};
use harness::kit::{double, single};
use harness::rng::Rng;
use harness::states::{self, State, bar, hinge, many, single3, stitch, triangle};
use harness::worst::{Worst, norm};
use muslin_core::dispatch::Serial;
use muslin_core::forces;
use muslin_core::forces::element::Element as Single;
use muslin_core::particles::Positions;
use muslin_core::real::{Vec3, to_f64, vec3};
use muslin_core_f64::forces::element::Element as Double;

/// Number of elements in each regime.
const COUNT: usize = 500;

/// About thirty roundings of 6e-8.
const BOUND: f64 = 2e-6;

/// Compares all results of two terms for the same elements. `stiffness` is the scale of the terms that forces
/// sum, N/m (N m / m^2 for hinges, N s/m for wind).
fn follows<const K: usize, const N: usize, P: Debug>(
    single: impl Fn(usize, &State<P, K>) -> Said<K>,
    double: impl Fn(usize, &State<P, K>) -> Said<K>,
    states: &[State<P, K>],
    stiffness: impl Fn(&State<P, K>) -> f64,
) {
    let mut forces = Worst::new("force in f32 against f64", BOUND);
    let mut energies = Worst::new("energy in f32 against f64", BOUND);
    let mut projected = Worst::new("projected Jacobian in f32 against f64", BOUND);
    let mut exact = Worst::new("exact Jacobian in f32 against f64", BOUND);
    for (i, s) in states.iter().enumerate() {
        let (single, double, stiffness) = (single(i, s), double(i, s), stiffness(s));
        let damped = size(&from_blocks::<K, N>(&double.projected)) * norm(&s.v);
        let scale = norm(&double.force).max(damped).max(stiffness * s.size);
        forces.vectors(scale, &single.force, &double.force, || s.place(i));
        let scale = double.energy.max(stiffness * s.size * s.size);
        energies.compare(scale, &[single.energy], &[double.energy], || s.place(i));
        for (worst, got, want) in
            [(&mut projected, single.projected, double.projected), (&mut exact, single.exact, double.exact)]
        {
            let [got, want]: [Dense<N>; 2] = [from_blocks(&got), from_blocks(&want)];
            worst.compare(size(&want).max(stiffness), got.as_flattened(), want.as_flattened(), || s.place(i));
        }
    }
    for worst in [forces, energies, projected, exact] {
        worst.check();
    }
}

/// All results of a term for one element.
struct Said<const K: usize> {
    force: [DVec3; K],
    energy: f64,
    projected: [[DMat3; K]; K],
    exact: [[DMat3; K]; K],
}

/// Elastic and damping parts are equally large: corners move by about one element size per second.
const SCALE: [f64; 2] = [1.0, 1.0];

fn in_single<P, const K: usize>(term: &impl Single<K>) -> impl Fn(usize, &State<P, K>) -> Said<K> {
    |i, s| Said {
        force: single::force(term, i, &s.x, &s.v),
        energy: single::energy(term, i, &s.x),
        projected: single::projected(term, i, &s.x, SCALE),
        exact: single::exact(term, i, &s.x, &s.v, SCALE),
    }
}

fn in_double<P, const K: usize>(term: &impl Double<K>) -> impl Fn(usize, &State<P, K>) -> Said<K> {
    |i, s| Said {
        force: double::force(term, i, &s.x, &s.v),
        energy: double::energy(term, i, &s.x),
        projected: double::projected(term, i, &s.x, SCALE),
        exact: double::exact(term, i, &s.x, &s.v, SCALE),
    }
}

#[test]
fn springs_follow() {
    let states = many(111, COUNT, bar);
    let (single, double) = (single::bars(&states), double::bars(&states));
    follows::<2, 6, _>(in_single(&single), in_double(&double), &states, |s| s.part.stiffness);
}

#[test]
fn membranes_follow() {
    let states = many(112, COUNT, triangle);
    let (single, double) = (single::membrane(&states), double::membrane(&states));
    let stiffness = |s: &State<states::Triangle, 3>| s.part.stiffness.into_iter().fold(0.0, f64::max);
    follows::<3, 9, _>(in_single(&single.view()), in_double(&double.view()), &states, stiffness);
}

#[test]
fn hinges_follow() {
    let states = many(113, COUNT, hinge);
    let (single, double) = (single::hinges(&states), double::hinges(&states));
    let stiffness = |s: &State<states::Fold, 4>| s.part.stiffness / (s.size * s.size);
    follows::<4, 12, _>(in_single(&single.view()), in_double(&double.view()), &states, stiffness);
}

#[test]
fn seams_follow() {
    let states = many(114, COUNT, stitch);
    let (single, double) = (single::seams(&states), double::seams(&states));
    follows::<3, 9, _>(in_single(&single.view()), in_double(&double.view()), &states, |s| s.part.stiffness);
}

#[test]
fn wind_follows() {
    let states = many(115, COUNT, triangle);
    let (wind, drag) = (DVec3::new(0.75, -0.25, 0.5), [0.625, 0.0625]);
    let (single, double) = (single::wind(&states, wind, drag), double::wind(&states, wind, drag));
    follows::<3, 9, _>(in_single(&single.view()), in_double(&double.view()), &states, |s| s.size);
}

const SCENE: &str = r#"
    name = "everything"
    duration = 0
    gravity = [1.0, -9.81, 2.0]
    [[cloth]]
    grid = { size = [1.0, 1.0], cells = [40, 46] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 2000.0, damping = 0.001 }
    shear = { stiffness = 500.0 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.001 }
    [[cloth]]
    grid = { size = [1.0, 1.0], cells = [40, 46] }
    density = 0.3
    stretch = { model = "spring", stiffness = 2000.0, damping = 0.001 }
    bend = { model = "spring", stiffness = 1.0 }
    [drag]
    linear = 0.01
    wind = { velocity = [3.0, -1.0, 2.0], normal = 0.6, tangential = 0.07 }
"#;

/// A sheet of 1 m with cells of 25 mm, crumpled by a tenth of a cell: each vertex sums six elements whose terms
/// have the size 2000 N/m x 25 mm.
#[test]
fn forces_and_energies_of_a_scene_follow() {
    let (single_scene, double_scene, rng) = (single::build(SCENE), double::build(SCENE), &mut Rng::new(116));
    let x: Vec<_> = single::positions(&single_scene).iter().map(|&x| single3(x + rng.cube(0.0025))).collect();
    let v: Vec<_> = x.iter().map(|_| single3(rng.cube(0.1))).collect();
    let (single_model, double_model) = (single_scene.model.view(), double_scene.model.view());
    let mut worst = Worst::new("force of a scene in f32 against f64", BOUND);
    let got = single::forces(&single_model, &single_scene.particles.masses, &x, &v);
    let want = double::forces(&double_model, &double_scene.particles.masses, &x, &v);
    worst.vectors(2000.0 * 0.025, &got, &want, || "vector a vertex".into());
    worst.check();
    println!("  against a mean force of {:.1e} N", norm(&want) / (want.len() as f64).sqrt());
    let mut worst = Worst::new("energy of a scene in f32 against f64, itself", BOUND);
    let got = single::energies(&single_model, &single_scene.particles.masses, &x);
    let want = double::energies(&double_model, &double_scene.particles.masses, &x);
    for (what, got, want) in [
        ("stretch", got.stretch, want.stretch),
        ("shear", got.shear, want.shear),
        ("bend", got.bend, want.bend),
        ("gravity", got.gravity, want.gravity),
    ] {
        worst.compare(want, &[got], &[want], || what.into());
    }
    worst.check();
}

/// The same scene 30 m from the origin, where the last digit of a position strains its cells by 4e-5: forces and
/// energies see the rounding errors of the positions, and are as exact as at the origin.
#[test]
fn forces_and_energies_far_from_the_origin_follow() {
    let (single_scene, double_scene, rng) = (single::build(SCENE), double::build(SCENE), &mut Rng::new(117));
    let far = DVec3::new(30.0, -20.0, 10.0);
    let places: Vec<_> = single::positions(&single_scene).iter().map(|&x| x + far + rng.cube(0.0025)).collect();
    let rounded: Vec<Vec3> = places.iter().map(|&x| vec3(x.to_array())).collect();
    let low: Vec<Vec3> =
        places.iter().zip(&rounded).map(|(&x, &r)| vec3((x - DVec3::from(to_f64(r))).into())).collect();
    let x = Positions { rounded: &rounded, low: &low };
    let (single_model, masses) = (single_scene.model.view(), &single_scene.particles.masses);
    let double_model = double_scene.model.view();
    let (still, mut scratch) = (vec![Vec3::ZERO; low.len()], vec![Vec3::ZERO; single_model.force_scratch()]);
    let mut forces = still.clone();
    forces::evaluate(&single_model, masses, x, &still, &mut scratch, &mut forces, &Serial);
    let got: Vec<DVec3> = forces.iter().map(|&f| to_f64(f).into()).collect();
    let want = double::forces(&double_model, &double_scene.particles.masses, &places, &vec![DVec3::ZERO; places.len()]);
    let mut worst = Worst::new("force far from the origin in f32 against f64", BOUND);
    worst.vectors(2000.0 * 0.025, &got, &want, || "vector a vertex".into());
    worst.check();
    let got = forces::energy(&single_model, masses, x);
    let want = double::energies(&double_model, &double_scene.particles.masses, &places);
    let mut worst = Worst::new("energy far from the origin in f32 against f64, itself", BOUND);
    for (what, got, want) in
        [("stretch", got.stretch, want.stretch), ("shear", got.shear, want.shear), ("bend", got.bend, want.bend)]
    {
        worst.compare(want, &[got], &[want], || what.into());
    }
    worst.check();
}

/// A stiff sheet that flies 37 m without forces stays undeformed: its vertices keep the same velocity, to some of its
/// digits. The last digit of its positions would excite vibrations of 0.3 to 100 mm/s.
#[test]
fn stiff_cloth_does_not_feel_the_last_digit_of_its_positions() {
    let start = Vec3::new(30.0, 20.0, -10.0);
    for method in ["backward-euler", "implicit-midpoint", "bdf2"] {
        let mut sim = single::simulation(
            &format!(
                "duration = 1.0\n[integrator]\nmethod = \"{method}\"\n[[cloth]]\n\
                 grid = {{ size = [1.0, 1.0], cells = [16, 16] }}\ndensity = 0.2\nvelocity = [30.0, 20.0, -10.0]\n\
                 stretch = {{ model = \"membrane\", stiffness = 2e5 }}\nshear = {{ stiffness = 5e4 }}\n\
                 bend = {{ model = \"hinge\", rigidity = 1e-4 }}\n"
            ),
            &[],
        );
        single::run(&mut sim, 1.0, |_| ());
        let change = sim.velocities().iter().map(|&v| (v - start).length()).fold(0.0, f32::max);
        println!("{method}: velocities change by {change:.1e} m/s");
        assert!(change < 10.0 * start.length() * f32::EPSILON, "{method}: velocities change by {change:e} m/s");
    }
}

#[test]
fn square_roots_are_rounded_correctly() {
    let mut rng = Rng::new(7);
    let special = [0.0, -0.0, 1.0, -1.0, f64::INFINITY, f64::NAN, f64::MIN_POSITIVE, 5e-324];
    // Bits drawn at random give all exponents, subnormal numbers included.
    let random = (0..100_000).map(|_| f64::from_bits(rng.bits()));
    for x in special.into_iter().chain(random) {
        let (root, expected) = (muslin_core_f64::real::sqrt(x), x.sqrt());
        assert!(
            root.to_bits() == expected.to_bits() || root.is_nan() && expected.is_nan(),
            "f64: {x:e} gives {root:e}"
        );
        let x = f32::from_bits((x.to_bits() >> 32) as u32);
        let (root, expected) = (muslin_core::real::sqrt(x), x.sqrt());
        assert!(
            root.to_bits() == expected.to_bits() || root.is_nan() && expected.is_nan(),
            "f32: {x:e} gives {root:e}"
        );
    }
}
