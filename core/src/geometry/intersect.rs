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
    match edge.map(|end| volume(a, b, c, end)) {
        [0, 0] => covers(triangle, p) || sides(triangle).iter().any(|&side| edges_meet(edge, side)),
        [above, below] => above != below && !of_both_signs(sides(triangle).map(|[a, b]| volume(p, q, a, b))),
    }
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
