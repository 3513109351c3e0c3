//! Friction around a drum: a belt with a heavy and a light end slips or holds by the tension that it
//! takes up on the way.
//!
//! Run: `cargo test --release -p muslin-tests --test response belt`; with `-- --nocapture` it prints
//! how far.

use core::f64::consts::PI;

use muslin_tests::both_precisions;

/// Of the drum, m: its axis lies along z.
const DRUM: f64 = 0.05;
const THICKNESS: f64 = 0.002;
/// m, from the top of the drum's side downward.
const HEAVY_END: f64 = 0.5;

/// A ribbon over the drum, its lighter end to the left.
#[derive(Default)]
struct Belt {
    positions: Vec<[f64; 3]>,
    uvs: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
}

fn belt(light_end: f64) -> Belt {
    const ACROSS: usize = 4;
    let radius = DRUM + THICKNESS + 1e-5;
    let length = light_end + PI * radius + HEAVY_END;
    let rows = (length / 0.012) as usize;
    let place = |s: f64| {
        let angle = (s - light_end) / radius;
        if angle < 0.0 {
            [-radius, s - light_end]
        } else if angle < PI {
            [-radius * angle.cos(), radius * angle.sin()]
        } else {
            [radius, -(s - light_end - PI * radius)]
        }
    };
    let mut belt = Belt::default();
    for row in 0..=rows {
        let s = length * row as f64 / rows as f64;
        let [x, y] = place(s);
        for k in 0..ACROSS {
            let z = 0.04 * k as f64 / (ACROSS - 1) as f64 - 0.02;
            belt.positions.push([x, y, z]);
            belt.uvs.push([z, s]);
        }
    }
    for cell in (0..rows * ACROSS).filter(|cell| cell % ACROSS < ACROSS - 1) {
        let [a, b, c, d] = [cell, cell + 1, cell + ACROSS, cell + ACROSS + 1].map(|v| v as u32);
        belt.triangles.extend([[a, b, c], [b, d, c]]);
    }
    belt
}

/// How long the lighter end must be so that the belt holds, m: its tension T, by its weight per
/// length, grows on the way over the drum by
/// `dT / da = mu (T + R sin a) + R cos a` [Euler 1769], with the belt's own weight.
fn holding_end(mu: f64) -> f64 {
    const STEPS: usize = 4000;
    let radius = DRUM + THICKNESS;
    let slips = |light_end: f64| {
        let part = PI / STEPS as f64;
        let grow = |tension: f64, k: usize| {
            let (sine, cosine) = (part * (k as f64 + 0.5)).sin_cos();
            tension + part * (mu * (tension + radius * sine) + radius * cosine)
        };
        (0..STEPS).fold(light_end, grow) < HEAVY_END
    };
    let (mut low, mut high) = (0.0, HEAVY_END);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if slips(middle) { low = middle } else { high = middle }
    }
    high
}

fn hanging(friction: f64, integrator: &str) -> String {
    format!(
        r#"
        name = "belt"
        duration = 0.4
        frame_rate = 10
        gravity = [0.0, -9.81, 0.0]
        [contact]
        thickness = {THICKNESS:?}
        friction = {friction:?}
        {integrator}
        [[cloth]]
        mesh = "belt"
        rest = "uv"
        uv_scale = 1.0
        density = 0.2
        stretch = {{ model = "membrane", stiffness = 100.0, damping = 0.0002 }}
        shear = {{ stiffness = 30.0 }}
        bend = {{ model = "hinge", rigidity = 1e-6 }}
        [[collider]]
        shape = "capsule"
        a = [0, 0, -0.2]
        b = [0, 0, 0.2]
        radius = {DRUM:?}
        "#
    )
}

both_precisions! {
    use super::{Belt, belt, hanging, holding_end};
    use muslin::mesh::TriMesh;
    use muslin::scene::Content;

    /// How far the heavy end goes down in a time, m.
    fn falls(light_end: f64, friction: f64, integrator: &str, seconds: f64) -> f64 {
        let text = hanging(friction, integrator);
        let Belt { positions, uvs, triangles } = belt(light_end);
        let uv_triangles = triangles.clone();
        let belt = TriMesh { positions, uvs, triangles, uv_triangles, ..TriMesh::default() };
        let mut sim = kit::simulation(&text, &[("belt".into(), Content::Mesh(belt))]);
        let end = |places: &[glam::DVec3]| places.last().expect("the belt has vertices").y;
        let start = end(&kit::places(&sim, 0));
        kit::run(&mut sim, seconds, |_| ());
        start - end(&kit::places(&sim, 0))
    }

    const IMPLICIT: &str = "[integrator]\nmethod = \"backward-euler\"\nstep =";

    #[test]
    #[cfg_attr(debug_assertions, ignore = "slow: run with --release")]
    fn a_belt_slips_over_a_drum_as_fast_by_an_implicit_method_as_by_an_explicit() {
        let light_end = 0.5 * holding_end(0.1);
        for friction in [0.0, 0.1] {
            let explicit = "[integrator]\nmethod = \"symplectic-euler\"\nstep = 0.0001";
            let expected = falls(light_end, friction, explicit, 0.35);
            for (step, bound) in [(0.005, 0.2), (0.0025, 0.1), (0.001, 0.03)] {
                let went = falls(light_end, friction, &format!("{IMPLICIT} {step:?}"), 0.35);
                let error = went / expected - 1.0;
                let what = format!("{} mu {friction}, h {step}", muslin::real::NAME);
                println!("{what}: {went:.4} m, explicit {expected:.4} m, off by {error:.3}, bound {bound}");
                assert!(error.abs() < bound, "{what}: {went} m, explicit {expected} m, bound {bound}");
            }
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "slow: run with --release")]
    fn a_belt_holds_by_the_weight_that_euler_says() {
        for friction in [0.1, 0.3] {
            for (part, slips) in [(0.8, true), (1.25, false)] {
                let light_end = part * holding_end(friction);
                let by = |seconds: f64| falls(light_end, friction, &format!("{IMPLICIT} 0.001"), seconds);
                // Its own weight draws the belt out first.
                let went = by(0.4) - by(0.1);
                let what = format!("{} mu {friction}, {part} of the holding end", muslin::real::NAME);
                println!("{what}: {went:.4} m");
                assert_eq!(went > 0.01, slips, "{what}: goes on by {went} m");
            }
        }
    }
}
