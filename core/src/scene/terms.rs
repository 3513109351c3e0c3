//! Converts the material of a cloth to the columns of its force terms.

use alloc::vec::Vec;

use glam::DVec3;

use super::bending::SheetRigidity;
use super::build::{Parts, Sheet, resource};
use super::check::{not_negative, positive};
use super::{BendModel, Resource, SeamDesc, StretchDesc, StretchModel};
use crate::error::{MeshError, SceneError};
use crate::forces::hinge;
use crate::forces::membrane::MembraneMaterial;
use crate::forces::spring::Spring;
use crate::mesh::rest::{self, RestSource};
use crate::mesh::{Stitch, hinges};
use crate::real::Real;

impl Parts {
    pub(super) fn add_stretch(&mut self, sheet: &Sheet<'_>) -> Result<(), SceneError> {
        let Some(stretch) = &sheet.desc.stretch else {
            return match sheet.desc.shear {
                Some(_) => Err(SceneError::KeyNeeded { key: "cloth.stretch", model: "membrane" }),
                None => Ok(()),
            };
        };
        positive("cloth.stretch.stiffness", stretch.stiffness)?;
        not_negative("cloth.stretch.damping", stretch.damping)?;
        match stretch.model {
            StretchModel::Spring => {
                for (key, present) in
                    [("cloth.stretch.weft", stretch.weft.is_some()), ("cloth.shear", sheet.desc.shear.is_some())]
                {
                    if present {
                        return Err(SceneError::KeyNotForModel { key, model: "spring" });
                    }
                }
                let springs = sheet.edges.iter().zip(&sheet.lengths).map(|(edge, &length)| {
                    let stiffness = match stretch.per_spring {
                        true => stretch.stiffness,
                        false => stretch.stiffness * sheet.areas_beside(edge).iter().sum::<f64>() / (length * length),
                    };
                    (sheet.shift(&edge.ends), spring(length, stiffness, stretch.damping))
                });
                self.stretch_springs.extend(springs);
                Ok(())
            }
            StretchModel::Membrane if stretch.per_spring => {
                Err(SceneError::KeyNotForModel { key: "cloth.stretch.per_spring", model: "membrane" })
            }
            StretchModel::Membrane => self.add_membrane(sheet, stretch),
        }
    }

    fn add_membrane(&mut self, sheet: &Sheet<'_>, stretch: &StretchDesc) -> Result<(), SceneError> {
        let weft = positive("cloth.stretch.weft", stretch.weft.unwrap_or(stretch.stiffness))?;
        let (shear, shear_damping) = sheet.desc.shear.as_ref().map_or((0.0, 0.0), |s| (s.stiffness, s.damping));
        not_negative("cloth.shear.stiffness", shear)?;
        not_negative("cloth.shear.damping", shear_damping)?;
        let material = self.membrane.table.len() as u16;
        self.membrane.table.push(MembraneMaterial {
            warp: stretch.stiffness as Real,
            weft: weft as Real,
            shear: shear as Real,
            stretch_damping: stretch.damping as Real,
            shear_damping: shear_damping as Real,
        });
        for (corners, rest) in sheet.mesh.triangles.iter().zip(&sheet.rest) {
            self.membrane.vertices.push(sheet.shift(corners));
            self.membrane.weights.push(rest.weights().map(|w| w as Real));
            self.membrane.areas.push(rest.area() as Real);
            self.membrane.materials.push(material);
        }
        Ok(())
    }

    pub(super) fn add_bend(&mut self, sheet: &Sheet<'_>) -> Result<(), SceneError> {
        let Some(bend) = &sheet.desc.bend else { return Ok(()) };
        not_negative("cloth.bend.damping", bend.damping)?;
        match (bend.model, bend.rigidity, bend.stiffness) {
            (BendModel::Hinge, Some(rigidity), None) => {
                positive("cloth.bend.rigidity", rigidity)?;
                self.add_hinges(sheet, rigidity, bend.damping);
                Ok(())
            }
            (BendModel::Spring, None, Some(stiffness)) => {
                positive("cloth.bend.stiffness", stiffness)?;
                self.add_bend_springs(sheet, stiffness, bend.damping);
                Ok(())
            }
            (BendModel::Hinge, None, _) => Err(SceneError::KeyNeeded { key: "cloth.bend.rigidity", model: "hinge" }),
            (BendModel::Hinge, ..) => Err(SceneError::KeyNotForModel { key: "cloth.bend.stiffness", model: "hinge" }),
            (BendModel::Spring, Some(_), _) => {
                Err(SceneError::KeyNotForModel { key: "cloth.bend.rigidity", model: "spring" })
            }
            (BendModel::Spring, ..) => Err(SceneError::KeyNeeded { key: "cloth.bend.stiffness", model: "spring" }),
        }
    }

