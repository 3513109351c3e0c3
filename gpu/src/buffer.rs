//! Buffers on a device, and what comes back from one.

use crate::device::Gpu;
use crate::slots::Slot;

/// The device was lost, or failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lost(pub String);

/// A buffer of at least so many bytes.
pub fn buffer(gpu: &Gpu, label: &str, bytes: usize, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let size = bytes.max(16) as u64;
    gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}

/// A column of words of four bytes.
pub fn column(gpu: &Gpu, slot: Slot, words: usize) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    buffer(gpu, &format!("{slot:?}"), 4 * words, usage)
}

/// Blocks until an answer is there.
pub fn wait(gpu: &Gpu, answer: &wgpu::Buffer) -> Result<(), Lost> {
    let (sender, receiver) = std::sync::mpsc::channel();
    answer.slice(..).map_async(wgpu::MapMode::Read, move |mapped| {
        let _ = sender.send(mapped);
    });
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| Lost(error.to_string()))?;
    match receiver.recv() {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(Lost(error.to_string())),
        Err(_) => Err(Lost("the device answers no more".into())),
    }
}
