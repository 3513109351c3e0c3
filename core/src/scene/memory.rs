//! The memory that a scene needs, estimated before anything of its size is allocated.
//!
//! Each part has its bytes per vertex in single and in double precision, as measured on sheets of 23 to 130 cells a
//! side. The estimate is one to two times the largest amount that the build takes at once (`tests/allocation.rs`). A
//! step with more contacts than usual needs more.

use alloc::vec::Vec;

use super::{BendModel, ClothDesc, Resource, SceneDesc, StretchModel, check, disc, grid, resource, tube};
use crate::error::SceneError;
use crate::integrate::Method;
use crate::real::Real;

/// Bytes per vertex in single and in double precision.
type Bytes = [u64; 2];

/// The state, and the columns that exist during the build only.
const STATE: Bytes = [620, 725];
const STRETCH_SPRINGS: Bytes = [75, 122];
const BEND_SPRINGS: Bytes = [180, 160];
const MEMBRANE: Bytes = [165, 275];
const HINGES: Bytes = [290, 475];
const WIND: Bytes = [60, 65];
/// Columns of the candidates and contacts that the build makes room for.
const CONTACT: Bytes = [7500, 11600];
/// A vertex of a collider's mesh.
const COLLIDER: Bytes = [1000, 1400];

/// Implicit methods: vectors, and the share of each term in the matrix. Terms share blocks, so the matrix has a limit.
const IMPLICIT: Bytes = [200, 375];
const STRETCH_SPRINGS_MATRIX: Bytes = [320, 510];
const BEND_SPRINGS_MATRIX: Bytes = [240, 500];
const MEMBRANE_MATRIX: Bytes = [555, 950];
const HINGES_MATRIX: Bytes = [750, 1230];
const WIND_MATRIX: Bytes = [600, 600];
const MOST_MATRIX: Bytes = [860, 1415];
/// Implicit methods with a history, an allowed error or Newton's method.
const HISTORY: Bytes = [335, 540];

/// Bytes per vertex in the precision of the crate.
fn of(bytes: Bytes) -> u64 {
    bytes[usize::from(size_of::<Real>() == size_of::<f64>())]
}

fn when(is_so: bool, bytes: Bytes) -> u64 {
    if is_so { of(bytes) } else { 0 }
}

/// Number of vertices of a cloth; 0 if it has no mesh, which the build refuses.
fn vertices(cloth: &ClothDesc, resources: &[Resource]) -> u64 {
    match (&cloth.grid, &cloth.tube, &cloth.disc, &cloth.mesh) {
        (Some(desc), ..) => grid::vertices(desc),
        (_, Some(desc), ..) => tube::vertices(desc),
        (_, _, Some(desc), _) => disc::vertices(desc),
        (.., Some(name)) => file(name, resources),
        _ => 0,
    }
}

fn file(name: &str, resources: &[Resource]) -> u64 {
    resource::mesh(name, resources).map_or(0, |mesh| mesh.positions.len() as u64)
}

/// Bytes per vertex of a cloth.
fn per_vertex(scene: &SceneDesc, cloth: &ClothDesc) -> u64 {
    let stretch = |model| cloth.stretch.as_ref().is_some_and(|stretch| stretch.model == model);
    let bend = |model| cloth.bend.as_ref().is_some_and(|bend| bend.model == model);
    let [membrane, springs] = [StretchModel::Membrane, StretchModel::Spring].map(stretch);
    let [hinges, bend_springs] = [BendModel::Hinge, BendModel::Spring].map(bend);
    let wind = scene.drag.as_ref().is_some_and(|drag| drag.wind.is_some());
    let explicit = of(STATE)
        + when(springs, STRETCH_SPRINGS)
        + when(bend_springs, BEND_SPRINGS)
        + when(membrane, MEMBRANE)
        + when(hinges, HINGES)
        + when(wind, WIND)
        + when(scene.contact.is_some(), CONTACT);
    let integrator = &scene.integrator;
    if !integrator.method.is_implicit() {
        return explicit;
    }
    let matrix = when(springs, STRETCH_SPRINGS_MATRIX)
        + when(bend_springs, BEND_SPRINGS_MATRIX)
        + when(membrane, MEMBRANE_MATRIX)
        + when(hinges, HINGES_MATRIX);
    let history = integrator.method == Method::Bdf2 || integrator.error().is_some() || integrator.newton > 1;
    let rest = of(IMPLICIT) + when(wind, WIND_MATRIX) + when(history, HISTORY);
    explicit + rest + matrix.min(of(MOST_MATRIX))
}

/// The memory that a scene needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Vertices of all cloths.
    pub vertices: u64,
    /// Estimate of the memory that the simulation needs, bytes.
    pub bytes: u64,
}

/// The memory that a scene needs. `resources` holds every mesh file that it names.
///
/// Errors: [`SceneError::TooLarge`].
#[cfg_attr(small, optimize(size))]
pub fn memory(scene: &SceneDesc, resources: &[Resource]) -> Result<Memory, SceneError> {
    let vertices = scene.cloth.iter().map(|cloth| vertices(cloth, resources));
    let bytes = vertices.clone().zip(&scene.cloth).map(|(count, cloth)| count.saturating_mul(per_vertex(scene, cloth)));
    let files = scene.collider.iter().filter_map(|collider| collider.file.as_ref());
    let of_colliders = files.map(|name| file(name, resources).saturating_mul(of(COLLIDER)));
    let bytes = bytes.chain(of_colliders).fold(0, u64::saturating_add);
    let vertices = vertices.fold(0, u64::saturating_add);
    check::nameable(vertices)?;
    Ok(Memory { vertices, bytes })
}

impl From<Memory> for SceneError {
    fn from(Memory { vertices, bytes }: Memory) -> Self {
        Self::Memory { vertices, bytes }
    }
}

/// Checks that the memory of a scene can be had, by reserving as much for a moment.
pub(crate) fn reserve(scene: &SceneDesc, resources: &[Resource]) -> Result<(), SceneError> {
    let needed = memory(scene, resources)?;
    let mut trial: Vec<u8> = Vec::new();
    let reserved = usize::try_from(needed.bytes).is_ok_and(|bytes| trial.try_reserve_exact(bytes).is_ok());
    // Without this, the compiler may leave the reservation out.
    core::hint::black_box(&mut trial);
    if reserved { Ok(()) } else { Err(needed.into()) }
}
