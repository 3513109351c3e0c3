//! Force = -dE/dx, and exact Jacobian = df/dx and df/dv, by central differences in f64, on 3,000 states per
//! term: near rest, stretched by up to 3, compressed to 0.2, sheared, folded past 90 degrees.
//!
//! Errors are relative to the norm of the element's whole force or Jacobian.

use std::fmt::Debug;

use glam::DVec3;
use harness::dense::{Dense, asymmetry, from_blocks, size};
use harness::differences::{gradient, jacobian};
use harness::kit::double as kit;
use harness::states::{State, bar, hinge, many, stitch, triangle};
use harness::worst::{Worst, norm};
use muslin_core_f64::forces::element::Element;

/// States of each regime.
const COUNT: usize = 500;
/// Sixth-order differences with a thousandth of the element size have an error of 1e-8 on the sharpest hinge.
const FORCE: f64 = 1e-7;
const JACOBIAN: f64 = 1e-6;
/// A few roundings.
const SYMMETRY: f64 = 1e-14;

const WIND: DVec3 = DVec3::new(3.0, -1.0, 2.0);
const WIND_DRAG: [f64; 2] = [0.6, 0.07];

fn force_is_slope_of_energy<const K: usize, P: Debug>(term: &impl Element<K>, states: &[State<P, K>]) {
    let mut worst = Worst::new("force against -dE/dx", FORCE);
    for (i, s) in states.iter().enumerate() {
        let force = kit::force(term, i, &s.x, &[DVec3::ZERO; K]);
        let slope = gradient(&s.x, s.step(), |x| -kit::energy(term, i, x));
        worst.vectors(norm(&slope), &force, &slope, || s.place(i));
    }
    worst.check();
}

/// Includes the contribution of the damping force: the corners move.
fn jacobian_is_slope_of_force<const K: usize, const N: usize, P: Debug>(
    term: &impl Element<K>,
    states: &[State<P, K>],
) {
    let mut by_position = Worst::new("Jacobian against -df/dx", JACOBIAN);
    let mut by_velocity = Worst::new("Jacobian against -df/dv", JACOBIAN);
    let negated = |f: [DVec3; K]| f.map(|f| -f);
    for (i, s) in states.iter().enumerate() {
        let exact: Dense<N> = from_blocks(&kit::exact(term, i, &s.x, &s.v, [1.0, 0.0]));
        let slope: Dense<N> = jacobian(&s.x, s.step(), |x| negated(kit::force(term, i, x, &s.v)));
        by_position.compare(size(&slope), exact.as_flattened(), slope.as_flattened(), || s.place(i));
        let exact: Dense<N> = from_blocks(&kit::exact(term, i, &s.x, &s.v, [0.0, 1.0]));
        let slope: Dense<N> = jacobian(&s.v, s.size, |v| negated(kit::force(term, i, &s.x, v)));
        by_velocity.compare(size(&slope), exact.as_flattened(), slope.as_flattened(), || s.place(i));
    }
    by_position.check();
    by_velocity.check();
}

/// df/dx is taken at zero velocity, because the contribution of the damping force is not symmetric.
fn jacobian_is_symmetric<const K: usize, const N: usize, P: Debug>(
    term: &impl Element<K>,
    states: &[State<P, K>],
    scale: [f64; 2],
) {
    let mut worst = Worst::new(format!("asymmetry of the Jacobian at scale {scale:?}"), SYMMETRY);
    for (i, s) in states.iter().enumerate() {
        let exact: Dense<N> = from_blocks(&kit::exact(term, i, &s.x, &[DVec3::ZERO; K], scale));
        worst.see(asymmetry(&exact) / size(&exact), || s.place(i));
    }
    worst.check();
}

#[test]
fn spring_force_is_the_slope_of_its_energy() {
    let states = many(1, COUNT, bar);
    force_is_slope_of_energy(&kit::bars(&states), &states);
}

#[test]
fn spring_jacobian_is_the_slope_of_its_force() {
    let states = many(2, COUNT, bar);
    jacobian_is_slope_of_force::<2, 6, _>(&kit::bars(&states), &states);
}

#[test]
fn spring_jacobians_are_symmetric() {
    let states = many(3, COUNT, bar);
    jacobian_is_symmetric::<2, 6, _>(&kit::bars(&states), &states, [1.0, 0.0]);
    jacobian_is_symmetric::<2, 6, _>(&kit::bars(&states), &states, [0.0, 1.0]);
}

#[test]
fn membrane_force_is_the_slope_of_its_energy() {
    let states = many(4, COUNT, triangle);
    force_is_slope_of_energy(&kit::membrane(&states).view(), &states);
}

#[test]
fn membrane_jacobian_is_the_slope_of_its_force() {
    let states = many(5, COUNT, triangle);
    jacobian_is_slope_of_force::<3, 9, _>(&kit::membrane(&states).view(), &states);
}

#[test]
fn membrane_jacobians_are_symmetric() {
    let states = many(6, COUNT, triangle);
    jacobian_is_symmetric::<3, 9, _>(&kit::membrane(&states).view(), &states, [1.0, 0.0]);
    jacobian_is_symmetric::<3, 9, _>(&kit::membrane(&states).view(), &states, [0.0, 1.0]);
}

#[test]
fn hinge_force_is_the_slope_of_its_energy() {
    let states = many(7, COUNT, hinge);
    force_is_slope_of_energy(&kit::hinges(&states).view(), &states);
}

#[test]
fn hinge_jacobian_is_the_slope_of_its_force() {
    let states = many(8, COUNT, hinge);
    jacobian_is_slope_of_force::<4, 12, _>(&kit::hinges(&states).view(), &states);
}

#[test]
fn hinge_jacobians_are_symmetric() {
    let states = many(9, COUNT, hinge);
    jacobian_is_symmetric::<4, 12, _>(&kit::hinges(&states).view(), &states, [1.0, 0.0]);
    jacobian_is_symmetric::<4, 12, _>(&kit::hinges(&states).view(), &states, [0.0, 1.0]);
}

#[test]
fn seam_force_is_the_slope_of_its_energy() {
    let states = many(10, COUNT, stitch);
    force_is_slope_of_energy(&kit::seams(&states).view(), &states);
}

#[test]
fn seam_jacobian_is_the_slope_of_its_force() {
    let states = many(11, COUNT, stitch);
    jacobian_is_slope_of_force::<3, 9, _>(&kit::seams(&states).view(), &states);
    jacobian_is_symmetric::<3, 9, _>(&kit::seams(&states).view(), &states, [1.0, 1.0]);
}

/// Wind has no energy; [`dissipation`](super::dissipation) compares its force with a formula.
#[test]
fn wind_jacobian_is_the_slope_of_its_force() {
    let states = many(12, COUNT, triangle);
    let columns = kit::wind(&states, WIND, WIND_DRAG);
    jacobian_is_slope_of_force::<3, 9, _>(&columns.view(), &states);
    jacobian_is_symmetric::<3, 9, _>(&columns.view(), &states, [0.0, 1.0]);
}
