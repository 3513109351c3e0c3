//! The degenerate elements, and bounds on their forces. Every list ranges from harmless to fully collapsed, at
//! rest and moving, in random orientations.

use glam::{DMat2, DVec2, DVec3};
use harness::rng::Rng;
use harness::states::{Bar, Fold, Regime, State, Stitch, Triangle};
use harness::worst::norm;

/// The largest allowed norms.
pub struct Limits {
    pub force: f64,
    pub jacobian: f64,
}

/// Factors from harmless, through values that vanish by rounding or whose square underflows in f32, to zero.
const COLLAPSE: [f64; 14] = [1.0, 0.3, 0.1, 0.05, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 3e-7, 1e-8, 1e-15, 1e-25, 0.0];

fn states<P: Copy, const K: usize>(size: f64, cases: impl IntoIterator<Item = (P, [DVec3; K])>) -> Vec<State<P, K>> {
    let rng = &mut Rng::new(120);
    let mut states = Vec::new();
    for (part, x) in cases {
        for speed in [0.0, size] {
            let turn = rng.rotation();
            for x in [x, x.map(|x| turn * x)] {
                states.push(State { regime: Regime::Mixed, size, part, x, v: x.map(|_| rng.cube(speed)) });
            }
        }
    }
    states
}

/// Coincident and nearly coincident ends, with and without a rest length.
pub fn bars() -> Vec<State<Bar, 2>> {
    let at = |rest: f64| {
        let part = Bar { rest, stiffness: 500.0, damping: 20.0 };
        COLLAPSE.map(|length| (part, [DVec3::ZERO, DVec3::X * (0.1 * length)]))
    };
    states(0.1, at(0.1).into_iter().chain(at(0.0)))
}

/// A spring along x of 500 N/m and 0.1 m, compressed to a fraction of its length.
pub fn compressed_bar(left: f64) -> (State<Bar, 2>, [DVec3; 2]) {
    let x = [DVec3::ZERO, DVec3::X * 0.1 * left];
    (states(0.1, [(Bar { rest: 0.1, stiffness: 500.0, damping: 0.0 }, x)])[0], x)
}

/// Force: k times length and rest length, plus kd times the velocities. Jacobian: k + kd.
pub fn bar_limits(s: &State<Bar, 2>) -> Limits {
    let Bar { rest, stiffness, damping } = s.part;
    let pull = stiffness * (rest + norm(&s.x)) + damping * norm(&s.v);
    Limits { force: 2.0 * pull, jacobian: 4.0 * (stiffness + damping) }
}

/// Triangles collapsed to a line, to an edge and to a point, and slivers of aspect 1e4 at rest and in the
/// state.
pub fn triangles() -> Vec<State<Triangle, 3>> {
    let equilateral = [DVec2::ZERO, DVec2::new(0.1, 0.0), DVec2::new(0.05, 0.0866)];
    let sliver = [DVec2::ZERO, DVec2::new(0.1, 0.0), DVec2::new(0.05, 1e-5)];
    let part = |rest| Triangle { rest, stiffness: [500.0, 300.0, 200.0], damping: [0.1, 0.2] };
    let mut cases = Vec::new();
    for rest in [equilateral, sliver] {
        let place = |map: DMat2| rest.map(|x| (map * x).extend(0.0));
        for t in COLLAPSE {
            cases.push((part(rest), place(DMat2::from_diagonal(DVec2::new(1.0, t)))));
            cases.push((part(rest), place(DMat2::from_diagonal(DVec2::new(t, 1.0)))));
            cases.push((part(rest), place(DMat2::from_diagonal(DVec2::splat(t)))));
            // Warp and weft lie on one line and keep their rest length.
            cases.push((part(rest), place(DMat2::from_cols(DVec2::X, DVec2::new(1.0, t)))));
            cases.push((part(rest), place(DMat2::from_cols(DVec2::X, DVec2::new(-1.0, t)))));
        }
        // Rest shape and state are exchanged: 1e4 times as high, or as low.
        for x in [equilateral, sliver] {
            cases.push((part(rest), x.map(|x| x.extend(0.0))));
        }
    }
    states(0.1, cases)
}

