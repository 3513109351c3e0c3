//! The meshes of a scene as they are drawn with a texture.

use alloc::vec::Vec;

use super::build::mesh;
use super::{Resource, SceneDesc};
use crate::error::SceneError;

/// The triangles of all cloths for drawing. Where the texture has a seam, a vertex of the cloth appears more than once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Texture {
    /// The vertex of the cloth that each vertex is at.
    pub vertices: Vec<u32>,
    /// Texture coordinates of each vertex, as the mesh has them: those of grids, tubes and discs are in metres. Zero if
    /// the mesh has none.
    pub uvs: Vec<[f32; 2]>,
    /// Three vertices per triangle, in the order of the triangles of the simulation.
    pub triangles: Vec<[u32; 3]>,
}

/// The triangles of all cloths for drawing. `resources` holds every mesh that the scene names.
///
/// Errors: those of the meshes ([`SceneError`]).
#[cfg_attr(small, optimize(size))]
pub fn texture(scene: &SceneDesc, resources: &[Resource]) -> Result<Texture, SceneError> {
    let (mut texture, mut first) = (Texture::default(), 0);
    for (index, cloth) in scene.cloth.iter().enumerate() {
        let mesh = mesh(index as u32, cloth, resources)?;
        mesh.check().map_err(|error| SceneError::Mesh { cloth: index as u32, error })?;
        let corners = |mesh: &[[u32; 3]], triangle: usize| mesh.get(triangle).copied().unwrap_or_default();
        // A corner: the vertex and its texture coordinates.
        let pairs = |triangle: usize| {
            let (own, uv) = (mesh.triangles[triangle], corners(&mesh.uv_triangles, triangle));
            [0, 1, 2].map(|k| (own[k], uv[k]))
        };
        let mut unique: Vec<_> = (0..mesh.triangles.len()).flat_map(pairs).collect();
        unique.sort_unstable();
        unique.dedup();
        let start = texture.vertices.len();
        for &(vertex, uv) in &unique {
            texture.vertices.push(first + vertex);
            let uv = mesh.uvs.get(uv as usize).copied().unwrap_or_default();
            texture.uvs.push(uv.map(|x| x as f32));
        }
        let place = |pair| (start + unique.binary_search(&pair).unwrap_or_default()) as u32;
        texture.triangles.extend((0..mesh.triangles.len()).map(|triangle| pairs(triangle).map(place)));
        first += mesh.positions.len() as u32;
    }
    Ok(texture)
}
