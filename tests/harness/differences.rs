//! Derivatives by central differences of sixth order. The error is about (step / length)^6, where `length` is
//! the scale over which the function varies.

use glam::DVec3;

use crate::dense::Dense;

const WEIGHTS: [(f64, f64); 3] = [(1.0, 45.0 / 60.0), (2.0, -9.0 / 60.0), (3.0, 1.0 / 60.0)];

/// df/dt at 0 of `N` functions at once.
pub fn slopes<const N: usize>(step: f64, f: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    for (k, weight) in WEIGHTS {
        let (ahead, behind) = (f(k * step), f(-k * step));
        for i in 0..N {
            sum[i] += weight * (ahead[i] - behind[i]) / step;
        }
    }
    sum
}

/// df/dt at 0.
pub fn slope(step: f64, f: impl Fn(f64) -> f64) -> f64 {
    slopes(step, |t| [f(t)])[0]
}

/// df/dx of a scalar function of `K` points.
pub fn gradient<const K: usize>(x: &[DVec3; K], step: f64, f: impl Fn(&[DVec3; K]) -> f64) -> [DVec3; K] {
    let by = |point: usize, axis: usize| slope(step, |t| f(&moved(x, point, axis, t)));
    std::array::from_fn(|point| DVec3::from_array(std::array::from_fn(|axis| by(point, axis))))
}

/// df/dx of `K` vectors of `K` points, as rows; `N` is `3 K`.
pub fn jacobian<const K: usize, const N: usize>(
    x: &[DVec3; K],
    step: f64,
    f: impl Fn(&[DVec3; K]) -> [DVec3; K],
) -> Dense<N> {
    let columns: Dense<N> =
        std::array::from_fn(|column| slopes(step, |t| flat(&f(&moved(x, column / 3, column % 3, t)))));
    std::array::from_fn(|row| std::array::from_fn(|column| columns[column][row]))
}

fn flat<const K: usize, const N: usize>(v: &[DVec3; K]) -> [f64; N] {
    const { assert!(N == 3 * K) };
    std::array::from_fn(|i| v[i / 3][i % 3])
}

fn moved<const K: usize>(x: &[DVec3; K], point: usize, axis: usize, t: f64) -> [DVec3; K] {
    let mut x = *x;
    x[point][axis] += t;
    x
}