/// A right triangle of 500 N/m with sides of 0.1 m, compressed along the warp to a fraction.
pub fn compressed_triangle(left: f64) -> (State<Triangle, 3>, [DVec3; 3]) {
    let rest = [DVec2::ZERO, DVec2::X * 0.1, DVec2::Y * 0.1];
    let x = rest.map(|x| DVec3::new(x.x * left, x.y, 0.0));
    (states(0.1, [(Triangle { rest, stiffness: [500.0; 3], damping: [0.0; 2] }, x)])[0], x)
}

/// Area, weight, and bounds on the deformation gradient and its rate for these corners.
fn deformation(s: &State<Triangle, 3>) -> [f64; 4] {
    let [a, b, c] = s.part.rest;
    let rest = DMat2::from_cols(b - a, c - a);
    let (inverse, area) = (rest.inverse(), rest.determinant().abs() / 2.0);
    let weight = inverse.x_axis.length().hypot(inverse.y_axis.length());
    [area, weight, weight * norm(&s.x), weight * norm(&s.v)]
}

/// Force: the stress k |w| (1 + |w|^2), distributed to the corners by the weights. Jacobian: its derivative.
pub fn triangle_limits(s: &State<Triangle, 3>) -> Limits {
    let ([area, weight, w, rate], stiffness, time) = (deformation(s), 500.0, 0.2);
    let stress = stiffness * ((1.0 + w).powi(3) + time * rate * (1.0 + w).powi(2));
    let stiffening = stiffness * (1.0 + time) * (1.0 + w).powi(2);
    Limits { force: 4.0 * area * weight * stress, jacobian: 8.0 * area * weight * weight * stiffening }
}

/// Vanishing edges and heights, coincident corners, exactly closed folds, slivers at rest and in the state.
pub fn hinges() -> Vec<State<Fold, 4>> {
    let part = |rest_angle, least_height| Fold { stiffness: 1e-3, rest_angle, least_height, damping: 1e-4 };
    let mut cases = Vec::new();
    for rest_angle in [0.0, 1.0, -3.0] {
        let height = 0.08;
        let usual = part(rest_angle, 0.1 * height);
        let fold = |length: f64, [h1, h2]: [f64; 2], angle: f64, along: f64| {
            let far = DVec3::new(along, h2 * angle.sin(), -h2 * angle.cos());
            (usual, [DVec3::ZERO, DVec3::X * length, DVec3::new(along, 0.0, h1), far])
        };
        for angle in [0.0, 0.5, -2.0, 3.0] {
            for t in COLLAPSE {
                cases.push(fold(0.1 * t, [height; 2], angle, 0.05 * t));
                // The far corners project beyond the short edge.
                cases.push(fold(0.1 * t, [height; 2], angle, 0.2));
                cases.push(fold(0.1, [height * t, height], angle, 0.05));
                cases.push(fold(0.1, [height * t; 2], angle, 0.05));
                // Collapse beside the edge, and in all directions.
                cases.push(fold(0.1, [height * t; 2], angle, 0.3));
                cases.push(fold(0.1 * t, [height * t; 2], angle, 0.05 * t));
            }
        }
        // Exactly closed, from both sides: the far corners coincide.
        let shut = [DVec3::ZERO, DVec3::X * 0.1, DVec3::Z * height, DVec3::Z * height];
        cases.push((usual, shut));
        cases.push((usual, [shut[1], shut[0], shut[3], shut[2]]));
        // Slivers of aspect 1e4 at rest: flat, folded and shut.
        for angle in [0.0, 1.0, std::f64::consts::PI] {
            let (_, x) = fold(0.1, [1e-5; 2], angle, 0.05);
            cases.push((part(rest_angle, 1e-6), x));
        }
    }
    states(0.1, cases)
}

