//! Steps that are not taken: what nothing can keep apart, what is too much to follow, and what the
//! host gives up. The state is then that before the step, and nothing has passed through anything.
//!
//! Run: `cargo test -p muslin-tests --test response refusal`.

use harness::both_precisions;

const HEAD: &str = r#"
    name = "refusal"
    duration = 1.0
    frame_rate = 100
    [contact]
    thickness = 0.004
    friction = 0.3
"#;

const SHEET: &str = r#"
    [[cloth]]
    grid = { size = [0.4, 0.4], cells = [10, 12] }
    position = [0.0, 0.2, 0.0]
    density = 0.2
    stretch = { model = "membrane", stiffness = 1000.0 }
    shear = { stiffness = 300.0 }
    bend = { model = "hinge", rigidity = 1e-5 }
"#;

/// Corners led down by 0.3 m.
const LED: &str =
    "pin = [{ select = { corners = [0, 1] }, motion = { keys = [[0.0, 0, 0, 0], [0.4, 0, -0.3, 0]] } }]\n";

/// What they are led into.
const BELOW: [(&str, &str); 5] = [
    ("plane", "shape = \"plane\"\npoint = [0, 0.1, 0]\nnormal = [0, 1, 0]\n"),
    ("box", "shape = \"box\"\ncenter = [0, 0.05, -0.2]\nhalf = [0.3, 0.05, 0.1]\n"),
    ("sphere", "shape = \"sphere\"\ncenter = [0.2, 0.0, -0.2]\nradius = 0.1\n"),
    ("capsule", "shape = \"capsule\"\na = [-1, 0, -0.2]\nb = [1, 0, -0.2]\nradius = 0.1\n"),
    ("mesh", "shape = \"mesh\"\nfile = \"plate\"\n"),
];

/// A sheet that falls on a sphere, with an allowed error below the smallest normal number.
const UNREACHABLE: &str = r#"
    duration = 1.0
    gravity = [0, -9.81, 0]
    [[cloth]]
    grid = { size = [0.5, 0.5], cells = [8, 10] }
    position = [0, 0.21, 0]
    density = 0.2
    stretch = { model = "membrane", stiffness = 1000.0 }
    shear = { stiffness = 100.0 }
    bend = { model = "hinge", rigidity = 1e-5 }
    [[collider]]
    shape = "sphere"
    center = [0, 0.1, 0]
    radius = 0.1
    [contact]
    thickness = 0.005
    friction = 0.3
    [integrator]
    error = 1e-40
"#;

