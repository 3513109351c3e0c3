//! Small dense symmetric matrices: a slow, plain reference for closed forms.

use glam::DMat3;

/// Rows.
pub type Dense<const N: usize> = [[f64; N]; N];

/// The matrix of 3x3 blocks `[row][column]`; `N` is `3 K`.
pub fn from_blocks<const K: usize, const N: usize>(blocks: &[[DMat3; K]; K]) -> Dense<N> {
    const { assert!(N == 3 * K) };
    std::array::from_fn(|i| std::array::from_fn(|k| blocks[i / 3][k / 3].col(k % 3)[i % 3]))
}

/// Adds a 3x3 block at a row and column of blocks.
pub fn add_block<const N: usize>(m: &mut Dense<N>, row: usize, column: usize, block: &DMat3) {
    for i in 0..3 {
        for k in 0..3 {
            m[3 * row + i][3 * column + k] += block.col(k)[i];
        }
    }
}

/// The Frobenius norm.
pub fn size<const N: usize>(m: &Dense<N>) -> f64 {
    m.as_flattened().iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The largest difference between an entry and its transpose.
pub fn asymmetry<const N: usize>(m: &Dense<N>) -> f64 {
    let pairs = (0..N).flat_map(|i| (0..i).map(move |k| (i, k)));
    pairs.map(|(i, k)| (m[i][k] - m[k][i]).abs()).fold(0.0, f64::max)
}

/// The smallest pivot of the Cholesky factorisation of `m + shift I`. The factorisation stops at the first
/// pivot that is not positive, and returns it. If the result is positive, `m` has no eigenvalue below `-shift`.
pub fn least_pivot<const N: usize>(m: &Dense<N>, shift: f64) -> f64 {
    let mut l = *m;
    let mut least = f64::INFINITY;
    for j in 0..N {
        let pivot = l[j][j] + shift - l[j][..j].iter().map(|x| x * x).sum::<f64>();
        least = least.min(pivot);
        if pivot.is_nan() || pivot <= 0.0 {
            return pivot;
        }
        let root = pivot.sqrt();
        for i in j + 1..N {
            let dot: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            l[i][j] = (l[i][j] - dot) / root;
        }
        l[j][j] = root;
    }
    least
}

/// Eigenvalues and, in the columns of the second result, eigenvectors: by cyclic Jacobi rotations.
pub fn eigen<const N: usize>(m: &Dense<N>) -> ([f64; N], Dense<N>) {
    let mut a = *m;
    let mut vectors: Dense<N> = std::array::from_fn(|i| std::array::from_fn(|k| f64::from(i == k)));
    for _ in 0..50 {
        let off: f64 = (0..N).flat_map(|i| (0..i).map(move |k| (i, k))).map(|(i, k)| a[i][k] * a[i][k]).sum();
        if off == 0.0 {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut a, &mut vectors, p, q);
            }
        }
    }
    (std::array::from_fn(|i| a[i][i]), vectors)
}

/// Applies the rotation that zeroes `a[p][q]`.
fn rotate<const N: usize>(a: &mut Dense<N>, vectors: &mut Dense<N>, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let ratio = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    let turn = |x: f64, y: f64| (c * x - s * y, s * x + c * y);
    for row in a.iter_mut().chain(vectors.iter_mut()) {
        (row[p], row[q]) = turn(row[p], row[q]);
    }
    for k in 0..N {
        (a[p][k], a[q][k]) = turn(a[p][k], a[q][k]);
    }
    (a[p][q], a[q][p]) = (0.0, 0.0);
}

/// The nearest positive semidefinite matrix: negative eigenvalues become zero.
pub fn clamped<const N: usize>(m: &Dense<N>) -> Dense<N> {
    let (values, q) = eigen(m);
    std::array::from_fn(|i| std::array::from_fn(|k| (0..N).map(|e| values[e].max(0.0) * q[i][e] * q[k][e]).sum()))
}
