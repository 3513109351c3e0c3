//! The state after every step is bitwise the same with 1, 2, 3 and 7 threads, for every method, with every
//! force term, in both precisions.

use harness::both_precisions;

/// Two sheets, moving pins and air: every term, and both kinds of motion.
const EVERYTHING: &str = r#"
    name = "everything"
    duration = 1.0
    gravity = [0.5, -9.81, 0.2]
    [drag]
    linear = 0.3
    wind = { velocity = [2.0, 1.0, 3.0], normal = 0.6, tangential = 0.1 }
    [[cloth]]
    grid = { size = [0.4, 0.35], cells = [5, 5] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 40.0, weft = 30.0, damping = 0.001 }
    shear = { stiffness = 12.0, damping = 0.001 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.001 }
    seam = [{ pairs = [[0, 30], [5, 34]], stiffness = 5.0, damping = 0.001 }]
    pin = [{ select = { corners = [0] }, motion = { turn = { axis = [1, 2, 3], rate = 5.0 } } }]
    [[cloth]]
    grid = { size = [0.4, 0.4], cells = [5, 5], pattern = "alternating" }
    density = 0.2
    position = [0.5, 0.0, 0.0]
    stretch = { model = "spring", stiffness = 40.0, damping = 0.001 }
    bend = { model = "spring", stiffness = 2.0, damping = 0.001 }
    pin = [{ select = { edge = "left" }, axes = "xz", motion = { keys = [[0.0, 0, 0, 0], [1.0, 0.5, 0.5, 0]] } }]
"#;

/// More vertices than one partial sum of the solver contains.
const LARGE: &str = r#"
    name = "large"
    duration = 1.0
    gravity = [0.5, -9.81, 0.2]
    [[cloth]]
    grid = { size = [1.0, 1.0], cells = [34, 34] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 40.0 }
    shear = { stiffness = 12.0 }
    bend = { model = "hinge", rigidity = 1e-5 }
    pin = [{ select = { corners = [0] } }]
"#;

/// Sheets thrown onto one another, onto a turning box and a plane: uses every pass of the response.
const TOUCHING: &str = r#"
    name = "touching"
    duration = 1.0
    gravity = [0.5, -9.81, 0.2]
    [[cloth]]
    grid = { size = [0.2, 0.2], cells = [7, 7] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 40.0 }
    bend = { model = "hinge", rigidity = 1e-6 }
    [[cloth]]
    grid = { size = [0.2, 0.2], cells = [6, 6], pattern = "alternating" }
    density = 0.2
    position = [0.02, 0.01, 0.03]
    stretch = { model = "membrane", stiffness = 40.0 }
    [contact]
    thickness = 0.003
    friction = { static = 0.4, kinetic = 0.3 }
    [[collider]]
    shape = "box"
    center = [0, -0.03, 0]
    half = [0.05, 0.01, 0.05]
    motion = { keys = [[0.0, 0, 0, 0], [0.1, 0, 0.5, 0]], turn = { axis = [1, 1, 0], rate = 20.0 } }
    [[collider]]
    shape = "plane"
    point = [0, -0.04, 0]
    normal = [0, 1, 0]
"#;

const STEP: f64 = 0.001;
const THREADS: [usize; 4] = [1, 2, 3, 7];

both_precisions! {
    use super::{EVERYTHING, LARGE, STEP, THREADS, TOUCHING};
    use muslin::diagnostics::StateHash;
    use muslin::dispatch::{Dispatch, Serial};
    use muslin::integrate::{Jacobian, Method, Preconditioner, Scheme, Tolerance};
    use muslin::real::{Real, vec3};
    use muslin::simulation::Simulation;
    use harness::rng::Rng;
    use harness::threads::Uneven;

    /// The hash chain after every step.
    fn chain(scene: &str, scheme: Scheme, steps: u32, dispatch: &impl Dispatch) -> Vec<StateHash> {
        let mut built = kit::build(scene);
        let mut rng = Rng::new(31);
        for (x, v) in built.particles.positions.iter_mut().zip(&mut built.particles.velocities) {
            *x += vec3(rng.cube(0.003).into());
            *v = vec3(rng.cube(0.2).into());
        }
        let mut sim = Simulation::from_columns(built, scheme, STEP as Real);
        let mut hash = StateHash::default();
        let step = |_| {
            sim.step(dispatch).expect("finite");
            hash.add(sim.positions(), sim.velocities());
            hash
        };
        (0..steps).map(step).collect()
    }

    fn check(scene: &str, scheme: Scheme, steps: u32) {
        let want = chain(scene, scheme, steps, &Serial);
        for threads in THREADS {
            let got = chain(scene, scheme, steps, &Uneven::new(threads));
            let first = got.iter().zip(&want).position(|(got, want)| got != want);
            assert_eq!(
                first, None,
                "{} {}, newton = {}, {:?}, {:?}: with {threads} threads the state differs from a single one's, first \
                 after this step counted from 0",
                muslin::real::NAME, scheme.method.name(), scheme.newton, scheme.preconditioner, scheme.jacobian
            );
        }
    }

    fn scheme(method: Method) -> Scheme {
        Scheme::fixed(method, 1e-4)
    }

    #[test]
    fn every_method_under_any_threads() {
        for method in Method::ALL {
            check(EVERYTHING, scheme(method), 8);
        }
    }

    #[test]
    fn every_solver_under_any_threads() {
        let preconditioner = Preconditioner::TwoLevel;
        for method in [Method::BackwardEuler, Method::Bdf2] {
            check(EVERYTHING, Scheme { newton: 5, ..scheme(method) }, 4);
            check(EVERYTHING, Scheme { preconditioner, ..scheme(method) }, 4);
            check(EVERYTHING, Scheme { jacobian: Jacobian::Exact, ..scheme(method) }, 4);
        }
    }

    #[test]
    fn contact_under_any_threads() {
        for method in [Method::SymplecticEuler, Method::BackwardEuler, Method::Bdf2] {
            check(TOUCHING, scheme(method), 30);
        }
    }

    #[test]
    fn error_control_under_any_threads() {
        let error = 1e-4;
        for method in [Method::BackwardEuler, Method::ImplicitMidpoint, Method::Bdf2] {
            check(TOUCHING, Scheme { tolerance: Tolerance::within(error), error: Some(error), ..scheme(method) }, 30);
        }
    }

    #[test]
    fn many_vertices_under_any_threads() {
        for preconditioner in [Preconditioner::BlockJacobi, Preconditioner::TwoLevel] {
            check(LARGE, Scheme { preconditioner, ..scheme(Method::BackwardEuler) }, 3);
        }
    }
}
