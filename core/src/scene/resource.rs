//! Files that a scene names and the host has loaded.

use alloc::string::String;
use alloc::vec::Vec;

use crate::mesh::TriMesh;

/// A loaded file: the name that the scene uses for it, and its content.
pub type Resource = (String, Content);

/// The content of a file.
#[derive(Clone, Debug)]
pub enum Content {
    /// A mesh, start positions or stitches.
    Mesh(TriMesh),
    /// The motion of a mesh collider.
    Cache(PointCache),
}

/// Positions of the vertices of a mesh in each frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCache {
    /// Number of vertices per frame.
    pub points: u32,
    /// Positions, m, frame after frame.
    pub positions: Vec<[f32; 3]>,
}

impl PointCache {
    /// Number of whole frames.
    pub fn frames(&self) -> usize {
        self.positions.len().checked_div(self.points as usize).unwrap_or(0)
    }
}

/// The mesh with the given name.
pub(super) fn mesh<'a>(name: &str, resources: &'a [Resource]) -> Option<&'a TriMesh> {
    resources.iter().find_map(|(known, content)| match content {
        Content::Mesh(mesh) if known == name => Some(mesh),
        _ => None,
    })
}

/// The point cache with the given name.
pub(super) fn cache<'a>(name: &str, resources: &'a [Resource]) -> Option<&'a PointCache> {
    resources.iter().find_map(|(known, content)| match content {
        Content::Cache(cache) if known == name => Some(cache),
        _ => None,
    })
}
