//! Distances against brute force in f64, which finds the closest parameter by ternary search. All errors are
//! relative to the largest coordinate.

use glam::DVec3;

use harness::query::Pair;
use harness::rng::Rng;

/// Number of random cases of each pair.
const COUNT: usize = 20_000;

/// The distance: minimises a convex function of one parameter, after minimising over the other parameter in
/// closed form.
pub fn brute_force(pair: Pair, x: &[DVec3; 4]) -> f64 {
    let [a, b, c, d] = x.map(|v| v - x[0]);
    match pair {
        Pair::VertexTriangle => least(|w| {
            let (from, to) = (b.lerp(c, w), d.lerp(c, w));
            point_edge(a, from, to)
        }),
        Pair::EdgeEdge => least(|s| point_edge(a.lerp(b, s), c, d)),
    }
}

fn least(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..90 {
        let third = (high - low) / 3.0;
        if f(low + third) < f(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    f(low).min(f(0.0)).min(f(1.0))
}

fn point_edge(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (reach, edge) = (p - a, b - a);
    let s = if edge == DVec3::ZERO { 0.0 } else { (reach.dot(edge) / edge.length_squared()).clamp(0.0, 1.0) };
    (reach - s * edge).length()
}

/// Features of every proportion; a quarter is nearly flat or parallel, and half are moved to a random distance
/// of at least `nearest`.
pub fn features(rng: &mut Rng, pair: Pair, nearest: f64) -> [DVec3; 4] {
    let mut x: [DVec3; 4] = std::array::from_fn(|_| rng.cube(1.0));
    let tilt = rng.direction() * rng.magnitude(1e-9, 1e-2);
    match (pair, rng.bits() % 8) {
        (Pair::VertexTriangle, 0 | 1) => x[3] = x[1].lerp(x[2], rng.between(-1.0, 2.0)) + tilt,
        (Pair::EdgeEdge, 0 | 1) => x[3] = x[2] + (x[1] - x[0]) * rng.between(-1.5, 1.5) + tilt,
        (Pair::VertexTriangle, 3) => {
            let along = rng.direction();
            x[2] = x[1] + along * rng.magnitude(1e-6, 1.0);
            x[3] = x[1] + along * rng.magnitude(1e-6, 1.0) + tilt;
        }
        (_, 2) => x[3] = x[2].lerp(x[3], rng.magnitude(1e-6, 1.0)),
        _ => {}
    }
    if pair == Pair::VertexTriangle {
        x[1..].rotate_left((rng.bits() % 3) as usize);
    }
    if rng.bits().is_multiple_of(2) {
        let second = match pair {
            Pair::VertexTriangle => x[1].lerp(x[2], rng.between(0.0, 1.0)).lerp(x[3], rng.between(0.0, 1.0)),
            Pair::EdgeEdge => x[2].lerp(x[3], rng.between(0.0, 1.0)),
        };
        let by = second - if pair == Pair::EdgeEdge { x[0].lerp(x[1], rng.between(0.0, 1.0)) } else { x[0] };
        let by = by + rng.direction() * rng.magnitude(nearest, 1.0);
        x[0] += by;
        x[1] += if pair == Pair::EdgeEdge { by } else { DVec3::ZERO };
    }
    x
}

/// Shapes without extent, and shapes for which a determinant vanishes.
fn degenerate(pair: Pair) -> Vec<[DVec3; 4]> {
    let [o, x, y] = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let tables: &[[DVec3; 3]] = match pair {
        Pair::VertexTriangle => &[
            [o, o, o],
            [o, x, x],
            [o, o, x],
            [o, x, o],
            [o, x, 2.0 * x],
            [2.0 * x, o, x],
            [o, 2.0 * x, x],
            [-x, x, o],
            [o, x, 0.5 * x + 1e-8 * y],
            [o, x, 0.5 * x + 1e-4 * y],
            [o, x, y],
        ],
        // The first edge starts at the vertex and ends at the first of these points.
        Pair::EdgeEdge => &[
            [o, o, o],
            [x, o, o],
            [o, o, x],
            [x, o, x],
            [x, x, o],
            [x, 2.0 * x, 3.0 * x],
            [x, -x, 2.0 * x],
            [x, y, x + y],
            [x, x + y, y],
            [x, y, x + y + 1e-8 * y],
            [x, 2.0 * x + y, 3.0 * x + y],
            [x, 0.5 * x + 1e-3 * y, 0.5 * x - y],
            [x, 1e-6 * y, 1e-6 * (x + y)],
        ],
    };
    let places = [-0.5, 0.0, 1e-7, 0.25, 0.5, 1.0, 1.5];
    let points = places.iter().flat_map(|&u| places.iter().map(move |&v| DVec3::new(u, v, u * v)));
    points.flat_map(|p| tables.iter().map(move |&[a, b, c]| [p, a, b, c])).collect()
}

harness::both_precisions! {
    use glam::DVec3;

    use super::{COUNT, brute_force, degenerate, features};
    use harness::query::{PAIRS, Pair};
    use harness::rng::Rng;
    use harness::worst::Worst;

    /// Thirteen roundings of 2^-24; in f64, brute force is limited by the rounding of its own squares.
    const BOUND: f64 = kit::bound(8e-7, 4e-15);

    fn agree(what: &str, pair: Pair, all: impl Iterator<Item = [DVec3; 4]>) {
        let mut worst = Worst::new(format!("{what}, {pair:?}"), BOUND);
        for x in all {
            let x = kit::wide(&kit::narrow(&x));
            let size = x.iter().map(|v| (v - x[0]).abs().max_element()).fold(1e-30, f64::max);
            let (got, want) = (kit::distance(pair, &x), brute_force(pair, &x));
            worst.compare(size, &[got], &[want], || format!("{x:?}"));
        }
        worst.check();
    }

    #[test]
    fn random_distances() {
        let rng = &mut Rng::new(201);
        for pair in PAIRS {
            agree("random", pair, (0..COUNT).map(|_| features(rng, pair, 1e-8)));
        }
    }

    #[test]
    fn degenerate_distances() {
        for pair in PAIRS {
            let orders = |x: [DVec3; 4]| [x, [x[0], x[2], x[3], x[1]], [x[0], x[3], x[1], x[2]], [x[1], x[0], x[3], x[2]]];
            agree("degenerate", pair, degenerate(pair).into_iter().flat_map(orders));
        }
    }

    /// The weights are finite, lie in [0, 1] and sum to 1.
    #[test]
    fn weights_are_weights() {
        use muslin::geometry::{edge_edge, point_triangle};
        let rng = &mut Rng::new(202);
        let random: Vec<_> = (0..COUNT).map(|_| features(rng, Pair::VertexTriangle, 1e-8)).collect();
        for x in degenerate(Pair::VertexTriangle).into_iter().chain(random) {
            let [p, a, b, c] = kit::narrow(&x);
            let weights = point_triangle::closest_weights(p, a, b, c).map(f64::from);
            let sum: f64 = weights.iter().sum();
            let inside = weights.iter().all(|w| (0.0..=1.0).contains(w));
            assert!(inside && (sum - 1.0).abs() <= BOUND, "weights {weights:?} of {x:?}");
        }
        let random: Vec<_> = (0..COUNT).map(|_| features(rng, Pair::EdgeEdge, 1e-8)).collect();
        for x in degenerate(Pair::EdgeEdge).into_iter().chain(random) {
            let [a0, a1, b0, b1] = kit::narrow(&x);
            let parameters = edge_edge::closest_parameters(a0, a1, b0, b1);
            assert!(parameters.iter().all(|s| (0.0..=1.0).contains(s)), "parameters {parameters:?} of {x:?}");
        }
    }
}
