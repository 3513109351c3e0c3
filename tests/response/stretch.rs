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

fn text(scene: &str, integrator: &str) -> String {
    let head = "name = \"drawn\"\nduration = 0.3\nframe_rate = 100\ngravity = [0.0, -9.81, 0.0]\n";
    format!("{head}[[cloth]]\n{CLOTH}{scene}[integrator]\n{integrator}")
}

/// Edges may be drawn out so far in the step in which something lands.
const MOST: f64 = 1.2;

both_precisions! {
    use super::{MOST, NAPKIN, PUSHED, SQUEEZED, text};

    fn most(text: &str) -> f64 {
        let mut most: f64 = 1.0;
        kit::run(&mut kit::simulation(text, &[]), 0.3, |sim| most = most.max(sim.stretch().max.into()));
        most
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
        let tally = sim.tally();
        println!("{}: {tally:?}", muslin::real::NAME);
        assert!(tally.proximity > 1_000, "{}: the sheet does not touch itself", muslin::real::NAME);
        assert!(tally.impacts * 100 < tally.proximity, "{}: left to impacts, {tally:?}", muslin::real::NAME);
    }
}
