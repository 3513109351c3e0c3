//! Muslin's collision detection in WGSL: the stages of `muslin_core::broad_phase` and `narrow_phase`, each in
//! a file of the same name, run through wgpu on any adapter.
//!
//! [`shaders`] lists the stages, [`slots`] the columns that they read and write, [`schedule`] the order in
//! which they run. A host uses [`detector`]: it uploads boxes and positions, and reads back candidates and, with the
//! feature `narrow-phase`, their distances and times of impact. The candidates are exactly those of the core; distances
//! agree to rounding.
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
