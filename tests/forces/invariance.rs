//! Symmetries of internal forces, in both precisions: no net force or torque on the cloth, no force at the rest
//! shape wherever it is placed, no damping of rigid motion, no dependence on the origin.
//!
//! Stitches balance and do not depend on the origin. But an open stitch has no fixed direction onto which its
//! damping could be projected: it resists rotation, because [`forces::seam`](muslin_core::forces::seam) is
//! linear. Rotation is tested on closed stitches.

use glam::DVec3;
use harness::both_precisions;
use harness::rng::Rng;
use harness::states::{State, single};

const COUNT: usize = 100;

/// A rigid velocity field, about as fast as the states' corners.
fn rigid_velocity<P, const K: usize>(s: &State<P, K>, rng: &mut Rng) -> [DVec3; K] {
    let (speed, spin) = (rng.cube(s.size), rng.cube(1.0));
    s.x.map(|x| speed + spin.cross(x - s.x[0]))
}

/// Corners on a lattice with spacing 2^-12 of the size: the corners, and their sums with small multiples of the
/// size, are exact in f32.
fn on_lattice<P, const K: usize>(s: &State<P, K>) -> ([DVec3; K], f64) {
    let size = s.size.log2().floor().exp2();
    (s.x.map(|x| (x / size * 4096.0).round() / 4096.0 * size), size)
}

