//! The torture set with candidates found on a device: no crossings, and no vertex inside a collider.

use muslin_core::dispatch::Serial;

use super::methods::gpu;
use super::on_device::{OnDevice, begin};
use harness::torture::{SCENES, Scene};

fn check(scene: &Scene, seed: u64) {
    let (device, mut sim) = (OnDevice::open(), begin(scene, seed));
    for step in 1..=scene.steps {
        sim.step(&device).unwrap_or_else(|diverged| panic!("{}, seed {seed}: {diverged}", scene.name));
        let (crossings, depth) = (sim.crossings(&Serial), sim.penetration().unwrap_or(0.0));
        assert_eq!((crossings, depth), (0, 0.0), "{}, seed {seed}: crossings and depth after step {step}", scene.name);
    }
    println!("{}: {:?}", scene.name, sim.contact_statistics());
}

/// The scenes that CI runs.
const SOME: [&str; 4] = ["folded", "wrung", "masses", "capsules"];

#[test]
#[ignore = "takes a graphics driver"]
fn nothing_passes_through_anything() {
    if gpu().is_some() {
        SCENES.iter().filter(|scene| SOME.contains(&scene.name)).for_each(|scene| check(scene, 0));
    }
}

#[test]
#[ignore = "a command of its own"]
fn long_form_of_every_scene() {
    if gpu().is_some() {
        SCENES.iter().for_each(|scene| check(scene, 0));
    }
}
