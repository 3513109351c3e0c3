//! Loads, masses and start velocities of groups of vertices.

use alloc::vec;
use alloc::vec::Vec;

use glam::DVec3;

use super::build::{Parts, Sheet};
use super::check::{finite, positive};
use super::select::{self, SelectDesc};
use super::vector::VectorDesc;
use crate::error::{SceneError, SelectError};
use crate::forces::load::LoadGroup;
use crate::real::{to_f64, vec3};

/// How a total is shared among the selected vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Share {
    /// Equally.
    #[default]
    Vertex,
    /// By length: each edge between selected vertices gives half of its rest length to each end.
    Length,
    /// By area: each triangle gives a third of its rest area to each corner.
    Area,
}

/// A force on some vertices.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LoadDesc {
    /// The loaded vertices.
    pub select: SelectDesc,
    /// The total force, N. It does not turn with the cloth.
    pub force: VectorDesc,
    /// How the force is shared.
    #[cfg_attr(feature = "serde", serde(default))]
    pub share: Share,
}

/// A mass that is added to some vertices. Exactly one of `mass` and `density` must be given.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MassDesc {
    /// The vertices that get heavier.
    pub select: SelectDesc,
    /// The total mass, kg.
    pub mass: Option<f64>,
    /// How the mass is shared.
    #[cfg_attr(feature = "serde", serde(default))]
    pub share: Share,
    /// Mass per rest area of the vertices, kg/m^2.
    pub density: Option<f64>,
}

/// The velocity of some vertices at the start. It replaces that of the cloth.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StartDesc {
    /// The vertices.
    pub select: SelectDesc,
    /// Velocity, m/s.
    pub velocity: [f64; 3],
}

/// A rotation of the whole cloth at the start.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpinDesc {
    /// Direction of the axis.
    pub axis: [f64; 3],
    /// Angular velocity, rad/s.
    pub rate: f64,
    /// A point on the axis, m; absent: the centre of mass of the cloth.
    pub center: Option<[f64; 3]>,
}

impl Parts {
    /// Adds the velocities at the start of the sheet that was added last, masses included.
    pub(super) fn add_velocities(&mut self, sheet: &Sheet<'_>, placed: &[DVec3], cloth: u32) -> Result<(), SceneError> {
        let desc = sheet.desc;
        finite("cloth.velocity", &desc.velocity)?;
        let (spin, centre) = match &desc.spin {
            Some(SpinDesc { axis, rate, center }) => {
                finite("cloth.spin", &[axis.as_slice(), &[*rate], &center.unwrap_or_default()].concat())?;
                let axis = DVec3::from(*axis).try_normalize().ok_or(SceneError::SpinAxis { cloth })?;
                (axis * *rate, center.map_or_else(|| self.centre_of_mass(sheet, placed), DVec3::from))
            }
            None => (DVec3::ZERO, DVec3::ZERO),
        };
        let first = sheet.first as usize;
        self.velocities.extend(placed.iter().map(|&x| DVec3::from(desc.velocity) + spin.cross(x - centre)));
        for (number, start) in desc.start.iter().enumerate() {
            finite("cloth.start.velocity", &start.velocity)?;
            for vertex in select::select(&start.select, sheet, placed, (cloth, "start", number as u32))? {
                self.velocities[first + vertex as usize] = start.velocity.into();
            }
        }
        Ok(())
    }

    fn centre_of_mass(&self, sheet: &Sheet<'_>, placed: &[DVec3]) -> DVec3 {
        let masses = &self.masses[sheet.first as usize..];
        let moment: DVec3 = masses.iter().zip(placed).map(|(&mass, &x)| x * mass).sum();
        moment / masses.iter().sum::<f64>()
    }

    /// Adds a mass to the vertices of the sheet that was added last.
    pub(super) fn add_mass(
        &mut self,
        sheet: &Sheet<'_>,
        placed: &[DVec3],
        (cloth, number): (u32, u32),
        desc: &MassDesc,
    ) -> Result<(), SceneError> {
        let part = (cloth, "mass", number);
        let (total, share) = match (desc.mass, desc.density) {
            (Some(mass), None) => (positive("cloth.mass.mass", mass)?, desc.share),
            (None, Some(density)) => {
                let areas = sheet.areas();
                let selected = select::select(&desc.select, sheet, placed, part)?;
                let area: f64 = selected.iter().map(|&v| areas[v as usize]).sum();
                (positive("cloth.mass.density", density)? * area, Share::Area)
            }
            _ => return Err(SceneError::OneMass { cloth, number }),
        };
        for (vertex, part) in shares(share, &desc.select, sheet, placed, part)? {
            self.masses[(sheet.first + vertex) as usize] += total * part;
        }
        Ok(())
    }

    pub(super) fn add_load(
        &mut self,
        sheet: &Sheet<'_>,
        placed: &[DVec3],
        (cloth, number): (u32, u32),
        load: &LoadDesc,
    ) -> Result<(), SceneError> {
        load.force.check("cloth.load.force")?;
        let (origin, keys) = (self.origin.unwrap_or_default(), load.force.keys());
        let shares = shares(load.share, &load.select, sheet, placed, (cloth, "load", number))?;
        // From rounded positions, so that the energy at the start is zero.
        let position = |vertex: u32| DVec3::from(to_f64(vec3((placed[vertex as usize] - origin).into())));
        self.loads.groups.push(LoadGroup {
            vertices: [self.loads.vertices.len(), shares.len()].map(|n| n as u32),
            keys: [self.loads.keys.len(), keys.len()].map(|n| n as u32),
            start: shares.iter().map(|&(vertex, part)| position(vertex) * part).sum(),
        });
        self.loads.keys.extend(keys);
        for (vertex, part) in shares {
            self.loads.vertices.push(sheet.first + vertex);
            self.loads.parts.push(part);
        }
        Ok(())
    }
}

/// The selected vertices and their parts of a total.
#[cfg_attr(small, optimize(size))]
fn shares(
    share: Share,
    select: &SelectDesc,
    sheet: &Sheet<'_>,
    placed: &[DVec3],
    part: select::Part,
) -> Result<Vec<(u32, f64)>, SceneError> {
    let selected = select::select(select, sheet, placed, part)?;
    let mut weights = vec![0.0; placed.len()];
    match share {
        Share::Vertex => weights.fill(1.0),
        Share::Length => {
            for (edge, length) in sheet.edges.iter().zip(&sheet.lengths) {
                if edge.ends.iter().all(|end| selected.binary_search(end).is_ok()) {
                    edge.ends.iter().for_each(|&end| weights[end as usize] += length);
                }
            }
        }
        Share::Area => weights = sheet.areas(),
    }
    let total: f64 = selected.iter().map(|&v| weights[v as usize]).sum();
    if total > 0.0 {
        Ok(selected.into_iter().map(|v| (v, weights[v as usize] / total)).collect())
    } else {
        let (cloth, part, number) = part;
        Err(SceneError::Selection { cloth, part, number, error: SelectError::NoEdge })
    }
}
