//! One thread, a clock for each part of a step, and a device for candidates where there is one.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch};
use muslin_core::dispatch::{Dispatch, Serial, Split};
use muslin_core::stage::Stage;
use muslin_gpu::step::StepDetector;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    /// ms, of pages, workers and Node.js.
    #[wasm_bindgen(js_namespace = performance)]
    fn now() -> f64;
}

/// Parts of a step with a clock each: predict, broad phase, narrow phase, response.
pub const PARTS: usize = 4;

#[derive(Default)]
struct Times {
    since: Option<(usize, f64)>,
    sums: [f64; PARTS],
}

impl Times {
    fn enter(&mut self, part: Option<usize>) {
        if self.since.map(|(current, _)| current) == part {
            return;
        }
        let time = now();
        if let Some((current, since)) = self.since {
            self.sums[current] += time - since;
        }
        self.since = part.map(|part| (part, time));
    }
}

/// Runs kernels here, told the time; asks its device for candidates.
#[derive(Default)]
pub struct Clock {
    times: Mutex<Times>,
    /// `None` while a step uses it, and without a device.
    detector: Mutex<Option<StepDetector>>,
    /// Whether a step must not wait for it.
    here: AtomicBool,
    /// What the device said last that it should not.
    note: Mutex<Option<String>>,
}

fn own<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Clock {
    /// Stops until the next part is entered.
    pub fn pause(&self) {
        own(&self.times).enter(None);
    }

    /// ms in each part since this was last asked.
    pub fn take(&self) -> [f64; PARTS] {
        core::mem::take(&mut own(&self.times).sums)
    }

    /// Whether steps find their candidates here from now on, whatever device there is. One type for both: two
    /// would be all kernels twice.
    pub fn stay_here(&self, here: bool) {
        self.here.store(here, Ordering::Relaxed);
    }

    /// Whether a device is asked for candidates.
    pub fn has_device(&self) -> bool {
        own(&self.detector).is_some()
    }

    /// Asks a device from now on.
    pub fn ask(&self, detector: Option<StepDetector>) {
        *own(&self.detector) = detector;
    }

    /// Another scene comes.
    pub fn forget(&self) {
        if let Some(detector) = own(&self.detector).as_mut() {
            detector.forget();
        }
    }

    /// What a device said that it should not, once.
    pub fn note(&self) -> Option<String> {
        own(&self.note).take()
    }
}

impl Dispatch for Clock {
    fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
        Serial.run(out, kernel);
    }

    async fn detect(&self, model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<Counts> {
        if self.here.load(Ordering::Relaxed) {
            return None;
        }
        let mut detector = own(&self.detector).take()?;
        let found = detector.detect(model, contact).await;
        let lost = detector.take_loss().map(|why| format!("{why}; opened it again"));
        let why = found.as_ref().err().map(|why| format!("{why}; the processor detects"));
        if let Some(note) = why.or(lost) {
            *own(&self.note) = Some(note);
        }
        // Fewer candidates will have room again; what is lost for good is not asked again.
        if !matches!(found, Err(muslin_gpu::DetectionError::Lost(_))) {
            self.ask(Some(detector));
        }
        found.ok()
    }

    fn enter(&self, stage: Stage) {
        let part = match stage {
            Stage::BroadPhase => 1,
            Stage::NarrowPhase => 2,
            Stage::Response => 3,
            _ => 0,
        };
        own(&self.times).enter(Some(part));
    }
}
