//! Friction around a drum: a belt with a heavy and a light end slips or holds by the tension that it
//! takes up on the way.
//!
//! Run: `cargo test -p muslin-tests --test response belt`; with `-- --nocapture` it prints
//! how far.

use harness::belt::{DRAWN, HEAVY_END, HELD, ROUND, ROUND_ONES, belt, hanging, holding_end, loaded, slips};
use harness::both_precisions;

both_precisions! {
    use super::{DRAWN, HEAVY_END, HELD, ROUND, ROUND_ONES, belt, hanging, holding_end, loaded, slips};
    use core::f64::consts::PI;

    /// How far the heavy end goes down after the light end was let go, m.
    fn falls(light_end: f64, spacing: f64, friction: f64, stiffness: f64, integrator: &str, seconds: f64) -> f64 {
        let belt = kit::resource("belt", belt(light_end, spacing));
        kit::falls(&hanging(friction, stiffness, integrator, ROUND), &[belt], [HELD, HELD + seconds])
    }

    /// The same of a belt of 20 kN/m. In a step of 1 ms waves of tension pass 46 of its edges.
    fn stiff_falls(light_end: f64, friction: f64, seconds: f64) -> f64 {
        falls(light_end, 0.0068, friction, 2e4, &format!("{IMPLICIT} 0.001"), seconds)
    }

    const IMPLICIT: &str = "[integrator]\nmethod = \"backward-euler\"\nstep =";

    /// A belt of 10 kN/m stretches by a ten-thousandth, so that the formula for a belt that does not stretch holds.
    #[test]
    #[ignore = "slow"]
    fn a_belt_slips_over_a_drum_as_euler_says_by_explicit_and_implicit_methods() {
        for friction in [0.0, 0.1, 0.4] {
            let light_end = 0.5 * holding_end(f64::max(friction, 0.1));
            let expected = slips(friction, light_end, 0.2);
            // In single precision gaps are rounded by more than such a short step changes them.
            let explicit = ("symplectic-euler", 1e-5, if muslin::real::NAME == "f32" { 0.06 } else { 0.02 });
            let implicit = [(0.005, 0.3), (0.0025, 0.1), (0.001, 0.02)].map(|(step, bound)| ("backward-euler", step, bound));
            for (method, step, bound) in implicit.into_iter().chain([explicit]) {
                let integrator = format!("[integrator]\nmethod = \"{method}\"\nstep = {step:?}");
                let went = falls(light_end, 0.0068, friction, 1e4, &integrator, 0.2);
                let error = went / expected - 1.0;
                let what = format!("{} mu {friction}, {method}, h {step}", muslin::real::NAME);
                println!("{what}: {went:.4} m, by Euler {expected:.4} m, off by {error:.4}, bound {bound}");
                assert!(error.abs() < bound, "{what}: {went} m, by Euler {expected} m, bound {bound}");
            }
        }
    }

    #[test]
    #[ignore = "slow"]
    fn a_belt_holds_by_the_weight_that_euler_says() {
        for friction in [0.1, 0.3] {
            for (part, slips) in [(0.8, true), (1.25, false)] {
                let light_end = part * holding_end(friction);
                let by = |seconds: f64| falls(light_end, 0.012, friction, 100.0, &format!("{IMPLICIT} 0.001"), seconds);
                // The release draws the belt out first.
                let went = by(0.4) - by(0.1);
                let what = format!("{} mu {friction}, {part} of the holding end", muslin::real::NAME);
                println!("{what}: {went:.4} m");
                assert_eq!(went > 0.01, slips, "{what}: goes on by {went} m");
            }
        }
    }

    /// Twice the tension at one end is less than the drum holds. The ends swing by micrometres.
    #[test]
    #[ignore = "slow"]
    fn a_belt_that_holds_does_not_creep() {
        for (stiffness, step) in [(5e3, 0.001), (5e3, 0.002), (5e4, 0.001)] {
            let belt = kit::resource("belt", belt(HEAVY_END, 0.0068));
            let way = kit::falls(&loaded(0.3, stiffness, [1.0, 2.0], step), &[belt], [0.5, 1.5]);
            let what = format!("{} a belt of {stiffness} N/m, h {step}", muslin::real::NAME);
            println!("{what}: creeps by {way:.1e} m in 1 s, bound 1e-5");
            assert!(way.abs() < 1e-5, "{what}: creeps by {way} m in 1 s, expected less than 1e-5");
        }
    }

    /// A belt is drawn over a capsule or a sphere by long steps and sinks into the thickness. It would stay rough,
    /// almost without friction, if only the nearest vertices were held and the others sank, and on a sphere also if
    /// contacts did not resist the tilt of triangles.
    #[test]
    #[ignore = "slow"]
    fn a_belt_that_sank_into_the_thickness_is_lifted_out() {
        for (collider, cells) in ROUND_ONES.iter().flat_map(|x| ["[60, 2]", "[59, 3]", "[100, 4]"].map(|y| (x, y))) {
            for friction in [0.28_f64, 0.29, 0.3, 0.31] {
                let text = DRAWN.replace("FRICTION", &format!("{friction:?}")).replace("[60, 2]", cells);
                let pin = kit::held(&text.replace("COLLIDER", collider));
                // It hangs down at the right, and goes straight to the pins, here from the axis, at the left.
                let [x, y, radius] = [-0.11_f64, -0.1445, 0.104];
                let wrapped = 1.5 * PI - (x / y).atan() - (radius / x.hypot(y)).acos();
                let holds = (friction * wrapped).exp();
                let name = muslin::real::NAME;
                let shape = collider.lines().next().unwrap_or_default();
                let belt = format!("{name} {cells}, friction {friction}, {shape}");
                println!("{belt}: {pin:.3} N of {holds:.3} N");
                assert!((pin / holds - 1.0).abs() < 0.08, "{belt}: {pin:.3} N of {holds:.3} N");
            }
        }
    }

    #[test]
    #[ignore = "slow"]
    fn a_stiff_belt_slips_and_sticks_as_euler_says() {
        let light_end = holding_end(0.4) / 1.98;
        let (went, expected) = (stiff_falls(light_end, 0.4, 0.2), slips(0.4, light_end, 0.2));
        let error = went / expected - 1.0;
        let what = format!("{}: pulled by 1.98 times the holding weight, {went:.4} m", muslin::real::NAME);
        println!("{what}, by Euler {expected:.4} m, off by {error:.4}, bound 0.015");
        assert!(error.abs() < 0.015, "{what}, by Euler {expected} m, off by {error}, expected at most 0.015");
        for (over, least, most) in [(0.96, 0.0, 0.001), (1.09, 0.065, 0.2)] {
            let by = |seconds: f64| stiff_falls(holding_end(0.2) / over, 0.2, seconds);
            let speed = (by(0.4) - by(0.2)) / 0.2;
            let what = format!("{}: pulled by {over} times the holding weight, {speed:.4} m/s", muslin::real::NAME);
            println!("{what}, expected {least} to {most}");
            assert!(speed.abs() >= least && speed.abs() <= most, "{what}, expected {least} to {most}");
        }
    }

    /// Prints how far belts of several stiffnesses slip in 0.2 s, by step, and the friction with which a belt that does
    /// not stretch slips as far: the table of the manual.
    #[test]
    #[ignore = "slow"]
    fn long_form_of_belts_by_stiffness_and_step() {
        for friction in [0.1, 0.4] {
            let light_end = 0.5 * holding_end(friction);
            println!("friction {friction}: {:.4} m by Euler's formula", slips(friction, light_end, 0.2));
            for (stiffness, explicit) in [(100.0, 1e-4), (1e3, 2.5e-5), (1e4, 1e-5), (1e5, 2.5e-6)] {
                let explicit = ("symplectic-euler", explicit);
                let implicit = [0.005, 0.0025, 0.001, 0.0005, 0.00025].map(|step| ("backward-euler", step));
                for (method, step) in implicit.into_iter().chain([explicit]) {
                    let integrator = format!("[integrator]\nmethod = \"{method}\"\nstep = {step:?}");
                    let way = falls(light_end, 0.0068, friction, stiffness, &integrator, 0.2);
                    let (mut low, mut high) = (0.2 * friction, 2.0 * friction);
                    while high - low > 1e-4 {
                        let middle = 0.5 * (low + high);
                        if slips(middle, light_end, 0.2) > way { low = middle } else { high = middle }
                    }
                    let name = muslin::real::NAME;
                    println!("{name} {stiffness} N/m, {method}, {step} s: {way:.4} m, as with friction {high:.3}");
                }
            }
        }
    }
}
