//! A state that a host writes anew knows nothing of the contact before it.
//!
//! Run: `cargo test --release -p muslin-tests --test response afresh`.

use harness::both_precisions;

const SCENE: &str = r#"
    name = "afresh"
    duration = 1.0
    frame_rate = 100
    gravity = [0.0, -9.81, 0.0]
    [contact]
    thickness = 0.004
    [[collider]]
    shape = "plane"
    point = [0, 0, 0]
    normal = [0, 1, 0]
    [[cloth]]
    grid = { size = [0.2, 0.2], cells = [8, 9] }
    position = [0.0, 0.005, 0.0]
"#;

both_precisions! {
    use super::SCENE;
    use crate::CLOTH;
    use muslin::real::{Real, Vec3};
    use muslin::simulation::Simulation;

    /// High above the plane, bent, and falling.
    fn write(sim: &mut Simulation, start: &[Vec3]) {
        let (x, v) = sim.state_mut();
        for (n, ((x, v), start)) in x.iter_mut().zip(v).zip(start).enumerate() {
            let bend = 0.001 * (n % 7) as Real;
            (*x, *v) = (*start + Vec3::Y * (1.0 + bend), Vec3::new(bend, -1.0, 0.0));
        }
    }

    #[test]
    fn a_state_written_anew_is_as_a_first_one() {
        for method in ["backward-euler", "implicit-midpoint"] {
            let text = format!("{SCENE}{CLOTH}[integrator]\nmethod = \"{method}\"\nstep = 0.005\n");
            let mut first = kit::simulation(&text, &[]);
            let start = first.positions().to_vec();
            let mut later = first.clone();
            while !later.state().after_contact {
                kit::run(&mut later, 0.005, |sim| assert!(sim.time() < 1.0, "it touches nothing"));
            }
            write(&mut first, &start);
            write(&mut later, &start);
            for n in 1..=3 {
                for sim in [&mut first, &mut later] {
                    sim.take_step().unwrap_or_else(|refused| panic!("{refused}"));
                }
                let same = first.positions() == later.positions() && first.velocities() == later.velocities();
                assert!(same, "{} {method}: after {n} steps contact long past still tells", muslin::real::NAME);
            }
        }
    }
}
