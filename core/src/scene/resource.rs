//! Files that a scene names and the host has loaded.

use alloc::string::String;
use alloc::vec::Vec;

use crate::mesh::TriMesh;

/// A loaded file, by the name that the scene gives it.
pub type Resource = (String, Content);

/// What a file holds.
#[derive(Clone, Debug)]
pub enum Content {
    /// A mesh, start positions or stitches.
    Mesh(TriMesh),
    /// The motion of a mesh collider.
    Cache(PointCache),
}

/// Positions of a mesh's vertices in frame after frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCache {
    /// Vertices of each frame.
    pub points: u32,
    /// m; frame after frame.
    pub positions: Vec<[f32; 3]>,
}

impl PointCache {
    /// Whole frames.
    pub fn frames(&self) -> usize {
        self.positions.len().checked_div(self.points as usize).unwrap_or(0)
    }
}

/// The mesh of that name.
pub(super) fn mesh<'a>(name: &str, resources: &'a [Resource]) -> Option<&'a TriMesh> {
    resources.iter().find_map(|(known, content)| match content {
        Content::Mesh(mesh) if known == name => Some(mesh),
        _ => None,
    })
}

/// The point cache of that name.
pub(super) fn cache<'a>(name: &str, resources: &'a [Resource]) -> Option<&'a PointCache> {
    resources.iter().find_map(|(known, content)| match content {
        Content::Cache(cache) if known == name => Some(cache),
        _ => None,
    })
}
