//! The torture scenes: each has a text, and a function that moves the start positions with a random generator.

use crate::rng::Rng;
use glam::DVec3;

/// A scene whose start has no crossings.
pub struct Scene {
    /// Shown in the table.
    pub name: &'static str,
    /// The scene file.
    pub text: fn() -> String,
    /// Moves the vertices, m.
    pub start: fn(&mut [DVec3], &mut Rng),
    /// Number of steps of a run.
    pub steps: u32,
}

/// Side of a sheet, m.
const SIDE: f64 = 0.2;

const MATERIAL: &str = r#"
    density = 0.2
    stretch = { model = "membrane", stiffness = 100.0, damping = 0.0005 }
    shear = { stiffness = 30.0 }
    bend = { model = "hinge", rigidity = 1e-6, damping = 0.0005 }
"#;

const GROUND: &str = r#"
    [[collider]]
    shape = "plane"
    point = [0, -0.3, 0]
    normal = [0, 1, 0]
"#;

fn scene(parts: &[&str]) -> String {
    let head = r#"
        name = "torture"
        duration = 1.0
        frame_rate = 50
        gravity = [0.0, -9.81, 0.0]
        [contact]
        thickness = 0.002
        friction = 0.3
        [integrator]
        step = 0.005
    "#;
    format!("{head}{}", parts.concat())
}

fn sheet(place: &str, material: &str) -> String {
    format!("[[cloth]]\ngrid = {{ size = [{SIDE}, {SIDE}], cells = [11, 12] }}\n{place}\n{material}")
}

fn one_sheet() -> String {
    scene(&[&sheet("", MATERIAL), GROUND])
}

fn two_sheets(light: &str, heavy: &str) -> String {
    let [lower, upper] =
        [("", light), ("position = [0.01, 0.02, 0.02]\nrotation = [0, 15, 0]", heavy)].map(|(place, change)| {
            let [from, to] = change.split_once("->").map(|(a, b)| [a, b]).expect("a change of the material");
            sheet(place, &MATERIAL.replace(from, to))
        });
    scene(&[&lower, &upper, &GROUND.replace("-0.3", "-0.02")])
}

/// Adds a random smooth height of about `size` metres; a height field does not intersect itself.
fn heights(x: &mut [DVec3], rng: &mut Rng, size: f64) {
    let waves: Vec<_> = (0..6)
        .map(|_| (rng.direction() * rng.between(10.0, 60.0), rng.between(0.0, 6.3), rng.between(0.0, size)))
        .collect();
    for x in x {
        let height: f64 =
            waves.iter().map(|(wave, phase, size)| size * (wave.x * x.x + wave.z * x.z + phase).sin()).sum();
        x.y += height;
    }
}

fn scale(x: &mut [DVec3], by: DVec3) {
    x.iter_mut().for_each(|x| *x *= by);
}

fn roughen(x: &mut [DVec3], rng: &mut Rng) {
    heights(x, rng, 2e-4);
}

