//! Muslin's detection in WGSL: the stages of `muslin_core::broad_phase` and `narrow_phase`, each in a
//! file of the same stem, run through wgpu on any adapter.
//!
//! [`stages`] is the table of them, [`slots`] that of the columns they work on, [`schedule`] the order
//! in which they run, [`detector`] what a host holds: boxes and positions go up, candidates with
//! their distances come back, the same as the core's.
#![forbid(unsafe_code)]

pub mod alone;
mod answer;
mod buffer;
mod clock;
pub mod detector;
pub mod device;
pub mod params;
mod program;
pub mod schedule;
pub mod slots;
pub mod stages;
pub mod step;
mod work;

pub use answer::{Found, Wanted};
pub use buffer::Failed;
pub use detector::Detector;
pub use device::Gpu;
pub use wgpu;
