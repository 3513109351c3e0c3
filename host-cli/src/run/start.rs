//! Before the first step: warnings of unsuitable settings, and the untangling of a start state with crossings.

use std::sync::atomic::{AtomicBool, Ordering};

use muslin_core::diagnostics::extent;
use muslin_core::scene::Content;
use muslin_core::warning;

use super::words::{self, Known};
use crate::args::Precision;
use crate::engine::{Engine, Untangled};
use crate::mesh_io;
use crate::pool::Pool;
use crate::record;
use crate::scene_file::SceneFile;
use crate::stopwatch::Stopwatch;
use crate::warning::Warning;

/// Displacement by untangling beyond which the note asks the user to look at the start state, m.
const FAR: f64 = 0.05;

/// Iterations that give the frequency of the fastest mode to about one per cent. They cost less than the steps.
pub(super) const ITERATIONS: u32 = 100;

/// The warnings of settings that do not suit the scene.
pub fn warnings(
    engine: &dyn Engine,
    scene: &SceneFile,
    precision: Precision,
    stopwatch: &Stopwatch<'_>,
) -> Vec<Warning> {
    let mut positions = Vec::new();
    engine.write_state(&mut positions);
    let size = extent(positions.into_iter()).into_iter().fold(0.0, f64::max);
    let start = warning::Start { mean_edge: engine.mean_edge(), size, is_single: precision == Precision::F32 };
    let modes = || engine.fastest_modes(0.0, ITERATIONS, stopwatch);
    let of_settings = warning::of_settings(&scene.desc, &start, modes).into_iter().flatten();
    let in_words = |one| words::of(&one, &scene.desc, Known::default());
    loose_vertices(scene).chain(of_settings.map(in_words)).collect()
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
    let warning = (found.before > 0 || found.inside[0] > 0).then(|| Warning::new("untangled", words(&found)));
    let crossings = audited.unwrap_or(found.before as u64);
    Some((record::Start { crossings: Some(crossings), untangled: Some((found.before - found.after) as u64) }, warning))
}

fn words(found: &Untangled) -> String {
    let Untangled { before, after, inside, rounds, moved } = *found;
    let what = match (before, inside[0]) {
        (0, inside) => format!("{inside} vertices inside colliders"),
        (before, _) => format!("{before} crossings"),
    };
    let left = match (after, inside[1]) {
        (0, 0) => format!("untangled in {rounds} round{}", if rounds == 1 { "" } else { "s" }),
        (0, inside) => format!("{inside} vertices left inside (fixed by pins or colliders)"),
        (after, _) => format!("{after} left (fixed by pins or colliders)"),
    };
    let moved_far = moved > FAR;
    let moved = match rounds {
        0 => "nothing was moved".into(),
        _ => format!("vertices moved by up to {:.1} mm", 1e3 * moved),
    };
    let advice = if moved_far { "; look at frame 0, and separate the surfaces yourself if it is wrong" } else { "" };
    format!("{what} at the start: {left}, {moved}{advice}")
}
