//! Positions of a cloth's vertices at time 0.

use alloc::vec::Vec;

use glam::{DMat3, DVec3};

use super::Resource;
use super::build::{Sheet, resource};
use crate::error::{MeshError, SceneError};
use crate::mesh::edges::Edge;
use crate::real::Real;

/// Least distance between two possible origins, relative to the size of the cloth. Up to half of it from the world's
/// origin, that is the origin of the columns.
const NEAR: f64 = 16.0;

/// Largest rounding of a position, relative to the length of an edge.
const MOST_ROUNDED: f64 = 0.02;

/// Start positions, m: rotated about x, then y, then z, then moved.
///
/// Errors: a start state that is missing, has another number of vertices or is not finite.
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
    Ok(start.iter().map(|&p| turn * DVec3::from(p) + DVec3::from(sheet.desc.position)).collect())
}

/// The point from which the columns of a scene measure positions, m: the world's origin, or for a cloth that is far
/// from it a round point near the cloth, because numbers far from zero have few digits after the point.
pub(super) fn origin(placed: &[DVec3]) -> DVec3 {
    let (min, max) = placed.iter().fold((placed[0], placed[0]), |(min, max), &x| (min.min(x), max.max(x)));
    // A power of two, so that most coordinates of a near cloth lose no digit.
    let unit = 2.0 * power_of_two(NEAR * (max - min).max_element());
    let origin = ((min + max) / (2.0 * unit)).round() * unit;
    if origin.is_finite() { origin } else { DVec3::ZERO }
}

/// The largest power of two that is not larger than a positive number.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000)
}

/// Checks that the positions of vertices are exact to a small part of the edges.
///
/// Errors: an edge that is too far from the `origin` for this precision, or from the world's for double precision.
pub(super) fn check_digits(sheet: &Sheet<'_>, placed: &[DVec3], origin: DVec3) -> Result<(), SceneError> {
    // The places themselves are in double.
    let rounding = |x: DVec3| {
        let (far, near) = (x.abs().max_element(), (x - origin).abs().max_element());
        (f64::EPSILON * far).max(f64::from(Real::EPSILON) * near)
    };
    let is_rough = |&(edge, &length): &(&Edge, &f64)| {
        edge.ends.iter().any(|&v| rounding(placed[v as usize]) > MOST_ROUNDED * length)
    };
    match sheet.edges.iter().zip(&sheet.lengths).find(is_rough) {
        Some((edge, _)) => {
            let [a, b] = sheet.shift(&edge.ends);
            Err(SceneError::TooFar { a, b })
        }
        None => Ok(()),
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
