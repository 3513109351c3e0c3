//! Normals of vertices, for drawing.

use crate::column::Column;
use crate::real::Vec3;

/// Writes the unit normal of each vertex: the mean normal of its triangles, weighted by area; zero if they have no area.
pub fn write_normals(positions: &[Vec3], triangles: &[[u32; 3]], normals: &mut [Vec3]) {
    normals.fill(Vec3::ZERO);
    for triangle in triangles {
        let [a, b, c] = positions.gather(triangle);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&v| normals.add(v as usize, normal));
    }
    normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
}
