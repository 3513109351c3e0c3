//! A torture scene whose candidates are found by a device.

use std::sync::Mutex;

use glam::DVec3;
use harness::kit::single::simulation;
use harness::rng::Rng;
use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch};
use muslin_core::dispatch::{Dispatch, Serial, Split};
use muslin_core::real::{to_f64, vec3};
use muslin_core::simulation::Simulation;
use muslin_gpu::Gpu;
use muslin_gpu::device::Ask;
use muslin_gpu::step::StepDetector;

use harness::torture::Scene;

/// One thread, and a device for detection.
pub struct OnDevice(Mutex<Option<StepDetector>>);

impl OnDevice {
    /// Opens a device of its own, which may be lost.
    pub fn open() -> Self {
        let gpu = pollster::block_on(Gpu::open(Ask::Web)).unwrap();
        Self(Mutex::new(Some(StepDetector::new(gpu))))
    }

    /// Calls a function with the detector, between steps.
    pub fn with<R>(&self, ask: impl FnOnce(&mut StepDetector) -> R) -> R {
        ask(self.0.lock().unwrap().as_mut().unwrap())
    }
}

impl Dispatch for OnDevice {
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        Serial.run(out, kernel);
    }

    async fn detect(&self, model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<Counts> {
        let mut own = self.0.lock().unwrap().take().unwrap();
        let counts = own.detect(model, contact).await.unwrap();
        *self.0.lock().unwrap() = Some(own);
        Some(counts)
    }
}

/// A simulation of a scene with the start positions of a seed.
pub fn begin(scene: &Scene, seed: u64) -> Simulation {
    let (mut sim, mut rng) = (simulation(&(scene.text)(), &[]), Rng::new(seed));
    let mut start: Vec<DVec3> = sim.positions().iter().map(|&x| to_f64(x).into()).collect();
    (scene.start)(&mut start, &mut rng);
    for (x, start) in sim.state_mut().0.iter_mut().zip(start) {
        *x = vec3(start.into());
    }
    sim
}
