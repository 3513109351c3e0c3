//! Selects vertices of a cloth, for pins and whatever else acts on a part of it.

use alloc::vec::Vec;

use glam::DVec3;

use super::build::Sheet;
use super::disc;
use crate::error::{SceneError, SelectError};
use crate::mesh::edges::NONE;

/// A side of a sheet before placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SheetSide {
    /// Smallest x.
    Left,
    /// Largest x.
    Right,
    /// Smallest z.
    Back,
    /// Largest z.
    Front,
}

/// A selection of vertices. Exactly one field must be given.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SelectDesc {
    /// Corners of the sheet before placement: 0 (-x,-z), 1 (+x,-z), 2 (-x,+z), 3 (+x,+z).
    pub corners: Option<Vec<u32>>,
    /// Indices of vertices.
    pub vertices: Option<Vec<u32>>,
    /// Vertices that are inside the box `[min, max]` after placement, m.
    #[cfg_attr(feature = "serde", serde(rename = "box"))]
    pub inside: Option<[[f64; 3]; 2]>,
    /// The vertex that is nearest to a point after placement, m.
    pub nearest: Option<[f64; 3]>,
    /// A side of the sheet before placement.
    pub edge: Option<SheetSide>,
    /// A ring of a disc, counted from the innermost, which is 0.
    pub ring: Option<u32>,
    /// If it is true, all vertices at the border of the mesh.
    pub border: Option<bool>,
    /// Vertices near a straight line after placement.
    pub line: Option<LineDesc>,
    /// Vertices near a plane after placement.
    pub plane: Option<PlaneDesc>,
}

/// The surroundings of the straight line between two points.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LineDesc {
    /// One end, m.
    pub a: [f64; 3],
    /// The other end, m.
    pub b: [f64; 3],
    /// Largest distance from the line, m.
    pub within: f64,
}

/// The surroundings of a plane.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlaneDesc {
    /// A point of the plane, m.
    pub point: [f64; 3],
    /// The direction of its normal.
    pub normal: [f64; 3],
    /// Largest distance from the plane, m.
    pub within: f64,
}

