//! A step that is not finite reports the step, the particle and the term, and keeps the last finite state.

use glam::DVec3;
use harness::kit::double as kit;
use harness::net::linearised;
use harness::rng::Rng;
use muslin_core_f64::forces::Term;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

/// Sheets in gravity and air; one term is too stiff for the step.
const STIFF: [(Term, &str); 4] = [
    (Term::StretchSpring, r#"stretch = { model = "spring", stiffness = 20000.0 }"#),
    (Term::Membrane, r#"stretch = { model = "membrane", stiffness = 20000.0 }"#),
    (Term::BendSpring, r#"bend = { model = "spring", stiffness = 20000.0 }"#),
    (Term::Seam, "seam = [{ pairs = [[0, 24]], stiffness = 20000.0 }]"),
];

fn stiff(material: &str) -> Simulation {
    let mut built = kit::build(&format!(
        r#"
        name = "stiff"
        duration = 1.0
        gravity = [0.0, -9.81, 0.0]
        drag = {{ linear = 0.1 }}
        [[cloth]]
        grid = {{ size = [0.4, 0.35], cells = [4, 4] }}
        density = 0.2
        {material}
        [[cloth.pin]]
        select = {{ vertices = [2] }}"#
    ));
    let mut rng = Rng::new(3);
    built.particles.positions.iter_mut().for_each(|x| *x += rng.cube(1e-3));
    Simulation::from_columns(built, linearised(Method::ExplicitEuler), 1.0 / 60.0)
}

#[test]
fn divergence_names_step_particle_and_term_and_keeps_the_state() {
    for (term, material) in STIFF {
        let mut sim = stiff(material);
        let mut steps = 0;
        let (error, before) = loop {
            let before = [sim.positions(), sim.velocities()].concat();
            match sim.take_step() {
                Ok(()) => steps += 1,
                Err(error) => break (error, before),
            }
            assert!(steps < 10_000, "explicit-euler: {} has not diverged", term.name());
        };
        println!("{error}");
        assert_eq!(error.step, steps + 1, "{error}");
        assert_eq!(error.term, Some(term), "{error}");
        assert_eq!(sim.take_step(), Err(error), "the same step fails otherwise");
        assert_eq!(sim.state().steps, steps);
        assert_eq!([sim.positions(), sim.velocities()].concat(), before, "{error}: the state has changed");
        assert!(before.iter().all(|x| x.is_finite()), "{error}: the state is not finite");
        let message =
            format!("diverged in step {} at vertex {}, pulled hardest by {}", steps + 1, error.particle, term.name());
        assert_eq!(error.to_string(), message);
    }
}

#[test]
fn a_number_that_is_none_is_reported_where_it_is() {
    for method in Method::ALL {
        let mut built = stiff(STIFF[0].1).scene().clone();
        built.particles.velocities[9] = DVec3::new(0.0, f64::NAN, 0.0);
        let mut sim = Simulation::from_columns(built, linearised(method), 1e-4);
        let error = sim.take_step().expect_err("a velocity is NaN");
        assert_eq!(error.step, 1, "{}: {error}", method.name());
        // In one stage without damping, no other vertex depends on the velocity.
        if matches!(method, Method::ExplicitEuler | Method::SymplecticEuler) {
            assert_eq!(error.particle, 9, "{}: {error}", method.name());
        }
    }
}
