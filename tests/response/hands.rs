//! What a host takes hold of and lets go is held, or free, for contact too: nothing pushes a vertex that is
//! led off its way, and a pin that is let go gives way as any other vertex.
//!
//! Run: `cargo test --release -p muslin-tests --test response hands`.

use harness::both_precisions;

const HEAD: &str = r#"
    name = "hands"
    duration = 1.0
    frame_rate = 100
    gravity = [0.0, -9.81, 0.0]
    integrator = { step = 0.005 }
    [contact]
    thickness = 0.004
    friction = 0.3
    [[collider]]
    shape = "plane"
    point = [0, 0, 0]
    normal = [0, 1, 0]
"#;

/// A sheet little above the plane.
const SHEET: &str = r#"
    [[cloth]]
    grid = { size = [0.2, 0.2], cells = [8, 9] }
    position = [0.0, 0.01, 0.0]
"#;

both_precisions! {
    use super::{HEAD, SHEET};
    use crate::CLOTH;
    use glam::DVec3;
    use muslin::real::{Real, to_f64};
    use muslin::live::Live as _;
    use muslin::simulation::Simulation;

    fn build(height: f64, pins: &str) -> Simulation {
        let sheet = SHEET.replace("0.01", &format!("{height:?}"));
        kit::simulation(&format!("{HEAD}{sheet}{CLOTH}{pins}"), &[])
    }

    /// Takes the same steps, and nothing tells one from the other: neither bits nor work.
    fn agree(mut one: Simulation, mut other: Simulation, what: &str) {
        for n in 1..=40 {
            let taken = [one.take_step(), other.take_step()];
            assert!(taken.iter().all(Result::is_ok), "{} {what}, step {n}: {taken:?}", muslin::real::NAME);
            let counts = [&one, &other].map(|sim| (sim.statistics(), sim.contact_statistics()));
            let same = one.state() == other.state() && counts[0] == counts[1];
            assert!(same, "{} {what}: step {n} differs, {counts:?}", muslin::real::NAME);
        }
        assert!(one.contact_statistics().proximity > 100, "{what}: hardly anything touches");
    }

    #[test]
    fn a_scene_whose_pins_are_let_go_is_that_without_pins() {
        for axes in ["xyz", "y", "xz"] {
            let mut freed = build(0.01, &format!("pin = [{{ select = {{ edge = \"left\" }}, axes = \"{axes}\" }}]\n"));
            for vertex in freed.pins().held().collect::<Vec<_>>() {
                assert!(freed.release(vertex));
            }
            agree(freed, build(0.01, ""), axes);
        }
    }

    /// Nearer to the plane than the thickness, so that contact parts what it can move.
    #[test]
    fn a_scene_whose_vertices_are_taken_hold_of_is_that_with_pins() {
        let pinned = build(0.003, "pin = [{ select = { edge = \"left\" } }]\n");
        let mut held = build(0.003, "");
        for vertex in pinned.pins().held() {
            assert_eq!(held.move_to(vertex, to_f64(held.positions()[vertex as usize]), 0.0), Ok(()));
        }
        agree(held, pinned, "held");
    }

    /// Down into a sheet that lies below, and away again.
    #[test]
    fn nothing_pushes_a_led_vertex_off_its_way() {
        let above = SHEET.replace("0.01,", "0.03,").replace("[8, 9]", "[6, 6]");
        let mut sim = kit::simulation(&format!("{HEAD}{SHEET}{CLOTH}{above}{CLOTH}"), &[]);
        let middle = sim.scene().cloths[1].vertices.start + 24;
        let from = DVec3::from(to_f64(sim.positions()[middle as usize]));
        for (to, steps) in [(DVec3::new(from.x, 0.0065, from.z), 20), (from, 20)] {
            let start = DVec3::from(to_f64(sim.positions()[middle as usize]));
            assert_eq!(sim.move_to(middle, to.into(), f64::from(steps) * f64::from(sim.step_length())), Ok(()));
            for n in 1..=steps {
                sim.take_step().unwrap_or_else(|refused| panic!("{refused}"));
                let place = start + (to - start) * (f64::from(n) / f64::from(steps));
                let off = (DVec3::from(to_f64(sim.positions()[middle as usize])) - place).length();
                assert!(off <= 4.0 * f64::from(Real::EPSILON), "{}: {off} m off after {n} steps", muslin::real::NAME);
            }
            assert!(sim.contact_statistics().proximity > 100, "hardly anything touches");
        }
        assert!(sim.release(middle));
        kit::run(&mut sim, 0.2, |_| ());
        let fallen = from.y - to_f64(sim.positions()[middle as usize])[1];
        assert!(fallen > 0.01, "let go, it fell by {fallen} m");
    }
}
