//! The boxes of triangles and edges: unions of the boxes of their vertices.

use super::{IS_FACE, Surface};
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::real::{Real, Vec3};

/// Overlaps nothing, not even a box without bounds.
pub const NOWHERE: Aabb = Aabb { min: Vec3::splat(Real::NAN), max: Vec3::splat(Real::NAN) };

/// Whether a box has no NaN and its corners in order.
#[inline]
pub fn is_valid(b: &Aabb) -> bool {
    b.min.cmple(b.max).all()
}

/// The box around boxes; [`NOWHERE`] if one of them is not valid.
#[inline]
pub fn around<const K: usize>(boxes: [&Aabb; K]) -> Aabb {
    let union = boxes[1..].iter().fold(*boxes[0], |union, b| union.union(b));
    if boxes.into_iter().all(is_valid) { union } else { NOWHERE }
}

/// Writes the box of every edge and of every triangle, and [`Surface::owned`] without the faces
/// that have an invalid vertex: their boxes are around the rest, which may have valid features.
pub fn write_bounds(
    boxes: &[Aabb],
    surface: &Surface<'_>,
    edge_boxes: &mut [Aabb],
    triangle_boxes: &mut [Aabb],
    owned: &mut [u8],
    dispatch: &impl Dispatch,
) {
    dispatch.run(edge_boxes, |start, part| {
        for (edge, out) in surface.edges[start..].iter().zip(part) {
            *out = around(edge.map(|v| &boxes[v as usize]));
        }
    });
    dispatch.run((triangle_boxes, owned), |start, (part, owned)| {
        let triangles = surface.triangles[start..].iter().zip(&surface.owned[start..]);
        for ((triangle, &all), (out, owned)) in triangles.zip(part.iter_mut().zip(owned)) {
            let corners = triangle.map(|v| &boxes[v as usize]);
            (*out, *owned) = (around(corners), all);
            if out.min.x.is_nan() {
                let valid = || corners.into_iter().filter(|b| is_valid(b));
                *owned &= !IS_FACE;
                *out = valid().fold(*valid().next().unwrap_or(&NOWHERE), |union, b| union.union(b));
            }
        }
    });
}
