//! Boxes, distances and exact intersection tests of points, edges and triangles. This module is pure geometry: it
//! does not depend on cloth, time steps or contact.

pub mod aabb;
pub mod edge_edge;
mod exact;
pub mod intersect;
pub mod normals;
pub mod point_edge;
pub mod point_triangle;

use crate::real::Real;

/// A triangle counts as flat, and two edges as parallel, if the height is below this fraction of the length. This
/// moves no nearest point by more than the rounding error of the coordinates.
const FLAT: Real = 4.0 * Real::EPSILON;
