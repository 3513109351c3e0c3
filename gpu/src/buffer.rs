//! Buffers on a device, and the wait until one can be read.

use futures_channel::oneshot;

use crate::device::Gpu;
use crate::slots::Slot;

/// Why a detection failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DetectionError {
    /// The device is lost, or its driver reported an error.
    Lost(String),
    /// One buffer would need this many bytes, more than the device allows.
    TooLarge(u64),
    /// The number of boxes or positions is not the number of vertices of the surface.
    Lengths {
        /// Number of vertices of the surface.
        needed: usize,
    },
    /// The shader does not exist, or it does not have the entry point.
    Unknown {
        /// Name of the shader.
        shader: &'static str,
        /// Name of the entry point.
        entry: &'static str,
    },
}

impl core::fmt::Display for DetectionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Lost(why) => write!(f, "the device failed: {why}"),
            Self::TooLarge(bytes) => {
                write!(
                    f,
                    "{} MiB or more are needed in one buffer, more than the device allows",
                    bytes.div_ceil(1 << 20)
                )
            }
            Self::Lengths { needed } => write!(f, "boxes and positions must have {needed} entries, one per vertex"),
            Self::Unknown { shader, entry } => write!(f, "there is no shader {shader} with an entry {entry}"),
        }
    }
}

impl core::error::Error for DetectionError {}

/// Size of the smallest buffer, bytes.
const LEAST: usize = 16;

/// Size of a column of `words` four-byte words, bytes.
pub fn bytes_of(words: usize) -> u64 {
    (4 * words).max(LEAST) as u64
}

/// A buffer of at least `bytes` bytes. Fails if the device does not allow this size.
pub fn buffer(gpu: &Gpu, label: &str, bytes: usize, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer, DetectionError> {
    let size = bytes.max(LEAST) as u64;
    let is_bound = usage.intersects(wgpu::BufferUsages::STORAGE);
    if size > if is_bound { gpu.largest_buffer } else { gpu.largest_readback } {
        return Err(DetectionError::TooLarge(size));
    }
    Ok(gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false }))
}

/// A storage buffer for a column of `words` four-byte words.
pub fn column(gpu: &Gpu, slot: Slot, words: usize) -> Result<wgpu::Buffer, DetectionError> {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    buffer(gpu, &format!("{slot:?}"), 4 * words, usage)
}

/// Waits until the first `bytes` bytes of a readback buffer are mapped. On a native device this blocks.
pub async fn mapped(gpu: &Gpu, readback: &wgpu::Buffer, bytes: u64) -> Result<(), DetectionError> {
    let (sender, receiver) = oneshot::channel();
    readback.slice(..bytes).map_async(wgpu::MapMode::Read, move |mapped| {
        // The caller may have dropped its end of the channel.
        let _ = sender.send(mapped);
    });
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| DetectionError::Lost(error.to_string()))?;
    let mapped = receiver.await;
    if let Some(error) = gpu.error() {
        return Err(DetectionError::Lost(error));
    }
    match mapped {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(DetectionError::Lost(error.to_string())),
        Err(_) => Err(DetectionError::Lost("the device answers no more".into())),
    }
}
