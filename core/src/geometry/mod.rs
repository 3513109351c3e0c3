//! Boxes, distances and exact crossings of points, edges and triangles. Pure geometry: nothing
//! here knows of cloth, time steps or contact.

pub mod aabb;
pub mod intersect;
