//! Triangle meshes and the data derived from them: unique edges, hinges, incidence, rest shape and
//! owned features. Rest shapes are computed once, in double precision; only the finished columns are
//! rounded to [`Real`](crate::real::Real).

mod incidence;
pub use incidence::Incidence;

#[cfg(feature = "alloc")]
pub mod edges;
#[cfg(feature = "alloc")]
pub mod hinges;
#[cfg(feature = "alloc")]
pub mod ownership;
#[cfg(feature = "alloc")]
pub mod rest;
#[cfg(feature = "alloc")]
pub use incidence::IncidenceColumns;
#[cfg(feature = "alloc")]
pub use ownership::SurfaceColumns;
#[cfg(feature = "alloc")]
pub use tri_mesh::{Stitch, TriMesh};

#[cfg(feature = "alloc")]
mod tri_mesh;

/// Stands for an edge or a triangle that does not exist.
pub const NONE: u32 = u32::MAX;
