//! Builds the columns of a scene from its description.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use glam::DVec3;

use super::check::{check_numbers, finite, nameable, positive};
use super::place::{check_digits, origin, place};
use super::{ClothDesc, Resource, SceneDesc, contact, disc, grid, resource as files, tube};
use crate::contact::ContactColumns;
use crate::diagnostics::extent;
use crate::error::{MeshError, SceneError};
use crate::forces::ModelColumns;
use crate::forces::drag::DragColumns;
use crate::forces::gravity::GravityColumns;
use crate::forces::hinge::HingeColumns;
use crate::forces::load::LoadColumns;
use crate::forces::membrane::MembraneColumns;
use crate::forces::seam::SeamColumns;
use crate::forces::spring::{Spring, SpringColumns};
use crate::forces::wind::WindColumns;
use crate::integrate::pins::{Hold, PinColumns};
use crate::mesh::edges::{self, Edge, NONE};
use crate::mesh::rest::{self, RestTriangle};
use crate::mesh::{IncidenceColumns, TriMesh};
use crate::particles::ParticleColumns;
use crate::reactions::PinGroup;
use crate::real::{Real, Sum, to_f64, vec3};

/// Range of a cloth's vertices and triangles in the scene's columns.
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
    /// The point in the world from which positions are measured, m.
    pub origin: DVec3,
    /// The particles at time 0.
    pub particles: ParticleColumns,
    /// The force terms that the scene names.
    pub model: ModelColumns,
    /// The pinned vertices.
    pub pins: PinColumns,
    /// The groups of pins, as the scene lists them.
    pub pin_groups: Vec<PinGroup>,
    /// Triangles of all cloths.
    pub triangles: Vec<[u32; 3]>,
    /// Unique edges of all cloths.
    pub edges: Vec<[u32; 2]>,
    /// Rest length of each edge, m.
    pub rest_lengths: Vec<Real>,
    /// Range of each cloth in the columns.
    pub cloths: Vec<ClothRange>,
    /// Position of each vertex in its mesh before placement, m. Texture coordinates would not do:
    /// different parts of a sheet may overlap in them.
    pub material: Vec<DVec3>,
    /// Largest rigidity of hinges over the one asked for, of all cloths and directions; 0 without hinges.
    pub largest_rigidity: f64,
    /// Columns of contact; absent: surfaces pass through one another.
    pub contact: Option<ContactColumns>,
}

impl BuiltScene {
    /// Bytes of the particle, edge, triangle, model and contact columns.
    pub fn bytes(&self) -> usize {
        let p = &self.particles;
        2 * size_of_val(&p.positions[..])
            + 2 * size_of_val(&p.velocities[..])
            + size_of_val(&p.masses[..])
            + size_of_val(&p.inverse_masses[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.edges[..])
            + size_of_val(&self.rest_lengths[..])
            + self.model.view().bytes()
            + self.contact.as_ref().map_or(0, ContactColumns::bytes)
    }

    /// Whether steps may be divided: to resolve contact, or by error control with a largest error.
    pub(crate) fn divides(&self, error: Option<Real>) -> bool {
        error.is_some() || self.contact.as_ref().is_some_and(|contact| contact.halving)
    }

    /// Harmonic mean of the rest lengths of all edges, m. Contact and rounding disturb short edges first, and in this mean
    /// they count most.
    pub fn mean_edge(&self) -> Sum {
        let inverses = self.rest_lengths.iter().map(|&length| 1.0 / Sum::from(length));
        self.rest_lengths.len() as Sum / inverses.sum::<Sum>()
    }

    /// Largest side of the box around the smallest cloth at present, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn smallest_size(&self) -> Sum {
        let of = |cloth: &ClothRange| {
            let [first, end] = [cloth.vertices.start, cloth.vertices.end].map(|vertex| vertex as usize);
            let places = self.particles.positions[first..end].iter().map(|&x| to_f64(x));
            extent(places).into_iter().fold(0.0, Sum::max)
        };
        self.cloths.iter().map(of).fold(Sum::INFINITY, Sum::min)
    }

    /// Pairs of vertices that seams join.
    pub fn sewn(&self) -> Vec<[u32; 2]> {
        let stitches = self.model.seams.iter().flat_map(|seams| &seams.vertices);
        stitches.flat_map(|&[a, b, c]| [[a, b], [a, c]]).filter(|[a, b]| a != b).collect()
    }
}

