//! The boxes of triangles: unions of the boxes of their vertices.

use super::{IS_FACE, OWNS_EDGE, OWNS_VERTEX, Surface};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::real::{Real, Vec3};

/// The box that overlaps nothing, not even an unbounded box.
pub const NOWHERE: Aabb = Aabb { min: Vec3::splat(Real::NAN), max: Vec3::splat(Real::NAN) };

/// Whether a box has no NaN, and no low corner above its high corner.
#[inline]
pub fn is_valid(b: &Aabb) -> bool {
    b.min.cmple(b.max).all()
}

/// The smallest box around all `boxes`, or [`NOWHERE`] if one of them is not valid.
#[inline]
pub fn around<const K: usize>(boxes: [&Aabb; K]) -> Aabb {
    let union = boxes.iter().fold(Aabb::EMPTY, |union, b| union.union(b));
    if boxes.into_iter().all(is_valid) { union } else { NOWHERE }
}

/// Writes the box of every triangle, and its bits of [`Surface::owned`]. If some vertices have invalid boxes, the
/// box surrounds the other vertices, and the features with an invalid vertex are not owned.
pub fn write_bounds(
    boxes: &[Aabb],
    surface: &Surface<'_>,
    triangle_boxes: &mut [Aabb],
    owned: &mut [u8],
    dispatch: &impl Dispatch,
) {
    dispatch.run((triangle_boxes, owned), |start, (triangle_boxes, owned)| {
        let given = surface.triangles.part(start..).iter().zip(surface.owned.part(start..));
        for ((triangle, &all), (whole, owned)) in given.zip(triangle_boxes.iter_mut().zip(owned)) {
            (*whole, *owned) = bounds_of(boxes, triangle, all);
        }
    });
}

/// The box of a triangle and its bits of [`Surface::owned`], of which `owned` are all.
#[inline(always)]
pub fn bounds_of(boxes: &[Aabb], triangle: &[u32; 3], owned: u8) -> (Aabb, u8) {
    let corners = triangle.map(|v| boxes.element(v as usize).unwrap_or(&NOWHERE));
    let whole = around(corners);
    if is_valid(&whole) { (whole, owned) } else { around_valid(corners, owned) }
}

#[cold]
fn around_valid(corners: [&Aabb; 3], mut owned: u8) -> (Aabb, u8) {
    let mut union = None;
    for (k, corner) in corners.into_iter().enumerate() {
        if is_valid(corner) {
            union = Some(union.map_or(*corner, |union: Aabb| union.union(corner)));
        } else {
            owned &= !(IS_FACE | OWNS_VERTEX << k | OWNS_EDGE << k | OWNS_EDGE << ((k + 2) % 3));
        }
    }
    (union.unwrap_or(NOWHERE), owned)
}

/// Leaves out the passive triangles, which begin at `first_passive`, that no other triangle can touch: most of a large
/// obstacle.
pub fn leave_out_far(triangle_boxes: &mut [Aabb], first_passive: usize) {
    let (active, passive) = triangle_boxes.cut_mut(first_passive.min(triangle_boxes.len()));
    let reach = active.iter().filter(|b| is_valid(b)).fold(Aabb::EMPTY, |reach, b| reach.union(b));
    for far in passive.iter_mut().filter(|b| !b.overlaps(&reach)) {
        *far = NOWHERE;
    }
}
