//! Rigidity of an endless sheet of hinges in equilibrium.
//!
//! A curvature of the sheet leaves the vertices of one period free to move out of the plane: the displacement is the
//! quadratic function of the curvature, plus a periodic one that makes the energy least. What remains is
//! E/A = 1/2 k^T D k with k = (d2w/dx2, d2w/dz2, d2w/dxdz). D is the rigidity tensor. In the plane the vertices need
//! not move: for small deflections the hinges do not depend on it.

use glam::{DMat3, DVec3};
use muslin_core_f64::forces::TangentScale;
use muslin_core_f64::forces::element::Element;

use super::lab::{self, Miss};
use super::lattice::ROW;

/// A grid whose cells are 1 m wide.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    /// Name in reports.
    pub name: &'static str,
    /// Pattern of the grid.
    pattern: &'static str,
    /// Depth of a cell, m.
    depth: f64,
    /// Cells after which the pattern repeats.
    period: [i64; 2],
}

/// The patterns of a grid, and the equilateral one in cells that are not as deep as it needs.
pub const SHEETS: [Sheet; 4] = [
    Sheet { name: "equilateral", pattern: "equilateral", depth: ROW, period: [1, 2] },
    Sheet { name: "equilateral in square cells", pattern: "equilateral", depth: 1.0, period: [1, 2] },
    Sheet { name: "alternating", pattern: "alternating", depth: 1.0, period: [2, 2] },
    Sheet { name: "diagonal", pattern: "diagonal", depth: 1.0, period: [1, 1] },
];

/// Sweeps over the vertices of a period. There are at most four of them: each sweep divides the error by at least two.
const SWEEPS: usize = 100;

/// The rigidity tensor over the rigidity that the scene asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigidity(pub DMat3);

impl Rigidity {
    /// The rigidity of a sheet, from the hinges of the core.
    pub fn of(sheet: &Sheet) -> Result<Self, Miss> {
        let Sheet { pattern, depth, period, .. } = *sheet;
        let built = lab::columns(
            &format!(
                "name = \"sheet\"\nduration = 0\n[[cloth]]\ndensity = 1.0\n\
                 grid = {{ size = [8.0, {:?}], cells = [8, 8], pattern = \"{pattern}\" }}\n\
                 bend = {{ model = \"hinge\", rigidity = 1.0 }}",
                8.0 * depth
            ),
            &[],
        )?;
        let rest = &built.particles.positions;
        let hinges = built.model.view().hinges.ok_or_else(|| Miss::Why("the sheet has no hinges".into()))?;
        // Columns lie on halves of cells.
        let [across, along] = period.map(|cells| 2 * cells);
        let alike = |x: DVec3| {
            let [column, row] = [2.0 * x.x, 2.0 * x.z / depth].map(|half| half.round() as i64);
            (column.rem_euclid(across) * along + row.rem_euclid(along)) as usize
        };
        let size = [period[0] as f64, period[1] as f64 * depth];
        // Midpoints of edges lie on quarters of cells, and therefore never on a border of this period.
        let within = |x: DVec3| [x.x, x.z].iter().zip(size).all(|(&x, size)| (0.1..0.1 + size).contains(&x));
        let scale = TangentScale { position: 1.0, velocity: 0.0 };
        let (mut periodic, mut bent) = (Vec::new(), Vec::new());
        for (hinge, corners) in hinges.vertices.iter().enumerate() {
            let x = corners.map(|corner| rest[corner as usize]);
            if !within((x[0] + x[1]) / 2.0) {
                continue;
            }
            // Root of the energy of each hinge, as a linear function of the heights of its corners.
            let weights = hinges.tangent(hinge, &x, scale).map(|root| root.y);
            let mut row = vec![0.0; (across * along) as usize];
            let mut turned = DVec3::ZERO;
            for (x, weight) in x.into_iter().zip(weights) {
                row[alike(x)] += weight;
                turned += weight * DVec3::new(0.5 * x.x * x.x, 0.5 * x.z * x.z, x.x * x.z);
            }
            periodic.push(row);
            bent.push(turned);
        }
        relax(&periodic, &mut bent);
        let outer = bent.iter().map(|&k| DMat3::from_cols(k * k.x, k * k.y, k * k.z));
        Ok(Self(outer.fold(DMat3::ZERO, |sum, part| sum + part) * (1.0 / (size[0] * size[1]))))
    }

    /// Rigidity for curvature along a direction, in degrees from x towards z, while the sheet stays a cylinder.
    pub fn held(&self, degrees: f64) -> f64 {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let k = DVec3::new(cosine * cosine, sine * sine, sine * cosine);
        k.dot(self.0 * k)
    }

    /// Curvature along a direction, and twist, of a strip with free sides that runs in this direction, over its bending
    /// moment.
    fn free(&self, degrees: f64) -> [f64; 2] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let curvature = DVec3::new(cosine * cosine, sine * sine, 2.0 * sine * cosine);
        let twist = DVec3::new(-sine * cosine, sine * cosine, cosine * cosine - sine * sine);
        // The moment does its work on the curvature along the direction.
        let k = self.0.inverse() * curvature;
        [curvature.dot(k), twist.dot(k)]
    }

    /// Rigidity of a narrow strip that runs in a direction and whose sides are free.
    pub fn narrow(&self, degrees: f64) -> f64 {
        1.0 / self.free(degrees)[0]
    }

    /// Twist over curvature of a narrow strip that is bent along a direction.
    pub fn twist(&self, degrees: f64) -> f64 {
        let [curvature, twist] = self.free(degrees);
        twist / curvature
    }
}

/// Makes the sum of squares of `bent` least by moving the vertices of a period, one after the other. `periodic` are the
/// weights of these vertices, by hinge. The first one stays: all together they would only lift the sheet.
fn relax(periodic: &[Vec<f64>], bent: &mut [DVec3]) {
    let vertices = periodic.first().map_or(0, Vec::len);
    for vertex in (0..SWEEPS).flat_map(|_| 1..vertices) {
        let column = || periodic.iter().map(|row| row[vertex]);
        let square: f64 = column().map(|weight| weight * weight).sum();
        if square > 0.0 {
            let slope: DVec3 = column().zip(&*bent).map(|(weight, &k)| weight * k).sum();
            bent.iter_mut().zip(column()).for_each(|(k, weight)| *k -= slope * (weight / square));
        }
    }
}
