//! A scene's description into columns.

use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use glam::{DMat3, DVec3};

use super::{BendModel, ClothDesc, MotionDesc, PinDesc, SceneDesc, StretchModel, disc, grid, select, tube};
use crate::error::{MeshError, SceneError};
use crate::forces::hinge::HingeColumns;
use crate::forces::membrane::{MembraneColumns, MembraneMaterial};
use crate::forces::seam::SeamColumns;
use crate::forces::spring::{Spring, SpringColumns};
use crate::forces::wind::WindColumns;
use crate::forces::{ModelColumns, hinge};
use crate::integrate::pins::{AT_REST, Key, Motion, PinColumns, Turn};
use crate::mesh::edges::{self, Edge, NONE};
use crate::mesh::rest::{self, RestSource, RestTriangle};
use crate::mesh::{IncidenceColumns, Stitch, TriMesh, hinges};
use crate::particles::ParticleColumns;
use crate::real::{Real, vec3};

/// A mesh file that the host has loaded, by the name that the scene gives it.
pub type Resource = (String, TriMesh);

/// Where a cloth's vertices and triangles lie in the scene's columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClothRange {
    /// Vertices.
    pub vertices: Range<u32>,
    /// Triangles.
    pub triangles: Range<u32>,
}

/// The columns of a scene.
#[derive(Clone, Debug, Default)]
pub struct BuiltScene {
    /// The particles at time 0.
    pub particles: ParticleColumns,
    /// The listed terms.
    pub model: ModelColumns,
    /// The held vertices.
    pub pins: PinColumns,
    /// Triangles of all cloths.
    pub triangles: Vec<[u32; 3]>,
    /// Unique edges of all cloths.
    pub edges: Vec<[u32; 2]>,
    /// Rest length of each edge, m.
    pub rest_lengths: Vec<Real>,
    /// Where each cloth lies in the columns.
    pub cloths: Vec<ClothRange>,
}

/// Most vertices of a scene: slots of hinges (four each) must fit into 32 bits.
const MOST_VERTICES: u64 = 1 << 28;

/// Builds the columns of a scene. `resources` holds every mesh file that the scene names.
///
/// Errors: what [`SceneError`] lists.
pub fn build(scene: &SceneDesc, resources: &[Resource]) -> Result<BuiltScene, SceneError> {
    check_numbers(scene)?;
    let mut parts = Parts::default();
    for (index, cloth) in scene.cloth.iter().enumerate() {
        parts.add_cloth(index as u32, cloth, resources)?;
    }
    Ok(parts.finish(scene))
}

/// A value that must be positive and finite.
pub(super) fn positive(key: &'static str, value: f64) -> Result<f64, SceneError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(SceneError::NotPositive { key, value }) }
}

/// A value that must be zero or more and finite.
pub(super) fn not_negative(key: &'static str, value: f64) -> Result<f64, SceneError> {
    if value >= 0.0 && value.is_finite() { Ok(value) } else { Err(SceneError::Negative { key, value }) }
}

/// Counts that must be at least `least`.
pub(super) fn at_least(key: &'static str, counts: [u32; 2], least: u32) -> Result<(), SceneError> {
    if counts.iter().all(|&n| n >= least) { Ok(()) } else { Err(SceneError::TooFewCells { key, least }) }
}

fn finite(key: &'static str, values: &[f64]) -> Result<(), SceneError> {
    if values.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(SceneError::NotFinite { key }) }
}

fn check_numbers(scene: &SceneDesc) -> Result<(), SceneError> {
    if scene.cloth.is_empty() {
        return Err(SceneError::NoCloth);
    }
    not_negative("duration", scene.duration)?;
    positive("frame_rate", scene.frame_rate)?;
    positive("integrator.step", scene.integrator.step)?;
    positive("integrator.tolerance", scene.integrator.tolerance)?;
    positive("integrator.newton", f64::from(scene.integrator.newton))?;
    finite("gravity", &scene.gravity.unwrap_or_default())?;
    if let Some(drag) = &scene.drag {
        not_negative("drag.linear", drag.linear)?;
        if let Some(wind) = &drag.wind {
            finite("drag.wind.velocity", &wind.velocity)?;
            not_negative("drag.wind.normal", wind.normal)?;
            not_negative("drag.wind.tangential", wind.tangential)?;
        }
    }
    Ok(())
}

