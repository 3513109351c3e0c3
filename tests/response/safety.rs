//! Nothing passes through anything: fast sheets, moving colliders, and what the scene's switches
//! turn off. After every step the exact audit finds no crossing and everything is on its side.
//!
//! Run: `cargo test -p muslin-tests --test response safety`.

use harness::both_precisions;

const HEAD: &str = r#"
    name = "safety"
    duration = 1.0
    frame_rate = 100
    [contact]
    thickness = 0.002
    friction = 0.2
"#;

/// A sheet of 1 m held all around in the plane y = 0.
const TAUT: &str = r#"
    [[cloth]]
    grid = { size = [1.0, 1.0], cells = [10, 10], pattern = "alternating" }
    density = 0.2
    stretch = { model = "membrane", stiffness = 500.0 }
    shear = { stiffness = 200.0 }
    bend = { model = "hinge", rigidity = 1e-5 }
    pin = [{ select = { edge = "left" } }, { select = { edge = "right" } }, { select = { edge = "front" } }, { select = { edge = "back" } }]
"#;

/// Two thin triangles above it.
const BLADE: &str = r#"
    [[cloth]]
    grid = { size = [0.05, 0.002], cells = [1, 1], pattern = "diagonal" }
    position = [0.013, 0.3, 0.017]
    density = 10.0
    stretch = { model = "membrane", stiffness = 20.0 }
    shear = { stiffness = 5.0 }
"#;

/// A free sheet above y = 0.
const NAPKIN: &str = r#"
    [[cloth]]
    grid = { size = [0.2, 0.2], cells = [8, 8] }
    position = [0.0, 0.03, 0.0]
    density = 0.2
    stretch = { model = "membrane", stiffness = 20.0 }
    shear = { stiffness = 5.0 }
    bend = { model = "hinge", rigidity = 1e-6 }
"#;

