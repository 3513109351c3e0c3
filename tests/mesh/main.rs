//! Meshes and scenes: what the generators make, what is derived from triangles, which vertices a
//! pin selects, and what every bad mesh or scene is told. In f64: meshes are built in double in
//! both precisions, and only the finished columns are rounded.
//!
//! Run: `cargo test -p muslin-tests --test mesh`.

mod mesh_errors;
mod pins;
mod rest;
mod scene_errors;
mod seams;
mod topology;

use harness::kit::double as kit;
use muslin_core_f64::scene::BuiltScene;

/// A scene with one cloth of 1 kg/m^2, built.
fn cloth(lines: &str) -> BuiltScene {
    kit::build(&scene(lines))
}

fn scene(lines: &str) -> String {
    format!("name = \"mesh\"\nduration = 0\n[[cloth]]\ndensity = 1.0\n{lines}")
}
