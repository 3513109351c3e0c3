//! Muslin's detection in WGSL: the stages of `muslin_core::broad_phase` and `narrow_phase`, each in a
//! file of the same stem, run through wgpu on any adapter.
//!
//! [`shaders`] is the table of them, [`slots`] that of the columns they commands on, [`schedule`] the order
//! in which they run, [`detector`] what a host holds: boxes and positions go up, candidates with
//! their distances come back, the same as the core's.
#![forbid(unsafe_code)]

mod buffer;
mod clock;
mod command_list;
pub mod detector;
pub mod device;
pub mod params;
mod program;
mod readback;
pub mod schedule;
pub mod shaders;
pub mod single_stage;
pub mod slots;
pub mod step;

pub use buffer::DetectionError;
pub use detector::Detector;
pub use device::Gpu;
pub use readback::{DetectionQuery, DetectionResult};
pub use wgpu;