/// The columns of the scene while cloth after cloth is added.
#[derive(Default)]
struct Parts {
    positions: Vec<DVec3>,
    masses: Vec<f64>,
    areas: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    rest_lengths: Vec<f64>,
    cloths: Vec<ClothRange>,
    stretch_springs: Vec<([u32; 2], Spring)>,
    bend_springs: Vec<([u32; 2], Spring)>,
    membrane: MembraneColumns,
    hinges: HingeColumns,
    seams: SeamColumns,
    pins: PinColumns,
}

/// One cloth's mesh with all that is derived from it, before its indices are shifted.
struct Sheet<'a> {
    desc: &'a ClothDesc,
    mesh: TriMesh,
    rest: Vec<RestTriangle>,
    edges: Vec<Edge>,
    lengths: Vec<f64>,
    /// Index of its first vertex in the scene.
    first: u32,
}

impl Parts {
    fn add_cloth(&mut self, index: u32, desc: &ClothDesc, resources: &[Resource]) -> Result<(), SceneError> {
        let sheet = self.sheet(index, desc, resources)?;
        let placed = place(&sheet, index, resources)?;
        self.add_particles(&sheet, &placed)?;
        self.add_stretch(&sheet)?;
        self.add_bend(&sheet)?;
        for seam in &desc.seam {
            self.add_seam(&sheet, index, seam, resources)?;
        }
        for (pin_index, pin) in desc.pin.iter().enumerate() {
            self.add_pin(&sheet, &placed, (index, pin_index as u32), pin)?;
        }
        Ok(())
    }

