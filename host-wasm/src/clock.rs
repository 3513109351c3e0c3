//! How the browser runs a step: on one thread, with a clock for each part, and optionally a device that finds
//! candidates.

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
    /// The time in pages, workers and Node.js, ms.
    #[wasm_bindgen(js_namespace = performance)]
    fn now() -> f64;
}

/// Number of parts of a step that are timed: predict, broad phase, narrow phase, response.
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

/// Runs kernels on this thread, measures their time, and lets its device find candidates.
#[derive(Default)]
pub struct Clock {
    times: Mutex<Times>,
    /// `None` while a step uses it, and without a device.
    detector: Mutex<Option<StepDetector>>,
    /// Whether steps find candidates on this thread, because they must not wait for the device.
    here: AtomicBool,
    /// The last message about a failure of the device.
    note: Mutex<Option<String>>,
    /// The time at which a step is given up, ms; `None`: never.
    deadline: Mutex<Option<f64>>,
}

fn own<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Clock {
    /// Stops the clock until the next part is entered.
    pub fn pause(&self) {
        own(&self.times).enter(None);
    }

    /// Time in each part since the last call, ms.
    pub fn take(&self) -> [f64; PARTS] {
        core::mem::take(&mut own(&self.times).sums)
    }

    /// Sets whether steps find their candidates on this thread, even if there is a device. One type serves both
    /// cases, because two types would compile all kernels twice.
    pub fn stay_here(&self, here: bool) {
        self.here.store(here, Ordering::Relaxed);
    }

    /// Gives up the next steps after this time, ms, if it is finite.
    pub fn allow(&self, longest: f64) {
        *own(&self.deadline) = longest.is_finite().then(|| now() + longest);
    }

    /// Whether there is a device that finds candidates.
    pub fn has_device(&self) -> bool {
        own(&self.detector).is_some()
    }

    /// Uses this device from now on, or no device.
    pub fn ask(&self, detector: Option<StepDetector>) {
        *own(&self.detector) = detector;
    }

    /// Discards the data of the scene on the device, because another scene follows.
    pub fn forget(&self) {
        if let Some(detector) = own(&self.detector).as_mut() {
            detector.forget();
        }
    }

    /// The last message about a failure of the device. It is returned only once.
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
        // A device that ran out of room is kept: fewer candidates will fit again. A device that is lost for good is
        // dropped.
        if !matches!(found, Err(muslin_gpu::DetectionError::Lost(_))) {
            self.ask(Some(detector));
        }
        found.ok()
    }

    fn stopped(&self) -> bool {
        own(&self.deadline).is_some_and(|deadline| now() > deadline)
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
