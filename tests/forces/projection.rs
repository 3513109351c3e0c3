//! Projected Jacobians, in f64: equal to the exact Jacobian where it is positive semidefinite; equal to its
//! eigenvalue clamp for springs and for the membrane's two energies; equal to ke grad grad^T for hinges. They
//! are never indefinite on 1,000,000 random states (400,000 springs, 400,000 membrane triangles, 200,000
//! hinges).

use glam::{DVec2, DVec3};
use harness::dense::{Dense, clamped, from_blocks, least_pivot, size};
use harness::differences::slope;
use harness::kit::double as kit;
use harness::rng::Rng;
use harness::states::{State, Triangle, bar, hinge, many, stitch, triangle};
use harness::worst::Worst;
use muslin_core_f64::forces::TangentScale;
use muslin_core_f64::forces::element::Element;
use muslin_core_f64::forces::spring::{self, Spring};
use muslin_core_f64::real::outer;

const COUNT: usize = 500;
const STILL: [f64; 2] = [1.0, 0.0];
/// Both sides are a few products; the eigenvalue solver converges to rounding.
const ROUNDING: f64 = 1e-12;

#[test]
fn projected_spring_is_the_clamp_of_the_exact_one() {
    let states = many(31, COUNT, bar);
    let term = kit::bars(&states);
    let mut worst = Worst::new("projected spring block against the clamp", ROUNDING);
    for (i, s) in states.iter().enumerate() {
        let exact: Dense<3> = from_blocks(&[[kit::exact(&term, i, &s.x, &[DVec3::ZERO; 2], STILL)[0][0]]]);
        let projected: Dense<3> = from_blocks(&[[kit::projected(&term, i, &s.x, STILL)[0][0]]]);
        worst.compare(size(&exact), projected.as_flattened(), clamped(&exact).as_flattened(), || s.place(i));
    }
    worst.check();
}

#[test]
fn projected_spring_is_exact_when_stretched() {
    let states: Vec<_> = many(32, COUNT, bar).into_iter().filter(|s| s.x[0].distance(s.x[1]) > s.part.rest).collect();
    let term = kit::bars(&states);
    let mut worst = Worst::new("projected against exact blocks of a stretched spring", 1e-15);
    for (i, s) in states.iter().enumerate() {
        let exact: Dense<6> = from_blocks(&kit::exact(&term, i, &s.x, &[DVec3::ZERO; 2], [1.0, 1.0]));
        let projected: Dense<6> = from_blocks(&kit::projected(&term, i, &s.x, [1.0, 1.0]));
        worst.compare(size(&exact), projected.as_flattened(), exact.as_flattened(), || s.place(i));
    }
    worst.check();
}

