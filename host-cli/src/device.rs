//! The graphics processor, for what can use it.

use muslin_gpu::device::Ask;
use muslin_gpu::{Failed, Gpu};

use crate::failure::Failure;

/// What to do without one.
pub const INSTALL: &str = "install the driver of your graphics card, or a software one (Debian and Ubuntu: apt-get install \
     mesa-vulkan-drivers), or say --backend cpu";

/// The fastest adapter.
pub fn open() -> Result<Gpu, Failure> {
    pollster::block_on(Gpu::open(Ask::Most))
        .map_err(|why| Failure::NoDevice(format!("--backend gpu: {why}; {INSTALL}")))
}

/// What a device says, as a failure of the command.
pub fn failed(why: Failed) -> Failure {
    Failure::NoDevice(format!("--backend gpu: {why}; say --backend cpu"))
}
