//! Rigidity of a sheet of [hinges](crate::forces::hinge) by direction, relative to the rigidity that is asked for.
//!
//! The sheet is bent to a cylinder of slight curvature, with all vertices on it. On a lattice whose vertices are alike
//! this is its equilibrium; on other meshes the rigidity in equilibrium is less. Equilateral triangles have the rigidity
//! 1 in all directions.

use glam::DVec2;

use crate::forces::hinge;

/// Number of directions in half a turn.
const DIRECTIONS: u32 = 12;

/// Sums over the hinges of a cloth.
#[derive(Default)]
pub(super) struct SheetRigidity {
    /// Products of the angles for unit curvatures along the warp, the weft and between them.
    products: [[f64; 3]; 3],
    area: f64,
}

impl SheetRigidity {
    /// Adds a hinge: the ends of its edge and the opposite corner of its first triangle, in warp and weft coordinates; the
    /// length of the edge, the areas of both triangles and the coordinates of the opposite corners
    /// ([`laid_flat`](crate::mesh::rest::laid_flat)), m.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn add(&mut self, [a, b, c]: [DVec2; 3], length: f64, areas: [f64; 2], flat: [[f64; 2]; 2]) {
        let u = (b - a).normalize_or_zero();
        let n = if u.perp_dot(c - a) < 0.0 { -u.perp() } else { u.perp() };
        let [[c_reach, c_height], [d_reach, d_height]] = flat.map(|[along, height]| [along - 0.5 * length, height]);
        // Slope of a triangle over the edge for a unit curvature along the edge.
        let slope = |reach: f64, height: f64| 0.5 * (reach * reach - 0.25 * length * length) / height;
        let by_across = 0.5 * (c_height + d_height);
        let (by_both, by_along) = (c_reach - d_reach, slope(c_reach, c_height) + slope(d_reach, d_height));
        let angles = [
            by_across * n.x * n.x + by_both * u.x * n.x + by_along * u.x * u.x,
            by_across * n.y * n.y + by_both * u.y * n.y + by_along * u.y * u.y,
            2.0 * (by_across * n.x * n.y + by_along * u.x * u.y) + by_both * (u.x * n.y + u.y * n.x),
        ];
        let stiffness = hinge::stiffness(1.0, length, areas);
        for (row, a) in self.products.iter_mut().zip(angles) {
            for (sum, b) in row.iter_mut().zip(angles) {
                *sum += stiffness * a * b;
            }
        }
        // Three edges share the area of a triangle.
        self.area += (areas[0] + areas[1]) / 3.0;
    }

    /// The largest rigidity of all directions, over the one asked for; 0 without hinges.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn largest(&self) -> f64 {
        let along = |direction: u32| {
            let (y, x) = libm::sincos(core::f64::consts::PI * f64::from(direction) / f64::from(DIRECTIONS));
            let curvature = [x * x, y * y, x * y];
            let row = |k: usize| (0..3).map(|l| self.products[k][l] * curvature[l]).sum::<f64>();
            (0..3).map(|k| row(k) * curvature[k]).sum::<f64>()
        };
        (0..DIRECTIONS).map(along).fold(0.0, f64::max) / self.area.max(f64::MIN_POSITIVE)
    }
}
