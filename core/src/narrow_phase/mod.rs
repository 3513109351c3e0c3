//! Candidates in, contacts out: where two features meet, how near, and when.

pub mod advance;
pub mod edge_edge_ccd;
pub mod vertex_triangle_ccd;
