//! Elements without length, area or angle, in both precisions: forces, energies and Jacobians stay finite,
//! forces sum to zero, and forces and projected Jacobians stay within a stated multiple of the stiffness
//! however far an element collapses. (The exact Jacobian of a collapsing element grows without bound; the test
//! only requires that it is finite.)
//!
//! Run: `cargo test -p muslin-tests --test degenerate`. It has caught: a collapsing edge of a hinge caused
//! forces that were a million times too large (forces/hinge.rs, `relief`).

mod cases;

use harness::both_precisions;

both_precisions! {
    use std::fmt::Debug;

    use glam::DVec3;
    use muslin::forces::Model;
    use muslin::forces::element::Element;
    use muslin::forces::spring::{Spring, SpringColumns};
    use muslin::integrate::Jacobian;
    use harness::dense::{from_blocks, size};
    use harness::rng::Rng;
    use harness::states::{State, single3};
    use harness::worst::{Worst, norm};

    use super::cases::{self, Limits};

    /// Relative to the force's limit: the projection of a corner far from a collapsed edge has a rounding error
    /// relative to the corner's distance, not to the edge.
    const SUM: f64 = kit::bound(1e-6, 1e-14);

    /// `limits` returns the largest permitted force and projected Jacobian of an element.
    fn stays_in_bounds<const K: usize, const N: usize, P: Debug>(
        term: &impl Element<K>,
        states: &[State<P, K>],
        balanced: bool,
        limits: impl Fn(&State<P, K>) -> Limits,
    ) {
        let mut sums = Worst::new("sum of a degenerate element's forces", SUM);
        let mut forces = Worst::new("force over its limit", 1.0);
        let mut jacobians = Worst::new("projected Jacobian over its limit", 1.0);
        for (i, s) in states.iter().enumerate() {
            let f = kit::force(term, i, &s.x, &s.v);
            assert!(f.iter().all(|f| f.is_finite()), "force {f:?} of {}", s.place(i));
            let energy = kit::energy(term, i, &s.x);
            assert!(energy.is_finite(), "energy {energy} of {}", s.place(i));
            let [projected, exact] =
                [kit::projected(term, i, &s.x, [1.0, 1.0]), kit::exact(term, i, &s.x, &s.v, [1.0, 1.0])];
            assert!(projected.iter().flatten().all(|b| b.is_finite()), "projected {projected:?} of {}", s.place(i));
            assert!(exact.iter().flatten().all(|b| b.is_finite()), "exact {exact:?} of {}", s.place(i));
            let limits = limits(s);
            forces.see(norm(&f) / limits.force.max(f64::MIN_POSITIVE), || format!("{f:?} of {}", s.place(i)));
            let jacobian = size(&from_blocks::<K, N>(&projected));
            jacobians.see(jacobian / limits.jacobian, || format!("{projected:?} of {}", s.place(i)));
            if balanced {
                sums.vectors(limits.force, &[f.iter().sum()], &[DVec3::ZERO], || s.place(i));
            }
        }
        forces.check();
        jacobians.check();
        if balanced {
            sums.check();
        }
    }

    #[test]
    fn springs() {
        let states = cases::bars();
        stays_in_bounds::<2, 6, _>(&kit::bars(&states), &states, true, cases::bar_limits);
    }

    /// Until less than a millionth of its size is left, a collapsed element still has a direction and resists
    /// in full.
    #[test]
    fn elements_resist_in_full_until_they_vanish() {
        let mut worst = Worst::new("resistance of what has nearly collapsed", kit::bound(1e-6, 1e-14));
        for left in [0.1, 1e-3, 1e-5, 2e-6] {
            let place = || format!("{left:e} is left");
            let (spring, x) = cases::compressed_bar(left);
            let push = kit::force(&kit::bars(&[spring]), 0, &x, &[DVec3::ZERO; 2])[1].length();
            worst.compare(50.0, &[push], &[500.0 * 0.1 * (1.0 - left)], || format!("spring, {}", place()));
            let (triangle, x) = cases::compressed_triangle(left);
            let push = kit::force(&kit::membrane(&[triangle]).view(), 0, &x, &[DVec3::ZERO; 3])[1].length();
            worst.compare(25.0, &[push], &[0.5 * 0.1 * 500.0 * (1.0 - left)], || format!("membrane, {}", place()));
            let (hinge, x) = cases::compressed_hinge(left, 0.5);
            let angle = kit::angle(&kit::hinges(&[hinge]).view(), 0, &x);
            worst.compare(0.5, &[angle], &[0.5], || format!("hinge, {}", place()));
        }
        worst.check();
    }

    /// A collapsed spring must not affect the springs beside it: stars of up to nine springs, one of them
    /// collapsed, in every position.
    #[test]
    fn springs_beside_a_collapsed_one() {
        let (rng, mut worst) = (&mut Rng::new(122), Worst::new("force of springs beside a collapsed one", SUM));
        for (count, collapsed) in (1..10).flat_map(|count| (1..=count).map(move |collapsed| (count, collapsed))) {
            let mut x: Vec<_> = (0..=count).map(|_| single3(rng.cube(0.1))).collect();
            x[collapsed] = x[0];
            let spring = |far| ([0, far as u32], Spring { rest: 0.125, stiffness: 500.0, damping: 0.0 });
            let columns = SpringColumns::build(x.len(), &(1..=count).map(spring).collect::<Vec<_>>());
            let model = Model { stretch_springs: Some(columns.view()), ..Model::default() };
            let f = kit::forces(&model, &vec![1.0; x.len()], &x, &vec![DVec3::ZERO; x.len()]);
            let others = x[1..].iter().filter(|far| **far != x[0]).map(|far| *far - x[0]);
            let want = others.map(|d| d * (500.0 * (1.0 - 0.125 / d.length()))).sum();
            let scale = 500.0 * 0.125 * count as f64;
            worst.vectors(scale, &[f[0], f[collapsed]], &[want, DVec3::ZERO], || {
                format!("spring {collapsed} of {count} collapsed: {x:?}")
            });
        }
        worst.check();
    }

    #[test]
    fn membranes() {
        let states = cases::triangles();
        stays_in_bounds::<3, 9, _>(&kit::membrane(&states).view(), &states, true, cases::triangle_limits);
    }

    #[test]
    fn hinges() {
        let states = cases::hinges();
        stays_in_bounds::<4, 12, _>(&kit::hinges(&states).view(), &states, true, cases::hinge_limits);
    }

    #[test]
    fn seams() {
        let states = cases::stitches();
        stays_in_bounds::<3, 9, _>(&kit::seams(&states).view(), &states, true, cases::stitch_limits);
    }

    #[test]
    fn wind() {
        let states = cases::triangles();
        let columns = kit::wind(&states, cases::WIND, cases::WIND_DRAG);
        stays_in_bounds::<3, 9, _>(&columns.view(), &states, false, cases::wind_limits);
    }

    /// All terms at once, with all vertices in one point, on a line, in a plane, or folded onto the sheet
    /// itself: forces, energies and Jacobians stay finite.
    #[test]
    fn collapsed_sheets() {
        let built = kit::build(cases::SCENE);
        let (model, masses, rng) = (built.model.view(), &built.particles.masses, &mut Rng::new(121));
        let rest = kit::positions(&built);
        for (name, collapse) in cases::COLLAPSES {
            let x: Vec<_> = rest.iter().map(|&x| collapse(x)).collect();
            let v: Vec<_> = x.iter().map(|_| rng.cube(1.0)).collect();
            let f = kit::forces(&model, masses, &x, &v);
            let bad = f.iter().position(|f| !f.is_finite());
            assert_eq!(bad, None, "{name}: the force on this vertex is not finite");
            let energy = kit::energies(&model, masses, &x);
            assert!(energy.total().is_finite(), "{name}: {energy:?}");
            for jacobian in [Jacobian::Projected, Jacobian::Exact] {
                let matrix = kit::tangents::<{ 3 * cases::VERTICES }>(&built, &model, &x, [1.0, 1.0], jacobian);
                assert!(size(&matrix).is_finite(), "{name}: {jacobian:?} Jacobian is not finite");
            }
        }
    }
}
