//! Free cloth without contact conserves its momentum: explicit methods to rounding over 10,000 steps in both
//! precisions, implicit methods to the residual of the linear solve.

use glam::DVec3;
use harness::both_precisions;
use harness::kit::double as kit;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::integrate::{Jacobian, Method};
use muslin_core_f64::spectrum::Tangent;

both_precisions! {
    use glam::DVec3;
    use muslin::integrate::{Method, Scheme};
    use muslin::real::{Real, Vec3, to_f64, vec3};
    use muslin::simulation::Simulation;
    use harness::rng::Rng;

    /// Drift over 10,000 steps, relative to the sum of all |momenta|.
    const DRIFT: f64 = kit::bound(1e-5, 1e-12);

    /// Two sheets with every internal force, thrown and spinning; damped so that explicit Euler is stable too.
    pub fn thrown(method: Method, newton: u32, tolerance: f64, step: f64) -> Simulation {
        let mut built = kit::build(r#"
            name = "thrown"
            duration = 1.0
            [[cloth]]
            grid = { size = [0.3, 0.26], cells = [3, 3] }
            density = 0.2
            stretch = { model = "membrane", stiffness = 20.0, damping = 0.004 }
            shear = { stiffness = 8.0, damping = 0.004 }
            bend = { model = "hinge", rigidity = 1e-5, damping = 0.004 }
            seam = [{ pairs = [[0, 14], [3, 17]], stiffness = 0.5 }]
            [[cloth]]
            grid = { size = [0.3, 0.26], cells = [3, 3] }
            density = 0.2
            stretch = { model = "spring", stiffness = 20.0, damping = 0.004 }
            bend = { model = "spring", stiffness = 1.0, damping = 0.004 }"#);
        let mut rng = Rng::new(19);
        let (throw, spin) = (DVec3::new(0.3, 0.5, -0.2), DVec3::new(1.0, 3.0, -2.0));
        for (x, v) in built.particles.positions.iter_mut().zip(&mut built.particles.velocities) {
            let at = DVec3::from(to_f64(*x)) + rng.cube(0.005);
            *x = vec3(at.into());
            *v = vec3((throw + spin.cross(at) + rng.cube(0.3)).into());
        }
        let scheme = Scheme { newton, ..Scheme::fixed(method, tolerance as Real) };
        Simulation::from_columns(built, scheme, step as Real)
    }

    /// Linear and angular momentum, each with the sum of its parts' magnitudes.
    fn momenta(sim: &Simulation) -> [(DVec3, f64); 2] {
        let mut sums = [(DVec3::ZERO, 0.0); 2];
        for ((&x, &v), &m) in sim.positions().iter().zip(sim.velocities()).zip(&sim.scene().particles.masses) {
            let (x, p) = (DVec3::from(to_f64(x)), DVec3::from(to_f64(v)) * to_f64(Vec3::splat(m))[0]);
            for (sum, part) in sums.iter_mut().zip([p, x.cross(p)]) {
                *sum = (sum.0 + part, sum.1 + part.length());
            }
        }
        sums
    }

    /// Compares the linear momentum, and if `angular` also the angular momentum, with the start.
    pub fn check(mut sim: Simulation, steps: u32, angular: bool, bound: f64) {
        let start = momenta(&sim);
        for _ in 0..steps {
            sim.take_step().expect("stable");
        }
        let core = DVec3::from(sim.momentum());
        let end = momenta(&sim);
        let what = format!("{} {}", muslin::real::NAME, sim.scheme().method.name());
        assert!((core - end[0].0).length() <= 1e-15 * end[0].1, "{what}: the core says {core}, expected {}", end[0].0);
        let parts = [("linear", start[0], end[0]), ("angular", start[1], end[1])];
        for (name, start, end) in parts.into_iter().take(if angular { 2 } else { 1 }) {
            let drift = (end.0 - start.0).length() / start.1.max(end.1);
            let measured = format!("{what}: {name} momentum drifts by {drift:.1e} of its parts in {steps} steps");
            println!("{measured}, bound {bound:.0e}");
            assert!(drift <= bound, "{measured}, expected at most {bound:e}");
        }
    }

    #[test]
    fn explicit_methods_keep_momentum_over_10000_steps() {
        for method in [Method::ExplicitEuler, Method::SymplecticEuler, Method::Midpoint, Method::Rk4] {
            // x1 x v1 = x0 x v1 for symplectic Euler, whose forces have no torque about x0.
            check(thrown(method, 1, 1e-4, 2e-4), 10_000, method == Method::SymplecticEuler, DRIFT);
        }
    }

    #[test]
    fn implicit_methods_keep_momentum_to_the_tolerance_of_their_solve() {
        // The drift of each step is at most the sum of the residual: tolerance times the requested change.
        for method in [Method::BackwardEuler, Method::ImplicitMidpoint, Method::Bdf2] {
            let tolerance = kit::bound(1e-6, 1e-13);
            check(thrown(method, 1, tolerance, 5e-3), 200, false, DRIFT);
        }
    }
}

/// M (v1 - v0) = h f(x0) - S v1 - r, where forces and the columns of S sum to zero. So the momentum that a step
/// of backward Euler gains is minus the sum of the residual r of the solve.
#[test]
fn momentum_gained_is_the_sum_of_the_residual() {
    for (tolerance, bound) in [(1e-2, 1.0), (1e-5, 1e-4), (1e-14, 1e-12)] {
        let mut sim = double::thrown(Method::BackwardEuler, 1, tolerance, 5e-3);
        let h = sim.step_length();
        let (start, v0) = (sim.scene().clone(), sim.velocities().to_vec());
        let masses = &start.particles.masses;
        let f = kit::forces(&sim.model(), masses, sim.positions(), &vec![DVec3::ZERO; v0.len()]);
        let before = DVec3::from(sim.momentum());
        sim.take_step().expect("finite");
        let gained = DVec3::from(sim.momentum()) - before;
        let mut product = vec![DVec3::ZERO; v0.len()];
        Tangent::of(&start, h * h, h, Jacobian::Projected, &Serial).multiply(
            1.0,
            sim.velocities(),
            &mut product,
            &Serial,
        );
        let residual: DVec3 = (0..v0.len()).map(|i| v0[i] * masses[i] + f[i] * h - product[i]).sum();
        let size: f64 = v0.iter().zip(masses).map(|(v, m)| (*v * *m).length()).sum();
        println!(
            "tolerance {tolerance:.0e}: gained {:.2e}, minus the residual {:.2e}",
            gained.length() / size,
            (gained + residual).length() / size
        );
        assert!(
            (gained + residual).length() <= 1e-13 * size,
            "tolerance {tolerance}: gained {gained}, the residual sums to {residual}"
        );
        assert!(gained.length() <= bound * size, "tolerance {tolerance}: gained {gained}, of {size} at most {bound}");
    }
}

/// Converged implicit midpoint conserves quadratic invariants, also angular momentum.
#[test]
fn implicit_midpoint_keeps_angular_momentum() {
    double::check(double::thrown(Method::ImplicitMidpoint, 100, 1e-12, 2e-3), 200, true, 1e-10);
}
