//! Normals and strains of vertices, for drawing.

use muslin_core::real::Vec3;

/// Writes the unit normal of each vertex: the mean normal of its triangles, weighted by area.
pub fn write_normals(positions: &[Vec3], triangles: &[[u32; 3]], normals: &mut [Vec3]) {
    normals.fill(Vec3::ZERO);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&v| normals[v as usize] += normal);
    }
    normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
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
