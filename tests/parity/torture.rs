//! The torture set with candidates found on a device: nothing passes through anything.

use std::sync::Mutex;

use glam::DVec3;
use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch};
use muslin_core::dispatch::{Dispatch, Serial, Split};
use muslin_core::real::{to_f64, vec3};
use muslin_gpu::Gpu;
use muslin_gpu::device::Ask;
use muslin_gpu::step::StepDetector;
use muslin_tests::kit::single::simulation;
use muslin_tests::rng::Rng;

use super::methods::gpu;
use super::scenes::{SCENES, Scene};

/// One thread, and a device for detection.
struct OnDevice(Mutex<StepDetector>);

impl Dispatch for OnDevice {
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        Serial.run(out, kernel);
    }

    fn detect(&self, model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<Counts> {
        Some(self.0.lock().unwrap().detect(model, contact).unwrap())
    }
}

fn check(scene: &Scene, seed: u64) {
    let gpu = pollster::block_on(Gpu::open(Ask::Web)).unwrap();
    let device = OnDevice(Mutex::new(StepDetector::new(gpu)));
    let (mut sim, mut rng) = (simulation(&(scene.text)(), &[]), Rng::new(seed));
    let mut start: Vec<DVec3> = sim.positions().iter().map(|&x| to_f64(x).into()).collect();
    (scene.start)(&mut start, &mut rng);
    for (x, start) in sim.state_mut().0.iter_mut().zip(start) {
        *x = vec3(start.into());
    }
    for step in 1..=scene.steps {
        sim.step(&device).unwrap_or_else(|diverged| panic!("{}, seed {seed}: {diverged}", scene.name));
        let (crossings, depth) = (sim.crossings(), sim.penetration().unwrap_or(0.0));
        assert_eq!((crossings, depth), (0, 0.0), "{}, seed {seed}: crossings and depth after step {step}", scene.name);
    }
    println!("{}: {:?}", scene.name, sim.tally());
}

/// Those that CI has time for.
const SOME: [&str; 4] = ["folded", "wrung", "masses", "capsules"];

#[test]
#[cfg_attr(debug_assertions, ignore = "slow: run with --release")]
fn nothing_passes_through_anything() {
    if gpu().is_some() {
        SCENES.iter().filter(|scene| SOME.contains(&scene.name)).for_each(|scene| check(scene, 0));
    }
}

#[test]
#[ignore = "takes a minute: all scenes"]
fn nothing_passes_through_anything_in_any_scene() {
    if gpu().is_some() {
        SCENES.iter().for_each(|scene| check(scene, 0));
    }
}
