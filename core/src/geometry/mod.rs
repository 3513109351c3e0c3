//! Boxes, distances and exact crossings of points, edges and triangles. Pure geometry: nothing
//! here knows of cloth, time steps or contact.

pub mod aabb;
pub mod edge_edge;
pub mod intersect;
pub mod point_edge;
pub mod point_triangle;

use crate::real::Real;

/// A thing whose height is below this fraction of its length is as good as flat: taking it for
/// flat moves no nearest point by more than the coordinates' own rounding.
const FLAT: Real = 4.0 * Real::EPSILON;