/// A hinge folded by an angle; its heights are the fraction `left` of the least height.
pub fn compressed_hinge(left: f64, angle: f64) -> (State<Fold, 4>, [DVec3; 4]) {
    let part = Fold { stiffness: 1e-3, rest_angle: 0.0, least_height: 0.01, damping: 0.0 };
    let far = DVec3::new(0.05, 0.01 * left * angle.sin(), -0.01 * left * angle.cos());
    let x = [DVec3::ZERO, DVec3::X * 0.1, DVec3::new(0.05, 0.0, 0.01 * left), far];
    (states(0.1, [(part, x)])[0], x)
}

/// The gradient of the angle is 1 / height, and the offset of a far corner along the edge divided by height and
/// length; heights and lengths count as at least `least_height`.
pub fn hinge_limits(s: &State<Fold, 4>) -> Limits {
    let least = s.part.least_height;
    let gradient = 2.0 / least * (1.0 + 2.0 * norm(&s.x) / least);
    let moment = s.part.stiffness * std::f64::consts::PI + s.part.damping * gradient * norm(&s.v);
    let jacobian = (s.part.stiffness + s.part.damping) * gradient * gradient;
    Limits { force: moment * gradient, jacobian }
}

/// Closed stitches, and stitches to an edge without length; both for three weights.
pub fn stitches() -> Vec<State<Stitch, 3>> {
    let part = |weight| Stitch { weight, stiffness: 500.0, damping: 20.0 };
    let closed = [DVec3::ZERO; 3];
    let short = [DVec3::X * 0.1, DVec3::ZERO, DVec3::ZERO];
    let cases = [0.0, 0.5, 1.0].map(part).into_iter().flat_map(|part| [closed, short].map(|x| (part, x)));
    states(0.1, cases)
}

/// Force: k times the gap. Jacobian: k.
pub fn stitch_limits(s: &State<Stitch, 3>) -> Limits {
    let Stitch { stiffness, damping, .. } = s.part;
    let pull = stiffness * norm(&s.x) + damping * norm(&s.v);
    Limits { force: 4.0 * pull, jacobian: 8.0 * (stiffness + damping) }
}

pub const WIND: DVec3 = DVec3::new(3.0, -1.0, 2.0);
pub const WIND_DRAG: [f64; 2] = [0.6, 0.07];

/// Coefficient times area times velocity.
pub fn wind_limits(s: &State<Triangle, 3>) -> Limits {
    let (area, speed) = (norm(&s.x).powi(2).max(1e-300), WIND.length() + norm(&s.v));
    Limits { force: area * WIND_DRAG[0] * speed, jacobian: area * WIND_DRAG[0] }
}

pub const VERTICES: usize = 26;
pub const SCENE: &str = r#"
    name = "everything"
    duration = 0
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.3, 0.2], cells = [3, 2] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 2000.0, damping = 0.1 }
    shear = { stiffness = 500.0, damping = 0.1 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.1 }
    seam = [{ pairs = [[0, 9]], stiffness = 20.0 }]
    [[cloth]]
    grid = { size = [0.3, 0.2], cells = [3, 2] }
    density = 0.3
    stretch = { model = "spring", stiffness = 2000.0, damping = 0.1 }
    bend = { model = "spring", stiffness = 1.0, damping = 0.1 }
    [drag]
    linear = 0.1
    wind = { velocity = [3.0, -1.0, 2.0], normal = 0.6, tangential = 0.07 }
"#;

/// A name, and a function from rest position to collapsed position.
pub type Collapse = (&'static str, fn(DVec3) -> DVec3);

pub const COLLAPSES: [Collapse; 6] = [
    ("in a point", |_| DVec3::splat(0.7)),
    ("on a line", |x| DVec3::X * x.x),
    ("on a slanting line", |x| DVec3::new(1.0, 2.0, 3.0) * (x.x + 0.3 * x.z)),
    ("in its plane", |x| x),
    ("folded onto itself", |x| DVec3::new(x.x.abs(), 0.0, x.z)),
    ("shrunk to 1e-12", |x| x * 1e-12),
];