/// Builds the columns of a scene. `resources` holds every mesh file that the scene names.
///
/// Errors: see [`SceneError`].
#[cfg_attr(small, optimize(size))]
pub fn build(scene: &SceneDesc, resources: &[Resource]) -> Result<BuiltScene, SceneError> {
    check_numbers(scene)?;
    let mut parts = Parts::default();
    for (index, cloth) in scene.cloth.iter().enumerate() {
        parts.add_cloth(index as u32, cloth, resources)?;
    }
    let mut built = parts.finish(scene);
    built.contact = contact::columns(scene, &built, resources)?;
    Ok(built)
}

/// Unfinished columns of a scene, to which cloths are added one by one.
#[derive(Default)]
pub(super) struct Parts {
    /// Given once the first cloth is placed.
    pub(super) origin: Option<DVec3>,
    pub(super) positions: Vec<DVec3>,
    pub(super) velocities: Vec<DVec3>,
    pub(super) masses: Vec<f64>,
    areas: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    rest_lengths: Vec<f64>,
    cloths: Vec<ClothRange>,
    material: Vec<DVec3>,
    pub(super) stretch_springs: Vec<([u32; 2], Spring)>,
    pub(super) bend_springs: Vec<([u32; 2], Spring)>,
    pub(super) membrane: MembraneColumns,
    pub(super) hinges: HingeColumns,
    pub(super) largest_rigidity: f64,
    pub(super) seams: SeamColumns,
    pub(super) pins: PinColumns,
    pub(super) loads: LoadColumns,
    pub(super) pin_groups: Vec<PinGroup>,
}

/// The mesh of one cloth and the data derived from it. Indices count from the cloth's first vertex.
pub(super) struct Sheet<'a> {
    pub(super) desc: &'a ClothDesc,
    pub(super) mesh: TriMesh,
    pub(super) rest: Vec<RestTriangle>,
    pub(super) edges: Vec<Edge>,
    pub(super) lengths: Vec<f64>,
    /// Index of the cloth's first vertex in the scene.
    pub(super) first: u32,
}

/// The mesh of a cloth before scale and placement.
#[cfg_attr(small, optimize(size), inline(never))]
pub(super) fn mesh(index: u32, desc: &ClothDesc, resources: &[Resource]) -> Result<TriMesh, SceneError> {
    match (&desc.grid, &desc.tube, &desc.disc, &desc.mesh) {
        (Some(desc), None, None, None) => grid::mesh(desc),
        (None, Some(desc), None, None) => tube::mesh(desc),
        (None, None, Some(desc), None) => disc::mesh(desc),
        (None, None, None, Some(name)) => resource(name, index, resources).cloned(),
        _ => Err(SceneError::OneMeshSource { cloth: index }),
    }
}

impl Parts {
    fn add_cloth(&mut self, index: u32, desc: &ClothDesc, resources: &[Resource]) -> Result<(), SceneError> {
        let sheet = self.sheet(index, desc, resources)?;
        let placed = place(&sheet, index, resources)?;
        check_digits(&sheet, &placed, *self.origin.get_or_insert_with(|| origin(&placed)))?;
        self.add_particles(&sheet, &placed)?;
        self.add_stretch(&sheet)?;
        self.add_bend(&sheet)?;
        for (number, seam) in desc.seam.iter().enumerate() {
            self.add_seam(&sheet, (index, number as u32), seam, resources)?;
        }
        for (pin_index, pin) in desc.pin.iter().enumerate() {
            self.add_pin(&sheet, &placed, (index, pin_index as u32), pin)?;
        }
        self.check_pins(sheet.first)?;
        for (number, mass) in desc.mass.iter().enumerate() {
            self.add_mass(&sheet, &placed, (index, number as u32), mass)?;
        }
        self.add_velocities(&sheet, &placed, index)?;
        for (number, load) in desc.load.iter().enumerate() {
            self.add_load(&sheet, &placed, (index, number as u32), load)?;
        }
        Ok(())
    }

