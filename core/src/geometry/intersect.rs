//! Whether edges and triangles meet, without error, for audits.
//!
//! Both are closed sets of points: they *meet* if they share any point, so that touching at a
//! corner and lying in one plane on one another count, and "nothing meets" means a distance above
//! zero everywhere. Edges without length and triangles without area are the points and lines that
//! they are. An edge p q meets a triangle a b c, with s the sign of a tetrahedron's volume, if
//!
//! * s(abcp) and s(abcq) are not one sign and not both 0, and s(pqab), s(pqbc), s(pqca) are not of
//!   both signs: the line passes through the triangle and the plane cuts the edge;
//! * s(abcp) = s(abcq) = 0, and p is inside, or the edge meets a side.
//!
//! Most pairs do not meet, and two tests in plain numbers say so first: both ends are on one side by more than
//! rounding, or a line keeps both apart in one shadow. The second is for points in a plane, whose exact volume
//! takes the longest.
//!
//! Signs come from adaptive predicates [Shewchuk 1997], exact while no product under- or
//! overflows: in f32 for all finite coordinates, in f64 for 0 and sizes from 1e-70 to 1e70.

use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::real::{Vec3, to_f64};

type Point = [f64; 3];

/// The coordinates of a point's shadow along each axis.
const SHADOWS: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// Whether an edge and a triangle share a point.
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

/// Sign of the volume of a triangle with a point; 0 where rounding may decide. Its error is at most 8 units of
/// rounding of the sum of the products' sizes [Shewchuk 1997]; 32 are allowed.
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

/// The shadow in which a triangle is largest, but for rounding.
fn largest_shadow([a, b, c]: [Point; 3]) -> [usize; 2] {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let size = |[x, y]: [usize; 2]| (u[x] * v[y] - u[y] * v[x]).abs();
    SHADOWS.into_iter().fold(SHADOWS[0], |most, shadow| if size(shadow) > size(most) { shadow } else { most })
}

/// Whether a line along a side of the triangle, or along the edge, has one of the two shadows strictly on either side.
fn kept_apart(shadow: [usize; 2], [p, q]: [Point; 2], triangle: [Point; 3]) -> bool {
    let [a, b, c] = triangle;
    let inside = area(shadow, a, b, c);
    let outside = |[a, b]: [Point; 2], point| area(shadow, a, b, point) * inside < 0;
    let beside = || triangle.map(|corner| area(shadow, p, q, corner));
    sides(triangle).into_iter().any(|side| outside(side, p) && outside(side, q))
        || [[1; 3], [-1; 3]].contains(&beside())
}

/// Whether two triangles share a point: then an edge of one meets the other.
pub fn triangles_meet(one: [Vec3; 3], other: [Vec3; 3]) -> bool {
    let meets = |a, b| sides(a).iter().any(|&edge| edge_meets_triangle(edge, b));
    meets(one, other) || meets(other, one)
}

/// Sign of the volume of a tetrahedron; 0 if the points lie in a plane.
fn volume(a: Point, b: Point, c: Point, d: Point) -> i8 {
    let [a, b, c, d] = [a, b, c, d].map(|[x, y, z]| Coord3D { x, y, z });
    sign(orient3d(a, b, c, d))
}

/// Sign of the area of a triangle's shadow; 0 if that lies on a line.
fn area([x, y]: [usize; 2], a: Point, b: Point, c: Point) -> i8 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p[x], y: p[y] });
    sign(orient2d(a, b, c))
}

/// Whether a point of a triangle's plane is strictly inside. One shadow with area decides, and
/// the others agree or have none.
fn covers(triangle: [Point; 3], point: Point) -> bool {
    SHADOWS.iter().any(|&shadow| {
        let turns = sides(triangle).map(|[a, b]| area(shadow, a, b, point));
        turns == [1; 3] || turns == [-1; 3]
    })
}

/// Whether two edges share a point. Of four points in a plane some shadow keeps all that is on
/// one another apart from what is not; where the edges meet, they do so in every shadow.
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
