//! Every way in which an edge and a triangle on a small lattice can intersect: most touch, lie in one plane or
//! on one line, or have no length or area.

use std::sync::OnceLock;

use harness::rng::Rng;

use crate::oracle::meet;

type Points<const N: usize> = [[i64; 3]; N];

/// An edge and a triangle, and whether they intersect.
type Case = (Points<2>, Points<3>, bool);

fn case([p, q, a, b, c]: Points<5>) -> Case {
    ([p, q], [a, b, c], meet(&[p, q], &[a, b, c]))
}

/// All ways to choose five of the points, with repetition.
fn choices(points: &[[i64; 3]]) -> impl Iterator<Item = Points<5>> {
    let n = points.len();
    (0..n.pow(5)).map(move |code| std::array::from_fn(|k| points[code / n.pow(k as u32) % n]))
}

/// All choices from 3 x 3 points of a plane: 59,049.
fn planar() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    let points: Vec<_> = (0..9).map(|k| [k % 3, k / 3, 0]).collect();
    CASES.get_or_init(|| choices(&points).map(case).collect())
}

/// All choices from 2 x 2 x 2 points in space, 32,768, and 40,000 random choices from 3 x 3 x 3.
fn spatial() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    let corners: Vec<_> = (0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2]).collect();
    let rng = &mut Rng::new(301);
    CASES.get_or_init(|| choices(&corners).chain((0..40_000).map(|_| random(rng))).map(case).collect())
}

/// Random pairs of triangles on 3 x 3 x 3 points, and whether they intersect.
fn pairs() -> &'static [(Points<6>, bool)] {
    static CASES: OnceLock<Vec<(Points<6>, bool)>> = OnceLock::new();
    let rng = &mut Rng::new(302);
    let pair = |rng: &mut Rng| {
        let points: Points<6> = random(rng);
        (points, meet(&points[..3], &points[3..]))
    };
    CASES.get_or_init(|| (0..10_000).map(|_| pair(rng)).collect())
}

fn random<const N: usize>(rng: &mut Rng) -> Points<N> {
    std::array::from_fn(|_| std::array::from_fn(|_| rng.pick(&[0, 1, 2])))
}

/// Planes into which the planar cases are mapped.
const PLANES: [fn([i64; 3]) -> [i64; 3]; 6] = [
    |[x, y, _]| [x, y, 0],
    |[x, y, _]| [y, 7, x],
    |[x, y, _]| [-3, x, y],
    |[x, y, _]| [x, x, y],
    |[x, y, _]| [x, y, x + y],
    |[x, y, _]| [2 * x - y, 5 - x, 3 * y],
];

harness::both_precisions! {
    use muslin::geometry::intersect::{edge_meets_triangle, triangles_meet};
    use muslin::real::{Vec3, vec3};

    use super::{Case, PLANES, pairs, planar, spatial};

    fn place<const N: usize>(points: [[i64; 3]; N], scale: f64) -> [Vec3; N] {
        points.map(|point| vec3(point.map(|x| x as f64 * scale)))
    }

    #[track_caller]
    fn agrees(cases: &[Case], scale: f64, lay: fn([i64; 3]) -> [i64; 3]) {
        for &(edge, triangle, answer) in cases {
            let (edge, triangle) = (edge.map(lay), triangle.map(lay));
            let got = edge_meets_triangle(place(edge, scale), place(triangle, scale));
            assert_eq!(got, answer, "{edge:?} {triangle:?} x {scale:e}");
        }
    }

    #[test]
    fn edges_and_triangles_of_a_plane() {
        PLANES.iter().for_each(|&lay| agrees(planar(), 1.0, lay));
    }

    #[test]
    fn edges_and_triangles_of_space() {
        let met = spatial().iter().filter(|case| case.2).count();
        println!("{met} of {} meet", spatial().len());
        agrees(spatial(), 1.0, |point| point);
        agrees(spatial(), 0.125, |[x, y, z]| [x - 1, y + 2, 5 - z]);
    }

    /// Scales from subnormal numbers to the largest; in f64 up to the documented bounds.
    #[test]
    fn at_any_scale() {
        for exponent in if size_of::<Vec3>() == 12 { [-149, -140, 125] } else { [-232, -200, 230] } {
            agrees(spatial(), 2_f64.powi(exponent), |point| point);
        }
    }

    #[test]
    fn triangles_and_triangles() {
        for &(points, answer) in pairs() {
            let [a, b, c, d, e, f] = place(points, 1.0);
            assert_eq!(triangles_meet([a, b, c], [d, e, f]), answer, "{points:?}");
            assert_eq!(triangles_meet([f, d, e], [b, a, c]), answer, "{points:?}");
        }
    }
}
