//! Going back to a snapshot and on gives the same bits, whatever the host did in between.

use harness::both_precisions;

/// The scene's pins, one that begins late, a scripted collider and contact.
fn scene(method: &str) -> String {
    let motion = "motion = { keys = [[0, 0, 0, 0], [0.3, 0.05, 0.02, 0]] }";
    super::ball(motion, "")
        .replace("integrator = { step = 0.005, tolerance = 1e-10 }", method)
        .replace("[[cloth]]", "[drag.wind]\nvelocity = [0, 0, 1]\nnormal = 0.5\n[[cloth]]\npin = [{ select = { vertices = [0] }, from = 0.05, until = 0.2 }]")
}

both_precisions! {
    use glam::DVec3;
    use muslin::diagnostics::StateHash;
    use muslin::dispatch::Serial;
    use muslin::kinematic::Pose;
    use muslin::live::Live as _;
    use muslin::simulation::Simulation;
    use muslin::work_done::WorkDone;

    /// What the host does before a step.
    fn act(sim: &mut Simulation, n: u32) {
        let step = f64::from(sim.step_length());
        let done = match n % 9 {
            0 => {
                let place = DVec3::from(sim.places_in_world().nth(90).expect("it exists"));
                sim.move_to(90, (place + DVec3::Y * step).into(), 3.0 * step)
            }
            1 => sim.push(20, [0.0, 0.0, 1e-4]),
            2 => sim.set_wind([0.0, 0.0, 0.02 * f64::from(n)]),
            3 => sim.set_force(80, [0.0, 1e-5 * f64::from(n), 0.0]),
            4 => sim.attach(7, 0),
            5 => { sim.release(7); Ok(()) }
            6 => {
                let pose = sim.collider_pose(0).expect("it exists");
                sim.move_collider(0, Pose::at(pose.position + DVec3::X * 0.4 * step), 2.0 * step)
            }
            7 => sim.set_gravity([0.1, -9.0, 0.0]),
            _ => { sim.release(90); Ok(()) }
        };
        assert_eq!(done, Ok(()), "action {n}");
    }

    fn go(sim: &mut Simulation, steps: core::ops::Range<u32>) -> Vec<StateHash> {
        let mut hashes = Vec::new();
        for n in steps {
            act(sim, n);
            sim.take_step().unwrap_or_else(|failed| panic!("step {n}: {failed}"));
            let mut hash = StateHash::default();
            hash.add(sim.positions(), sim.velocities());
            hashes.push(hash);
        }
        hashes
    }

    #[test]
    fn going_back_and_on_gives_the_same_bits() {
        for method in [
            "integrator = { step = 0.005 }",
            "integrator = { method = \"bdf2\", step = 0.005 }",
            "integrator = { error = 0.001 }",
            "integrator = { method = \"symplectic-euler\", step = 0.0001 }",
        ] {
            let mut sim = kit::simulation(&super::scene(method), &[]);
            sim.measure_work(WorkDone::default());
            sim.measure_reactions();
            go(&mut sim, 0..35);
            let snapshot = sim.snapshot();
            let [first, second] = [(); 2].map(|()| {
                let hashes = go(&mut sim, 35..60);
                let counted = format!("{:?} {:?} {:?}", sim.work_done(), sim.reactions(), sim.statistics());
                let crossings = sim.crossings(&Serial);
                assert_eq!(sim.go_back(&snapshot), Ok(()), "{method}");
                (hashes, counted, crossings)
            });
            assert_eq!(first, second, "{method}");
            // The same snapshot serves another simulation of the scene.
            let mut other = kit::simulation(&super::scene(method), &[]);
            other.measure_work(WorkDone::default());
            other.measure_reactions();
            assert_eq!(other.go_back(&snapshot), Ok(()), "{method}");
            assert_eq!(go(&mut other, 35..60), first.0, "{method}, in another simulation");
        }
    }
}

#[test]
fn a_snapshot_of_another_scene_is_refused() {
    let ball = harness::kit::double::simulation(&super::ball("", ""), &[]);
    let mut hanging = harness::kit::double::simulation(&super::hanging(""), &[]);
    let before = hanging.positions().to_vec();
    assert!(hanging.go_back(&ball.snapshot()).is_err());
    assert_eq!(hanging.positions(), before);
    // The same mesh without bending.
    let soft = harness::kit::double::simulation(&super::hanging("").replace("bend", "# bend"), &[]);
    assert!(hanging.go_back(&soft.snapshot()).is_err());
}

/// What one simulation measures, another need not.
#[test]
fn a_snapshot_of_a_simulation_that_measures_more_or_less_fits() {
    use harness::kit::double as kit;
    use muslin_core_f64::live::Live as _;
    let build = || kit::simulation(&scene("integrator = { error = 0.0001 }"), &[]);
    let [mut measured, mut plain] = [build(), build()];
    measured.measure_reactions();
    super::lead(&mut measured, 5, |_, _| ());
    super::lead(&mut plain, 8, |_, _| ());
    let snapshot = measured.snapshot();
    assert_eq!(plain.go_back(&snapshot), Ok(()));
    super::lead(&mut plain, 10, |_, _| ());
    super::lead(&mut measured, 10, |_, _| ());
    assert_eq!(plain.positions(), measured.positions());
    assert_eq!(measured.go_back(&plain.snapshot()), Ok(()));
    assert!(measured.take_impulse(0).is_ok(), "it is still measured");
    super::lead(&mut measured, 3, |_, _| ());
}

#[test]
fn a_snapshot_holds_the_thickness_and_the_rest_shape() {
    use harness::kit::double as kit;
    use muslin_core_f64::live::Live as _;
    let text = super::ball("", "");
    let [mut changed, mut kept] = [(); 2].map(|()| kit::simulation(&text, &[]));
    for sim in [&mut changed, &mut kept] {
        super::lead(sim, 40, |_, _| ());
    }
    let snapshot = changed.snapshot();
    let other = text.replace("thickness = 0.004", "thickness = 0.008").replace("[0.5, 0.5]", "[0.49, 0.5]");
    assert_eq!(changed.set_materials(&kit::scene(&other), &[]), Ok(()));
    super::lead(&mut changed, 3, |_, _| ());
    assert_eq!(changed.go_back(&snapshot), Ok(()));
    assert_eq!(changed.touches().count(), 0, "there was no step yet");
    for sim in [&mut changed, &mut kept] {
        super::lead(sim, 10, |_, _| ());
    }
    assert_eq!(changed.positions(), kept.positions());
}