both_precisions! {
    use std::fmt::Debug;

    use glam::DVec3;
    use muslin::forces::element::Element;
    use harness::rng::Rng;
    use harness::states::{Regime, State, bar, hinge, many, stitch, triangle};
    use harness::worst::{Worst, norm};

    use super::{COUNT, on_lattice, rigid_velocity, single};

    /// Relative to the forces: a few roundings, and more near rest, where forces are small differences.
    const BALANCE: f64 = kit::bound(5e-6, 1e-12);
    /// Relative to stiffness x size: roundings of positions up to seven sizes away from the origin.
    const REST: f64 = kit::bound(1e-5, 1e-12);

    fn balances<const K: usize, P: Debug>(term: &impl Element<K>, states: &[State<P, K>], moving: bool) {
        let mut sums = Worst::new("sum of an element's forces", BALANCE);
        let mut torques = Worst::new("sum of an element's torques", BALANCE);
        for (i, s) in states.iter().enumerate() {
            let v = if moving { s.v } else { [DVec3::ZERO; K] };
            let f = kit::force(term, i, &s.x, &v);
            let arms = s.x.map(|x| x - s.x[0]);
            let torque = arms.iter().zip(&f).map(|(arm, f)| arm.cross(*f)).sum();
            sums.vectors(norm(&f), &[f.iter().sum()], &[DVec3::ZERO], || s.place(i));
            torques.vectors(norm(&f) * norm(&arms), &[torque], &[DVec3::ZERO], || s.place(i));
        }
        sums.check();
        torques.check();
    }

    #[test]
    fn springs_balance() {
        let states = many(51, COUNT, bar);
        balances(&kit::bars(&states), &states, true);
    }

    #[test]
    fn membranes_balance() {
        let states = many(52, COUNT, triangle);
        balances(&kit::membrane(&states).view(), &states, true);
    }

    #[test]
    fn hinges_balance() {
        let states = many(53, COUNT, hinge);
        balances(&kit::hinges(&states).view(), &states, true);
    }

    #[test]
    fn seams_balance() {
        let states = many(54, COUNT, stitch);
        balances(&kit::seams(&states).view(), &states, false);
    }

    fn rests<const K: usize, P: Debug>(term: &impl Element<K>, states: &[State<P, K>], stiffness: impl Fn(&P) -> f64) {
        let mut worst = Worst::new("force on a turned and moved rest shape", REST);
        for (i, s) in states.iter().enumerate() {
            let f = kit::force(term, i, &s.x, &[DVec3::ZERO; K]);
            worst.vectors(stiffness(&s.part), &f, &[DVec3::ZERO; K], || s.place(i));
        }
        worst.check();
    }

    #[test]
    fn springs_rest_wherever_they_are_moved() {
        let (mut states, rng) = (many(55, COUNT, bar), &mut Rng::new(55));
        for s in &mut states {
            s.x[1] = s.x[0] + rng.direction() * s.part.rest;
        }
        rests(&kit::bars(&states), &states, |p| p.stiffness * p.rest);
    }

    #[test]
    fn membranes_rest_wherever_they_are_moved() {
        let (mut states, rng) = (many(56, COUNT, triangle), &mut Rng::new(56));
        for s in &mut states {
            let (turn, offset) = (rng.rotation(), rng.cube(4.0 * s.size));
            s.x = s.part.rest.map(|x| offset + turn * x.extend(0.0));
        }
        rests(&kit::membrane(&states).view(), &states, |p| {
            let [warp, weft, shear] = p.stiffness;
            warp.max(weft).max(shear) * p.rest[0].distance(p.rest[1])
        });
    }

    #[test]
    fn hinges_rest_wherever_they_are_moved() {
        let (mut states, rng) = (many(57, COUNT, |_, rng| hinge(Regime::Rest, rng)), &mut Rng::new(57));
        let shapes = kit::hinges(&states);
        for (i, s) in states.iter_mut().enumerate() {
            let (turn, offset) = (rng.rotation(), rng.cube(4.0 * s.size));
            s.part.rest_angle = kit::angle(&shapes.view(), i, &s.x);
            s.x = s.x.map(|x| offset + turn * (x - s.x[0]));
        }
        rests(&kit::hinges(&states).view(), &states, |p| p.stiffness / (10.0 * p.least_height));
    }

    fn rigid_motion_is_free<const K: usize, P: Debug>(term: &impl Element<K>, states: &[State<P, K>]) {
        let (mut worst, rng) = (Worst::new("damping of a rigid motion", REST), &mut Rng::new(58));
        for (i, s) in states.iter().enumerate() {
            let moving = kit::force(term, i, &s.x, &rigid_velocity(s, rng));
            let still = kit::force(term, i, &s.x, &[DVec3::ZERO; K]);
            // The scale is the damping of the same corners at random velocities.
            let scale = norm(&kit::force(term, i, &s.x, &s.v)) + norm(&still);
            worst.vectors(scale, &moving, &still, || s.place(i));
        }
        worst.check();
    }

    #[test]
    fn springs_do_not_damp_rigid_motion() {
        let states = many(59, COUNT, bar);
        rigid_motion_is_free(&kit::bars(&states), &states);
    }

    #[test]
    fn membranes_do_not_damp_rigid_motion() {
        let states = many(60, COUNT, triangle);
        rigid_motion_is_free(&kit::membrane(&states).view(), &states);
    }

    #[test]
    fn hinges_do_not_damp_rigid_motion() {
        let states = many(61, COUNT, hinge);
        rigid_motion_is_free(&kit::hinges(&states).view(), &states);
    }

    #[test]
    fn closed_seams_do_not_damp_rigid_motion() {
        let mut states = many(62, COUNT, stitch);
        for s in &mut states {
            // Exactly on the edge, in f32 too.
            s.part.weight = single((s.part.weight * 4.0).round() / 4.0);
            let x = on_lattice(s).0;
            s.x = [x[1] * (1.0 - s.part.weight) + x[2] * s.part.weight, x[1], x[2]];
        }
        rigid_motion_is_free(&kit::seams(&states).view(), &states);
    }

    fn forgets_the_origin<const K: usize, P: Debug>(term: &impl Element<K>, states: &[State<P, K>]) {
        for (i, s) in states.iter().enumerate() {
            let (x, size) = on_lattice(s);
            let offset = DVec3::new(16.0, -32.0, 8.0) * size;
            let moved = x.map(|x| x + offset);
            let (here, there) = (kit::force(term, i, &x, &s.v), kit::force(term, i, &moved, &s.v));
            assert_eq!(here, there, "force of {}, moved by {offset}", s.place(i));
            let (here, there) = (kit::energy(term, i, &x), kit::energy(term, i, &moved));
            assert_eq!(here, there, "energy of {}, moved by {offset}", s.place(i));
        }
    }

    /// Equal to the last bit: kernels take differences of positions first.
    #[test]
    fn no_term_knows_the_origin() {
        let (bars, triangles, folds, stitches) =
            (many(63, COUNT, bar), many(63, COUNT, triangle), many(63, COUNT, hinge), many(63, COUNT, stitch));
        forgets_the_origin(&kit::bars(&bars), &bars);
        forgets_the_origin(&kit::membrane(&triangles).view(), &triangles);
        forgets_the_origin(&kit::hinges(&folds).view(), &folds);
        forgets_the_origin(&kit::seams(&stitches).view(), &stitches);
        forgets_the_origin(&kit::wind(&triangles, DVec3::new(3.0, -1.0, 2.0), [0.6, 0.07]).view(), &triangles);
    }
}
