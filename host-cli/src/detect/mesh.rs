//! The input mesh: its surface, and a box around each vertex or around its motion.

use std::path::Path;

use muslin_core::geometry::aabb::Aabb;
use muslin_core::mesh::{SurfaceColumns, TriMesh};
use muslin_core::real::Vec3;

use crate::args::DetectArguments;
use crate::failure::Failure;
use crate::mesh_io;

/// The input mesh and its motion.
pub struct Subject {
    /// Thickness, m.
    pub thickness: f32,
    /// Number of vertices that belong to no triangle, and so touch nothing.
    pub loose_vertices: usize,
    /// The features of the mesh.
    pub surface: SurfaceColumns,
    /// Positions, m.
    pub positions: Vec<Vec3>,
    /// Positions in the next mesh, m.
    pub next: Option<Vec<Vec3>>,
    /// Box around the motion of each vertex, enlarged by half the thickness on each side.
    pub boxes: Vec<Aabb>,
}

impl Subject {
    /// Loads and checks the meshes that the arguments name.
    pub fn load(arguments: &DetectArguments) -> Result<Self, Failure> {
        let (mesh, positions) = load(&arguments.mesh)?;
        let next = match &arguments.next {
            Some(path) => {
                let (next, places) = load(path)?;
                same_triangles(&mesh, &next).map_err(|why| {
                    Failure::Usage(format!(
                        "{}: {why}; --next must be the same mesh with other positions",
                        path.display()
                    ))
                })?;
                Some(places)
            }
            None => None,
        };
        let half = 0.5 * arguments.thickness;
        let ends = next.as_ref().unwrap_or(&positions);
        let around = |(start, end): (&Vec3, &Vec3)| Aabb { min: start.min(*end) - half, max: start.max(*end) + half };
        Ok(Self {
            thickness: arguments.thickness,
            loose_vertices: mesh.loose_vertices(),
            surface: SurfaceColumns::build(positions.len(), &mesh.triangles, &[]),
            boxes: positions.iter().zip(ends).map(around).collect(),
            positions,
            next,
        })
    }
}

fn load(path: &Path) -> Result<(TriMesh, Vec<Vec3>), Failure> {
    let failed = |why: String| Failure::Usage(format!("{}: {why}", path.display()));
    let mesh = mesh_io::load(path).map_err(|error| Failure::Usage(error.to_string()))?;
    mesh.check_surface().map_err(|error| failed(error.to_string()))?;
    let positions: Vec<_> = mesh.positions.iter().map(|p| Vec3::from_array(p.map(|x| x as f32))).collect();
    match positions.iter().position(|p| !p.is_finite()) {
        Some(vertex) => Err(failed(format!("vertex {vertex} is beyond single precision; scale the mesh down"))),
        None => Ok((mesh, positions)),
    }
}

fn same_triangles(mesh: &TriMesh, next: &TriMesh) -> Result<(), String> {
    let [vertices, triangles] = [|m: &TriMesh| m.positions.len(), |m: &TriMesh| m.triangles.len()];
    if vertices(mesh) != vertices(next) || triangles(mesh) != triangles(next) {
        return Err(format!(
            "{} vertices and {} triangles, the first mesh has {} and {}",
            vertices(next),
            triangles(next),
            vertices(mesh),
            triangles(mesh)
        ));
    }
    match mesh.triangles.iter().zip(&next.triangles).position(|(a, b)| a != b) {
        Some(triangle) => Err(format!("triangle {triangle} has other vertices than in the first mesh")),
        None => Ok(()),
    }
}
