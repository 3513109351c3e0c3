//! Positions of a cloth's vertices at time 0.

use alloc::vec::Vec;

use glam::{DMat3, DVec3};

use super::Resource;
use super::build::{Sheet, resource};
use crate::error::{MeshError, SceneError};
use crate::real::vec3;

/// Start positions, m: rotated about x, then y, then z, then moved.
///
/// Errors: a start state that is missing, has another number of vertices or is not finite; an edge
/// whose ends coincide after rounding.
pub(super) fn place(sheet: &Sheet<'_>, index: u32, resources: &[Resource]) -> Result<Vec<DVec3>, SceneError> {
    let start = match &sheet.desc.state {
        Some(name) => {
            let (state, expected) = (resource(name, index, resources)?, sheet.mesh.positions.len());
            if state.positions.len() != expected {
                let (expected, found) = (expected as u32, state.positions.len() as u32);
                return Err((index, MeshError::StateLength { expected, found }).into());
            }
            if let Some(vertex) = state.positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
                return Err((index, MeshError::NotFinite { vertex: vertex as u32 }).into());
            }
            &state.positions
        }
        None => &sheet.mesh.positions,
    };
    let turn = turn(sheet.desc.rotation);
    let placed: Vec<_> = start.iter().map(|&p| turn * DVec3::from(p) + DVec3::from(sheet.desc.position)).collect();
    let merged = |&[a, b]: &[u32; 2]| {
        let rounded = |v: u32| vec3(placed[v as usize].into());
        start[a as usize] != start[b as usize] && rounded(a) == rounded(b)
    };
    match sheet.edges.iter().map(|edge| edge.ends).find(merged) {
        Some([a, b]) => Err(SceneError::TooFar { a, b }),
        None => Ok(placed),
    }
}

/// Rotation about x, then y, then z, in degrees.
pub(super) fn turn(degrees: [f64; 3]) -> DMat3 {
    let [rx, ry, rz] = degrees.map(f64::to_radians);
    axis_turn(2, rz) * axis_turn(1, ry) * axis_turn(0, rx)
}

/// Rotation about a coordinate axis. Uses libm, so that every machine gets the same positions.
fn axis_turn(axis: usize, angle: f64) -> DMat3 {
    // Quarter turns are exact: a sheet that is turned upright must stay plane.
    let quarters = angle / core::f64::consts::FRAC_PI_2;
    let (sine, cosine) = if quarters == libm::trunc(quarters) && quarters.abs() < 1e9 {
        [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][(quarters as i64).rem_euclid(4) as usize]
    } else {
        (libm::sin(angle), libm::cos(angle))
    };
    let mut columns = DMat3::IDENTITY.to_cols_array_2d();
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    columns[a][a] = cosine;
    columns[a][b] = sine;
    columns[b][a] = -sine;
    columns[b][b] = cosine;
    DMat3::from_cols_array_2d(&columns)
}