/// The part of a cloth that a selection belongs to: its cloth, its key and its number among those of this key.
pub(super) type Part = (u32, &'static str, u32);

/// The selected vertices in ascending order, counted from the first one of the sheet. `placed` are their positions
/// after placement, m.
#[cfg_attr(small, optimize(size))]
pub(super) fn select(
    select: &SelectDesc,
    sheet: &Sheet<'_>,
    placed: &[DVec3],
    (cloth, part, number): Part,
) -> Result<Vec<u32>, SceneError> {
    let found = find(select, sheet, placed).and_then(|mut selected| {
        selected.sort_unstable();
        selected.dedup();
        if selected.is_empty() { Err(nothing(select, placed)) } else { Ok(selected) }
    });
    found.map_err(|error| SceneError::Selection { cloth, part, number, error })
}

/// The error of a selection without vertices.
fn nothing(select: &SelectDesc, placed: &[DVec3]) -> SelectError {
    let is_place = select.inside.is_some() || select.line.is_some() || select.plane.is_some();
    let corner = |least: fn(DVec3, DVec3) -> DVec3| placed.iter().copied().reduce(least).map(|v| v.to_array());
    match (corner(DVec3::min), corner(DVec3::max)) {
        (Some(lowest), Some(highest)) if is_place => SelectError::Elsewhere { lowest, highest },
        _ => SelectError::Empty,
    }
}

/// The selected vertices in any order.
fn find(select: &SelectDesc, sheet: &Sheet<'_>, placed: &[DVec3]) -> Result<Vec<u32>, SelectError> {
    let flat = &sheet.mesh.positions;
    let SelectDesc { corners, vertices, inside, nearest, edge, ring, border, line, plane } = select;
    let mut ways = Vec::new();
    if let Some(corners) = corners {
        ways.push(by_corners(corners, flat));
    }
    if let Some(vertices) = vertices {
        let missing = vertices.iter().find(|&&v| v as usize >= flat.len());
        let out_of_range = |&index: &u32| SelectError::OutOfRange {
            kind: "vertex",
            index,
            last: (flat.len() as u32).saturating_sub(1),
        };
        ways.push(missing.map_or_else(|| Ok(vertices.clone()), |index| Err(out_of_range(index))));
    }
    if let Some([min, max]) = inside {
        let within = |p: &DVec3| p.cmpge((*min).into()).all() && p.cmple((*max).into()).all();
        ways.push(finite(&[*min, *max], 0.0).map(|()| indices(placed.len(), |v| within(&placed[v]))));
    }
    if let Some(point) = nearest {
        let nearest = || least(placed.len(), |v| placed[v].distance_squared((*point).into()));
        ways.push(finite(&[*point], 0.0).map(|()| nearest().into_iter().collect()));
    }
    if let Some(side) = edge {
        ways.push(Ok(by_side(*side, flat)));
    }
    if let Some(index) = *ring {
        let disc = sheet.desc.disc.as_ref().ok_or(SelectError::NoDisc);
        ways.push(disc.and_then(|disc| {
            if index > disc.rings {
                Err(SelectError::OutOfRange { kind: "ring", index, last: disc.rings })
            } else {
                Ok(disc::ring(disc, index).collect())
            }
        }));
    }
    if *border == Some(true) {
        let edges = sheet.edges.iter().filter(|edge| edge.triangles[1] == NONE);
        ways.push(Ok(edges.flat_map(|edge| edge.ends).collect()));
    }
    if let Some(LineDesc { a, b, within }) = *line {
        let (start, along) = (DVec3::from(a), DVec3::from(b) - DVec3::from(a));
        let beside = |x: DVec3| {
            let part = (x - start).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
            x.distance(start + along * part.clamp(0.0, 1.0))
        };
        ways.push(finite(&[a, b], within).map(|()| indices(placed.len(), |v| beside(placed[v]) <= within)));
    }
    if let Some(PlaneDesc { point, normal, within }) = *plane {
        let normal = DVec3::from(normal).try_normalize().ok_or(SelectError::BadNumbers);
        let above = |x: DVec3, normal: DVec3| (x - DVec3::from(point)).dot(normal).abs();
        let near = |normal| indices(placed.len(), |v| above(placed[v], normal) <= within);
        ways.push(finite(&[point], within).and(normal).map(near));
    }
    match ways.pop() {
        Some(only) if ways.is_empty() => only,
        None if border.is_some() => Err(SelectError::NoBorder),
        _ => Err(SelectError::OneWay),
    }
}

/// Checks that points are finite and that a distance is finite and not negative.
fn finite(points: &[[f64; 3]], within: f64) -> Result<(), SelectError> {
    let is_good = points.as_flattened().iter().all(|x| x.is_finite()) && (0.0..f64::INFINITY).contains(&within);
    if is_good { Ok(()) } else { Err(SelectError::BadNumbers) }
}

fn by_corners(corners: &[u32], flat: &[[f64; 3]]) -> Result<Vec<u32>, SelectError> {
    let corner = |&corner: &u32| {
        let towards = |bit: u32| if corner & bit == 0 { 1.0 } else { -1.0 };
        match corner {
            0..4 => Ok(least(flat.len(), |v| towards(1) * flat[v][0] + towards(2) * flat[v][2])),
            _ => Err(SelectError::OutOfRange { kind: "corner", index: corner, last: 3 }),
        }
    };
    Ok(corners.iter().map(corner).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

fn by_side(side: SheetSide, flat: &[[f64; 3]]) -> Vec<u32> {
    let (axis, sign) = match side {
        SheetSide::Left => (0, 1.0),
        SheetSide::Right => (0, -1.0),
        SheetSide::Back => (2, 1.0),
        SheetSide::Front => (2, -1.0),
    };
    let along = |v: usize| sign * flat[v][axis];
    let (low, high) = (0..flat.len()).map(along).fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
    indices(flat.len(), |v| along(v) <= low + 1e-6 * (high - low))
}

fn indices(count: usize, keep: impl Fn(usize) -> bool) -> Vec<u32> {
    (0..count).filter(|&v| keep(v)).map(|v| v as u32).collect()
}

/// The first index with the smallest value.
fn least(count: usize, value: impl Fn(usize) -> f64) -> Option<u32> {
    (0..count).map(|v| (v as u32, value(v))).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(v, _)| v)
}
