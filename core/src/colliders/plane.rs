//! Plane colliders: the half space below a point.

use crate::real::{Real, Vec3};

/// Depth of a point below the plane, m; 0 above.
pub fn depth(on_plane: Vec3, normal: Vec3, point: Vec3) -> Real {
    (on_plane - point).dot(normal).max(0.0)
}
