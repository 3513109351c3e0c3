//! A scene file: it is read and built, and takes two steps if it is small.
#![no_main]

use muslin_cli::readers;
use muslin_core::dispatch::{Limited, Serial};
use muslin_core::simulation::Simulation;

/// Vertices and colliders of a scene that takes steps here. Larger ones take too long.
const MOST: u64 = 400;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let Ok(scene) = readers::scene(text) else { return };
    let cells = scene.cloth.iter().filter_map(|cloth| cloth.grid.as_ref()).map(|grid| grid.cells);
    let vertices: u64 = cells.map(|[x, z]| (u64::from(x) + 1).saturating_mul(u64::from(z) + 1).saturating_mul(2)).sum();
    let is_small = scene.cloth.iter().all(|cloth| cloth.tube.is_none() && cloth.disc.is_none());
    if vertices > MOST || !is_small {
        return;
    }
    let Ok(mut simulation) = Simulation::new(&scene, &[]) else { return };
    for _ in 0..2 {
        _ = simulation.step(&Limited::new(&Serial, 500, 100_000));
    }
});
