//! Coulomb on a plane: where a sheet begins to slide, how it slides, where it stops and that it does
//! not creep; for a speck of two triangles and for a sheet of 32x32 vertices. Gravity leans instead
//! of the plane, but for one test.
//!
//! Run: `cargo test -p muslin-tests --test response friction`.

use harness::both_precisions;

const GRAVITY: f64 = 9.81;
const MU: f64 = 0.5;
const SPECK: &str = r#"size = [0.02, 0.02], cells = [1, 1]"#;
const PATCH: &str = r#"size = [0.31, 0.31], cells = [31, 31]"#;
const METHODS: [&str; 2] = ["symplectic-euler", "backward-euler"];
/// Directions in the plane, degrees: along both families of edges, along and across the diagonals.
const HEADINGS: [f64; 4] = [0.0, 45.0, 90.0, 135.0];

/// A sheet that lies on a plane.
#[derive(Clone, Copy)]
struct Lying {
    sheet: &'static str,
    method: &'static str,
    friction: &'static str,
    /// Tangent of the angle by which gravity leans.
    slope: f64,
    /// Where it leans to, degrees.
    heading: f64,
    /// s.
    step: f64,
}

impl Lying {
    fn new(sheet: &'static str, method: &'static str, slope: f64) -> Self {
        Self { sheet, method, friction: "0.5", slope, heading: 0.0, step: 5e-4 }
    }

    fn down(&self) -> [f64; 2] {
        let (sine, cosine) = self.heading.to_radians().sin_cos();
        [cosine, sine]
    }

    fn text(&self) -> String {
        let Self { sheet, method, friction, slope, step, .. } = self;
        let level = GRAVITY / (1.0 + slope * slope).sqrt();
        let [x, z] = self.down().map(|part| part * slope * level);
        format!(
            r#"
            name = "lying"
            duration = 1.0
            frame_rate = 100
            gravity = [{x:?}, {:?}, {z:?}]
            [[cloth]]
            grid = {{ {sheet}, pattern = "diagonal" }}
            position = [0.0, 0.001, 0.0]
            density = 0.2
            stretch = {{ model = "membrane", stiffness = 20.0 }}
            shear = {{ stiffness = 8.0 }}
            bend = {{ model = "hinge", rigidity = 1e-7 }}
            [contact]
            thickness = 0.001
            friction = {friction}
            [[collider]]
            shape = "plane"
            point = [0, 0, 0]
            normal = [0, 1, 0]
            [integrator]
            method = "{method}"
            step = {step:?}
            "#,
            -level
        )
    }

    /// g (sin - mu cos), m/s^2.
    fn acceleration(&self, mu: f64) -> f64 {
        GRAVITY * (self.slope - mu) / (1.0 + self.slope * self.slope).sqrt()
    }
}