    fn add_hinges(&mut self, sheet: &Sheet<'_>, rigidity: f64, damping: f64) {
        let mut by_direction = SheetRigidity::default();
        for (corners, edge_index) in hinges::build(&sheet.edges) {
            let (edge, length) = (&sheet.edges[edge_index as usize], sheet.lengths[edge_index as usize]);
            let areas = sheet.areas_beside(edge);
            let stiffness = hinge::stiffness(rigidity, length, areas);
            let [first, _] = edge.triangles;
            let flat = rest::laid_flat(length, areas, rest::far_sides(&sheet.mesh, edge, &sheet.rest));
            let in_first = [edge.ends[0], edge.ends[1], edge.opposite[0]];
            let places = in_first.map(|v| sheet.rest[first as usize].corners[rest::corner(&sheet.mesh, first, v)]);
            by_direction.add(places, length, areas, flat);
            let angle = match sheet.desc.rest {
                RestSource::Shape => rest::hinge_angle(&sheet.mesh, corners),
                RestSource::Uv => 0.0,
            };
            self.hinges.vertices.push(sheet.shift(&corners));
            self.hinges.stiffness.push(stiffness as Real);
            self.hinges.rest_angles.push(angle as Real);
            self.hinges.least_heights.push((0.1 * length.min(2.0 * areas[0].min(areas[1]) / length)) as Real);
            self.hinges.damping.push((damping * stiffness) as Real);
        }
        self.largest_rigidity = self.largest_rigidity.max(by_direction.largest());
    }

    fn add_bend_springs(&mut self, sheet: &Sheet<'_>, stiffness: f64, damping: f64) {
        for ([_, _, c, d], edge_index) in hinges::build(&sheet.edges) {
            let (edge, length) = (&sheet.edges[edge_index as usize], sheet.lengths[edge_index as usize]);
            let span = match sheet.desc.rest {
                RestSource::Shape => {
                    DVec3::from(sheet.mesh.positions[c as usize]).distance(sheet.mesh.positions[d as usize].into())
                }
                RestSource::Uv => {
                    let sides = rest::far_sides(&sheet.mesh, edge, &sheet.rest);
                    rest::flat_span(length, sheet.areas_beside(edge), sides)
                }
            };
            self.bend_springs.push((sheet.shift(&[c, d]), spring(span, stiffness, damping)));
        }
    }

    pub(super) fn add_seam(
        &mut self,
        sheet: &Sheet<'_>,
        (index, seam_number): (u32, u32),
        seam: &SeamDesc,
        resources: &[Resource],
    ) -> Result<(), SceneError> {
        positive("cloth.seam.stiffness", seam.stiffness)?;
        not_negative("cloth.seam.damping", seam.damping)?;
        let from_file = match &seam.file {
            Some(name) => resource(name, index, resources)?.stitches.clone(),
            None => Vec::new(),
        };
        let pairs = seam.pairs.iter().map(|&[a, b]| Stitch { a, edge: [b, b], weight: 0.0 });
        let vertices = sheet.mesh.positions.len() as u32;
        let stitches: Vec<_> = from_file.into_iter().chain(pairs).collect();
        if stitches.is_empty() {
            return Err(SceneError::EmptySeam { cloth: index, seam: seam_number });
        }
        for (number, stitch) in stitches.into_iter().enumerate() {
            let [b, c] = stitch.edge;
            let to_itself = stitch.a == b && stitch.a == c;
            if stitch.a.max(b).max(c) >= vertices || !(0.0..=1.0).contains(&stitch.weight) || to_itself {
                return Err((index, MeshError::BadStitch { stitch: number as u32 }).into());
            }
            // A pair of vertices is a stitch to an edge whose two ends are the same vertex.
            self.seams.vertices.push(sheet.shift(&[stitch.a, b, c]));
            self.seams.weights.push(stitch.weight as Real);
            self.seams.stiffness.push(seam.stiffness as Real);
            self.seams.damping.push((seam.damping * seam.stiffness) as Real);
        }
        Ok(())
    }
}

fn spring(rest: f64, stiffness: f64, damping: f64) -> Spring {
    Spring { rest: rest as Real, stiffness: stiffness as Real, damping: (damping * stiffness) as Real }
}
