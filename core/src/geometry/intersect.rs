//! Exact tests whether edges and triangles intersect, for audits.
//!
//! Both are closed sets of points, which *meet* if they share any point. Sets that touch at a corner, or that are
//! coplanar and overlap, do meet; sets that do not meet have a positive distance. Edges without length and
//! triangles without area are treated as the points and lines that they are. With s the sign of the volume of a
//! tetrahedron, an edge p q meets a triangle a b c in one of two cases:
//!
//! * s(abcp) and s(abcq) differ, and s(pqab), s(pqbc), s(pqca) do not include both signs: the line passes through
//!   the triangle and the plane cuts the edge;
//! * s(abcp) = s(abcq) = 0, and p is inside the triangle or the edge meets a side.
//!
//! Most pairs do not meet, and two cheaper tests exclude most of these first: both ends are on the same side of the
//! plane by more than the rounding error, or a line separates the edge and the triangle in one projection. The
//! second test serves coplanar points, for which the exact volume is most expensive.
//!
//! Signs come from adaptive predicates [Shewchuk 1997], which are exact unless a product under- or overflows: in
//! f32 for all finite coordinates, in f64 for coordinates that are 0 or have sizes from 1e-70 to 1e70.

use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::real::{Vec3, to_f64};

type Point = [f64; 3];

/// The projections along each axis: the two coordinates that remain.
const SHADOWS: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// Whether an edge and a triangle share a point.
#[cfg_attr(small, optimize(size))]
pub fn edge_meets_triangle(edge: [Vec3; 2], triangle: [Vec3; 3]) -> bool {
    let (edge, triangle) = (edge.map(to_f64), triangle.map(to_f64));
    let ([p, q], [a, b, c]) = (edge, triangle);
    let plainly = edge.map(|end| plain_volume(triangle, end));
    if [[1; 2], [-1; 2]].contains(&plainly) || kept_apart(largest_shadow(triangle), edge, triangle) {
        return false;
    }
    match edge.map(|end| volume(a, b, c, end)) {
        [0, 0] => covers(triangle, p) || sides(triangle).iter().any(|&side| edges_meet(edge, side)),
        [above, below] => above != below && !of_both_signs(sides(triangle).map(|[a, b]| volume(p, q, a, b))),
    }
}

/// Sign of the volume of a triangle and a point in ordinary arithmetic; 0 if the rounding error may decide. The
/// error is at most 8 unit roundoffs times the sum of the magnitudes of the products [Shewchuk 1997]; 32 are
/// allowed.
#[inline]
fn plain_volume([a, b, c]: [Point; 3], d: Point) -> i8 {
    let [a, b, c] = [a, b, c].map(|p| [p[0] - d[0], p[1] - d[1], p[2] - d[2]]);
    let products = |k: usize| (b[(k + 1) % 3] * c[(k + 2) % 3], b[(k + 2) % 3] * c[(k + 1) % 3]);
    let part = |k: usize| {
        let (plus, minus) = products(k);
        (a[k] * (plus - minus), a[k].abs() * (plus.abs() + minus.abs()))
    };
    let (volume, size) = [1, 2].into_iter().map(part).fold(part(0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    if volume.abs() > 16.0 * f64::EPSILON * size { sign(volume) } else { 0 }
}

/// The projection in which a triangle has the largest area, up to rounding.
fn largest_shadow([a, b, c]: [Point; 3]) -> [usize; 2] {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let size = |[x, y]: [usize; 2]| (u[x] * v[y] - u[y] * v[x]).abs();
    SHADOWS.into_iter().fold(SHADOWS[0], |most, shadow| if size(shadow) > size(most) { shadow } else { most })
}

/// Whether, in a projection, a line along a side of the triangle or along the edge strictly separates the two.
fn kept_apart(shadow: [usize; 2], [p, q]: [Point; 2], triangle: [Point; 3]) -> bool {
    let [a, b, c] = triangle;
    let inside = area(shadow, a, b, c);
    let outside = |[a, b]: [Point; 2], point| area(shadow, a, b, point) * inside < 0;
    let beside = || triangle.map(|corner| area(shadow, p, q, corner));
    sides(triangle).into_iter().any(|side| outside(side, p) && outside(side, q))
        || [[1; 3], [-1; 3]].contains(&beside())
}

/// Whether two triangles share a point. If they do, an edge of one of them meets the other.
pub fn triangles_meet(one: [Vec3; 3], other: [Vec3; 3]) -> bool {
    let meets = |a, b| sides(a).iter().any(|&edge| edge_meets_triangle(edge, b));
    meets(one, other) || meets(other, one)
}

/// Sign of the volume of a tetrahedron; 0 if the points are coplanar.
fn volume(a: Point, b: Point, c: Point, d: Point) -> i8 {
    let [a, b, c, d] = [a, b, c, d].map(|[x, y, z]| Coord3D { x, y, z });
    sign(orient3d(a, b, c, d))
}

/// Sign of the area of a projected triangle; 0 if its points are collinear.
fn area([x, y]: [usize; 2], a: Point, b: Point, c: Point) -> i8 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p[x], y: p[y] });
    sign(orient2d(a, b, c))
}

/// Whether a point in the plane of a triangle is strictly inside it. One projection with a nonzero area decides
/// this; the others agree or have no area.
fn covers(triangle: [Point; 3], point: Point) -> bool {
    SHADOWS.iter().any(|&shadow| {
        let turns = sides(triangle).map(|[a, b]| area(shadow, a, b, point));
        turns == [1; 3] || turns == [-1; 3]
    })
}

/// Whether two edges share a point. Edges that meet do so in every projection. Coplanar edges that do not meet are
/// apart in at least one projection.
fn edges_meet([p, q]: [Point; 2], [a, b]: [Point; 2]) -> bool {
    let overlap = |k: usize| p[k].max(q[k]) >= a[k].min(b[k]) && a[k].max(b[k]) >= p[k].min(q[k]);
    let meet_in = |&shadow: &[usize; 2]| {
        let turns = [[p, q, a], [p, q, b], [a, b, p], [a, b, q]].map(|[a, b, c]| area(shadow, a, b, c));
        let [a_side, b_side, p_side, q_side] = turns;
        a_side * b_side <= 0 && p_side * q_side <= 0 && (turns != [0; 4] || shadow.iter().all(|&k| overlap(k)))
    };
    volume(p, q, a, b) == 0 && SHADOWS.iter().all(meet_in)
}

fn sides<P: Copy>([a, b, c]: [P; 3]) -> [[P; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn of_both_signs(signs: [i8; 3]) -> bool {
    signs.contains(&1) && signs.contains(&-1)
}

fn sign(value: f64) -> i8 {
    i8::from(value > 0.0) - i8::from(value < 0.0)
}
