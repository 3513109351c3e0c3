//! Decides in integers whether the convex hulls of two sets of points intersect. They do if the hull of all
//! differences contains 0. Then the hull of at most four of the differences contains 0 too, no one of them in
//! the span of the others [Carathéodory 1911], and their weights are the solution of a linear system.

use std::ops::{Mul, Sub};

use num_bigint::BigInt;

/// Integers that do not overflow here.
pub trait Integer: Clone + PartialOrd + From<i8> + Sub<Output = Self> + Mul<Output = Self> {}

impl Integer for i64 {}
impl Integer for BigInt {}

/// Whether the hull of `a` and the hull of `b` share a point.
pub fn meet<T: Integer>(a: &[[T; 3]], b: &[[T; 3]]) -> bool {
    let minus = |p: &[T; 3], q: &[T; 3]| std::array::from_fn(|k| p[k].clone() - q[k].clone());
    let differences: Vec<[T; 3]> = a.iter().flat_map(|p| b.iter().map(move |q| minus(p, q))).collect();
    (1_u32..1 << differences.len()).filter(|subset| subset.count_ones() <= 4).any(|subset| {
        let members = differences.iter().enumerate().filter(|(k, _)| subset >> k & 1 == 1);
        surrounds_origin(&members.map(|(_, point)| point).collect::<Vec<_>>())
    })
}

/// Whether weights w >= 0 with sum w = 1, sum w point = 0 exist and are the only solution.
fn surrounds_origin<T: Integer>(points: &[&[T; 3]]) -> bool {
    let (zero, one, n) = (T::from(0), T::from(1), points.len());
    let row = |k: usize| points.iter().map(|p| p[k].clone()).chain([zero.clone()]).collect::<Vec<T>>();
    let mut rows = [row(0), row(1), row(2), vec![one; n + 1]];
    for column in 0..n {
        let Some(pivot) = (column..4).find(|&r| rows[r][column] != zero) else { return false };
        rows.swap(column, pivot);
        let pivot = rows[column].clone();
        for row in (0..4).filter(|&r| r != column) {
            let factor = rows[row][column].clone();
            let eliminated = rows[row].iter().zip(&pivot);
            rows[row] =
                eliminated.map(|(x, p)| x.clone() * pivot[column].clone() - p.clone() * factor.clone()).collect();
        }
    }
    let solvable = rows[n..].iter().all(|row| row[n] == zero);
    solvable && (0..n).all(|k| rows[k][n].clone() * rows[k][k].clone() >= zero)
}

/// Converts doubles to integers: each is multiplied by the same power of two.
pub fn integers<const N: usize>(points: &[[f64; 3]; N]) -> [[BigInt; 3]; N] {
    let least = points.as_flattened().iter().filter(|x| **x != 0.0).map(|&x| parts(x).1).min().unwrap_or(0);
    points.map(|point| {
        point.map(|x| {
            let (mantissa, exponent) = parts(x);
            if x == 0.0 { BigInt::from(0) } else { BigInt::from(mantissa) << (exponent - least) }
        })
    })
}

/// A double as mantissa x 2^exponent.
fn parts(x: f64) -> (i64, i32) {
    let (bits, sign) = (x.to_bits(), if x < 0.0 { -1 } else { 1 });
    let (fraction, exponent) = ((bits & ((1 << 52) - 1)) as i64, (bits >> 52 & 0x7ff) as i32);
    if exponent == 0 { (sign * fraction, -1074) } else { (sign * (fraction | 1 << 52), exponent - 1075) }
}

#[test]
fn knows_simple_answers() {
    let triangle = [[0, 0, 0], [4, 0, 0], [0, 4, 0]];
    for (edge, answer) in [
        ([[1, 1, -1], [1, 1, 1]], true),
        ([[2, 2, -1], [2, 2, 1]], true),
        ([[3, 2, -1], [3, 2, 1]], false),
        ([[1, 1, 1], [1, 1, 2]], false),
        ([[-1, 0, 0], [9, 0, 0]], true),
        ([[-1, 0, 0], [-1, 9, 0]], false),
        ([[1, 1, 0], [1, 1, 0]], true),
    ] {
        assert_eq!(meet::<i64>(&edge, &triangle), answer, "{edge:?}");
    }
    let doubles = [[0.75, -3.0, 0.0], [f64::MIN_POSITIVE, 5e-324, 1.0], [1e300, 0.1, -0.0]];
    let scaled = integers(&doubles);
    let times = |n: &BigInt, k: i32| n.clone() * BigInt::from(k);
    assert_eq!(scaled[1][1], BigInt::from(1));
    assert_eq!(times(&scaled[0][0], 4), times(&scaled[1][2], 3));
    assert_eq!(scaled[0][1], times(&scaled[1][2], -3));
    assert_eq!((scaled[0][2] == scaled[2][2], &scaled[0][2]), (true, &BigInt::from(0)));
}
