//! Strains and texture coordinates, for drawing.

use muslin_core::real::Vec3;
use muslin_core::scene::Texture;
use wasm_bindgen::prelude::wasm_bindgen;

/// The mesh for drawing with a texture.
#[wasm_bindgen]
pub struct Surface(pub(crate) Texture);

#[wasm_bindgen]
impl Surface {
    /// The vertex of the cloth of each vertex.
    #[wasm_bindgen(getter)]
    pub fn vertices(&self) -> Vec<u32> {
        self.0.vertices.clone()
    }

    /// Two texture coordinates of each vertex.
    #[wasm_bindgen(getter)]
    pub fn uvs(&self) -> Vec<f32> {
        self.0.uvs.as_flattened().to_vec()
    }

    /// Three vertices per triangle.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Vec<u32> {
        self.0.triangles.as_flattened().to_vec()
    }
}

/// Writes for each vertex the strain l / l0 - 1 of largest magnitude among its edges.
pub fn write_strains(positions: &[Vec3], edges: &[[u32; 2]], rest_lengths: &[f32], strains: &mut [f32]) {
    strains.fill(0.0);
    for (&[a, b], &rest) in edges.iter().zip(rest_lengths) {
        let strain = positions[a as usize].distance(positions[b as usize]) / rest - 1.0;
        for v in [a, b] {
            let own = &mut strains[v as usize];
            if strain.abs() > own.abs() {
                *own = strain;
            }
        }
    }
}
