//! Friction on round colliders that turn: their surface moves, their vertices do not.
//!
//! Run: `cargo test -p muslin-tests --test response turning`; with `-- --nocapture` it prints what was measured.

use core::f64::consts::PI;

use harness::belt::{ROUND, belt, drawn};
use harness::both_precisions;

use super::CLOTH;

/// Angular velocity of the sphere, rad/s.
const RATE: f64 = 2.0;

/// A small sheet on top of a sphere of 1 m that turns about `axis`.
fn on_a_sphere(axis: [f64; 3], friction: f64) -> String {
    format!(
        r#"
        name = "turning"
        duration = 1.0
        gravity = [0.0, -9.81, 0.0]
        [contact]
        thickness = 0.001
        friction = {friction:?}
        self = false
        [integrator]
        method = "backward-euler"
        step = 0.002
        [[cloth]]
        grid = {{ size = [0.06, 0.06], cells = [6, 7] }}
        position = [0.0, 0.0021, 0.0]
        {CLOTH}
        [[collider]]
        shape = "sphere"
        center = [0, -1, 0]
        radius = 1
        motion = {{ turn = {{ axis = {axis:?}, rate = {RATE:?} }} }}
        "#
    )
}

both_precisions! {
    use super::{PI, RATE, ROUND, belt, drawn, on_a_sphere};
    use glam::DVec3;
    use muslin::reactions::Impulse;
    use muslin::work_done::WorkDone;

    #[test]
    fn a_sphere_takes_cloth_along_where_its_surface_moves() {
        let mean_spin = |sim: &muslin::simulation::Simulation| {
            let velocities = sim.velocities().iter().map(|&v| DVec3::from(muslin::real::to_f64(v)));
            let each = kit::places(sim, 0).into_iter().zip(velocities).map(|(x, v)| (x.cross(v).y, x.x * x.x + x.z * x.z));
            let (moment, inertia) = each.fold((0.0, 0.0), |(p, q), (a, b)| (p + a, q + b));
            moment / inertia
        };
        for (friction, expected) in [(0.5, RATE), (0.0, 0.0)] {
            let mut sim = kit::simulation(&on_a_sphere([0.0, 1.0, 0.0], friction), &[]);
            kit::run(&mut sim, 0.5, |_| ());
            let spin = mean_spin(&sim);
            println!("{} friction {friction}: {spin:.5} rad/s, expected {expected}", muslin::real::NAME);
            assert!((spin - expected).abs() < 0.01 * RATE, "friction {friction}: {spin} rad/s, expected {expected}");
        }
        // About an axis that lies level the top of the sphere moves by radius times rate: along x, about -z.
        let mut sim = kit::simulation(&on_a_sphere([0.0, 0.0, -1.0], 0.5), &[]);
        kit::run(&mut sim, 0.1, |_| ());
        let (drift, expected) = (kit::drift(&sim, 0).x, 0.1 * 0.5 * 9.81);
        println!("{}: {drift:.5} m/s after 0.1 s, by Coulomb {expected:.5}", muslin::real::NAME);
        assert!((drift / expected - 1.0).abs() < 0.02, "{drift} m/s after 0.1 s, by Coulomb {expected}");
    }

    /// Tensions of both ends of a belt over a drum, N, and the moment about the drum's axis, N m, over the last part of
    /// a scene.
    fn tensions(scene: &str, ends: [f64; 2]) -> [f64; 3] {
        let mut sim = kit::simulation(scene, &[kit::resource("belt", belt(ends[0], 0.0068))]);
        sim.measure_work(WorkDone::default());
        sim.measure_reactions();
        kit::run(&mut sim, 0.1, |_| ());
        let sums = sim.reactions_mut().expect("measured");
        sums.pins.iter_mut().chain(&mut sums.colliders).for_each(|sum| *sum = Impulse::default());
        kit::run(&mut sim, 0.05, |_| ());
        let sums = sim.reactions().expect("measured");
        [-sums.pins[0].linear.y / 0.05, -sums.pins[1].linear.y / 0.05, sums.colliders[0].angular.z / 0.05]
    }

    #[test]
    #[ignore = "slow"]
    fn a_belt_pulls_as_euler_says_whether_it_is_drawn_over_a_drum_or_the_drum_turns_under_it() {
        let turns = |rate: f64| format!("{ROUND}\nmotion = {{ turn = {{ axis = [0, 0, 1], rate = {rate:?} }} }}");
        for friction in [0.1, 0.4] {
            for (name, drum, speed, sign) in [
                ("drawn", ROUND.to_owned(), 0.2, 1.0),
                ("turned against it", turns(4.0), 0.0, 1.0),
                ("turned along", turns(-4.0), 0.0, -1.0),
            ] {
                let [light, heavy, _] = tensions(&drawn(friction, 1e4, speed, &drum), [0.5, 0.5]);
                let (measured, expected) = ((heavy / light).ln() / PI, sign * friction);
                let what = format!("{} friction {friction}, {name}", muslin::real::NAME);
                println!("{what}: tensions {light:.4} and {heavy:.4} N, friction {measured:.4}, bound 2 %");
                assert!((measured / expected - 1.0).abs() < 0.02, "{what}: as with {measured}, tensions {light} and {heavy} N");
            }
        }
    }
}
