//! The graphics processor, for what can use it.

use std::sync::{Mutex, PoisonError};

use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch};
use muslin_gpu::device::Ask;
use muslin_gpu::{Failed, Gpu, step};

use crate::failure::{Failure, print_note};

/// What to do without one.
pub const INSTALL: &str = "install the driver of your graphics card, or a software one (Debian and Ubuntu: apt-get \
                           install mesa-vulkan-drivers), or say --backend cpu";

/// The fastest adapter.
pub fn open() -> Result<Gpu, Failure> {
    pollster::block_on(Gpu::open(Ask::Most))
        .map_err(|why| Failure::NoDevice(format!("--backend gpu: {why}; {INSTALL}")))
}

/// What a device says, as a failure of the command.
pub fn failed(why: Failed) -> Failure {
    Failure::NoDevice(format!("--backend gpu: {why}; say --backend cpu"))
}

/// Finds the candidates of a run's steps on a device.
pub struct StepDetector {
    name: String,
    /// None: it was lost and could not be had again.
    own: Mutex<Option<step::StepDetector>>,
}

impl StepDetector {
    /// On the fastest adapter.
    pub fn open() -> Result<Self, Failure> {
        let gpu = open()?;
        Ok(Self { name: gpu.name.clone(), own: Mutex::new(Some(step::StepDetector::new(gpu))) })
    }

    /// Of the adapter.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Finds candidates and their distances. A device that is lost is opened again and asked again; where
    /// that does not help the processor goes on: none.
    pub fn detect(&self, model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<Counts> {
        let mut own = self.own.lock().unwrap_or_else(PoisonError::into_inner);
        let found = own.as_mut()?.detect(model, contact).or_else(|why| {
            print_note(&format!("warning: --backend gpu: {why}; opening it again"));
            let again = open().map_err(|_| why)?;
            own.insert(step::StepDetector::new(again)).detect(model, contact)
        });
        if let Err(why) = &found {
            print_note(&format!("warning: --backend gpu: {why}; the processor goes on"));
            *own = None;
        }
        found.ok()
    }
}
