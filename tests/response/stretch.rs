//! Contact does not draw cloth out: a method that rings does not ring with what it met.
//!
//! Run: `cargo test -p muslin-tests --test response stretch`; with `-- --nocapture` it
//! prints the largest stretch of every method.

use super::CLOTH;
use harness::both_precisions;

/// A napkin on a box that is drawn away under it.
const NAPKIN: &str = r#"
    grid = { size = [0.3, 0.3], cells = [12, 8] }
    position = [-0.022, 0.001, -0.033]
    [[collider]]
    shape = "box"
    center = [0.0, -0.05, 0.0]
    half = [0.05, 0.05, 0.05]
    motion = { keys = [[0.0, 0, 0, 0], [0.2, 0.1, -0.036, -0.01], [0.5, 0, 0, 0]] }
    [contact]
    thickness = 0.004
"#;

/// A sheet pushed along a box by pins within the thickness, with friction.
const PUSHED: &str = r#"
    grid = { size = [0.4, 0.4], cells = [16, 18] }
    position = [0.0, 0.103, 0.0]
    pin = [{ select = { edge = "left" }, motion = { keys = [[0.0, 0, 0, 0], [0.5, 0.3, 0, 0]] } }]
    [[collider]]
    shape = "box"
    center = [0.0, 0.05, 0.0]
    half = [0.15, 0.05, 0.15]
    [contact]
    thickness = 0.004
    friction = 0.3
"#;

/// A sheet whose sides are led together in its own plane, which nothing makes it leave.
const SQUEEZED: &str = r#"
    grid = { size = [0.3, 0.3], cells = [12, 14] }
    position = [0.0, 0.2, 0.0]
    pin = [
        { select = { edge = "left" }, motion = { keys = [[0.0, 0, 0, 0], [0.3, 0.12, 0, 0]] } },
        { select = { edge = "right" }, motion = { keys = [[0.0, 0, 0, 0], [0.3, -0.12, 0, 0]] } },
    ]
    [contact]
    thickness = 0.004
    friction = 0.3
"#;

/// A strip that falls on its end and folds there.
const LANDING: &str = r#"
    grid = { size = [0.1, 0.4], cells = [5, 20], pattern = "alternating" }
    rotation = [88.0, 0.0, 0.0]
    position = [0.0, 0.21, 0.0]
    [[collider]]
    shape = "plane"
    point = [0.0, 0.0, 0.0]
    normal = [0.0, 1.0, 0.0]
    [contact]
    thickness = 0.002
    friction = 0.3
"#;

fn text(scene: &str, integrator: &str) -> String {
    let head = "name = \"drawn\"\nduration = 0.3\nframe_rate = 100\ngravity = [0.0, -9.81, 0.0]\n";
    format!("{head}[[cloth]]\n{CLOTH}{scene}[integrator]\n{integrator}")
}

/// Edges may be drawn out so far in the step in which something lands.
const MOST: f64 = 1.2;

both_precisions! {
    use super::{LANDING, MOST, NAPKIN, PUSHED, SQUEEZED, text};
    use glam::DVec3;

    fn most(text: &str) -> f64 {
        let mut most: f64 = 1.0;
        kit::run(&mut kit::simulation(text, &[]), 0.3, |sim| most = most.max(sim.stretch().max.into()));
        most
    }

    /// A contact turns elements in one step. Linearised once, the step stretches them by half.
    #[test]
    fn a_strip_that_lands_on_its_end_is_not_stretched() {
        let text = text(LANDING, "step = 0.005\n");
        let mut sim = kit::simulation(&text, &[]);
        kit::throw(&mut sim, 0, DVec3::Y * -1.5);
        let mut most: f64 = 1.0;
        kit::run(&mut sim, 0.1, |sim| most = most.max(sim.stretch().max.into()));
        println!("{}: stretched by at most {most:.4}", muslin::real::NAME);
        assert!(most < 1.1, "{}: stretched {most}fold, bound 1.1", muslin::real::NAME);
        let (steps, solves) = (sim.state().steps, sim.statistics().newton_iterations);
        assert!(solves < 2 * steps, "{}: {solves} linearisations in {steps} steps", muslin::real::NAME);
    }

    #[test]
    #[ignore = "slow"]
    fn no_implicit_method_rings_with_what_it_met() {
        for method in ["backward-euler", "implicit-midpoint", "bdf2"] {
            let integrator = format!("step = 0.01\nnewton = 5\nmethod = \"{method}\"\n");
            let most = most(&text(NAPKIN, &integrator));
            println!("{} {method}: stretched by at most {most:.3}", muslin::real::NAME);
            assert!(most < MOST, "{} {method}: stretched {most}fold, bound {MOST}", muslin::real::NAME);
        }
    }

    /// Friction beyond the cone in the implicit system once drew it out to 300 times its length.
    #[test]
    #[ignore = "slow"]
    fn pins_within_the_thickness_push_cloth_along() {
        for step in [5e-3, 2.5e-3] {
            let most = most(&text(PUSHED, &format!("step = {step:?}\n")));
            println!("{} h {step}: stretched by at most {most:.3}", muslin::real::NAME);
            assert!(most < 1.1, "{} h {step}: stretched {most}fold, bound 1.1", muslin::real::NAME);
        }
    }

    /// What lies in one plane has no contact that stands for another.
    #[test]
    #[ignore = "slow"]
    fn a_sheet_pressed_together_in_its_plane_keeps_its_thickness_by_contacts() {
        let text = text(SQUEEZED, "step = 0.005\n").replace("-9.81", "0.0");
        let mut sim = kit::simulation(&text, &[]);
        kit::run(&mut sim, 0.3, |_| ());
        let contact_statistics = sim.contact_statistics();
        println!("{}: {contact_statistics:?}", muslin::real::NAME);
        assert!(contact_statistics.proximity > 1_000, "{}: the sheet does not touch itself", muslin::real::NAME);
        assert!(contact_statistics.impacts * 100 < contact_statistics.proximity, "{}: left to impacts, {contact_statistics:?}", muslin::real::NAME);
    }
}