/// All torture scenes.
pub const SCENES: &[Scene] = &[
    Scene {
        name: "crumpled",
        text: one_sheet,
        start: |x, rng| {
            heights(x, rng, 0.03);
            scale(x, DVec3::new(rng.between(0.1, 0.4), 1.0, rng.between(0.1, 0.4)));
        },
        steps: 60,
    },
    Scene {
        name: "line",
        text: one_sheet,
        start: |x, rng| {
            roughen(x, rng);
            scale(x, DVec3::new(1.0, 0.1, rng.magnitude(0.01, 0.05)));
        },
        steps: 60,
    },
    Scene {
        name: "plane",
        text: one_sheet,
        start: |x, rng| {
            roughen(x, rng);
            let size = rng.between(0.05, 0.5);
            scale(x, DVec3::new(size, 1e-3, size));
        },
        steps: 60,
    },
    Scene {
        // With one linearised step, the start from a thousandfold stretch would overshoot.
        name: "stretched",
        text: || one_sheet().replace("step = 0.005", "step = 0.005\nnewton = 20"),
        start: |x, rng| {
            roughen(x, rng);
            let size = rng.pick(&[10.0, 100.0, 1000.0]);
            scale(x, DVec3::new(size, 1.0, size * rng.between(0.5, 1.0)));
        },
        steps: 60,
    },
    Scene {
        name: "folded",
        text: one_sheet,
        start: |x, rng| {
            roughen(x, rng);
            scale(x, DVec3::new(1.0, 0.1, 1.0));
            let slope = rng.between(0.05, 0.3);
            for x in x.iter_mut().filter(|x| x.x > 0.0) {
                *x = DVec3::new(-x.x, x.y + slope * x.x, x.z);
            }
        },
        steps: 60,
    },
    Scene {
        name: "wrung",
        text: || {
            let clamp = |edge: &str, rate: f64| {
                format!(
                    "[[cloth.pin]]\nselect = {{ edge = \"{edge}\" }}\nmotion = {{ keys = [[0.0, 0, 0, 0], [0.5, {}, 0, 0]], \
                     turn = {{ axis = [1, 0, 0], rate = {rate:?}, until = 0.5 }} }}\n",
                    -0.1 * rate.signum() * if edge == "left" { -1.0 } else { 1.0 } * rate.signum()
                )
            };
            let strip = format!("[[cloth]]\ngrid = {{ size = [0.4, 0.1], cells = [20, 6] }}\n{MATERIAL}");
            scene(&[&strip, &clamp("left", 50.0), &clamp("right", -50.0)])
        },
        start: roughen,
        steps: 120,
    },
    Scene {
        name: "funnel",
        text: || {
            let wall = |turn: f64| {
                let (sine, cosine) = f64::to_radians(turn).sin_cos();
                format!(
                    "[[collider]]\nshape = \"box\"\ncenter = [{:?}, -0.06, {:?}]\nhalf = [0.12, 0.005, 0.08]\n\
                     rotation = [-40.0, {turn:?}, 0.0]\n",
                    0.085 * sine,
                    0.085 * cosine
                )
            };
            let walls: String = [0.0, 90.0, 180.0, 270.0].map(wall).concat();
            scene(&[&sheet("position = [0, 0.05, 0]", MATERIAL), &walls, GROUND])
        },
        start: roughen,
        steps: 120,
    },
    Scene {
        name: "masses",
        text: || two_sheets("density = 0.2->density = 0.02", "density = 0.2->density = 20000.0"),
        start: roughen,
        steps: 60,
    },
    Scene {
        name: "stiffnesses",
        text: || two_sheets("stiffness = 100.0->stiffness = 0.1", "stiffness = 100.0->stiffness = 100000.0"),
        start: roughen,
        steps: 60,
    },
    Scene {
        name: "slivers",
        text: || {
            let slivers = format!("[[cloth]]\ngrid = {{ size = [1.0, 0.1], cells = [2, 100] }}\n{MATERIAL}");
            let capsule =
                "[[collider]]\nshape = \"capsule\"\na = [0.02, -0.05, -0.1]\nb = [0, -0.05, 0.1]\nradius = 0.03\n";
            scene(&[&slivers, capsule])
        },
        start: roughen,
        steps: 60,
    },
    Scene {
        name: "capsules",
        text: || {
            let capsule = |z: f64, up: f64, rate: f64| {
                format!(
                    "[[collider]]\nshape = \"capsule\"\na = [-0.05, -0.1, {z:?}]\nb = [0.05, -0.1, {z:?}]\nradius = 0.03\n\
                     motion = {{ keys = [[0.0, 0, 0, 0], [0.1, 0, {up:?}, 0], [0.2, 0, 0, 0]], turn = {{ axis = [0, 1, 0.2], \
                     rate = {rate:?} }} }}\n"
                )
            };
            scene(&[&sheet("", MATERIAL), &capsule(0.09, 0.5, 20.0), &capsule(-0.09, 1.0, -30.0), GROUND])
        },
        start: roughen,
        steps: 60,
    },
    Scene {
        name: "pressed",
        text: || {
            let jaw = |sign: f64| {
                format!(
                    "[[collider]]\nshape = \"box\"\ncenter = [0, {:?}, 0]\nhalf = [0.3, 0.02, 0.3]\n\
                     motion = {{ keys = [[0.0, 0, 0, 0], [0.2, 0, {:?}, 0], [0.3, 0, 0, 0]] }}\n",
                    0.17 * sign,
                    -0.14 * sign
                )
            };
            scene(&[&sheet("", MATERIAL), &jaw(1.0), &jaw(-1.0)])
        },
        start: |x, rng| {
            heights(x, rng, 0.02);
            scale(x, DVec3::new(0.4, 1.0, 0.4));
        },
        steps: 60,
    },
];
