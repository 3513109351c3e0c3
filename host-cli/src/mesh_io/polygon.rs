//! Cuts polygons into triangles between their own corners. No corner is added. A corner is left out only if it
//! coincides with the corner before it.

use earcut::Earcut;

type Point = [f64; 3];

/// Cuts a polygon of n >= 3 corners into n - 2 triangles, each given by places in `corners`. Every corner must be
/// the index of a position.
///
/// A corner at the same position as the corner before it is left out, unless fewer than three would remain. A
/// quad is cut along its shorter diagonal, or along the other one if only that lies inside. Larger polygons are
/// cut by ear clipping. A polygon without interior becomes a fan; for one that intersects itself the cuts are
/// arbitrary.
pub fn triangles(corners: &[u32], positions: &[Point]) -> Vec<[usize; 3]> {
    let place = |k: usize| positions[corners[k] as usize];
    let mut kept: Vec<usize> = (0..corners.len()).collect();
    kept.dedup_by(|k, before| place(*k) == place(*before));
    if kept.len() > 1 && place(kept[0]) == place(kept[kept.len() - 1]) {
        kept.pop();
    }
    if kept.len() < 3 {
        kept = (0..corners.len()).collect();
    }
    let points: Vec<_> = kept.iter().map(|&k| place(k)).collect();
    let cut = match points[..] {
        [_, _, _] => vec![[0, 1, 2]],
        [a, b, c, d] => quad([a, b, c, d]),
        _ => Some(ears(&points)).filter(|ears| ears.len() == points.len() - 2).unwrap_or_else(|| fan(0, points.len())),
    };
    cut.into_iter().map(|triangle| triangle.map(|k| kept[k])).collect()
}

/// A fan of triangles that share the corner `first`.
fn fan(first: usize, count: usize) -> Vec<[usize; 3]> {
    (1..count - 1).map(|k| [first, (first + k) % count, (first + k + 1) % count]).collect()
}

fn quad(points: [Point; 4]) -> Vec<[usize; 3]> {
    let diagonals = [0, 1].map(|first| minus(points[first + 2], points[first]));
    let normal = cross(diagonals[0], diagonals[1]);
    let faces_along =
        |[a, b, c]: [usize; 3]| dot(cross(minus(points[b], points[a]), minus(points[c], points[a])), normal) > 0.0;
    let inside = |first: usize| fan(first, 4).into_iter().all(faces_along);
    let [even, odd] = diagonals.map(|diagonal| dot(diagonal, diagonal));
    let shorter = usize::from(odd < even);
    let first = if !inside(shorter) && inside(1 - shorter) { 1 - shorter } else { shorter };
    fan(first, 4)
}

/// Ear clipping of the polygon, projected along the coordinate axis nearest to its normal. The projection only
/// drops a coordinate, so corners on a line stay exactly on a line.
fn ears(points: &[Point]) -> Vec<[usize; 3]> {
    let normal = normal(points).map(f64::abs);
    let axis = (0..3).fold(0, |most, axis| if normal[axis] > normal[most] { axis } else { most });
    let flat: Vec<_> = points.iter().map(|p| [p[(axis + 1) % 3], p[(axis + 2) % 3]]).collect();
    let mut corners: Vec<usize> = Vec::new();
    Earcut::new().earcut(flat.iter().copied(), &[], &mut corners);
    // Without refinement the triangles are long and thin.
    earcut::refine(&mut corners, &flat);
    let mut triangles = corners.as_chunks::<3>().0.to_vec();
    // With its corners in the order of the polygon, a triangle has the orientation of the polygon.
    triangles.iter_mut().for_each(|triangle| triangle.sort_unstable());
    triangles
}

/// Normal of a polygon; its length is twice the area.
fn normal(points: &[Point]) -> Point {
    let spokes = points.iter().map(|&point| minus(point, points[0]));
    spokes.clone().zip(spokes.skip(1)).fold([0.0; 3], |sum, (a, b)| {
        let part = cross(a, b);
        [0, 1, 2].map(|k| sum[k] + part[k])
    })
}

