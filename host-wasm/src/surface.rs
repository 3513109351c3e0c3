//! Strains of vertices, for drawing.

use muslin_core::real::Vec3;

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
