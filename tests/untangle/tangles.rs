//! Tangled start states: the text of a scene, and a function that moves its vertices.

use glam::DVec3;
use harness::rng::Rng;

/// Side of a square sheet, m.
pub const SIDE: f64 = 0.2;

/// A scene with the given cloths and colliders.
pub fn scene(parts: &[&str]) -> String {
    let head = "name = \"tangled\"\nduration = 0.5\nframe_rate = 50\n[contact]\nthickness = 0.002\nfriction = 0.3\n\
                [integrator]\nstep = 0.005\n";
    format!("{head}{}", parts.concat())
}

/// A square sheet with cells of 1/60 m and additional keys.
pub fn sheet(keys: &str) -> String {
    format!(
        "[[cloth]]\ngrid = {{ size = [{SIDE}, {SIDE}], cells = [12, 14] }}\ndensity = 0.2\n\
         stretch = {{ model = \"membrane\", stiffness = 100.0, damping = 0.0005 }}\nshear = {{ stiffness = 30.0 }}\n\
         bend = {{ model = \"hinge\", rigidity = 1e-6, damping = 0.0005 }}\n{keys}\n"
    )
}

/// Two sheets; `keys` place the second.
pub fn two(keys: &str) -> String {
    scene(&[&sheet(""), &sheet(keys)])
}

/// A tangled start state.
pub struct Tangle {
    pub name: &'static str,
    pub text: fn() -> String,
    /// Moves the vertices, m.
    pub start: fn(&mut [DVec3]),
    /// The farthest that a vertex may be moved, m: about a fifth above the measured value.
    pub most: f64,
}

fn as_built(_: &mut [DVec3]) {}

/// A smooth bump: 1 in the middle, 0 beyond the radius.
fn bump(x: DVec3, radius: f64) -> f64 {
    let r = x.x.hypot(x.z) / radius;
    if r < 1.0 { (1.0 - r * r).powi(2) } else { 0.0 }
}

pub const TANGLES: &[Tangle] = &[
    Tangle {
        name: "tilted",
        text: || two("position = [0.003, 0.003, 0.002]\nrotation = [0, 0, 3]"),
        start: as_built,
        most: 0.004,
    },
    Tangle {
        name: "steep",
        text: || two("position = [0.003, 0.07, 0.002]\nrotation = [0, 8, 70]"),
        start: as_built,
        most: 0.045,
    },
    Tangle {
        name: "folded through",
        text: || scene(&[&sheet("")]),
        // The right half bends back over the sheet and dips through it.
        start: |x| {
            for x in x {
                let past = x.x;
                if past > 0.0 {
                    let (radius, turn) = (0.012, past / 0.012);
                    let half = std::f64::consts::PI;
                    let (along, up) = if turn < half {
                        (radius * turn.sin(), radius * (1.0 - turn.cos()))
                    } else {
                        let back = past - radius * half;
                        (-0.7 * back, 2.0 * radius - 0.7 * back)
                    };
                    x.x = along;
                    x.y += up;
                }
            }
        },
        most: 0.033,
    },
    Tangle {
        name: "ball",
        text: || {
            let ball = "[[collider]]\nshape = \"sphere\"\ncenter = [0.01, -0.03, 0.005]\nradius = 0.05\n";
            scene(&[&sheet(""), ball])
        },
        start: as_built,
        most: 0.0265,
    },
    Tangle {
        name: "box",
        text: || {
            let block = "[[collider]]\nshape = \"box\"\ncenter = [0.05, -0.03, 0.005]\nhalf = [0.06, 0.045, 0.05]\n\
                         rotation = [5, 20, 3]\n";
            scene(&[&sheet(""), block])
        },
        start: as_built,
        most: 0.0265,
    },
    Tangle {
        name: "box edge",
        text: || {
            let block = "[[collider]]\nshape = \"box\"\ncenter = [0.002, -0.06, 0.005]\nhalf = [0.3, 0.05, 0.05]\n\
                         rotation = [45, 0, 0]\n";
            scene(&[&sheet(""), block])
        },
        start: as_built,
        most: 0.014,
    },
    Tangle {
        // The spike passes through the middle of a triangle: it cuts no edge of the sheet.
        name: "spike",
        text: || {
            let block = "[[collider]]\nshape = \"box\"\ncenter = [0.03, -0.0766, 0.03]\nhalf = [0.05, 0.05, 0.05]\n\
                         rotation = [45, 0, 35.26]\n";
            scene(&[&sheet("").replace("[12, 14]", "[2, 2]"), block])
        },
        start: as_built,
        most: 0.036,
    },
    Tangle {
        name: "corner",
        text: || two("position = [0.12, 0.012, 0.13]"),
        start: |x| {
            let half = x.len() / 2;
            for x in &mut x[half..] {
                x.y -= 0.03 * (1.0 - (x.x - 0.02).hypot(x.z - 0.03) / 0.1).max(0.0);
            }
        },
        most: 0.0158,
    },
    Tangle {
        name: "borders",
        text: || two("position = [0.17, 0.002, 0.002]\nrotation = [25, 0, 0]"),
        start: as_built,
        most: 0.0495,
    },
    Tangle {
        name: "bump",
        text: || two("position = [0.002, 0.005, 0.001]"),
        start: |x| {
            let half = x.len() / 2;
            x[..half].iter_mut().for_each(|x| x.y += 0.03 * bump(*x, 0.06));
        },
        most: 0.0073,
    },
    Tangle {
        name: "two bumps",
        text: || two("position = [0.002, 0.0, 0.001]"),
        start: |x| {
            let half = x.len() / 2;
            x[..half].iter_mut().for_each(|x| x.y += 0.02 * (60.0 * x.x).sin() * (50.0 * x.z + 0.3).sin());
            x[half..].iter_mut().for_each(|x| x.y += 0.004);
        },
        most: 0.0206,
    },
    Tangle { name: "on one another", text: || two(""), start: as_built, most: 0.0026 },
    Tangle {
        name: "ground",
        text: || {
            scene(&[
                &sheet("rotation = [30, 0, 80]"),
                "[[collider]]\nshape = \"plane\"\npoint = [0, -0.03, 0]\nnormal = [0, 1, 0]\n",
            ])
        },
        start: as_built,
        most: 0.095,
    },
];

/// Deforms a sheet by random waves and folds it in the middle, so that the layers pass through one another by a
/// few millimetres to a centimetre.
pub fn crumple(x: &mut [DVec3], rng: &mut Rng) {
    let waves: Vec<_> = (0..6)
        .map(|_| {
            (
                rng.direction() * rng.between(20.0, 60.0),
                rng.between(0.0, 6.3),
                rng.direction() * rng.between(0.001, 0.005),
            )
        })
        .collect();
    let (lift, slope) = (rng.between(0.0, 0.002), rng.between(-0.05, 0.05));
    for x in x {
        let shift: DVec3 =
            waves.iter().map(|(wave, phase, size)| *size * (wave.x * x.x + wave.z * x.z + phase).sin()).sum();
        *x += shift;
        if x.x > 0.0 {
            *x = DVec3::new(-x.x, x.y + lift * (x.x / 0.02).min(1.0) + slope * x.x, x.z);
        }
    }
}
