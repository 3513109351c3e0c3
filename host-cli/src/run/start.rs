//! Before the first step: warnings of unsuitable settings, and the untangling of a start state with crossings.

use std::sync::atomic::{AtomicBool, Ordering};

use muslin_core::diagnostics::extent;
use muslin_core::integrate::stability::Mode;
use muslin_core::scene::Content;
use muslin_core::warning;

use super::words::{self, Known};
use crate::args::Precision;
use crate::engine::Engine;
use crate::limits;
use crate::mesh_io;
use crate::pool::Pool;
use crate::record;
use crate::scene_file::SceneFile;
use crate::stopwatch::Stopwatch;
use crate::warning::Warning;

/// Iterations that give the frequency of the fastest mode to about one per cent. They cost less than the steps.
const ITERATIONS: u32 = 100;

/// Memory that the fastest modes take, bytes per vertex in single and in double precision: two matrices and the
/// memory of their build. Up to 3000 were measured in single precision.
const MODES: [u64; 2] = [4000, 6500];

/// Memory that the fastest modes of so many vertices take, bytes.
fn memory_of_modes(vertices: usize, precision: Precision) -> u64 {
    vertices as u64 * MODES[usize::from(precision == Precision::F64)]
}

/// The fastest modes of the current state; `None` if there is no memory for their matrices.
pub(super) fn fastest_modes(
    engine: &dyn Engine,
    vertices: usize,
    precision: Precision,
    stopwatch: &Stopwatch<'_>,
) -> Option<[Mode; 2]> {
    let has_memory = limits::has_memory(memory_of_modes(vertices, precision));
    has_memory.then(|| engine.fastest_modes(0.0, ITERATIONS, stopwatch))
}

/// The warning that the fastest modes of so many vertices are not known.
pub(super) fn unchecked(vertices: usize, precision: Precision) -> Warning {
    let text = format!(
        "it was not checked whether the steps are too long for the stiffness: this needs about {} MB of memory, more \
         than is left{}",
        memory_of_modes(vertices, precision).div_ceil(1_000_000),
        limits::memory_in_words()
    );
    Warning::new("unchecked", text)
}

/// The warnings of settings that do not suit the scene.
pub fn warnings(
    engine: &dyn Engine,
    scene: &SceneFile,
    precision: Precision,
    stopwatch: &Stopwatch<'_>,
) -> Vec<Warning> {
    let mut positions = Vec::new();
    engine.write_state(&mut positions);
    let vertices = positions.len();
    let size = extent(positions.into_iter()).into_iter().fold(0.0, f64::max);
    let start = warning::Start {
        mean_edge: engine.mean_edge(),
        size,
        smallest: engine.smallest_size(),
        mass: engine.mass(),
        rigidity: engine.largest_rigidity(),
        deviation: engine.largest_deviation(scene.desc.duration),
        is_single: precision == Precision::F32,
    };
    let mut not_checked = None;
    let modes = || {
        fastest_modes(engine, vertices, precision, stopwatch).unwrap_or_else(|| {
            not_checked = Some(unchecked(vertices, precision));
            // No warning is about a mode at rest.
            [Mode { stiffness: 0.0, damping: 0.0 }; 2]
        })
    };
    let of_settings = warning::of_settings(&scene.desc, &start, modes).into_iter().flatten();
    let in_words = |one| words::of(&one, &scene.desc, Known::default());
    loose_vertices(scene).chain(of_settings.map(in_words)).chain(not_checked).collect()
}

/// Vertices of a collider's mesh that belong to no triangle. Cloth with such vertices is refused.
fn loose_vertices(scene: &SceneFile) -> impl Iterator<Item = Warning> {
    scene.resources.iter().filter_map(|(name, content)| {
        let of_collider = scene.desc.collider.iter().any(|collider| collider.file.as_ref() == Some(name));
        match content {
            Content::Mesh(mesh) if of_collider => mesh_io::loose_note(name, mesh.loose_vertices()),
            Content::Mesh(_) | Content::Cache(_) => None,
        }
        .map(|note| Warning::new("loose-vertices", note))
    })
}

/// Untangles the start state of a scene with contact. Also returns a warning, if there was something to untangle.
/// `None` after an interrupt: then the state is not to be used.
pub fn untangle(
    engine: &mut dyn Engine,
    audit: bool,
    pool: &Pool,
    stop: &AtomicBool,
) -> Option<(record::Start, Option<Warning>)> {
    let stopwatch = Stopwatch::new(pool).until(stop);
    let audited = audit.then(|| engine.crossings(&stopwatch) as u64);
    let found = engine.untangle(&stopwatch);
    if (audit || found.is_some()) && stop.load(Ordering::Relaxed) {
        return None;
    }
    let Some(found) = found else { return Some((record::Start { crossings: audited, untangled: None }, None)) };
    let warning =
        (found.before > 0 || found.inside[0] > 0).then(|| Warning::new("untangled", words::untangled(&found)));
    let crossings = audited.unwrap_or(found.before as u64);
    Some((record::Start { crossings: Some(crossings), untangled: Some((found.before - found.after) as u64) }, warning))
}