both_precisions! {
    use super::{BELOW, HEAD, LED, SHEET, UNREACHABLE};
    use core::sync::atomic::{AtomicU32, Ordering};
    use glam::DVec3;
    use muslin::audit;
    use muslin::dispatch::{Dispatch, Serial, Split};
    use muslin::mesh::{SurfaceColumns, TriMesh};
    use muslin::real::Vec3;
    use muslin::scene::{Content, Resource};
    use muslin::simulation::{Cause, StepError, Simulation};

    fn plate() -> [Resource; 1] {
        let corners = [[-1.0, 0.1, -1.0], [1.0, 0.1, -1.0], [1.0, 0.1, 1.0], [-1.0, 0.1, 1.0]];
        let triangles = vec![[0, 2, 1], [0, 3, 2]];
        [("plate".into(), Content::Mesh(TriMesh { positions: corners.to_vec(), triangles, ..TriMesh::default() }))]
    }

    fn build(pins: &str, collider: &str, method: &str, step: f64) -> Simulation {
        let text = format!(
            "{HEAD}{SHEET}{pins}[[collider]]\n{collider}[integrator]\nmethod = \"{method}\"\nstep = {step:?}\n"
        );
        kit::simulation(&text, &plate())
    }

    fn state(sim: &Simulation) -> Vec<Vec3> {
        sim.positions().iter().chain(sim.velocities()).copied().collect()
    }

    /// Steps until one is refused, for a second at most.
    fn refused(sim: &mut Simulation, what: &str) -> StepError {
        while sim.time() < 1.0 {
            let before = state(sim);
            let Err(refused) = sim.take_step() else {
                assert_eq!(sim.crossings(&Serial), 0, "{what}: crossings at {} s", sim.time());
                continue;
            };
            println!("{what}: {refused}");
            assert!(state(sim) == before, "{what}: {refused}, and the state is no more that before");
            return refused;
        }
        panic!("{what}: every step was taken");
    }

    #[test]
    fn pins_led_into_anything_are_refused_and_named() {
        for (name, collider) in BELOW {
            for (method, step) in [("symplectic-euler", 2e-4), ("backward-euler", 5e-3)] {
                let what = format!("{} {name}, {method}", muslin::real::NAME);
                let mut sim = build(LED, collider, method, step);
                let refused = refused(&mut sim, &what);
                assert_eq!(refused.cause, Cause::Contact { collider: Some(0), pinned: true }, "{what}: {refused}");
                assert_eq!(sim.penetration(), Some(0.0), "{what}: something is inside");
            }
        }
    }

    /// Within the thickness, and on the surface itself.
    #[test]
    fn pins_that_only_rest_near_a_plane_are_not_refused() {
        for height in [0.1, 0.1 + 1e-6, 0.102, 0.1039, 0.099] {
            let resting = SHEET.replace("0.2, 0.0]", &format!("{height:?}, 0.0]"));
            let pins = "pin = [{ select = { edge = \"left\" } }]\n";
            let integrator = "[integrator]\nmethod = \"backward-euler\"\nstep = 0.005\n";
            let text = format!("{HEAD}{resting}{pins}[[collider]]\n{}{integrator}", BELOW[0].1);
            let mut sim = kit::simulation(&text, &[]);
            for _ in 0..20 {
                let taken = sim.take_step();
                assert!(taken.is_ok(), "{} at {height} m: {taken:?}", muslin::real::NAME);
            }
        }
    }

    /// An explicit method beyond its limit: with contact it would boil for hours.
    #[test]
    #[ignore = "slow"]
    fn an_explosion_is_refused_before_all_is_near_all() {
        let mut sim = build("", BELOW[1].1, "symplectic-euler", 2e-3);
        let what = format!("{} explosion", muslin::real::NAME);
        let refused = refused(&mut sim, &what);
        assert!(matches!(refused.cause, Cause::TooMuch | Cause::NotFinite), "{what}: {refused}");
    }

    /// No solve leaves so little, so each ends at its limit of iterations. Translations of whole cloths count too: in f32
    /// this step once went on for ever.
    #[test]
    fn a_solve_that_cannot_reach_its_goal_ends() {
        let (ends, ended) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let mut sim = kit::simulation(UNREACHABLE, &[]);
            let refused = (0..3).any(|_| sim.take_step().is_err());
            // The test may have given up before.
            let _ = ends.send((refused, sim.statistics().unconverged));
        });
        let end = ended.recv_timeout(core::time::Duration::from_secs(300));
        println!("{}: {end:?}", muslin::real::NAME);
        assert!(end.is_ok(), "a step does not end: Goal::most_iterations bounds every solve");
    }

    /// Gives up when asked for the so manieth time, and then until it is patient again.
    struct Impatient(AtomicU32);

    impl Dispatch for Impatient {
        fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
            Serial.run(out, kernel);
        }
        fn stopped(&self) -> bool {
            let left = self.0.load(Ordering::Relaxed);
            self.0.store(left.saturating_sub(1), Ordering::Relaxed);
            left <= 1
        }
    }

    #[test]
    fn a_step_that_is_given_up_can_be_taken_again() {
        for method in ["symplectic-euler", "backward-euler", "implicit-midpoint", "bdf2"] {
            let falling = SHEET.replace("0.2, 0.0]", "0.105, 0.0]");
            let fast = [1, 2, 3, 4, 6, 9, 20, 60, 150].map(|asked| {
                let text = format!(
                    "{HEAD}{falling}[[collider]]\n{}[integrator]\nmethod = \"{method}\"\nstep = 0.0002\n", BELOW[1].1
                );
                let mut sim = kit::simulation(&text, &[]);
                kit::throw(&mut sim, 0, DVec3::Y * -20.0);
                let impatient = Impatient(AtomicU32::new(asked));
                let mut given_up = 0;
                for _ in 0..20 {
                    let (before, counted) = (state(&sim), (sim.statistics(), sim.contact_statistics()));
                    while let Err(refused) = sim.step(&impatient) {
                        assert_eq!(refused.cause, Cause::Stopped, "{method}: {refused}");
                        assert!(state(&sim) == before, "{method}: given up, and the state is no more that before");
                        let counts = (sim.statistics(), sim.contact_statistics());
                        assert!(counts == counted, "{method}: given up, and its work counts: {counts:?}, {counted:?}");
                        given_up += 1;
                        impatient.0.store(u32::MAX, Ordering::Relaxed);
                    }
                }
                assert_eq!(given_up, 1, "{method}: given up {given_up} times");
                state(&sim)
            });
            assert!(fast.windows(2).all(|two| two[0] == two[1]), "{method}: a step that was given up left a trace");
        }
    }

    /// What is switched off does not count: a sheet that passes through itself, while elsewhere
    /// something touches.
    #[test]
    fn without_self_contact_a_sheet_may_pass_through_itself() {
        let flopping = r#"
            [[cloth]]
            grid = { size = [0.4, 0.1], cells = [24, 6] }
            position = [2.0, 0.5, 0.0]
            density = 0.2
            stretch = { model = "membrane", stiffness = 1000.0 }
            shear = { stiffness = 300.0 }
            pin = [
                { select = { edge = "left" }, motion = { keys = [[0.0, 0, 0, 0], [0.3, 0.6, 0, 0]] } },
                { select = { edge = "right" } },
            ]
        "#;
        let resting = SHEET.replace("0.2, 0.0]", "0.1000001, 0.0]").replace("[10, 12]", "[2, 2]");
        let head = HEAD.replace("thickness", "self = false\nthickness");
        let text = format!("{head}{flopping}{resting}[[collider]]\n{}[integrator]\nstep = 0.005\n", BELOW[1].1);
        let mut sim = kit::simulation(&text, &[]);
        let all = SurfaceColumns::build(sim.positions().len(), sim.triangles(), &[]);
        let mut most = 0;
        kit::run(&mut sim, 0.3, |sim| {
            most = most.max(audit::count(&all.view(), sim.positions(), &Serial));
            assert_eq!(sim.crossings(&Serial), 0, "{}: what is switched off counts", muslin::real::NAME);
        });
        println!("{}: {most} crossings, {:?}", muslin::real::NAME, sim.contact_statistics());
        assert!(most > 0 && sim.contact_statistics().touching > 0, "the sheet does not cross itself or nothing touches");
        assert_eq!(sim.contact_statistics().rejected, 0, "a step was rejected although the contact is switched off");
    }
}