both_precisions! {
    use super::{GRAVITY, HEADINGS, Lying, METHODS, MU, PATCH, SPECK};
    use glam::DVec3;
    use muslin::simulation::Simulation;

    /// Faster than this a sheet slides, m/s: in f32 rounding alone moves it by a quarter of that.
    const STILL: f64 = kit::bound(2e-5, 1e-6);

    fn laid(lying: &Lying) -> (Simulation, DVec3) {
        let [x, z] = lying.down();
        (kit::simulation(&lying.text(), &[]), DVec3::new(x, 0.0, z))
    }

    /// Speed downhill after a time from rest, m/s.
    fn speed_after(lying: &Lying, seconds: f64) -> f64 {
        let (mut sim, down) = laid(lying);
        kit::run(&mut sim, seconds, |_| ());
        kit::drift(&sim, 0).dot(down)
    }

    #[test]
    fn a_speck_slides_from_the_slope_of_its_friction_on() {
        for method in METHODS {
            let slides = |slope: f64| speed_after(&Lying::new(SPECK, method, slope), 0.2) > STILL;
            let (mut sticks_at, mut slides_at) = (0.9 * MU, 1.1 * MU);
            assert!(!slides(sticks_at) && slides(slides_at), "{method}: sticks and slides within a tenth of mu {MU}");
            while slides_at - sticks_at > 1e-4 {
                let middle = 0.5 * (sticks_at + slides_at);
                if slides(middle) { slides_at = middle } else { sticks_at = middle }
            }
            println!("{} {method}: slides from a slope of {slides_at:.5} on, mu {MU}", muslin::real::NAME);
            assert!(
                slides_at >= MU - 1e-3 && sticks_at <= MU + 1e-3,
                "{method}: slides from a slope between {sticks_at} and {slides_at} on, expected {MU} within 1e-3"
            );
        }
    }

    #[test]
    fn a_patch_sticks_and_slides_a_thousandth_beside_the_slope_of_its_friction() {
        for (method, step) in METHODS.into_iter().zip([5e-4, 2e-3]) {
            for heading in HEADINGS {
                let at = |slope: f64| Lying { heading, step, ..Lying::new(PATCH, method, slope) };
                let below = speed_after(&at(MU - 1e-3), 0.1);
                let above = speed_after(&at(MU + 1e-3), 0.1);
                println!("{} {method} to {heading}: {below:.1e} m/s below, {above:.1e} above", muslin::real::NAME);
                assert!(below.abs() < STILL, "{method} to {heading} degrees: slides at {below} m/s below its slope");
                assert!(above > STILL, "{method} to {heading} degrees: {above} m/s only above its slope");
            }
        }
    }

    /// Over the second half, once the sheet has taken its elastic shape.
    fn creep(lying: &Lying, seconds: f64) -> f64 {
        let (mut sim, _) = laid(lying);
        kit::run(&mut sim, 0.5 * seconds, |_| ());
        let before = kit::places(&sim, 0);
        kit::run(&mut sim, 0.5 * seconds, |_| ());
        let moved = kit::places(&sim, 0).iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        moved / (0.5 * seconds)
    }

    #[test]
    fn what_sticks_does_not_creep() {
        for (method, step) in METHODS.into_iter().zip([5e-4, 2e-3]) {
            for sheet in [SPECK, PATCH] {
                for slope in [0.0, 0.5 * MU, 0.99 * MU] {
                    let creep = creep(&Lying { step, heading: 30.0, ..Lying::new(sheet, method, slope) }, 0.2);
                    let what = format!("{} {method}, {sheet}, slope {slope}", muslin::real::NAME);
                    println!("{what}: creeps at {creep:.1e} m/s, bound {:.0e}", STILL);
                    assert!(creep < STILL, "{what}: creeps at {creep} m/s, expected less than {STILL}");
                }
            }
        }
    }

    /// Checks the acceleration between two times, m/s^2.
    fn slides_by(lying: &Lying, expected: f64) {
        let (mut sim, down) = laid(lying);
        let mut at = |seconds: f64| {
            kit::run(&mut sim, seconds, |_| ());
            kit::drift(&sim, 0).dot(down)
        };
        let (early, late) = (at(0.05), at(0.1));
        let error = (late - early) / 0.1 / expected - 1.0;
        let what = format!("{} {} {} to {}", muslin::real::NAME, lying.method, lying.sheet, lying.heading);
        println!("{what}: acceleration off by {error:.1e}, bound 5e-4");
        assert!(error.abs() <= 5e-4, "{what}: acceleration off by {error} of {expected} m/s^2");
    }

    #[test]
    fn sliding_accelerates_by_what_friction_leaves() {
        for (method, step) in METHODS.into_iter().zip([5e-4, 2e-3]) {
            slides_by(&Lying::new(SPECK, method, 0.8), Lying::new(SPECK, method, 0.8).acceleration(MU));
            for heading in HEADINGS {
                let lying = Lying { heading, step, ..Lying::new(PATCH, method, 0.8) };
                slides_by(&lying, lying.acceleration(MU));
            }
        }
    }

    /// In f32 friction moves it in a step by less than positions round.
    #[test]
    fn friction_is_not_lost_in_the_rounding_of_short_steps() {
        let lying = Lying { step: 2.5e-5, ..Lying::new(SPECK, "symplectic-euler", 0.8) };
        slides_by(&lying, lying.acceleration(MU));
    }

    #[test]
    fn a_frictionless_slope_is_a_free_fall_along_it() {
        for method in METHODS {
            let lying = Lying { friction: "0.0", ..Lying::new(PATCH, method, 0.8) };
            slides_by(&lying, lying.acceleration(0.0));
        }
    }

    #[test]
    fn a_sheet_stops_after_its_stopping_distance() {
        let speed: f64 = 1.0;
        let expected = speed * speed / (2.0 * MU * GRAVITY);
        for method in METHODS {
            for sheet in [SPECK, PATCH] {
                let (mut sim, _) = laid(&Lying::new(sheet, method, 0.0));
                kit::throw(&mut sim, 0, DVec3::new(0.6, 0.0, 0.8) * speed);
                let before: DVec3 = kit::places(&sim, 0).iter().sum();
                kit::run(&mut sim, 0.25, |_| ());
                let places = kit::places(&sim, 0);
                let moved = (places.iter().sum::<DVec3>() - before).length() / places.len() as f64;
                let what = format!("{} {method}, {sheet}", muslin::real::NAME);
                println!("{what}: stops after {moved:.5} m, expected {expected:.5} within 0.5 %");
                assert!((moved / expected - 1.0).abs() <= 5e-3, "{what}: stops after {moved} m, expected {expected}");
                let left = kit::drift(&sim, 0).length();
                assert!(left < STILL, "{what}: still moves at {left} m/s");
            }
        }
    }

    #[test]
    fn a_leaning_plane_is_as_good_as_leaning_gravity() {
        for (slope, sticks) in [(MU - 1e-3, true), (MU + 1e-3, false)] {
            let (level, degrees) = ((1.0 + slope * slope).sqrt().recip(), slope.atan().to_degrees());
            let normal = DVec3::new(slope, 1.0, 0.0) * level;
            let lies = normal * 0.001;
            let text = Lying::new(PATCH, "backward-euler", 0.0).text();
            let text = text
                .replace("normal = [0, 1, 0]", &format!("normal = {:?}", normal.to_array()))
                .replace("position = [0.0, 0.001, 0.0]", &format!("position = {:?}\nrotation = [0, 0, {:?}]", lies.to_array(), -degrees));
            let mut sim = kit::simulation(&text, &[]);
            kit::run(&mut sim, 0.1, |_| ());
            let speed = kit::drift(&sim, 0).dot(DVec3::new(1.0, -slope, 0.0) * level);
            println!("{} on a slope of {slope}: {speed:.1e} m/s", muslin::real::NAME);
            assert_eq!(speed.abs() < STILL, sticks, "on a slope of {slope} with mu {MU}: {speed} m/s");
        }
    }

    #[test]
    fn what_rests_needs_the_static_coefficient_and_what_slides_the_kinetic() {
        let friction = "{ static = 0.6, kinetic = 0.4 }";
        for method in METHODS {
            for sheet in [SPECK, PATCH] {
                let lying = Lying { friction, ..Lying::new(sheet, method, 0.5) };
                let rests = speed_after(&lying, 0.1);
                assert!(rests.abs() < STILL, "{method}, {sheet}: from rest it slides at {rests} m/s");
                let (mut sim, down) = laid(&lying);
                kit::throw(&mut sim, 0, down * 0.5);
                kit::run(&mut sim, 0.1, |_| ());
                let error = (kit::drift(&sim, 0).dot(down) - 0.5) / 0.1 / lying.acceleration(0.4) - 1.0;
                println!("{} {method}, {sheet}: acceleration off by {error:.1e}, bound 5e-4", muslin::real::NAME);
                assert!(error.abs() <= 5e-4, "{method}, {sheet}: thrown, its acceleration is off by {error}");
            }
        }
    }

    /// In each step the speed falls by mu(v) g h, with mu at the speed before friction.
    fn follows(friction: &'static str, mu: impl Fn(f64) -> f64) {
        let (mut sim, _) = laid(&Lying { friction, ..Lying::new(SPECK, "symplectic-euler", 0.0) });
        kit::throw(&mut sim, 0, DVec3::X);
        let (mut before, mut worst, h) = (1.0, 0.0_f64, f64::from(sim.step_length()));
        kit::run(&mut sim, 0.1, |sim| {
            let now = kit::drift(sim, 0).length();
            worst = worst.max(((before - now) / (GRAVITY * h) - mu(before)).abs());
            before = now;
        });
        let bound = kit::bound(2e-4, 1e-9);
        println!("{} {friction}: coefficient off by {worst:.1e}, bound {bound:.0e}", muslin::real::NAME);
        assert!(worst <= bound, "{friction}: in some step the coefficient is off by {worst}, expected {bound}");
    }

    #[test]
    fn a_coefficient_that_depends_on_the_speed_is_met_in_every_step() {
        let stribeck = |v: f64| 0.3 + 0.3 * (-(v / 0.4) * (v / 0.4)).exp();
        follows("{ static = 0.6, kinetic = 0.3, stribeck = 0.4 }", stribeck);
        follows("{ static = 0.6, kinetic = 0.3, stribeck = 0.4, viscous = 0.2 }", |v| stribeck(v) + 0.2 * v);
        follows("{ static = 0.3, kinetic = 0.3, viscous = 0.2 }", |v| 0.3 + 0.2 * v);
    }

    #[test]
    fn viscous_friction_needs_no_other() {
        follows("{ static = 0.0, kinetic = 0.0, viscous = 0.2 }", |v| 0.2 * v);
    }

    /// Friction that is judged anew with every correction of a step is chased by them: a sheet on a
    /// sphere was torn to ten times its size by it.
    #[test]
    #[ignore = "slow"]
    fn a_coefficient_that_depends_on_the_speed_does_not_tear() {
        let ball = muslin::scene::BUILT_IN.iter().find(|(name, _)| *name == "ball").expect("ball is built in").1;
        for friction in ["{ static = 0.4, kinetic = 0.3 }", "{ static = 0.4, kinetic = 0.3, stribeck = 0.1, viscous = 0.1 }"] {
            let mut sim = kit::simulation(&ball.replace("friction = 0.3", &format!("friction = {friction}")), &[]);
            let mut most = 1.0;
            kit::run(&mut sim, 0.3, |sim| most = sim.stretch().max.max(most));
            println!("{} {friction}: stretched by at most {most:.3}", muslin::real::NAME);
            assert!(most < 1.2, "{friction}: an edge is stretched to {most}");
        }
    }
}
