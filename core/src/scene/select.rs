//! Selects the vertices of a pin.

use alloc::vec::Vec;

use glam::DVec3;

use crate::error::SceneError;

/// A side of a sheet before placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "lowercase"))]
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
}

/// Reason why a selection is not usable. The caller adds the cloth and the pin.
pub(super) enum SelectError {
    OneSelection,
    Empty,
    OutOfRange(u32),
    NotFinite,
}

impl SelectError {
    pub(super) fn at(self, cloth: u32, pin: u32) -> SceneError {
        match self {
            Self::OneSelection => SceneError::OneSelection { cloth, pin },
            Self::Empty => SceneError::EmptyPin { cloth, pin },
            Self::NotFinite => SceneError::NotFinite { key: "cloth.pin.select" },
            Self::OutOfRange(index) => SceneError::PinOutOfRange { cloth, pin, index },
        }
    }
}

/// The selected vertices in ascending order. `flat` are the positions before placement, `placed` after it.
pub(super) fn select(select: &SelectDesc, flat: &[[f64; 3]], placed: &[DVec3]) -> Result<Vec<u32>, SelectError> {
    let SelectDesc { corners, vertices, inside, nearest, edge } = select;
    let places = inside.iter().flat_map(|corners| corners.as_flattened()).chain(nearest.iter().flatten());
    if places.into_iter().any(|x| !x.is_finite()) {
        return Err(SelectError::NotFinite);
    }
    let mut selected = match (corners, vertices, inside, nearest, edge) {
        (Some(corners), None, None, None, None) => by_corners(corners, flat)?,
        (None, Some(vertices), None, None, None) => match vertices.iter().find(|&&v| v as usize >= flat.len()) {
            Some(&missing) => return Err(SelectError::OutOfRange(missing)),
            None => vertices.clone(),
        },
        (None, None, Some([min, max]), None, None) => {
            let within = |p: &DVec3| p.cmpge((*min).into()).all() && p.cmple((*max).into()).all();
            indices(placed.len(), |v| within(&placed[v]))
        }
        (None, None, None, Some(point), None) => {
            least(placed.len(), |v| placed[v].distance_squared((*point).into())).into_iter().collect()
        }
        (None, None, None, None, Some(side)) => by_side(*side, flat),
        _ => return Err(SelectError::OneSelection),
    };
    selected.sort_unstable();
    selected.dedup();
    if selected.is_empty() { Err(SelectError::Empty) } else { Ok(selected) }
}

fn by_corners(corners: &[u32], flat: &[[f64; 3]]) -> Result<Vec<u32>, SelectError> {
    let corner = |&corner: &u32| {
        let towards = |bit: u32| if corner & bit == 0 { 1.0 } else { -1.0 };
        match corner {
            0..4 => Ok(least(flat.len(), |v| towards(1) * flat[v][0] + towards(2) * flat[v][2])),
            _ => Err(SelectError::OutOfRange(corner)),
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
