//! The cloth answers: what it loses, a body of the host gains. The host here is a ball that flies freely.

use glam::DVec3;
use harness::both_precisions;

/// A ball of 50 g that meets a free sheet of 50 g without gravity.
fn scene() -> String {
    super::ball("", "").replace("gravity = [0, -9.81, 0]", "").replace("tolerance = 1e-10", "tolerance = 1e-14")
}

/// A ball that hangs at a sheet by attached vertices; the sheet is held at two corners.
fn carried() -> String {
    super::ball("", "")
        .replace("tolerance = 1e-10", "tolerance = 1e-14")
        .replace("[[cloth]]", "[[cloth]]\npin = [{ select = { corners = [0, 1] } }]")
}

both_precisions! {
    use glam::DVec3;
    use muslin::kinematic::Pose;
    use muslin::real::Real;
    use muslin::live::Live as _;
    use muslin::simulation::Simulation;

    const MASS: f64 = 0.05;

    /// Takes a step in which the ball moves with its velocity, and changes this by the impulse of the cloth.
    fn step(sim: &mut Simulation, place: &mut DVec3, velocity: &mut DVec3, mass: f64) -> DVec3 {
        let step = f64::from(sim.step_length());
        *place += *velocity * step;
        assert_eq!(sim.move_collider(0, Pose::at(*place), step), Ok(()));
        sim.take_step().unwrap_or_else(|failed| panic!("{failed}"));
        let impulse = sim.take_impulse(0).expect("measured").linear;
        *velocity += impulse / mass;
        impulse
    }

    fn measured(text: &str) -> Simulation {
        let mut sim = kit::simulation(text, &[]);
        sim.measure_reactions();
        sim
    }

    #[test]
    fn a_ball_and_a_sheet_keep_their_momentum() {
        let mut sim = measured(&super::scene());
        let mut place = sim.collider_pose(0).expect("it exists").position;
        let mut velocity = DVec3::new(0.2, 1.5, 0.0);
        let before = velocity * MASS;
        let mut worst = 0.0_f64;
        for _ in 0..40 {
            step(&mut sim, &mut place, &mut velocity, MASS);
            worst = worst.max((velocity * MASS + DVec3::from(sim.momentum())).distance(before));
        }
        assert!(velocity.y < 1.0, "the sheet does not slow the ball down: {velocity}");
        let bound = 40.0 * f64::from(Real::EPSILON) * before.length();
        assert!(worst < bound, "{}: {worst} kg m/s of {before} are lost", muslin::real::NAME);
    }

    /// The ball carries the whole sheet, throws it, and lets it go: both keep their momentum together.
    #[test]
    fn what_a_ball_carries_and_lets_go_keeps_the_momentum() {
        let mut sim = measured(&super::scene());
        let count = sim.positions().len() as u32;
        (0..count).for_each(|vertex| assert_eq!(sim.attach(vertex, 0), Ok(())));
        let mut place = sim.collider_pose(0).expect("it exists").position;
        let mut velocity = DVec3::new(0.2, 1.5, 0.0);
        let before = velocity * MASS;
        (0..5).for_each(|_| _ = step(&mut sim, &mut place, &mut velocity, MASS));
        (0..count).for_each(|vertex| assert!(sim.release(vertex)));
        velocity += sim.take_impulse(0).expect("measured").linear / MASS;
        let own = DVec3::from(sim.momentum());
        let off = (velocity * MASS + own).distance(before);
        assert!(own.y > 0.2 * before.y, "the sheet does not fly: {own} kg m/s");
        let bound = 40.0 * f64::from(Real::EPSILON) * before.length();
        assert!(off < bound, "{}: {off} kg m/s of {before} are lost", muslin::real::NAME);
    }

    #[test]
    fn a_ball_hangs_at_the_cloth_that_is_pinned_to_it() {
        let mut sim = measured(&super::carried());
        for vertex in [84, 70, 98] {
            assert_eq!(sim.attach(vertex, 0), Ok(()));
        }
        let start = sim.collider_pose(0).expect("it exists").position;
        let (mut place, mut velocity) = (start, DVec3::ZERO);
        let mass = 0.02;
        let gravity = DVec3::NEG_Y * 9.81 * f64::from(sim.step_length());
        let own: f64 = sim.scene().particles.masses.iter().map(|&mass| f64::from(mass)).sum();
        for n in 0..200 {
            velocity += gravity;
            let before = DVec3::from(sim.momentum());
            sim.reactions_mut().expect("measured").pins[0] = Default::default();
            let pull = step(&mut sim, &mut place, &mut velocity, mass);
            let gained = DVec3::from(sim.momentum()) - before;
            let reactions = sim.reactions().expect("measured");
            let given = gravity * own + reactions.pins[0].linear - pull;
            let bound = if muslin::real::NAME == "f64" { 1e-12 } else { 1e-5 };
            assert!(gained.distance(given) < bound, "{} step {n}: {gained} of {given}", muslin::real::NAME);
            assert!(place.y - start.y > -0.8, "step {n}: the cloth does not hold the ball");
        }
    }
}

/// A box under one half of a sheet: the sheet turns it.
#[test]
fn the_moment_turns_a_body_that_is_hit_off_its_centre() {
    use harness::kit::double as kit;
    use muslin_core_f64::live::Live as _;
    let shape = "shape = \"box\"\n        center = [0.3, -0.12, 0]\n        half = [0.2, 0.1, 0.3]";
    let sphere = "shape = \"sphere\"\n        center = [0, -0.12, 0]\n        radius = 0.1";
    let mut sim = kit::simulation(&super::ball("", "").replace(sphere, shape), &[]);
    sim.measure_reactions();
    let (mut linear, mut angular) = (DVec3::ZERO, DVec3::ZERO);
    let (mut gained, mut turned) = (DVec3::ZERO, DVec3::ZERO);
    let weight: f64 = sim.scene().particles.masses.iter().sum::<f64>() * 9.81 * 0.005;
    for _ in 0..40 {
        let (momentum, moment) = (DVec3::from(sim.momentum()), DVec3::from(sim.angular_momentum()));
        super::lead(&mut sim, 1, |_, _| ());
        let impulse = sim.take_impulse(0).expect("measured");
        (linear, angular) = (linear + impulse.linear, angular + impulse.angular);
        gained += DVec3::from(sim.momentum()) - momentum + DVec3::Y * weight;
        turned += DVec3::from(sim.angular_momentum()) - moment;
    }
    assert!(linear.distance(-gained) < 1e-8 * gained.length(), "{linear} of {gained}");
    // The sheet lies on the left edge of the box, 0.2 m from its centre, and pushes it down.
    assert!(linear.y < -0.05 && angular.z > 0.1 * linear.length(), "{linear} N s, {angular} N m s");
    // The moment of gravity about the origin is small: the sheet hardly moves aside.
    let about_origin = angular + DVec3::new(0.3, -0.12, 0.0).cross(linear);
    assert!(about_origin.distance(-turned) < 0.1 * about_origin.length(), "{about_origin} of {turned}");
}

#[test]
fn impulses_must_be_measured() {
    use muslin_core_f64::error::LiveError;
    use muslin_core_f64::live::Live as _;
    let mut sim = harness::kit::double::simulation(&super::ball("", ""), &[]);
    assert_eq!(sim.take_impulse(0).map(|_| ()), Err(LiveError::NotMeasured));
    assert!(sim.take_impulse(1).is_err());
}
