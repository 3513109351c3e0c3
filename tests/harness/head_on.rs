//! Features that approach head-on: no point moves farther than the features approach, so that an error of one
//! rounding in a distance makes the difference between a hit and a miss.

use glam::DVec3;

use crate::query::{Pair, Query};
use crate::rng::Rng;

/// The location of the contact on the two features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A vertex inside a triangle.
    Face,
    /// A vertex on an edge of a triangle.
    Side,
    /// A vertex on a corner of a triangle.
    Corner,
    /// Two edges inside both.
    Crossing,
    /// The end of an edge inside another.
    EndOnEdge,
    /// The ends of two edges.
    Ends,
    /// Two edges that enclose a small angle.
    NearlyParallel,
    /// Two parallel edges.
    Parallel,
}

/// All kinds.
pub const KINDS: [Kind; 8] = [
    Kind::Face,
    Kind::Side,
    Kind::Corner,
    Kind::Crossing,
    Kind::EndOnEdge,
    Kind::Ends,
    Kind::NearlyParallel,
    Kind::Parallel,
];

impl Kind {
    /// The pair of features.
    pub fn pair(self) -> Pair {
        match self {
            Self::Face | Self::Side | Self::Corner => Pair::VertexTriangle,
            _ => Pair::EdgeEdge,
        }
    }
}

/// Features that touch, and the direction from the second to the first, along which they approached. All
/// coordinates are multiples of one eighth below 2^11.
struct Touch {
    x: [DVec3; 4],
    along: DVec3,
}

/// Integer vectors with an integer length.
const WHOLE: [[i64; 3]; 6] = [[1, 0, 0], [0, 3, 4], [1, 2, 2], [2, 3, 6], [1, 4, 8], [4, 4, 7]];

/// Features that touch at the end and at no earlier time, and the radius around the first feature if `round`.
/// All numbers are multiples of a power of two and exact with `bits` bits of significand. The features are
/// between 1 mm and 100 m large, and up to 256 times their size from the origin.
fn exact(rng: &mut Rng, kind: Kind, bits: i32, round: bool) -> (Query, f64) {
    let Touch { x, along } = touch(rng, kind, round);
    let radius = f64::from(round) * rng.pick(&[0.125, 1.0, 8.0, 64.0]);
    let reach = rng.pick(&[0, 0, 11, 15, 18]);
    // Bits of the fraction that remain below the largest sum.
    let finest = bits - 13.max(reach + 2);
    let way = odd(rng) * 2f64.powi(4 - below(rng, i64::from(finest) + 5) as i32);
    let [first, second] = rng.pick(&[[way, 0.0], [0.0, way], [way, way]]);
    let [place, drift] = [(); 2].map(|()| vector(rng, 1 << reach) * f64::from(reach > 0));
    let scale = 2f64.powi(-20 + below(rng, 18) as i32);
    let at = |i: usize, first: f64, second: f64| x[i] + along * if i < firsts(kind) { radius + first } else { -second };
    let query = Query {
        pair: kind.pair(),
        start: std::array::from_fn(|i| (at(i, first, second) + place) * scale),
        end: std::array::from_fn(|i| (at(i, 0.0, 0.0) + place + drift) * scale),
    };
    (query, radius * along.length() * scale)
}

/// Features that approach up to a gap, before rounding. They are between 1 mm and 100 m large, and up to 10,000
/// times their size from the origin. `gap` returns the final gap divided by the size.
fn real(rng: &mut Rng, kind: Kind, epsilon: f64, gap: impl Fn(&mut Rng) -> f64) -> Query {
    let Touch { mut x, along } = touch(rng, kind, false);
    let size = x.iter().map(|v| (v - x[0]).abs().max_element()).fold(0.0, f64::max);
    if kind == Kind::NearlyParallel {
        x[3] += along.cross(x[1] - x[0]) / along.length() * rng.magnitude(1e-10, 1e-2);
    }
    let (turn, along) = (rng.rotation(), along.normalize() * size);
    let (way, gap) = (rng.magnitude(0.1 * epsilon, 1.0), gap(rng));
    let [first, second] = rng.pick(&[[1.0, 0.0], [0.0, 1.0], [0.5, 0.5]]);
    let scale = rng.magnitude(1e-3, 1e2) / size;
    let place = rng.direction() * rng.pick(&[0.0, 0.0, 1.0, 1e2, 1e4]) * size;
    let drift = rng.cube(1.0) * rng.pick(&[0.0, 1e-3, 1.0]) * size;
    let at = |i: usize, apart: f64| x[i] + along * if i < firsts(kind) { first * apart } else { -second * apart };
    Query {
        pair: kind.pair(),
        start: std::array::from_fn(|i| (turn * at(i, gap + way) + place) * scale),
        end: std::array::from_fn(|i| (turn * at(i, gap) + place + drift) * scale),
    }
}

/// A query about features of one kind.
pub struct Case {
    /// The query after rounding.
    pub query: Query,
    /// Radius around the first feature, m.
    pub radius: f64,
    /// Whether the motion ends exactly at contact. For other cases only the exact decision tells.
    pub touches: bool,
}

