//! The graphics processor, for what can use it.

use std::sync::{Mutex, MutexGuard, PoisonError};

use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch};
use muslin_gpu::device::Ask;
use muslin_gpu::{DetectionError, Gpu, step};
use serde::Serialize;

use crate::failure::{Failure, print_note};

/// What to do without one.
pub const INSTALL: &str = "install the driver of your graphics card, or a software one (Debian and Ubuntu: apt-get \
                           install mesa-vulkan-drivers)";

/// The fastest adapter.
pub fn open() -> Result<Gpu, Failure> {
    pollster::block_on(Gpu::open(Ask::Most))
        .map_err(|why| Failure::NoDevice(format!("--backend gpu: {why}; {INSTALL}, or say --backend cpu")))
}

/// What a device says, as a failure of the command.
pub fn failed(why: DetectionError) -> Failure {
    let advice = match why {
        DetectionError::TooLarge(_) => "take a lesser --thickness, or say --backend cpu",
        _ => "say --backend cpu",
    };
    Failure::NoDevice(format!("--backend gpu: {why}; {advice}"))
}

/// How long a device takes for a stage, by its own clock.
#[derive(Clone, Debug, Serialize)]
pub struct StageTime {
    /// The file that it is in.
    pub stage: &'static str,
    /// ms.
    pub ms: f64,
}

/// Those of all stages; none where a device has no clocks.
pub fn stage_times(times: impl Iterator<Item = (&'static str, f64)>) -> Option<Vec<StageTime>> {
    let all: Vec<_> = times.map(|(stage, ms)| StageTime { stage, ms }).collect();
    (!all.is_empty()).then_some(all)
}

fn held<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Finds the candidates of a run's steps on a device.
pub struct StepDetector {
    /// Of the adapter that was asked last.
    name: Mutex<String>,
    /// None while it is asked, and when it was lost and could not be had again.
    own: Mutex<Option<step::StepDetector>>,
}

impl StepDetector {
    /// On the fastest adapter.
    pub fn open() -> Result<Self, Failure> {
        let gpu = open()?;
        Ok(Self { name: Mutex::new(gpu.name.clone()), own: Mutex::new(Some(step::StepDetector::new(gpu))) })
    }

    /// Of the adapter that was asked last.
    pub fn name(&self) -> String {
        held(&self.name).clone()
    }

    fn own(&self) -> MutexGuard<'_, Option<step::StepDetector>> {
        held(&self.own)
    }

    /// Mean times of so many steps.
    pub fn stage_times(&self, steps: u64) -> Option<Vec<StageTime>> {
        let per_step = |&(stage, ms): &(&'static str, f64)| (stage, ms / steps.max(1) as f64);
        stage_times(self.own().as_ref()?.stage_ms().iter().map(per_step))
    }

    /// Finds candidates and their distances. Where a device was lost and could not be had again the processor
    /// goes on: none.
    pub async fn detect(&self, model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<Counts> {
        let mut own = self.own().take()?;
        let found = own.detect(model, contact).await;
        if let Some(why) = own.take_loss() {
            held(&self.name).clone_from(&own.gpu().name);
            print_note(&format!("warning: --backend gpu: {why}; opened it again"));
        }
        match found {
            Ok(counts) => {
                *self.own() = Some(own);
                Some(counts)
            }
            // Fewer candidates will have room again.
            Err(why @ DetectionError::TooLarge(_)) => {
                print_note(&format!("warning: --backend gpu: {why}; the processor detects once"));
                *self.own() = Some(own);
                None
            }
            Err(why) => {
                print_note(&format!("warning: --backend gpu: {why}; the processor goes on"));
                None
            }
        }
    }
}
