//! Box colliders, made of twelve triangles.

use crate::column::Column;
use crate::real::{Real, Vec3, sqrt};

/// The triangles, by corners, wound outward.
pub const TRIANGLES: [[u32; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

/// The corners, m. Corner k lies on the positive side of axis i if bit i of k is set, else on the
/// negative side. Each vector in `axes` has half the length of the box along that axis.
pub fn corners(centre: Vec3, axes: [Vec3; 3]) -> [Vec3; 8] {
    core::array::from_fn(|corner| {
        let side = |axis: usize| if corner >> axis & 1 == 1 { axes.at(axis) } else { -axes.at(axis) };
        centre + side(0) + side(1) + side(2)
    })
}

/// Depth of a point inside the box, m; 0 outside.
pub fn depth(corners: &[Vec3], point: Vec3) -> Real {
    let least = |depth: Real, axis: usize| {
        let edge = corners.at(1 << axis) - corners.at(0);
        let length = sqrt(edge.length_squared());
        let along = (point - corners.at(0)).dot(edge) / length;
        depth.min(along).min(length - along)
    };
    (0..3).fold(Real::INFINITY, least).max(0.0)
}