fn minus(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn dot(a: Point, b: Point) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[Point]) -> Vec<[usize; 3]> {
        let corners: Vec<_> = (0..points.len() as u32).collect();
        triangles(&corners, points)
    }

    /// Lifts points to the plane z = x / 2 + y / 4, on which integers stay exact.
    fn tilted(flat: &[[f64; 2]]) -> Vec<Point> {
        flat.iter().map(|&[x, y]| [x, y, 0.5 * x + 0.25 * y]).collect()
    }

    /// Asserts that the triangles cover the polygon once, each with the orientation of the polygon.
    #[track_caller]
    fn covers(points: &[Point]) {
        let triangles = cut(points);
        assert_eq!(triangles.len(), points.len() - 2, "{points:?}");
        let whole = normal(points);
        let parts = triangles.iter().map(|&corners| {
            let part = dot(normal(&corners.map(|k| points[k])), whole) / dot(whole, whole);
            assert!(part > 0.0, "{corners:?} of {points:?} has no area, or faces the other way");
            part
        });
        assert!((parts.sum::<f64>() - 1.0).abs() < 1e-12, "{triangles:?} overlap in {points:?}");
        for edge in (0..points.len()).map(|k| [k, (k + 1) % points.len()]) {
            let owners = triangles.iter().filter(|corners| edge.iter().all(|k| corners.contains(k))).count();
            assert_eq!(owners, 1, "edge {edge:?} of {points:?}");
        }
    }

    #[test]
    fn a_quad_takes_its_shorter_diagonal() {
        let long = |x: f64| cut(&[[-x, 0.0, 0.0], [0.0, -1.0, 0.0], [x, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(long(0.5), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(long(2.0), [[1, 2, 3], [1, 3, 0]]);
        // A quad folded by more than a right angle is still treated as convex.
        let folded = cut(&[[-0.5, 0.0, 0.0], [0.0, -0.3, 1.0], [0.5, 0.0, 0.0], [0.0, 0.3, 1.0]]);
        assert_eq!(folded, [[1, 2, 3], [1, 3, 0]]);
    }

    #[test]
    fn a_concave_quad_takes_the_diagonal_inside() {
        let dart = [[0.0, 3.0], [-4.0, 0.0], [0.0, 1.0], [4.0, 0.0]];
        for turn in 0..4 {
            let mut turned = dart;
            turned.rotate_left(turn);
            covers(&tilted(&turned));
            turned.reverse();
            covers(&tilted(&turned));
        }
        // A corner on an edge.
        covers(&tilted(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 3.0]]));
    }

    #[test]
    fn a_concave_polygon_is_covered_once() {
        covers(&tilted(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]]));
        // A cross: each of its corners is in line with others.
        let arm = |[x, y]: [f64; 2]| [[2.0, -1.0], [2.0, 1.0], [1.0, 1.0]].map(|[u, v]| [u * x - v * y, u * y + v * x]);
        let cross = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(arm);
        covers(&tilted(cross.as_flattened()));
    }

    /// Combs with integer coordinates and many corners on straight lines, in both orientations.
    #[test]
    fn every_corner_is_kept() {
        let mut state = 1_u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % below
        };
        for _ in 0..2000 {
            let teeth = 3 + random(6);
            let tips: Vec<_> = (0..=2 * teeth).map(|k| [f64::from(k), f64::from(random(4))]).collect();
            let base = (0..=2 * teeth).rev().map(|k| [f64::from(k), -1.0]);
            let mut comb: Vec<_> = tips.iter().copied().chain(base).collect();
            comb.rotate_left(random(4 * teeth + 2) as usize);
            covers(&tilted(&comb));
            comb.reverse();
            covers(&tilted(&comb));
        }
    }

    #[test]
    fn a_corner_given_twice_counts_once() {
        let pentagon = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
        let whole = cut(&tilted(&pentagon));
        for twice in 0..pentagon.len() {
            let mut corners = pentagon.to_vec();
            corners.insert(twice, pentagon[twice]);
            let original = |k: usize| if k > twice { k - 1 } else { k };
            let triangles: Vec<_> = cut(&tilted(&corners)).into_iter().map(|t| t.map(original)).collect();
            assert_eq!(triangles.len(), whole.len(), "corner {twice} twice");
            let areas =
                triangles.iter().map(|&t| dot(normal(&t.map(|k| tilted(&pentagon)[k])), normal(&tilted(&pentagon))));
            let square = dot(normal(&tilted(&pentagon)), normal(&tilted(&pentagon)));
            assert!(
                areas.clone().all(|area| area > 0.0) && areas.sum::<f64>() == square,
                "corner {twice} twice: {triangles:?}"
            );
        }
        let quad = tilted(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(cut(&quad), [[0, 1, 3]]);
    }

    #[test]
    fn a_polygon_without_an_inside_is_a_fan() {
        let fan = [[0, 1, 2], [0, 2, 3], [0, 3, 4]];
        assert_eq!(cut(&[[0.0; 3]; 5]), fan);
        assert_eq!(cut(&[[f64::NAN; 3]; 5]).len(), 3, "a mesh with it is refused later");
        let line: Vec<_> = (0..5).map(|k| [f64::from(k), 0.0, 0.0]).collect();
        assert_eq!(cut(&line), fan);
    }
}
