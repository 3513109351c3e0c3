//! The rest shape: each triangle undeformed, in its own plane.

use alloc::vec::Vec;

use glam::{DVec2, DVec3};

use super::TriMesh;
use super::edges::{Edge, NONE};
use super::hinges::Hinge;
use crate::error::MeshError;

/// A triangle has no usable area if its area is at most this factor times its longest edge squared.
const LEAST_AREA: f64 = 1e-10;

/// An undeformed triangle: its corners in warp and weft coordinates, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestTriangle {
    /// Coordinates of the corners: u along the warp, v along the weft.
    pub corners: [DVec2; 3],
}

impl RestTriangle {
    /// Rest area, m^2.
    pub fn area(&self) -> f64 {
        self.determinant().abs() / 2.0
    }

    /// Twice the signed area.
    fn determinant(&self) -> f64 {
        let [a, b, c] = self.corners;
        (b - a).perp_dot(c - a)
    }

    /// `(pj, pk, qj, qk)` with `dx/du = pj (xj - xi) + pk (xk - xi)` and
    /// `dx/dv = qj (xj - xi) + qk (xk - xi)` [Baraff 1998].
    pub fn weights(&self) -> [f64; 4] {
        let [a, b, c] = self.corners;
        let (d1, d2) = (b - a, c - a);
        let det = self.determinant();
        [d2.y / det, -d1.y / det, -d2.x / det, d1.x / det]
    }

    /// Length of the side from corner `k` to corner `l`.
    fn side(&self, k: usize, l: usize) -> f64 {
        self.corners[k].distance(self.corners[l])
    }
}

/// Source of the rest shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum RestSource {
    /// The positions of the mesh.
    Shape,
    /// The texture coordinates, as a flat pattern.
    Uv,
}

/// The undeformed triangles. `uv_scale` is the size of one texture unit, m.
///
/// With [`RestSource::Shape`] the warp runs along u if the mesh has texture coordinates, else along
/// the projection of the x axis (of the z axis where a triangle faces x).
///
/// Errors: a triangle without area; [`RestSource::Uv`] for a mesh without texture coordinates.
#[cfg_attr(small, optimize(size))]
pub fn triangles(mesh: &TriMesh, source: RestSource, uv_scale: f64) -> Result<Vec<RestTriangle>, MeshError> {
    if source == RestSource::Uv && !mesh.has_uvs() {
        return Err(MeshError::NoTextureCoordinates);
    }
    let rest = |t: usize| {
        let uv = mesh.has_uvs().then(|| mesh.uv_triangles[t].map(|i| DVec2::from(mesh.uvs[i as usize]) * uv_scale));
        match (source, uv) {
            (RestSource::Uv, Some(corners)) => RestTriangle { corners },
            _ => from_shape(mesh.triangles[t].map(|i| mesh.positions[i as usize].into()), uv),
        }
    };
    let rest: Vec<_> = (0..mesh.triangles.len()).map(rest).collect();
    match rest.iter().position(|t| !has_area(t)) {
        Some(triangle) => Err(MeshError::NoArea { triangle: triangle as u32 }),
        None => Ok(rest),
    }
}

fn has_area(t: &RestTriangle) -> bool {
    let longest = t.side(0, 1).max(t.side(1, 2)).max(t.side(2, 0));
    t.area() > LEAST_AREA * longest * longest
}

/// Lays a triangle flat, with its warp along u of the texture or along the projected axis.
fn from_shape(x: [DVec3; 3], uv: Option<[DVec2; 3]>) -> RestTriangle {
    let (e1, e2) = (x[1] - x[0], x[2] - x[0]);
    let normal = e1.cross(e2);
    let along_axis = || {
        // The x axis, or the z axis where x is too close to the normal.
        let faces_x = normal.x * normal.x > 0.8 * normal.length_squared();
        let axis = if faces_x { DVec3::Z } else { DVec3::X };
        normal.cross(axis).cross(normal)
    };
    let u = uv.and_then(|uv| warp_from_uv(e1, e2, uv)).unwrap_or_else(along_axis).normalize_or_zero();
    let v = normal.cross(u).normalize_or_zero();
    RestTriangle { corners: [DVec2::ZERO, DVec2::new(e1.dot(u), e1.dot(v)), DVec2::new(e2.dot(u), e2.dot(v))] }
}

/// Direction of growing u in the plane of the triangle; `None` if the triangle has no area in the texture.
fn warp_from_uv(e1: DVec3, e2: DVec3, uv: [DVec2; 3]) -> Option<DVec3> {
    let flat = RestTriangle { corners: uv };
    let [pj, pk, ..] = flat.weights();
    has_area(&flat).then(|| e1 * pj + e2 * pk)
}

/// Rest length of each edge, m: the side of its rest triangle, or the mean over its two triangles. The
/// two sides may differ, as in texture coordinates of sewn pieces.
pub fn edge_lengths(mesh: &TriMesh, edges: &[Edge], rest: &[RestTriangle]) -> Vec<f64> {
    let side = |edge: &Edge, t: u32| {
        let [a, b] = edge.ends.map(|end| corner(mesh, t, end));
        rest[t as usize].side(a, b)
    };
    let length = |edge: &Edge| match edge.triangles {
        [t, NONE] => side(edge, t),
        [s, t] => 0.5 * (side(edge, s) + side(edge, t)),
    };
    edges.iter().map(length).collect()
}

/// The place of a vertex among the corners of a triangle.
pub fn corner(mesh: &TriMesh, triangle: u32, vertex: u32) -> usize {
    mesh.triangles[triangle as usize].iter().position(|&corner| corner == vertex).unwrap_or(0)
}

/// Angle of a hinge in the positions of the mesh, radians; 0 when flat. The sign is as in
/// [`forces::hinge`](crate::forces::hinge).
pub fn hinge_angle(mesh: &TriMesh, hinge: Hinge) -> f64 {
    let [a, b, c, d] = hinge.map(|v| DVec3::from(mesh.positions[v as usize]));
    let e = b - a;
    let (n1, n2) = (e.cross(c - a), (d - a).cross(e));
    libm::atan2(n1.cross(n2).dot(e) / e.length(), n1.dot(n2))
}

/// Distance between the opposite vertices `c d` of a hinge that is laid flat, computed from the sides
/// of its rest triangles, m. It is the rest length of a bending spring.
pub fn flat_span(edge_length: f64, areas: [f64; 2], sides: [[f64; 2]; 2]) -> f64 {
    let [[c_along, c_height], [d_along, d_height]] = laid_flat(edge_length, areas, sides);
    libm::hypot(c_along - d_along, c_height + d_height)
}

/// Coordinates of the opposite vertices `c d` of a hinge that is laid flat: along the edge from its end a, and the height
/// over it, m.
pub fn laid_flat(edge_length: f64, areas: [f64; 2], sides: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    core::array::from_fn(|k| {
        let [to_a, to_b] = sides[k];
        let along = (to_a * to_a - to_b * to_b + edge_length * edge_length) / (2.0 * edge_length);
        [along, 2.0 * areas[k] / edge_length]
    })
}

/// For each of an edge's two triangles, the lengths of the sides from the opposite vertex to the ends, m.
pub fn far_sides(mesh: &TriMesh, edge: &Edge, rest: &[RestTriangle]) -> [[f64; 2]; 2] {
    core::array::from_fn(|k| {
        let t = edge.triangles[k];
        edge.ends.map(|end| rest[t as usize].side(corner(mesh, t, edge.opposite[k]), corner(mesh, t, end)))
    })
}
