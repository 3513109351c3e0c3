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
//! Signs come from `exact.rs`.

use super::exact::{self, Point, plain_volume, volume};
use crate::column::Column;
use crate::real::{Vec3, to_f64};

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

/// The projection in which a triangle has the largest area, up to rounding.
fn largest_shadow([a, b, c]: [Point; 3]) -> [usize; 2] {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let size = |[x, y]: [usize; 2]| (u.at(x) * v.at(y) - u.at(y) * v.at(x)).abs();
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

/// Sign of the area of a projected triangle; 0 if its points are collinear.
fn area([x, y]: [usize; 2], a: Point, b: Point, c: Point) -> i8 {
    let [a, b, c] = [a, b, c].map(|p| [p.at(x), p.at(y)]);
    exact::area(a, b, c)
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
    let overlap = |k: usize| {
        let [p, q, a, b] = [p, q, a, b].map(|point| point.at(k));
        p.max(q) >= a.min(b) && a.max(b) >= p.min(q)
    };
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
