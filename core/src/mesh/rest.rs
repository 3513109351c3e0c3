//! The rest shape: what each triangle looks like undeformed, in its own plane.

use alloc::vec::Vec;

use glam::{DVec2, DVec3};

use super::TriMesh;
use super::edges::{Edge, NONE};
use super::hinges::Hinge;
use crate::error::MeshError;

/// Below this area over longest edge squared a triangle has none.
const LEAST_AREA: f64 = 1e-10;

/// An undeformed triangle: its corners in warp and weft coordinates, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestTriangle {
    /// Coordinates (u along the warp, v along the weft) of the corners.
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

    /// `(pj, pk, qj, qk)` with `dx/du = pj (xj - xi) + pk (xk - xi)`, `dx/dv` likewise with q
    /// [Baraff 1998].
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

/// Where the rest shape comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestSource {
    /// The mesh as it stands.
    Shape,
    /// The texture coordinates: the flat pattern.
    Uv,
}

/// The undeformed triangles; `uv_scale` is metres per texture unit.
///
/// From [`RestSource::Shape`] the warp runs along the texture's u where there is one, else along
/// the projection of x (of z where a triangle faces x).
///
/// Errors: a triangle without area; no texture coordinates where they are asked for.
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

/// Lays a triangle flat with its warp along the texture's u or the projection of x.
fn from_shape(x: [DVec3; 3], uv: Option<[DVec2; 3]>) -> RestTriangle {
    let (e1, e2) = (x[1] - x[0], x[2] - x[0]);
    let normal = e1.cross(e2);
    let along_axis = || {
        // The axis that lies flatter in the triangle's plane.
        let faces_x = normal.x * normal.x > 0.8 * normal.length_squared();
        let axis = if faces_x { DVec3::Z } else { DVec3::X };
        normal.cross(axis).cross(normal)
    };
    let u = uv.and_then(|uv| warp_from_uv(e1, e2, uv)).unwrap_or_else(along_axis).normalize_or_zero();
    let v = normal.cross(u).normalize_or_zero();
    RestTriangle { corners: [DVec2::ZERO, DVec2::new(e1.dot(u), e1.dot(v)), DVec2::new(e2.dot(u), e2.dot(v))] }
}

/// Direction of growing u in the triangle's plane; none where the texture has no area.
fn warp_from_uv(e1: DVec3, e2: DVec3, uv: [DVec2; 3]) -> Option<DVec3> {
    let flat = RestTriangle { corners: uv };
    let [pj, pk, ..] = flat.weights();
    has_area(&flat).then(|| e1 * pj + e2 * pk)
}

/// Rest length of each edge: of its triangles' sides, averaged where they differ (sewn pieces).
pub fn edge_lengths(mesh: &TriMesh, edges: &[Edge], rest: &[RestTriangle]) -> Vec<f64> {
    let side = |edge: &Edge, t: u32| {
        let corner = |v: u32| mesh.triangles[t as usize].iter().position(|&c| c == v).unwrap_or(0);
        rest[t as usize].side(corner(edge.ends[0]), corner(edge.ends[1]))
    };
    let length = |edge: &Edge| match edge.triangles {
        [t, NONE] => side(edge, t),
        [s, t] => 0.5 * (side(edge, s) + side(edge, t)),
    };
    edges.iter().map(length).collect()
}

/// Rest angle of a hinge in the mesh as it stands, 0 when flat; the sign of
/// [`forces::hinge`](crate::forces::hinge).
pub fn hinge_angle(mesh: &TriMesh, hinge: Hinge) -> f64 {
    let [a, b, c, d] = hinge.map(|v| DVec3::from(mesh.positions[v as usize]));
    let e = b - a;
    let (n1, n2) = (e.cross(c - a), (d - a).cross(e));
    libm::atan2(n1.cross(n2).dot(e) / e.length(), n1.dot(n2))
}

/// Distance between the far vertices `c d` of a hinge laid flat, from its rest triangles' sides:
/// the rest length of a bending spring.
pub fn flat_span(edge_length: f64, areas: [f64; 2], sides: [[f64; 2]; 2]) -> f64 {
    // Each far vertex in the frame of the edge: along it from a, and its height.
    let height = areas.map(|a| 2.0 * a / edge_length);
    let along = sides.map(|[to_a, to_b]| (to_a * to_a - to_b * to_b + edge_length * edge_length) / (2.0 * edge_length));
    libm::hypot(along[0] - along[1], height[0] + height[1])
}

/// Lengths of the sides from the far vertex of each of an edge's two triangles to its ends.
pub fn far_sides(mesh: &TriMesh, edge: &Edge, rest: &[RestTriangle]) -> [[f64; 2]; 2] {
    core::array::from_fn(|k| {
        let t = edge.triangles[k] as usize;
        let corner = |v: u32| mesh.triangles[t].iter().position(|&c| c == v).unwrap_or(0);
        edge.ends.map(|end| rest[t].side(corner(edge.opposite[k]), corner(end)))
    })
}