    fn sheet<'a>(&self, index: u32, desc: &'a ClothDesc, resources: &[Resource]) -> Result<Sheet<'a>, SceneError> {
        finite("cloth.position", &desc.position)?;
        finite("cloth.rotation", &desc.rotation)?;
        let scale = positive("cloth.scale", desc.scale)?;
        positive("cloth.density", desc.density)?;
        let in_cloth = |error: MeshError| SceneError::Mesh { cloth: index, error };
        let mut mesh = mesh(index, desc, resources)?;
        nameable(self.positions.len() as u64 + mesh.positions.len() as u64)?;
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
        let areas = sheet.areas();
        self.material.extend(sheet.mesh.positions.iter().map(|&p| DVec3::from(p)));
        self.positions.extend_from_slice(placed);
        for area in &areas {
            let mass = area * sheet.desc.density;
            let usable = positive("mass", mass).and_then(|mass| positive("mass", 1.0 / mass));
            usable.map_err(|_| SceneError::NotPositive { key: "cloth.density", value: sheet.desc.density })?;
            self.masses.push(mass);
        }
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

    fn finish(mut self, scene: &SceneDesc) -> BuiltScene {
        let (vertices, origin) = (self.positions.len(), self.origin.unwrap_or_default());
        let drag = scene.drag.as_ref();
        let springs = |springs: &[_]| (!springs.is_empty()).then(|| SpringColumns::build(vertices, springs));
        self.membrane.incidence = IncidenceColumns::build(vertices, &self.membrane.vertices);
        self.hinges.incidence = IncidenceColumns::build(vertices, &self.hinges.vertices);
        self.seams.incidence = IncidenceColumns::build(vertices, &self.seams.vertices);
        if self.hinges.damping.iter().all(|&d| d == 0.0) {
            self.hinges.damping = Vec::new();
        }
        if self.pins.holds.iter().all(Hold::is_always) {
            self.pins.holds = Vec::new();
        }
        let linear = drag.map_or(0.0, |drag| drag.linear);
        let model = ModelColumns {
            gravity: scene.gravity.as_ref().map(|gravity| {
                let (acceleration, keys) = gravity.over_time();
                GravityColumns { acceleration, keys }
            }),
            drag: (linear > 0.0)
                .then(|| DragColumns { coefficients: self.areas.iter().map(|area| (area * linear) as Real).collect() }),
            stretch_springs: springs(&self.stretch_springs),
            bend_springs: springs(&self.bend_springs),
            membrane: (!self.membrane.vertices.is_empty()).then_some(self.membrane),
            hinges: (!self.hinges.vertices.is_empty()).then_some(self.hinges),
            seams: (!self.seams.vertices.is_empty()).then_some(self.seams),
            wind: drag.and_then(|drag| drag.wind.as_ref()).map(|wind| {
                let (velocity, keys) = wind.velocity.over_time();
                WindColumns {
                    vertices: self.triangles.clone(),
                    velocity,
                    keys,
                    normal: wind.normal as Real,
                    tangential: wind.tangential as Real,
                    incidence: IncidenceColumns::build(vertices, &self.triangles),
                }
            }),
            loads: (!self.loads.vertices.is_empty()).then_some(self.loads),
        };
        let mut particles = ParticleColumns::at_rest(
            self.positions.iter().map(|&p| vec3((p - origin).into())).collect(),
            self.masses.iter().map(|&m| m as Real).collect(),
            self.masses.iter().map(|&m| (1.0 / m) as Real).collect(),
        );
        particles.velocities = self.velocities.iter().map(|&v| vec3(v.into())).collect();
        BuiltScene {
            origin,
            particles,
            model,
            pins: self.pins,
            pin_groups: self.pin_groups,
            triangles: self.triangles,
            edges: self.edges,
            rest_lengths: self.rest_lengths.iter().map(|&l| l as Real).collect(),
            cloths: self.cloths,
            material: self.material,
            largest_rigidity: self.largest_rigidity,
            contact: None,
        }
    }
}

impl Sheet<'_> {
    /// Converts indices in the cloth to indices in the scene.
    pub(super) fn shift<const N: usize>(&self, indices: &[u32; N]) -> [u32; N] {
        indices.map(|i| self.first + i)
    }

    /// Rest area of each vertex: a third of its triangles', m^2.
    pub(super) fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.mesh.positions.len()];
        for (corners, rest) in self.mesh.triangles.iter().zip(&self.rest) {
            for &corner in corners {
                areas[corner as usize] += rest.area() / 3.0;
            }
        }
        areas
    }

    /// Rest areas of the triangles on both sides of an edge, m^2. The second is 0 at the border.
    pub(super) fn areas_beside(&self, edge: &Edge) -> [f64; 2] {
        edge.triangles.map(|t| if t == NONE { 0.0 } else { self.rest[t as usize].area() })
    }
}

pub(super) fn resource<'a>(name: &str, cloth: u32, resources: &'a [Resource]) -> Result<&'a TriMesh, SceneError> {
    files::mesh(name, resources).ok_or(SceneError::MissingMesh { cloth })
}
