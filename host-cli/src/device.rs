//! The graphics processor, for the commands that can use one.

use std::sync::{Mutex, MutexGuard, PoisonError};

use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch};
use muslin_gpu::device::Ask;
use muslin_gpu::{DetectionError, Gpu, step};
use serde::Serialize;

use crate::failure::{Failure, print_note};
use crate::warning::Warning;

/// Advice for a machine without a graphics device.
pub const INSTALL: &str = "install the driver of your graphics card, or a software one (Debian and Ubuntu: apt-get \
                           install mesa-vulkan-drivers)";

/// Opens the fastest adapter.
pub fn open() -> Result<Gpu, Failure> {
    pollster::block_on(Gpu::open(Ask::Most))
        .map_err(|why| Failure::NoDevice(format!("--backend gpu: {why}; {INSTALL}, or use --backend cpu")))
}

/// Converts an error of the device into a failure of the command, with advice.
pub fn failed(why: DetectionError) -> Failure {
    let advice = match why {
        DetectionError::TooLarge(_) => "take a smaller --thickness, or use --backend cpu",
        _ => "say --backend cpu",
    };
    Failure::NoDevice(format!("--backend gpu: {why}; {advice}"))
}

/// Time of a stage, by the device's own clock.
#[derive(Clone, Debug, Serialize)]
pub struct StageTime {
    /// The shader file of the stage.
    pub stage: &'static str,
    /// Time, ms.
    pub ms: f64,
}

/// The times of all stages; `None` if the device has no clock.
pub fn stage_times(times: impl Iterator<Item = (&'static str, f64)>) -> Option<Vec<StageTime>> {
    let all: Vec<_> = times.map(|(stage, ms)| StageTime { stage, ms }).collect();
    (!all.is_empty()).then_some(all)
}

fn held<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Finds the candidates of each step of a run on a device.
pub struct StepDetector {
    /// Name of the adapter that was used last.
    name: Mutex<String>,
    /// `None` during a detection, and after an error that ended the use of the device.
    own: Mutex<Option<step::StepDetector>>,
    warnings: Mutex<Vec<Warning>>,
}

impl StepDetector {
    /// Opens the fastest adapter.
    pub fn open() -> Result<Self, Failure> {
        let gpu = open()?;
        let name = Mutex::new(gpu.name.clone());
        Ok(Self { name, own: Mutex::new(Some(step::StepDetector::new(gpu))), warnings: Mutex::default() })
    }

    /// Prints a warning at once, and keeps it for the summary.
    fn warn(&self, text: String) {
        let warning = Warning::new("gpu", text);
        print_note(&format!("warning: {}", warning.text));
        held(&self.warnings).push(warning);
    }

    /// The warnings so far.
    pub fn warnings(&self) -> Vec<Warning> {
        held(&self.warnings).clone()
    }

    /// Name of the adapter that was used last.
    pub fn name(&self) -> String {
        held(&self.name).clone()
    }

    fn own(&self) -> MutexGuard<'_, Option<step::StepDetector>> {
        held(&self.own)
    }

    /// Mean times per step over `steps` steps.
    pub fn stage_times(&self, steps: u64) -> Option<Vec<StageTime>> {
        let per_step = |&(stage, ms): &(&'static str, f64)| (stage, ms / steps.max(1) as f64);
        stage_times(self.own().as_ref()?.stage_ms().iter().map(per_step))
    }

    /// Finds candidates and their distances. Returns `None` if the device has failed or has too little memory for
    /// this step; the CPU then finds them.
    pub async fn detect(&self, model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<Counts> {
        let mut own = self.own().take()?;
        let found = own.detect(model, contact).await;
        if let Some(why) = own.take_loss() {
            held(&self.name).clone_from(&own.gpu().name);
            self.warn(format!("--backend gpu: {why}; opened it again"));
        }
        match found {
            Ok(counts) => {
                *self.own() = Some(own);
                Some(counts)
            }
            // The device stays in use: a later step may have fewer candidates, which fit.
            Err(why @ DetectionError::TooLarge(_)) => {
                self.warn(format!("--backend gpu: {why}; the processor finds the candidates of this step"));
                *self.own() = Some(own);
                None
            }
            Err(why) => {
                self.warn(format!("--backend gpu: {why}; the processor finds all further candidates"));
                None
            }
        }
    }
}
