//! A rectangle in the xz plane, centred at the origin.
//!
//! The default pattern is equilateral, the only one on which hinge bending is isotropic (see the README of this crate).

use crate::error::SceneError;
use crate::mesh::TriMesh;

/// The pattern in which the rectangle is cut into triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Pattern {
    /// Every second row is shifted by half a cell. Triangles are equilateral if the cell's depth is
    /// `sqrt(3) / 2` times its width. Shifted rows end in half triangles.
    #[default]
    Equilateral,
    /// Squares, all cut along the same diagonal.
    Diagonal,
    /// Squares, cut along diagonals that alternate like a chessboard.
    Alternating,
}

/// A rectangle of `cells` cells.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GridDesc {
    /// Size along x and z, m.
    pub size: [f64; 2],
    /// Cells along x and z.
    pub cells: [u32; 2],
    /// Pattern of the triangles.
    #[cfg_attr(feature = "serde", serde(default))]
    pub pattern: Pattern,
}

/// Number of vertices. Every second row of the equilateral pattern has one more.
pub(super) fn vertices(grid: &GridDesc) -> u64 {
    let [nx, nz] = grid.cells.map(u64::from);
    let longer = if grid.pattern == Pattern::Equilateral { nz.div_ceil(2) } else { 0 };
    (nx + 1).saturating_mul(nz + 1).saturating_add(longer)
}

pub(super) fn mesh(grid: &GridDesc) -> Result<TriMesh, SceneError> {
    super::check::positive("grid.size", grid.size[0])?;
    super::check::positive("grid.size", grid.size[1])?;
    super::check::at_least("grid.cells", grid.cells, 1)?;
    super::check::nameable(vertices(grid))?;
    Ok(match grid.pattern {
        Pattern::Equilateral => shifted_rows(grid),
        Pattern::Diagonal => squares(grid, |_, _| false),
        Pattern::Alternating => squares(grid, |i, j| (i + j) % 2 == 1),
    })
}

fn squares(grid: &GridDesc, flip: impl Fn(u32, u32) -> bool) -> TriMesh {
    let [nx, nz] = grid.cells;
    let mut mesh = TriMesh::default();
    for j in 0..=nz {
        for i in 0..=nx {
            add_vertex(&mut mesh, grid, f64::from(i), j);
        }
    }
    for j in 0..nz {
        for i in 0..nx {
            let a = j * (nx + 1) + i;
            let (b, c, d) = (a + 1, a + nx + 1, a + nx + 2);
            if flip(i, j) {
                mesh.triangles.extend([[a, c, b], [b, c, d]]);
            } else {
                mesh.triangles.extend([[a, d, b], [a, c, d]]);
            }
        }
    }
    finish(mesh)
}

fn shifted_rows(grid: &GridDesc) -> TriMesh {
    let [nx, nz] = grid.cells;
    let mut mesh = TriMesh::default();
    let mut start = 0;
    let mut previous: Option<(u32, u32)> = None;
    for j in 0..=nz {
        let count = if j % 2 == 0 { nx + 1 } else { nx + 2 };
        for i in 0..count {
            let column = match j % 2 {
                0 => f64::from(i),
                _ => (f64::from(i) - 0.5).clamp(0.0, f64::from(nx)),
            };
            add_vertex(&mut mesh, grid, column, j);
        }
        if let Some((above, above_count)) = previous {
            // One of the two rows is shifted and has one vertex more. Walk both from the left.
            let (mut i, mut k) = (0, 0);
            while i + 1 < above_count || k + 1 < count {
                let lower_next = k + 1 < count && (i + 1 == above_count || (k <= i && count > above_count) || k < i);
                if lower_next {
                    mesh.triangles.push([above + i, start + k, start + k + 1]);
                    k += 1;
                } else {
                    mesh.triangles.push([above + i, start + k, above + i + 1]);
                    i += 1;
                }
            }
        }
        previous = Some((start, count));
        start += count;
    }
    finish(mesh)
}

/// Adds the vertex at a column and a row, in cells. Its texture coordinates are its x and z, m.
fn add_vertex(mesh: &mut TriMesh, grid: &GridDesc, column: f64, row: u32) {
    let [w, d] = grid.size;
    let x = w * (column / f64::from(grid.cells[0]) - 0.5);
    let z = d * (f64::from(row) / f64::from(grid.cells[1]) - 0.5);
    mesh.positions.push([x, 0.0, z]);
    mesh.uvs.push([x, z]);
}

/// Completes a mesh with one pair of texture coordinates per vertex.
pub(super) fn finish(mut mesh: TriMesh) -> TriMesh {
    mesh.uv_triangles = mesh.triangles.clone();
    mesh
}
