//! Rigidity of a sheet of [hinges](crate::forces::hinge) by direction, relative to the rigidity that is asked for.
//!
//! The sheet is bent to a cylinder of slight curvature, with all vertices on it. On a lattice whose vertices are alike
//! this is its equilibrium; on other meshes the rigidity in equilibrium is less. Equilateral triangles have the rigidity
//! 1 in all directions.

use glam::DVec2;

use crate::mesh::edges::Edge;
use crate::mesh::rest::RestTriangle;

/// Number of directions in half a turn.
const DIRECTIONS: u32 = 12;

/// Sums over the hinges of a cloth.
#[derive(Default)]
pub(super) struct SheetRigidity {
    /// Products of the angles for unit curvatures along the warp, the weft and between them.
    products: [[f64; 3]; 3],
    area: f64,
}

/// One of the two triangles at a hinge, in warp and weft coordinates: unit vectors along the edge and across it, and
/// where the opposite corner lies from the middle of the edge, m.
struct Side {
    along: DVec2,
    across: DVec2,
    reach: f64,
    height: f64,
    length: f64,
}

impl Side {
    /// `corners` are the ends of the edge and the opposite corner.
    fn new(rest: &RestTriangle, corners: [usize; 3]) -> Self {
        let [a, b, c] = corners.map(|k| rest.corners[k]);
        let (along, arm) = ((b - a).normalize_or_zero(), c - 0.5 * (a + b));
        let reach = arm.dot(along);
        let height = (arm - along * reach).length();
        Self { along, across: (arm - along * reach) / height, reach, height, length: a.distance(b) }
    }

    /// Slope of the triangle over the edge for a unit curvature along the edge.
    fn slope(&self) -> f64 {
        0.5 * (self.reach * self.reach - 0.25 * self.length * self.length) / self.height
    }
}

impl SheetRigidity {
    /// Adds a hinge, whose rest triangles are given with its edge's ends and opposite corner.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn add(&mut self, sides: [(&RestTriangle, [usize; 3]); 2]) {
        let [first, second] = sides.map(|(rest, corners)| Side::new(rest, corners));
        let area = sides.iter().map(|(rest, _)| rest.area()).sum::<f64>();
        let by_across = 0.5 * (first.height + second.height);
        let (by_both, by_along) = (first.reach - second.reach, first.slope() + second.slope());
        let (u, n) = (first.along, first.across);
        let angles = [
            by_across * n.x * n.x + by_both * u.x * n.x + by_along * u.x * u.x,
            by_across * n.y * n.y + by_both * u.y * n.y + by_along * u.y * u.y,
            2.0 * (by_across * n.x * n.y + by_along * u.x * u.y) + by_both * (u.x * n.y + u.y * n.x),
        ];
        let stiffness = first.length * first.length / area;
        for (row, a) in self.products.iter_mut().zip(angles) {
            for (sum, b) in row.iter_mut().zip(angles) {
                *sum += stiffness * a * b;
            }
        }
        // Three edges share the area of a triangle.
        self.area += area / 3.0;
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

/// The corners of a triangle at the ends of an edge and opposite to it. `side` tells which of the edge's triangles.
pub(super) fn corners(triangle: &[u32; 3], edge: &Edge, side: usize) -> [usize; 3] {
    let [a, b] = edge.ends;
    [a, b, edge.opposite[side]].map(|v| triangle.iter().position(|&corner| corner == v).unwrap_or(0))
}
