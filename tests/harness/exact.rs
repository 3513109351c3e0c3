//! Decides without rounding whether moving features touch.
//!
//! Features that touch are coplanar: this happens at a root of `f(t) = det(edges, difference)`. There the
//! static tests are signs of polynomials in t. If f is identically zero, the times of contact are a closed set,
//! which starts at 0 or at a root of one of those polynomials.

use num_bigint::{BigInt, Sign};
use num_traits::Zero;

use crate::polynomial::{Polynomial, Root};
use crate::query::{Pair, Query};

type Vector = [Polynomial; 3];

/// Whether the features share a point at some time in [0, 1].
pub fn touch(query: &Query) -> bool {
    let x = paths(query);
    let (f, of) = match query.pair {
        Pair::VertexTriangle => {
            let [p, a, b, c] = &x;
            (dot(&normal(&x, query.pair), &minus(p, a)), vec![[p, a, b], [p, b, c], [p, c, a]])
        }
        Pair::EdgeEdge => {
            let [a0, a1, b0, b1] = &x;
            let ends = vec![[a0, b0, b1], [a1, b0, b1], [b0, a0, a1], [b1, a0, a1]];
            (dot(&normal(&x, query.pair), &minus(b0, a0)), ends)
        }
    };
    let normal = normal(&x, query.pair);
    let bounds = match query.pair {
        Pair::VertexTriangle => {
            of.iter().map(|[p, a, b]| dot(&normal, &cross(&minus(b, a), &minus(p, a)))).collect::<Vec<_>>()
        }
        Pair::EdgeEdge => {
            let [a0, a1, b0, b1] = &x;
            let (a, b, r, square) = (minus(a1, a0), minus(b1, b0), minus(b0, a0), dot(&normal, &normal));
            let (s, t) = (dot(&cross(&r, &b), &normal), dot(&cross(&r, &a), &normal));
            vec![&square - &s, s, &square - &t, t]
        }
    };
    let ends: Vec<_> = of.iter().map(|[p, a, b]| OnEdge::new(p, a, b)).collect();
    let here = |root: &Root| {
        let holds = |p: &Polynomial| root.sign(p) != Sign::Minus;
        if normal.iter().any(|n| root.sign(n) != Sign::NoSign) {
            root.sign(&f) == Sign::NoSign && bounds.iter().all(holds)
        } else {
            ends.iter().any(|end| end.holds(root))
        }
    };
    if f.is_zero() {
        let all = bounds.iter().chain(&normal).chain(ends.iter().flat_map(OnEdge::polynomials));
        let mut times = vec![Root::At(BigInt::zero(), 0)];
        times.extend(all.flat_map(Polynomial::roots));
        times.iter().any(here)
    } else {
        f.roots().iter().any(here)
    }
}

/// The condition that a point is on an edge: collinear with its ends, and not beyond them.
struct OnEdge {
    collinear: Vector,
    beyond: Polynomial,
}

impl OnEdge {
    fn new(p: &Vector, a: &Vector, b: &Vector) -> Self {
        Self { collinear: cross(&minus(b, a), &minus(p, a)), beyond: dot(&minus(p, a), &minus(p, b)) }
    }

    fn holds(&self, root: &Root) -> bool {
        self.collinear.iter().all(|c| root.sign(c) == Sign::NoSign) && root.sign(&self.beyond) != Sign::Plus
    }

    fn polynomials(&self) -> impl Iterator<Item = &Polynomial> {
        self.collinear.iter().chain([&self.beyond])
    }
}

fn normal([a, b, c, d]: &[Vector; 4], pair: Pair) -> Vector {
    match pair {
        Pair::VertexTriangle => cross(&minus(c, b), &minus(d, b)),
        Pair::EdgeEdge => cross(&minus(b, a), &minus(d, c)),
    }
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn dot(a: &Vector, b: &Vector) -> Polynomial {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| &(&a[j] * &b[k]) - &(&a[k] * &b[j]))
}

/// Every coordinate as a line in t, all scaled by the power of two that makes them integers.
fn paths(query: &Query) -> [Vector; 4] {
    let least = query.start.iter().chain(&query.end).flat_map(|x| x.to_array()).filter(|&x| x != 0.0);
    let least = least.map(|x| parts(x).1).min().unwrap_or(0);
    let whole = |x: f64| match parts(x) {
        (0, _) => BigInt::zero(),
        (mantissa, exponent) => BigInt::from(mantissa) << (exponent - least),
    };
    std::array::from_fn(|i| {
        let (start, end) = (query.start[i].to_array().map(whole), query.end[i].to_array().map(whole));
        std::array::from_fn(|k| Polynomial::line(&start[k], &end[k]))
    })
}

/// A double as an odd integer, or zero, times a power of two.
fn parts(x: f64) -> (i64, i32) {
    let (bits, exponent) = (x.to_bits(), (x.to_bits() >> 52 & 0x7ff) as i32);
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mantissa, exponent) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    let zeros = if mantissa == 0 { 0 } else { mantissa.trailing_zeros() as i32 };
    let mantissa = mantissa >> zeros;
    (if x < 0.0 { -mantissa } else { mantissa }, exponent + zeros)
}