/// Cases of a kind, rounded to `bits` bits of significand. A third ends exactly at contact, half of these with
/// a radius if `round`; in a third, contact depends on the rounding; a third ends short of contact.
pub fn cases(rng: &mut Rng, kind: Kind, count: u64, bits: i32, round: bool, rounded: fn(&Query) -> Query) -> Vec<Case> {
    let epsilon = 2f64.powi(1 - bits);
    let mut case = |i: u64| {
        if i.is_multiple_of(3) {
            let (query, radius) = exact(rng, kind, bits, round && i.is_multiple_of(2));
            return Case { query, radius, touches: true };
        }
        let by_rounding = |rng: &mut Rng| rng.between(-4.0, 4.0) * epsilon;
        let short = |rng: &mut Rng| rng.magnitude(4.0 * epsilon, 0.1);
        let query = if i % 3 == 1 { real(rng, kind, epsilon, by_rounding) } else { real(rng, kind, epsilon, short) };
        Case { query: rounded(&query), radius: 0.0, touches: false }
    };
    (0..count).map(&mut case).collect()
}

/// Counts of the results for one kind of contact.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    hits: u64,
    missed: u64,
    short: u64,
    reported: u64,
}

impl Row {
    /// Adds a case that touches or ends short, and whether a collision is reported; prints the first that is
    /// missed.
    pub fn add(&mut self, query: &Query, touches: bool, meets: bool) {
        if touches && !meets && self.missed == 0 {
            eprintln!("missed {query}");
        }
        self.hits += u64::from(touches);
        self.missed += u64::from(touches && !meets);
        self.short += u64::from(!touches);
        self.reported += u64::from(!touches && meets);
    }

    /// Prints the row; returns the number of missed cases.
    pub fn print(&self, path: &str, kind: Kind) -> u64 {
        let Self { hits, missed, short, reported } = self;
        let (kind, share) = (format!("{kind:?}"), 100.0 * *reported as f64 / *short as f64);
        println!("{path:10} {kind:14} {hits:7} hit, {missed:5} missed; {short:7} end short, {share:5.2} % reported");
        assert!(10 * hits.min(short) >= hits + short, "{path} {kind} says nothing: {self:?}");
        *missed
    }
}

/// Number of vertices of the first feature.
fn firsts(kind: Kind) -> usize {
    if kind.pair() == Pair::VertexTriangle { 1 } else { 2 }
}

/// Creates random features that touch; if `round`, the direction has an integer length.
fn touch(rng: &mut Rng, kind: Kind, round: bool) -> Touch {
    let along = if round { whole(rng) } else { nonzero(|| vector(rng, 7)) };
    let half = rng.pick(&[2, 16, 64]);
    let mut across = || nonzero(|| along.cross(vector(rng, half)));
    let [a, b] = [across(), across()];
    let [i, j] = [(); 2].map(|()| below(rng, 9) as f64 / 8.0);
    // The other end leans away from the other feature, by up to about the length of the edges.
    let away = |part: f64| along * (part * half as f64).trunc();
    let x = match kind {
        Kind::Face => [a * i + b * j.min(1.0 - i), DVec3::ZERO, a, b],
        Kind::Side => [a * i, DVec3::ZERO, a, b - away(j)],
        Kind::Corner => [DVec3::ZERO, DVec3::ZERO, a - away(i), b - away(j)],
        Kind::Crossing => [a * -i, a * (1.0 - i), b * -j, b * (1.0 - j)],
        Kind::EndOnEdge => [DVec3::ZERO, a + away(i), b * -j, b * (1.0 - j)],
        Kind::Ends => [DVec3::ZERO, a + away(i), DVec3::ZERO, b - away(j)],
        Kind::NearlyParallel => {
            let b = a + along.cross(vector(rng, 1));
            [a * -i, a * (1.0 - i), b * -j, b * (1.0 - j)]
        }
        Kind::Parallel => {
            let b = rng.pick(&[a, -a, a * 0.5]);
            [a * -i, a * (1.0 - i), b * -j, b * (1.0 - j)]
        }
    };
    Touch { x, along }
}

fn whole(rng: &mut Rng) -> DVec3 {
    let mut along = rng.pick(&WHOLE);
    along.rotate_left(below(rng, 3) as usize);
    DVec3::from_array(along.map(|x| if rng.bits().is_multiple_of(2) { x } else { -x } as f64))
}

fn nonzero(mut vector: impl FnMut() -> DVec3) -> DVec3 {
    loop {
        let v = vector();
        if v != DVec3::ZERO {
            return v;
        }
    }
}

fn vector(rng: &mut Rng, half: i64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| (below(rng, 2 * half + 1) - half) as f64))
}

fn odd(rng: &mut Rng) -> f64 {
    (2 * below(rng, 4) + 1) as f64
}

/// A random integer in `0..bound`.
fn below(rng: &mut Rng, bound: i64) -> i64 {
    (rng.bits() % bound as u64) as i64
}
