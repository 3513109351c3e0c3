//! Meshes and scenes: the output of the generators, the quantities derived from triangles, the vertices that a
//! pin selects, and the error for every bad mesh or scene. In f64: both precisions build meshes in double and
//! round only the finished columns.
//!
//! Run: `cargo test -p muslin-tests --test mesh`.

mod groups;
mod mesh_errors;
mod pins;
mod rest;
mod scene_errors;
mod seams;
mod topology;

use harness::kit::double as kit;
use muslin_core_f64::scene::BuiltScene;

/// Builds a scene with one cloth of 1 kg/m^2.
fn cloth(lines: &str) -> BuiltScene {
    kit::build(&scene(lines))
}

fn scene(lines: &str) -> String {
    format!("name = \"mesh\"\nduration = 0\n[[cloth]]\ndensity = 1.0\n{lines}")
}
