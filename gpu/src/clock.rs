//! Timestamps of a device: one at the start and one at the end of each pass.

use std::ops::Range;

use wgpu::{BufferUsages, CommandEncoder, ComputePassTimestampWrites, QuerySetDescriptor, QueryType};

use crate::buffer::{DetectionError, buffer};
use crate::device::Gpu;

/// Most passes that one query set has room for on any device.
const MOST_PASSES: usize = wgpu::QUERY_SET_MAX_QUERIES as usize / 2;

/// Words per pass: two timestamps of eight bytes.
pub const WORDS: usize = 4;

/// The timestamp queries of all passes.
#[derive(Debug)]
pub struct Clock {
    queries: wgpu::QuerySet,
    ticks: wgpu::Buffer,
}

impl Clock {
    /// A clock for `passes` passes; `None` if the device has no timestamps or one query set is too small.
    pub fn new(gpu: &Gpu, passes: usize) -> Result<Option<Self>, DetectionError> {
        if gpu.tick.is_none() || passes > MOST_PASSES {
            return Ok(None);
        }
        let count = 2 * passes.max(1) as u32;
        let described = QuerySetDescriptor { label: Some("clock"), ty: QueryType::Timestamp, count };
        let queries = gpu.device.create_query_set(&described);
        let ticks = buffer(gpu, "ticks", 4 * WORDS * passes, BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC)?;
        Ok(Some(Self { queries, ticks }))
    }

    /// The timestamps that a pass writes.
    pub fn around(&self, pass: usize) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * pass as u32),
            end_of_pass_write_index: Some(2 * pass as u32 + 1),
        }
    }

    /// Copies the timestamps of all passes to a range of words of a readback buffer.
    pub fn copy(&self, encoder: &mut CommandEncoder, readback: &wgpu::Buffer, words: Range<usize>) {
        if !words.is_empty() {
            encoder.resolve_query_set(&self.queries, 0..(words.len() / 2) as u32, &self.ticks, 0);
            encoder.copy_buffer_to_buffer(
                &self.ticks,
                0,
                readback,
                4 * words.start as u64,
                Some(4 * words.len() as u64),
            );
        }
    }
}

/// Ticks from the start to the end of a pass.
pub fn passed(words: &[u32; WORDS]) -> u64 {
    let [start, end] = [0, 2].map(|k| u64::from(words[k]) | u64::from(words[k + 1]) << 32);
    end.saturating_sub(start)
}
