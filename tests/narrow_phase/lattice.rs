//! Features that touch, without any rounding: contacts made of small integers, so that start, end and the
//! contact are exact in f32.

use glam::DVec3;

use harness::query::{Pair, Query};
use harness::rng::Rng;

/// Lattice steps per unit of length.
const UNIT: f64 = 16384.0;

/// Contacts of every kind: inside the features and on their borders, between slivers, parallel edges and
/// features without extent; head-on, grazing and at rest.
pub struct Contact {
    /// Features of about unit length that touch.
    pub query: Query,
    /// A time of contact; the features may touch earlier too.
    pub time: f64,
}

/// A random contact.
pub fn contact(rng: &mut Rng, pair: Pair) -> Contact {
    let eighths = pick(rng, 9);
    let (x, v) = match pair {
        Pair::VertexTriangle => vertex_triangle(rng),
        Pair::EdgeEdge => edge_edge(rng),
    };
    let at = |eighths: f64| std::array::from_fn(|i| (x[i] + v[i] / 8.0 * eighths) / UNIT);
    Contact { query: Query { pair, start: at(-eighths), end: at(8.0 - eighths) }, time: eighths / 8.0 }
}

/// A long translation whose sum with the positions is still exact in f32.
pub fn far(rng: &mut Rng) -> DVec3 {
    let reach = [0, 1 << 12, 1 << 16, 1 << 21][below(rng, 4) as usize];
    vector(rng, reach, 1) / UNIT
}

/// Positions at the contact and motions of `[p, t0, t1, t2]`.
fn vertex_triangle(rng: &mut Rng) -> ([DVec3; 4], [DVec3; 4]) {
    let [a, mut b, mut c] = [(); 3].map(|()| point(rng));
    match below(rng, 12) {
        0 => b = a,
        1 => (b, c) = (a, a),
        2 => c = a + 2.0 * (b - a),
        3 => c = a + coarse((b - a) / 2.0) + vector(rng, 1, 64),
        _ => {}
    }
    let inside = below(rng, 9);
    let (w_b, w_c) = (pick(rng, inside + 1), (8 - inside) as f64);
    let mix = |a: DVec3, b: DVec3, c: DVec3| a + (b - a) / 8.0 * w_b + (c - a) / 8.0 * w_c;
    let [v_a, v_b, v_c] = motions(rng);
    let along = (b - a) / 8.0 * (pick(rng, 17) - 8.0) + (c - a) / 8.0 * (pick(rng, 17) - 8.0);
    let motion = mix(v_a, v_b, v_c) + relative(rng, along);
    ([mix(a, b, c), a, b, c], [motion, v_a, v_b, v_c])
}

/// Positions at the contact and motions of `[a0, a1, b0, b1]`.
fn edge_edge(rng: &mut Rng) -> ([DVec3; 4], [DVec3; 4]) {
    let [a0, mut a1] = [(); 2].map(|()| point(rng));
    let mut b = vector(rng, 128, 64);
    match below(rng, 12) {
        0 => a1 = a0,
        1 => b = DVec3::ZERO,
        2 => (a1, b) = (a0, DVec3::ZERO),
        3 => b = coarse((a1 - a0) / 2.0),
        4 => b = a1 - a0 + vector(rng, 1, 64),
        _ => {}
    }
    let (s, t) = (pick(rng, 9), pick(rng, 9));
    let [v_0, v_1, turn] = motions(rng);
    let along = (a1 - a0) / 8.0 * (pick(rng, 17) - 8.0) + b / 8.0 * (pick(rng, 17) - 8.0);
    let b0 = a0 + (a1 - a0) / 8.0 * s - b / 8.0 * t;
    let v_b0 = v_0 + (v_1 - v_0) / 8.0 * s + relative(rng, along) - turn / 8.0 * t;
    ([a0, a1, b0, b0 + b], [v_0, v_1, v_b0, v_b0 + turn])
}

/// Relative motion of the touching points: free, or along the features with little or no motion off them.
fn relative(rng: &mut Rng, along: DVec3) -> DVec3 {
    match below(rng, 4) {
        0 => along,
        1 => along + vector(rng, 1, 8),
        _ => vector(rng, 1024, 8),
    }
}

/// Motions of three vertices: random, equal, small or zero.
fn motions(rng: &mut Rng) -> [DVec3; 3] {
    let common = vector(rng, 128, 64);
    match below(rng, 4) {
        0 => [common; 3],
        1 => [DVec3::ZERO; 3],
        2 => [(); 3].map(|()| vector(rng, 4, 64)),
        _ => [(); 3].map(|()| vector(rng, 128, 64)),
    }
}

fn point(rng: &mut Rng) -> DVec3 {
    let half = [2, 16, 256][below(rng, 3) as usize];
    vector(rng, half, 64)
}

fn vector(rng: &mut Rng, half: i64, step: i64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| ((below(rng, 2 * half + 1) - half) * step) as f64))
}

/// Truncates to multiples of 64.
fn coarse(v: DVec3) -> DVec3 {
    (v / 64.0).trunc() * 64.0
}

/// A random integer in `0..bound`.
fn pick(rng: &mut Rng, bound: i64) -> f64 {
    below(rng, bound) as f64
}

fn below(rng: &mut Rng, bound: i64) -> i64 {
    (rng.bits() % bound as u64) as i64
}
