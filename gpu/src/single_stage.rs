//! Runs single stages on columns that the caller provides, so that tests can compare each stage with the core.

use std::collections::HashMap;

use crate::buffer::{DetectionError, buffer, column, mapped};
use crate::command_list::CommandList;
use crate::device::Gpu;
use crate::schedule::Dispatch;
use crate::slots::Slot;

/// Columns by slot, in words of four bytes.
pub type Columns = HashMap<Slot, Vec<u32>>;

/// Runs dispatches in order on the given columns and reads these back. All other columns are empty.
pub async fn run(gpu: &Gpu, dispatches: Vec<Dispatch>, columns: &mut Columns) -> Result<(), DetectionError> {
    let words = |slot: &Slot| columns.get(slot).map_or(0, Vec::len);
    let buffers = Slot::ALL.iter().map(|slot| column(gpu, *slot, words(slot))).collect::<Result<Vec<_>, _>>()?;
    let all: usize = Slot::ALL.iter().map(words).sum();
    for (slot, words) in columns.iter().filter(|(_, words)| !words.is_empty()) {
        gpu.queue.write_buffer(&buffers[*slot as usize], 0, bytemuck::cast_slice(words));
    }
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    CommandList::new(gpu, dispatches, &buffers)?.record(gpu, &mut encoder);
    let readback = buffer(gpu, "readback", 4 * all, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST)?;
    let mut at = 0;
    for slot in columns.keys() {
        let bytes = 4 * columns[slot].len() as u64;
        if bytes > 0 {
            encoder.copy_buffer_to_buffer(&buffers[*slot as usize], 0, &readback, at, Some(bytes));
        }
        at += bytes;
    }
    gpu.queue.submit([encoder.finish()]);
    mapped(gpu, &readback, readback.size()).await?;
    let view = readback.slice(..).get_mapped_range().map_err(|error| DetectionError::Lost(error.to_string()))?;
    let mut rest: &[u32] = bytemuck::cast_slice(&view);
    for words in columns.values_mut() {
        let (own, others) = rest.split_at(words.len());
        words.copy_from_slice(own);
        rest = others;
    }
    Ok(())
}