/// Colliders whose tops are wide and at y = 0.
const GROUNDS: [(&str, &str); 5] = [
    ("plane", r#"shape = "plane", point = [0, 0, 0], normal = [0, 1, 0]"#),
    ("box", r#"shape = "box", center = [0, -0.05, 0], half = [2, 0.05, 2]"#),
    ("sphere", r#"shape = "sphere", center = [0, -0.5, 0], radius = 0.5"#),
    ("capsule", r#"shape = "capsule", a = [-3, -0.5, -3], b = [3, -0.5, 3], radius = 0.5"#),
    ("mesh", r#"shape = "mesh", file = "plate""#),
];

both_precisions! {
    use super::{BLADE, GROUNDS, HEAD, NAPKIN, TAUT};
    use glam::DVec3;
    use muslin::dispatch::Serial;
    use muslin::mesh::TriMesh;
    use muslin::scene::{Content, PointCache, Resource};
    use harness::pieces::Piece;
    use muslin::simulation::Simulation;
    use muslin::real::{Real, to_f64};
    use harness::rng::Rng;

    /// A square of 4 m at y = 0, and its way in a point cache: up and down by 0.2 m, 50 frames a
    /// second.
    fn plate() -> [Resource; 2] {
        let corners = [[-2.0, 0.0, -2.0], [2.0, 0.0, -2.0], [2.0, 0.0, 2.0], [-2.0, 0.0, 2.0]];
        let mesh = TriMesh {
            positions: corners.to_vec(),
            triangles: vec![[0, 2, 1], [0, 3, 2]],
            ..TriMesh::default()
        };
        let frame = |k: usize| corners.map(|c| [c[0] as f32, if k % 2 == 1 { 0.2 } else { 0.0 }, c[2] as f32]);
        let cache = PointCache { points: 4, positions: (0..20).flat_map(frame).collect() };
        [("plate".into(), Content::Mesh(mesh)), ("jolts".into(), Content::Cache(cache))]
    }

    fn build(parts: &[&str], method: &str) -> Simulation {
        let integrator = format!("[integrator]\nmethod = \"{method}\"\nstep = 0.001\n");
        kit::simulation(&format!("{HEAD}{}{integrator}", parts.concat()), &plate())
    }

    fn collider(keys: &str, motion: &str) -> String {
        format!("[[collider]]\n{}\n{motion}\n", keys.replace(", point", "\npoint").replace(", normal", "\nnormal")
            .replace(", center", "\ncenter").replace(", half", "\nhalf").replace(", radius", "\nradius")
            .replace(", a =", "\na =").replace(", b =", "\nb =").replace(", file", "\nfile"))
    }

    fn no_crossing(sim: &Simulation, what: &str) {
        let (found, contact_statistics) = (sim.crossings(&Serial), sim.contact_statistics());
        assert_eq!(found, 0, "{what}: crossings at {} s; the response saw {contact_statistics:?}", sim.time());
    }

    /// How often a line straight down from a point passes through a cloth.
    fn layers_below(sim: &Simulation, cloth: usize, from: DVec3) -> usize {
        let range = sim.scene().cloths[cloth].vertices.clone();
        let triangles = sim.triangles().iter().filter(|t| range.contains(&t[0]));
        let passed = triangles.filter(|t| {
            let [a, b, c] = t.map(|v| DVec3::from(to_f64(sim.positions()[v as usize])) - from);
            let turn = |p: DVec3, q: DVec3| p.x * q.z - p.z * q.x;
            let [u, v, w] = [turn(b, c), turn(c, a), turn(a, b)];
            let inside = (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
            inside && (u * a.y + v * b.y + w * c.y) / (u + v + w) < 0.0
        });
        passed.count()
    }

    #[test]
    fn a_blade_at_100_m_per_s_does_not_pass_a_taut_sheet() {
        for method in ["backward-euler", "bdf2"] {
            for (seed, stand) in [[0.0, 0.0, 0.0], [0.0, 0.0, 90.0], [90.0, 0.0, 0.0], [37.0, 20.0, 61.0]].iter().enumerate() {
                let blade = format!("{BLADE}rotation = {stand:?}\n");
                let mut sim = build(&[TAUT, &blade], method);
                let mut rng = Rng::new(seed as u64);
                kit::throw(&mut sim, 1, DVec3::new(0.0, -100.0, 0.0) + rng.cube(5.0));
                let what = format!("{} {method}, blade turned by {stand:?}", muslin::real::NAME);
                kit::run(&mut sim, 0.012, |sim| {
                    no_crossing(sim, &what);
                    for x in kit::places(sim, 1) {
                        let layers = layers_below(sim, 0, x);
                        assert_eq!(layers % 2, 1, "{what}: at {} s a vertex at {x} is not above the sheet", sim.time());
                    }
                });
            }
        }
    }

    #[test]
    fn a_blade_at_100_m_per_s_does_not_pass_a_collider() {
        for (name, keys) in GROUNDS {
            for (moves, motion) in [("at rest", ""), ("rising", "motion = { keys = [[0.0, 0, 0, 0], [1.0, 0, 30, 0]] }")] {
                for stand in [[0.0, 0.0, 0.0], [0.0, 0.0, 90.0], [90.0, 0.0, 0.0], [37.0, 20.0, 61.0]] {
                    let blade = format!("{BLADE}rotation = {stand:?}\n");
                    let mut sim = build(&[&blade, &collider(keys, motion)], "backward-euler");
                    kit::throw(&mut sim, 0, DVec3::new(0.0, -100.0, 0.0));
                    let what = format!("{} {name} {moves}, blade turned by {stand:?}", muslin::real::NAME);
                    let rises = if motion.is_empty() { 0.0 } else { 30.0 };
                    kit::run(&mut sim, 0.01, |sim| {
                        no_crossing(sim, &what);
                        let depth = f64::from(sim.penetration().unwrap_or_default());
                        assert_eq!(depth, 0.0, "{what}: at {} s a vertex is inside", sim.time());
                        for x in kit::places(sim, 0) {
                            // A sphere falls off to the sides of where it is hit.
                            let top = rises * sim.time() - if name == "sphere" || name == "capsule" { 0.02 } else { 0.0 };
                            assert!(x.y > top, "{what}: at {} s a vertex at {x} is below", sim.time());
                        }
                    });
                }
            }
        }
    }

    #[test]
    fn a_rising_collider_lifts_a_napkin() {
        for (name, keys) in GROUNDS {
            let motion = "motion = { keys = [[0.0, 0, 0, 0], [0.02, 0, 0.3, 0], [0.04, 0, 0.2, 0], [0.06, 0, 0.6, 0]] }";
            for method in ["symplectic-euler", "backward-euler"] {
                let mut sim = build(&[NAPKIN, &collider(keys, motion)], method);
                let what = format!("{} {name}, {method}", muslin::real::NAME);
                kit::run(&mut sim, 0.06, |sim| {
                    no_crossing(sim, &what);
                    assert_eq!(sim.penetration(), Some(0.0), "{what}: at {} s a vertex is inside", sim.time());
                });
                let lowest = kit::places(&sim, 0).iter().map(|x| x.y).fold(f64::INFINITY, f64::min);
                // A ball of 0.5 m is 0.02 m lower at the corners of a napkin of 0.2 m.
                assert!(lowest > 0.57, "{what}: lifted to 0.6 m, the napkin is at {lowest}");
            }
        }
    }

    #[test]
    fn a_plate_in_a_point_cache_jolts_a_napkin() {
        let keys = r#"shape = "mesh", file = "plate""#;
        let mut sim = build(&[NAPKIN, &collider(keys, "motion = \"jolts\"\nmotion_rate = 50.0")], "backward-euler");
        kit::run(&mut sim, 0.3, |sim| {
            no_crossing(sim, muslin::real::NAME);
            let plate = to_f64(sim.collider_positions()[0])[1];
            let lowest = kit::places(sim, 0).iter().map(|x| x.y).fold(f64::INFINITY, f64::min);
            assert!(lowest > plate, "at {} s the napkin is at {lowest}, the plate at {plate}", sim.time());
        });
    }

    #[test]
    fn a_turning_box_sweeps_a_napkin_away() {
        let keys = r#"shape = "box", center = [0, 0, 0], half = [0.6, 0.02, 0.3]"#;
        for rate in [5.0, 50.0] {
            let motion = format!("motion = {{ turn = {{ axis = [0, 0, 1], rate = {rate:?} }} }}");
            let napkin = NAPKIN.replace("[0.0, 0.03, 0.0]", "[0.3, 0.03, 0.0]");
            let mut sim = build(&[&napkin, &collider(keys, &motion)], "backward-euler");
            let what = format!("{}, {rate} rad/s", muslin::real::NAME);
            let mut deepest: f64 = 0.0;
            kit::run(&mut sim, 0.1, |sim| {
                no_crossing(sim, &what);
                deepest = deepest.max(sim.penetration().map_or(0.0, f64::from));
            });
            println!("{what}: at most {deepest:.1e} m deep");
            assert_eq!(deepest, 0.0, "{what}: a vertex gets inside");
        }
    }

    /// Pairs nearer than a time of impact can tell: the exact test decides.
    #[test]
    fn sheets_that_begin_all_but_touching_do_not_pass() {
        let above = NAPKIN.replace("[0.0, 0.03, 0.0]", "[0.013, 0.03000001, 0.017]");
        let plate = collider(GROUNDS[1].1, "");
        for method in ["symplectic-euler", "backward-euler"] {
            let mut sim = build(&[NAPKIN, &above, &plate], method);
            let what = format!("{}, {method}", muslin::real::NAME);
            assert_eq!(sim.crossings(&Serial), 0, "{what}: choose a start without crossings");
            kit::run(&mut sim, 0.1, |sim| no_crossing(sim, &what));
            println!("{what}: {} pairs touched", sim.contact_statistics().touching);
            assert!(sim.contact_statistics().touching > 0, "{what}: nothing touched, choose a start nearer");
        }
    }

    /// A collider so fast beside the thickness that its push leaves every box.
    #[test]
    fn a_ball_far_faster_than_thick_still_pushes() {
        for (thickness, speed) in [(1e-3, 100.0), (1e-4, 100.0), (1e-5, 30.0)] {
            let ball = r#"shape = "sphere", center = [0, -0.11, 0], radius = 0.1"#;
            let motion = format!("motion = {{ keys = [[0.0, 0, 0, 0], [1.0, 0, {speed:?}, 0]] }}");
            let text = format!("{HEAD}{NAPKIN}{}[integrator]\nstep = 0.005\n", collider(ball, &motion));
            let text = text.replace("thickness = 0.002", &format!("thickness = {thickness:?}"));
            let mut sim = kit::simulation(&text, &[]);
            let what = format!("{}, {speed} m/s, {thickness} m thick", muslin::real::NAME);
            kit::run(&mut sim, 0.02, |sim| {
                assert_eq!(sim.penetration(), Some(0.0), "{what}: at {} s a vertex is inside", sim.time());
            });
            println!("{what}: {:?}", sim.contact_statistics());
        }
    }

    #[test]
    fn what_starts_inside_a_ball_or_a_plane_is_pushed_out() {
        for (name, keys) in [GROUNDS[0], GROUNDS[2]] {
            for method in ["symplectic-euler", "backward-euler"] {
                let sunk = NAPKIN.replace("0.03", "-0.004");
                let mut sim = build(&[&sunk, &collider(keys, "")], method);
                let what = format!("{} {name}, {method}", muslin::real::NAME);
                let start = sim.penetration().map_or(0.0, f64::from);
                assert!(start >= 0.004, "{what}: starts {start} m deep only");
                kit::run(&mut sim, 0.1, |_| ());
                let (depth, speed) = (sim.penetration().map_or(0.0, f64::from), kit::fastest(&sim));
                println!("{what}: from {start:.4} to {depth:.1e} m deep, at {speed:.1e} m/s");
                assert_eq!(depth, 0.0, "{what}: started {start} m deep and is still inside");
                assert!(speed < 0.5, "{what}: comes out at {speed} m/s");
            }
        }
    }

    /// A lower and an upper napkin that falls on it, with a plane below both.
    fn two_napkins(switch: &str, speed: f64) -> Simulation {
        let upper = NAPKIN.replace("0.03", "0.06");
        let plane = collider(GROUNDS[0].1, "");
        let text = format!("{HEAD}{switch}\n{NAPKIN}{upper}{plane}[integrator]\nstep = 0.001\n");
        let mut sim = kit::simulation(&text, &[]);
        kit::throw(&mut sim, 1, DVec3::Y * -speed);
        sim
    }

    fn lowest(sim: &Simulation, cloth: usize) -> f64 {
        kit::places(sim, cloth).iter().map(|x| x.y).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn without_self_contact_only_colliders_are_met() {
        let mut sim = two_napkins("self = false", 2.0);
        kit::run(&mut sim, 0.05, |sim| assert!(lowest(sim, 1) > 0.0, "the plane is passed at {} s", sim.time()));
        assert!(lowest(&sim, 1) < 0.02 && lowest(&sim, 0) > 0.025, "the upper napkin did not fall through the lower");
    }

    #[test]
    fn without_continuous_detection_what_is_slow_is_met_and_what_is_fast_passes() {
        let mut slow = two_napkins("continuous = false", 1.0);
        kit::run(&mut slow, 0.05, |sim| no_crossing(sim, "1 mm a step, 2 mm thick"));
        assert_eq!(slow.contact_statistics().impacts, 0, "impacts were looked for");
        let mut fast = two_napkins("continuous = false", 100.0);
        kit::run(&mut fast, 0.001, |_| ());
        assert!(lowest(&fast, 1) < 0.03, "100 mm in a step did not pass a sheet of 2 mm");
    }

    /// Contact is inelastic whatever the method: one that rings would throw back what it stops, and
    /// does so no more than the cloth's own springs.
    #[test]
    fn a_sheet_that_lands_does_not_bounce() {
        for method in ["symplectic-euler", "backward-euler", "implicit-midpoint", "bdf2"] {
            let mut sim = build(&[NAPKIN, &collider(GROUNDS[0].1, "")], method);
            kit::throw(&mut sim, 0, DVec3::Y * -2.0);
            let mut landed = false;
            let mut back: f64 = 0.0;
            kit::run(&mut sim, 0.05, |sim| {
                let rate = kit::drift(sim, 0).y;
                landed |= rate > -1.0;
                back = back.max(rate);
            });
            println!("{} {method}: comes back at {back:.1e} of 2 m/s", muslin::real::NAME);
            assert!(landed, "{method}: it never landed");
            assert!(back < 0.1, "{method}: it landed at 2 m/s and comes back at {back}");
        }
    }

    /// What the implicit system moves for contact is looked for where it is moved to.
    #[test]
    fn what_the_implicit_system_throws_is_swept_again() {
        let triangle = |y: f64| Piece {
            start: vec![DVec3::Y * y, DVec3::new(1.0, y, 0.0), DVec3::new(0.0, y, 1.0)],
            moves: vec![DVec3::ZERO; 3],
            masses: vec![1.0; 3],
        };
        let pieces = [triangle(0.0), triangle(1.0)];
        let outcome = |by: f64| kit::respond_after(&pieces, 0.01, 0.0, |ends| ends[0].y -= by as Real).outcome;
        assert_eq!(outcome(0.1), "Free", "within the boxes around the motion");
        assert_eq!(outcome(100.0), "LeavesBoxes", "out of the box for which its candidates were found");
    }
}