/// Triangles whose corners 1 and 2 are wu and wv themselves. The blocks of these corners are then the second
/// derivative with respect to (wu; wv), times the area.
fn gradient_triangles(seed: u64, stiffness: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<State<Triangle, 3>> {
    let rng = &mut Rng::new(seed);
    let mut states = many(seed, COUNT, triangle);
    for s in &mut states {
        s.part.rest = [DVec2::ZERO, DVec2::X, DVec2::Y];
        s.part.stiffness = stiffness(s.part.stiffness);
        s.x = [DVec3::ZERO, rng.direction() * rng.magnitude(0.2, 3.0), rng.direction() * rng.magnitude(0.2, 3.0)];
        // Branches of the closed form: exactly at rest, and without shear.
        match rng.bits() % 8 {
            0 => s.x[1] = DVec3::X,
            1 => (s.x[1], s.x[2]) = (DVec3::X * 1.5, DVec3::Y * 0.5),
            2 => s.x[2] = s.x[1],
            3 => s.x[2] = -s.x[1],
            _ => {}
        }
    }
    states
}

fn projected_membrane_is_the_clamp(what: &str, states: &[State<Triangle, 3>]) {
    let columns = kit::membrane(states);
    let mut worst = Worst::new(format!("projected {what} against the clamp"), ROUNDING);
    for (i, s) in states.iter().enumerate() {
        let exact = kit::exact(&columns.view(), i, &s.x, &[DVec3::ZERO; 3], STILL);
        let projected = kit::projected(&columns.view(), i, &s.x, STILL);
        let [exact, projected]: [Dense<6>; 2] =
            [exact, projected].map(|b| from_blocks(&[[b[1][1], b[1][2]], [b[2][1], b[2][2]]]));
        worst.compare(size(&exact), projected.as_flattened(), clamped(&exact).as_flattened(), || s.place(i));
    }
    worst.check();
}

#[test]
fn projected_stretch_is_the_clamp_of_the_exact_one() {
    projected_membrane_is_the_clamp("stretch", &gradient_triangles(33, |[warp, weft, _]| [warp, weft, 0.0]));
}

#[test]
fn projected_shear_is_the_clamp_of_the_exact_one() {
    projected_membrane_is_the_clamp("shear", &gradient_triangles(34, |[_, _, shear]| [0.0, 0.0, shear]));
}

#[test]
fn projected_membrane_is_exact_when_stretched_along_warp_and_weft() {
    let (mut states, rng) = (many(35, COUNT, triangle), &mut Rng::new(35));
    for s in &mut states {
        let (turn, warp, weft) = (rng.rotation(), rng.between(1.0, 3.0), rng.between(1.0, 3.0));
        s.x = s.part.rest.map(|x| turn * DVec3::new(warp * x.x, weft * x.y, 0.0));
    }
    let columns = kit::membrane(&states);
    let mut worst = Worst::new("projected against exact blocks of a stretched membrane", ROUNDING);
    for (i, s) in states.iter().enumerate() {
        let exact: Dense<9> = from_blocks(&kit::exact(&columns.view(), i, &s.x, &[DVec3::ZERO; 3], [1.0, 1.0]));
        let projected: Dense<9> = from_blocks(&kit::projected(&columns.view(), i, &s.x, [1.0, 1.0]));
        worst.compare(size(&exact), projected.as_flattened(), exact.as_flattened(), || s.place(i));
    }
    worst.check();
}

#[test]
fn projected_hinge_is_gauss_newton() {
    let states = many(36, COUNT, hinge);
    let columns = kit::hinges(&states);
    let (term, scale) = (columns.view(), [0.7, 0.3]);
    // The gradient is computed by differences.
    let mut worst = Worst::new("projected hinge against ke grad grad^T", 1e-7);
    for (i, s) in states.iter().enumerate() {
        let now = term.angle(i, &s.x);
        let angle = |corner: usize, axis: usize, t: f64| {
            let mut x = s.x;
            x[corner][axis] += t;
            (term.angle(i, &x) - now + 9.0).rem_euclid(std::f64::consts::TAU)
        };
        let slope = |corner, axis| slope(s.step(), |t| angle(corner, axis, t));
        let gradient: [DVec3; 4] = std::array::from_fn(|c| DVec3::from_array(std::array::from_fn(|a| slope(c, a))));
        let stiffness = scale[0] * s.part.stiffness + scale[1] * s.part.damping;
        let want = gradient.map(|a| gradient.map(|b| outer(a * stiffness, b)));
        let [want, got]: [Dense<12>; 2] = [&want, &kit::projected(&term, i, &s.x, scale)].map(from_blocks);
        worst.compare(size(&want), got.as_flattened(), want.as_flattened(), || s.place(i));
    }
    worst.check();
}

fn is_linear_in_the_scale<const K: usize, const N: usize, P: std::fmt::Debug>(
    term: &impl Element<K>,
    states: &[State<P, K>],
) {
    let mut worst = Worst::new("projected at a scale against its parts", 1e-14);
    for (i, s) in states.iter().enumerate() {
        let at = |scale| from_blocks::<K, N>(&kit::projected(term, i, &s.x, scale));
        let (whole, position, velocity) = (at([0.04, 0.2]), at([1.0, 0.0]), at([0.0, 1.0]));
        let sum: Dense<N> =
            std::array::from_fn(|r| std::array::from_fn(|c| 0.04 * position[r][c] + 0.2 * velocity[r][c]));
        worst.compare(size(&whole), whole.as_flattened(), sum.as_flattened(), || s.place(i));
    }
    worst.check();
}

#[test]
fn projected_jacobians_are_linear_in_the_scale() {
    let (bars, triangles, folds, stitches) =
        (many(37, 20, bar), many(37, 20, triangle), many(37, 20, hinge), many(37, 20, stitch));
    is_linear_in_the_scale::<2, 6, _>(&kit::bars(&bars), &bars);
    is_linear_in_the_scale::<3, 9, _>(&kit::membrane(&triangles).view(), &triangles);
    is_linear_in_the_scale::<4, 12, _>(&kit::hinges(&folds).view(), &folds);
    is_linear_in_the_scale::<3, 9, _>(&kit::seams(&stitches).view(), &stitches);
    is_linear_in_the_scale::<3, 9, _>(&kit::wind(&triangles, DVec3::X, [0.6, 0.07]).view(), &triangles);
}

/// Checks by a Cholesky factorisation of the matrix plus 1e-12 of its largest diagonal entry, which exists if
/// no eigenvalue is lower than that below zero.
fn assert_semidefinite<const N: usize>(m: &Dense<N>, place: impl Fn() -> String) {
    let largest = (0..N).map(|i| m[i][i]).fold(f64::MIN_POSITIVE, f64::max);
    let pivot = least_pivot(m, 1e-12 * largest);
    assert!(pivot > 0.0, "indefinite: pivot {pivot:e} beside {largest:e} in {}", place());
}

/// A scale of an implicit stage: elastic only, or with damping.
fn scale(rng: &mut Rng) -> [f64; 2] {
    [1.0, rng.pick(&[0.0, 0.01, 1.0])]
}

#[test]
fn projected_springs_are_semidefinite_on_400_000_states() {
    let rng = &mut Rng::new(38);
    for i in 0..400_000 {
        let d = rng.direction() * rng.magnitude(1e-3, 3.0);
        let spring = Spring { rest: 1.0, stiffness: rng.magnitude(1.0, 1e4), damping: rng.between(0.0, 1e4) };
        let [position, velocity] = scale(rng);
        let block = spring::tangent(d, &spring, TangentScale { position, velocity });
        assert_semidefinite::<3>(&from_blocks(&[[block]]), || format!("state {i}: {d:?}, {spring:?}"));
    }
}

#[test]
fn projected_membranes_are_semidefinite_on_400_000_states() {
    let rng = &mut Rng::new(39);
    for _ in 0..100 {
        let states = many(rng.bits(), 667, triangle);
        let columns = kit::membrane(&states);
        for (i, s) in states.iter().enumerate() {
            let blocks = kit::projected(&columns.view(), i, &s.x, scale(rng));
            assert_semidefinite::<9>(&from_blocks(&blocks), || s.place(i));
        }
    }
}

#[test]
fn projected_hinges_are_semidefinite_on_200_000_states() {
    let rng = &mut Rng::new(40);
    for _ in 0..100 {
        let states = many(rng.bits(), 334, hinge);
        let columns = kit::hinges(&states);
        for (i, s) in states.iter().enumerate() {
            let blocks = kit::projected(&columns.view(), i, &s.x, scale(rng));
            assert_semidefinite::<12>(&from_blocks(&blocks), || s.place(i));
        }
    }
}
