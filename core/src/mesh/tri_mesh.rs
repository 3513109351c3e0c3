use alloc::vec;
use alloc::vec::Vec;

use crate::error::MeshError;

/// Maximum number of triangles at one vertex: places in a row of the system matrix have 16 bits.
const MOST_TRIANGLES: u32 = 10_000;

/// A stitch: vertex `a` is sewn to the point `(1 - weight) b + weight c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stitch {
    /// The sewn vertex.
    pub a: u32,
    /// The ends `b c` of the edge that it is sewn to. If they are equal, it is sewn to a vertex.
    pub edge: [u32; 2],
    /// Position on the edge, 0 at its first end, 1 at its second.
    pub weight: f64,
}

/// A triangle mesh, as a host loads it or a generator makes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions, m.
    pub positions: Vec<[f64; 3]>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates; empty if the mesh has none.
    pub uvs: Vec<[f64; 2]>,
    /// Indices of the texture coordinates of each triangle's corners; empty if the mesh has none.
    pub uv_triangles: Vec<[u32; 3]>,
    /// Stitches.
    pub stitches: Vec<Stitch>,
}

impl TriMesh {
    /// Checks everything that kernels rely on: indices are in range, numbers are finite, no triangle
    /// repeats a vertex, every vertex has a triangle but not too many, stitches are valid. Edges are
    /// checked when they are [built](super::edges::build), areas when the [rest shape](super::rest) is.
    #[cfg_attr(small, optimize(size))]
    pub fn check(&self) -> Result<(), MeshError> {
        self.check_positions()?;
        if let Some(i) = self.uvs.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(MeshError::TextureNotFinite { coordinate: i as u32 });
        }
        self.check_triangles()?;
        self.check_stitches()
    }

    /// Checks everything that detection relies on, for the meshes of colliders: indices are in range,
    /// positions are finite, no triangle repeats a vertex.
    pub fn check_surface(&self) -> Result<(), MeshError> {
        self.check_positions()?;
        self.count_uses().map(|_| ())
    }

    /// Number of vertices that belong to no triangle.
    pub fn loose_vertices(&self) -> usize {
        let mut used = vec![false; self.positions.len()];
        for &vertex in self.triangles.as_flattened() {
            if let Some(used) = used.get_mut(vertex as usize) {
                *used = true;
            }
        }
        used.iter().filter(|&&used| !used).count()
    }

    /// Whether every triangle has texture coordinates.
    pub fn has_uvs(&self) -> bool {
        !self.triangles.is_empty() && self.uv_triangles.len() == self.triangles.len()
    }

    fn check_positions(&self) -> Result<(), MeshError> {
        if self.triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        match self.positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            Some(vertex) => Err(MeshError::NotFinite { vertex: vertex as u32 }),
            None => Ok(()),
        }
    }

    /// Number of triangles at each vertex. Errors: an index out of range, a repeated vertex.
    fn count_uses(&self) -> Result<Vec<u32>, MeshError> {
        let vertices = self.positions.len() as u32;
        let mut uses = vec![0u32; self.positions.len()];
        for (t, corners) in self.triangles.iter().enumerate() {
            let triangle = t as u32;
            for (k, &vertex) in corners.iter().enumerate() {
                match uses.get_mut(vertex as usize) {
                    Some(uses) => *uses += 1,
                    None => return Err(MeshError::VertexOutOfRange { triangle, vertex, vertices }),
                }
                if corners[..k].contains(&vertex) {
                    return Err(MeshError::RepeatedVertex { triangle, vertex });
                }
            }
        }
        Ok(uses)
    }

    fn check_triangles(&self) -> Result<(), MeshError> {
        let uses = self.count_uses()?;
        if let Some(vertex) = uses.iter().position(|&uses| uses == 0) {
            return Err(MeshError::LooseVertex { vertex: vertex as u32, count: self.loose_vertices() as u32 });
        }
        if let Some(vertex) = uses.iter().position(|&uses| uses > MOST_TRIANGLES) {
            return Err(MeshError::Hub { vertex: vertex as u32, most: MOST_TRIANGLES });
        }
        let coordinates = self.uvs.len() as u32;
        for (t, corners) in self.uv_triangles.iter().enumerate() {
            if let Some(&coordinate) = corners.iter().find(|&&c| c >= coordinates) {
                return Err(MeshError::TextureOutOfRange { triangle: t as u32, coordinate, coordinates });
            }
        }
        Ok(())
    }

    fn check_stitches(&self) -> Result<(), MeshError> {
        let exists = |v: u32| (v as usize) < self.positions.len();
        let good =
            |s: &Stitch| exists(s.a) && exists(s.edge[0]) && exists(s.edge[1]) && (0.0..=1.0).contains(&s.weight);
        match self.stitches.iter().position(|s| !good(s)) {
            Some(stitch) => Err(MeshError::BadStitch { stitch: stitch as u32 }),
            None => Ok(()),
        }
    }
}
