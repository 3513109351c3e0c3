//! Polygons to triangles.

/// Splits a polygon of three corners or more into a fan, each triangle as places in `corners`.
/// A quad is split along its shorter diagonal. Every corner must be the index of a position.
pub fn fan(corners: &[u32], positions: &[[f64; 3]]) -> impl Iterator<Item = [usize; 3]> + use<> {
    let count = corners.len();
    let diagonal =
        |a: usize, b: usize| distance_squared(positions[corners[a] as usize], positions[corners[b] as usize]);
    let first = usize::from(count == 4 && diagonal(1, 3) < diagonal(0, 2));
    (1..count - 1).map(move |k| [first, (first + k) % count, (first + k + 1) % count])
}

fn distance_squared(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_takes_its_shorter_diagonal() {
        let long = |x: f64| [[-x, 0.0, 0.0], [0.0, -1.0, 0.0], [x, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let split = |x| fan(&[0, 1, 2, 3], &long(x)).collect::<Vec<_>>();
        assert_eq!(split(0.5), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(split(2.0), [[1, 2, 3], [1, 3, 0]]);
    }

    #[test]
    fn a_pentagon_becomes_three() {
        let flat = [[0.0; 3]; 5];
        assert_eq!(fan(&[0, 1, 2, 3, 4], &flat).collect::<Vec<_>>(), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }
}