    fn sheet<'a>(&self, index: u32, desc: &'a ClothDesc, resources: &[Resource]) -> Result<Sheet<'a>, SceneError> {
        finite("cloth.position", &desc.position)?;
        finite("cloth.rotation", &desc.rotation)?;
        let scale = positive("cloth.scale", desc.scale)?;
        positive("cloth.density", desc.density)?;
        let in_cloth = |error: MeshError| SceneError::Mesh { cloth: index, error };
        let mut mesh = match (&desc.grid, &desc.tube, &desc.disc, &desc.mesh) {
            (Some(desc), None, None, None) => grid::mesh(desc)?,
            (None, Some(desc), None, None) => tube::mesh(desc)?,
            (None, None, Some(desc), None) => disc::mesh(desc)?,
            (None, None, None, Some(name)) => resource(name, index, resources)?.clone(),
            _ => return Err(SceneError::OneMeshSource { cloth: index }),
        };
        let vertices = self.positions.len() as u64 + mesh.positions.len() as u64;
        if vertices > MOST_VERTICES {
            return Err(SceneError::TooLarge { vertices });
        }
        mesh.check().map_err(in_cloth)?;
        for x in mesh.positions.as_flattened_mut() {
            *x *= scale;
        }
        let rest = rest::triangles(&mesh, desc.rest, positive("cloth.uv_scale", desc.uv_scale)?).map_err(in_cloth)?;
        let edges = edges::build(&mesh.triangles).map_err(in_cloth)?;
        let lengths = rest::edge_lengths(&mesh, &edges, &rest);
        Ok(Sheet { desc, mesh, rest, edges, lengths, first: self.positions.len() as u32 })
    }

    fn add_particles(&mut self, sheet: &Sheet<'_>, placed: &[DVec3]) -> Result<(), SceneError> {
        let first_triangle = self.triangles.len() as u32;
        let mut areas = vec![0.0; sheet.mesh.positions.len()];
        for (corners, rest) in sheet.mesh.triangles.iter().zip(&sheet.rest) {
            for &corner in corners {
                areas[corner as usize] += rest.area() / 3.0;
            }
        }
        self.positions.extend_from_slice(placed);
        self.masses.extend(areas.iter().map(|area| area * sheet.desc.density));
        self.areas.extend(areas);
        self.triangles.extend(sheet.mesh.triangles.iter().map(|t| sheet.shift(t)));
        self.edges.extend(sheet.edges.iter().map(|edge| sheet.shift(&edge.ends)));
        self.rest_lengths.extend(&sheet.lengths);
        self.cloths.push(ClothRange {
            vertices: sheet.first..self.positions.len() as u32,
            triangles: first_triangle..self.triangles.len() as u32,
        });
        Ok(())
    }

    fn add_stretch(&mut self, sheet: &Sheet<'_>) -> Result<(), SceneError> {
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

    fn add_membrane(&mut self, sheet: &Sheet<'_>, stretch: &super::StretchDesc) -> Result<(), SceneError> {
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

    fn add_bend(&mut self, sheet: &Sheet<'_>) -> Result<(), SceneError> {
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
        for (corners, edge_index) in hinges::build(&sheet.edges) {
            let (edge, length) = (&sheet.edges[edge_index as usize], sheet.lengths[edge_index as usize]);
            let areas = sheet.areas_beside(edge);
            let stiffness = hinge::stiffness(rigidity, length, areas);
            let angle = match sheet.desc.rest {
                RestSource::Shape => rest::hinge_angle(&sheet.mesh, corners),
                RestSource::Uv => 0.0,
            };
            self.hinges.vertices.push(sheet.shift(&corners));
            self.hinges.stiffness.push(stiffness as Real);
            self.hinges.rest_angles.push(angle as Real);
            self.hinges.least_heights.push((0.1 * 2.0 * areas[0].min(areas[1]) / length) as Real);
            self.hinges.damping.push((damping * stiffness) as Real);
        }
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

    fn add_seam(
        &mut self,
        sheet: &Sheet<'_>,
        index: u32,
        seam: &super::SeamDesc,
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
        for (number, stitch) in from_file.into_iter().chain(pairs).enumerate() {
            let [b, c] = stitch.edge;
            if stitch.a.max(b).max(c) >= vertices {
                return Err((index, MeshError::BadStitch { stitch: number as u32 }).into());
            }
            // The element wants three different corners: a point at the edge's end needs no other.
            self.seams.vertices.push(sheet.shift(&[stitch.a, b, c]));
            self.seams.weights.push(stitch.weight as Real);
            self.seams.stiffness.push(seam.stiffness as Real);
            self.seams.damping.push((seam.damping * seam.stiffness) as Real);
        }
        Ok(())
    }

    fn add_pin(
        &mut self,
        sheet: &Sheet<'_>,
        placed: &[DVec3],
        (cloth, number): (u32, u32),
        pin: &PinDesc,
    ) -> Result<(), SceneError> {
        let selected =
            select::select(&pin.select, &sheet.mesh.positions, placed).map_err(|error| error.at(cloth, number))?;
        let axes = axes(&pin.axes).ok_or(SceneError::PinAxes { cloth, pin: number })?;
        let centre = selected.iter().map(|&v| placed[v as usize]).sum::<DVec3>() / selected.len() as f64;
        let motion = match &pin.motion {
            Some(motion) => self.add_motion(motion, centre).ok_or(SceneError::MotionKeys { cloth, pin: number })?,
            None => AT_REST,
        };
        for vertex in selected {
            self.pins.vertices.push(sheet.first + vertex);
            self.pins.axes.push(axes);
            self.pins.anchors.push(vec3(placed[vertex as usize].into()));
            self.pins.motions.push(motion);
        }
        Ok(())
    }

    /// None where keys are out of order or an axis has no direction.
    fn add_motion(&mut self, motion: &MotionDesc, centre: DVec3) -> Option<u32> {
        let times_increase = motion.keys.windows(2).all(|k| k[0][0] < k[1][0]);
        if !times_increase || motion.keys.as_flattened().iter().any(|x| !x.is_finite()) {
            return None;
        }
        let turn = match &motion.turn {
            Some(turn) => Some(Turn {
                axis: vec3(DVec3::from(turn.axis).try_normalize()?.into()),
                centre: vec3(centre.into()),
                rate: turn.rate.is_finite().then_some(turn.rate)?,
                until: turn.until.unwrap_or(f64::INFINITY),
            }),
            None => None,
        };
        let first = self.pins.keys.len() as u32;
        self.pins.keys.extend(motion.keys.iter().map(|&[time, x, y, z]| Key { time, offset: vec3([x, y, z]) }));
        self.pins.table.push(Motion { keys: [first, motion.keys.len() as u32], turn });
        Some(self.pins.table.len() as u32 - 1)
    }

    fn finish(mut self, scene: &SceneDesc) -> BuiltScene {
        let vertices = self.positions.len();
        let drag = scene.drag.as_ref();
        let springs = |springs: &[_]| (!springs.is_empty()).then(|| SpringColumns::build(vertices, springs));
        self.membrane.incidence = IncidenceColumns::build(vertices, &self.membrane.vertices);
        self.hinges.incidence = IncidenceColumns::build(vertices, &self.hinges.vertices);
        self.seams.incidence = IncidenceColumns::build(vertices, &self.seams.vertices);
        if self.hinges.damping.iter().all(|&d| d == 0.0) {
            self.hinges.damping = Vec::new();
        }
        let linear = drag.map_or(0.0, |drag| drag.linear);
        let model = ModelColumns {
            gravity: scene.gravity.map(vec3),
            drag: (linear > 0.0).then(|| self.areas.iter().map(|area| (area * linear) as Real).collect()),
            stretch_springs: springs(&self.stretch_springs),
            bend_springs: springs(&self.bend_springs),
            membrane: (!self.membrane.vertices.is_empty()).then_some(self.membrane),
            hinges: (!self.hinges.vertices.is_empty()).then_some(self.hinges),
            seams: (!self.seams.vertices.is_empty()).then_some(self.seams),
            wind: drag.and_then(|drag| drag.wind.as_ref()).map(|wind| WindColumns {
                vertices: self.triangles.clone(),
                velocity: vec3(wind.velocity),
                normal: wind.normal as Real,
                tangential: wind.tangential as Real,
                incidence: IncidenceColumns::build(vertices, &self.triangles),
            }),
        };
        let particles = ParticleColumns {
            positions: self.positions.iter().map(|&p| vec3(p.into())).collect(),
            velocities: vec![crate::real::Vec3::ZERO; vertices],
            masses: self.masses.iter().map(|&m| m as Real).collect(),
            inverse_masses: self.masses.iter().map(|&m| (1.0 / m) as Real).collect(),
        };
        BuiltScene {
            particles,
            model,
            pins: self.pins,
            triangles: self.triangles,
            edges: self.edges,
            rest_lengths: self.rest_lengths.iter().map(|&l| l as Real).collect(),
            cloths: self.cloths,
        }
    }
}

impl Sheet<'_> {
    /// Indices in the scene.
    fn shift<const N: usize>(&self, indices: &[u32; N]) -> [u32; N] {
        indices.map(|i| self.first + i)
    }

    /// Rest areas of the triangles on both sides of an edge, 0 beyond the border.
    fn areas_beside(&self, edge: &Edge) -> [f64; 2] {
        edge.triangles.map(|t| if t == NONE { 0.0 } else { self.rest[t as usize].area() })
    }
}

fn spring(rest: f64, stiffness: f64, damping: f64) -> Spring {
    Spring { rest: rest as Real, stiffness: stiffness as Real, damping: (damping * stiffness) as Real }
}

fn resource<'a>(name: &str, cloth: u32, resources: &'a [Resource]) -> Result<&'a TriMesh, SceneError> {
    let found = resources.iter().find(|(known, _)| known == name);
    found.map(|(_, mesh)| mesh).ok_or(SceneError::MissingMesh { cloth })
}

/// Start positions: rotated about x, then y, then z, and moved.
fn place(sheet: &Sheet<'_>, index: u32, resources: &[Resource]) -> Result<Vec<DVec3>, SceneError> {
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
    let [rx, ry, rz] = sheet.desc.rotation.map(f64::to_radians);
    let turn = axis_turn(2, rz) * axis_turn(1, ry) * axis_turn(0, rx);
    Ok(start.iter().map(|&p| turn * DVec3::from(p) + DVec3::from(sheet.desc.position)).collect())
}

/// Rotation about a coordinate axis by libm, so that every machine places alike.
fn axis_turn(axis: usize, angle: f64) -> DMat3 {
    // Quarter turns are exact: a sheet hung upright must lie in a plane.
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

fn axes(text: &str) -> Option<u8> {
    let mut axes = 0;
    for letter in text.chars() {
        let bit = 1 << "xyz".find(letter)?;
        if axes & bit != 0 {
            return None;
        }
        axes |= bit;
    }
    (axes != 0).then_some(axes)
}
