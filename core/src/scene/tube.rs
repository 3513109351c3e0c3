//! An open cylinder about the y axis, centred at the origin. Every second row is shifted by half a cell.

use core::f64::consts::PI;

use crate::error::SceneError;
use crate::mesh::TriMesh;

/// An open cylinder of `cells` cells.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TubeDesc {
    /// Radius, m.
    pub radius: f64,
    /// Height along y, m.
    pub height: f64,
    /// Cells around the axis and along it.
    pub cells: [u32; 2],
}

/// Number of vertices.
pub(super) fn vertices(tube: &TubeDesc) -> u64 {
    let [around, along] = tube.cells.map(u64::from);
    around.saturating_mul(along + 1)
}

/// The mesh of a tube. Texture coordinates unroll it: u runs around the axis, v along it.
pub(super) fn mesh(tube: &TubeDesc) -> Result<TriMesh, SceneError> {
    super::check::positive("tube.radius", tube.radius)?;
    super::check::positive("tube.height", tube.height)?;
    super::check::at_least("tube.cells", [tube.cells[0], u32::MAX], 3)?;
    super::check::at_least("tube.cells", tube.cells, 1)?;
    let [around, along] = tube.cells;
    super::check::nameable(vertices(tube))?;
    let chord = 2.0 * tube.radius * libm::sin(PI / f64::from(around));
    let mut mesh = TriMesh::default();
    for j in 0..=along {
        let shift = 0.5 * f64::from(j % 2);
        let y = tube.height * (0.5 - f64::from(j) / f64::from(along));
        // One more column of texture coordinates than of vertices: the unrolled tube is not closed.
        for i in 0..=around {
            let angle = 2.0 * PI * (f64::from(i) + shift) / f64::from(around);
            if i < around {
                mesh.positions.push([tube.radius * libm::cos(angle), y, tube.radius * libm::sin(angle)]);
            }
            mesh.uvs.push([chord * (f64::from(i) + shift), -y]);
        }
    }
    for j in 0..along {
        for i in 0..around {
            let (a, b, c, d) = ((i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1));
            // The vertices of the shifted row lie half a cell further around the axis.
            for corners in if j % 2 == 0 { [[a, b, c], [c, b, d]] } else { [[a, b, d], [a, d, c]] } {
                mesh.triangles.push(corners.map(|(i, j)| j * around + i % around));
                mesh.uv_triangles.push(corners.map(|(i, j)| j * (around + 1) + i));
            }
        }
    }
    Ok(mesh)
}
