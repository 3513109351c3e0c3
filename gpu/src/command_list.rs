//! A list of dispatches, bound to their columns and uniforms and grouped into timed passes.

use std::ops::Range;

use crate::buffer::{DetectionError, buffer};
use crate::clock::{self, Clock};
use crate::device::Gpu;
use crate::params::Params;
use crate::schedule::Dispatch;
use crate::shaders::{self, SCAN};

/// Workgroups in a row of a dispatch: the most that every browser allows.
const ROW: usize = 65_535;

/// Bytes from the parameters of one dispatch to the next: the alignment that uniforms need.
const STRIDE: usize = 256;

/// Dispatches that are ready to be recorded.
#[derive(Debug, Default)]
pub struct CommandList {
    dispatches: Vec<Dispatch>,
    /// For each dispatch, the indices of its shader in the table and of its entry point in the shader.
    pipelines: Vec<[usize; 2]>,
    /// The name of each timed pass and the range of its dispatches.
    passes: Vec<(&'static str, Range<usize>)>,
    /// The parameters of all dispatches.
    uniforms: Option<wgpu::Buffer>,
    /// One bind group per shader: the parameters and its columns.
    groups: Vec<wgpu::BindGroup>,
    clock: Option<Clock>,
}

impl CommandList {
    /// Binds the columns, one buffer per slot. Fails if the table lacks the shader or the entry point of a dispatch.
    pub fn new(gpu: &Gpu, dispatches: Vec<Dispatch>, buffers: &[wgpu::Buffer]) -> Result<Self, DetectionError> {
        let pipelines = dispatches.iter().map(pipeline_of).collect::<Result<_, _>>()?;
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let uniforms = buffer(gpu, "uniforms", STRIDE * dispatches.len().max(1), usage)?;
        let groups = gpu.programs.iter().map(|program| program.bind(&gpu.device, &uniforms, buffers)).collect();
        let passes = passes(&dispatches);
        let clock = Clock::new(gpu, passes.len())?;
        let mut commands = Self { dispatches, pipelines, passes, uniforms: Some(uniforms), groups, clock };
        commands.write_uniforms(gpu, |_| ());
        Ok(commands)
    }

    /// Changes the parameters of all dispatches and writes them to the device.
    pub fn write_uniforms(&mut self, gpu: &Gpu, change: impl Fn(&mut Params)) {
        let mut bytes = vec![0; STRIDE * self.dispatches.len()];
        for (dispatch, bytes) in self.dispatches.iter_mut().zip(bytes.chunks_mut(STRIDE)) {
            change(&mut dispatch.params);
            bytes[..size_of::<Params>()].copy_from_slice(bytemuck::bytes_of(&dispatch.params));
        }
        if let Some(uniforms) = &self.uniforms {
            gpu.queue.write_buffer(uniforms, 0, &bytes);
        }
    }

    /// Records all dispatches.
    pub fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        for (number, (label, dispatches)) in self.passes.iter().enumerate() {
            let timestamp_writes = self.clock.as_ref().map(|clock| clock.around(number));
            let descriptor = wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            for at in dispatches.clone() {
                self.dispatch(gpu, at, &mut pass);
            }
        }
    }

    fn dispatch(&self, gpu: &Gpu, number: usize, pass: &mut wgpu::ComputePass<'_>) {
        let [shader, entry] = self.pipelines[number];
        pass.set_pipeline(&gpu.programs[shader].pipelines[entry]);
        pass.set_bind_group(0, &self.groups[shader], &[(STRIDE * number) as u32]);
        let groups = self.dispatches[number].groups.max(1);
        pass.dispatch_workgroups(groups.min(ROW) as u32, groups.div_ceil(ROW) as u32, 1);
    }

    /// Number of words of the timestamps of all passes.
    pub fn tick_words(&self) -> usize {
        self.clock.as_ref().map_or(0, |_| clock::WORDS * self.passes.len())
    }

    /// Copies the timestamps of all passes to a readback buffer.
    pub fn copy_ticks(&self, encoder: &mut wgpu::CommandEncoder, readback: &wgpu::Buffer, words: Range<usize>) {
        if let Some(clock) = &self.clock {
            clock.copy(encoder, readback, words);
        }
    }

    /// Adds the duration of each pass, in ticks, to the sum of its stage.
    pub fn add_ticks(&self, words: &[u32], stages: &mut Vec<(&'static str, u64)>) {
        for ((shader, _), words) in self.passes.iter().zip(words.as_chunks().0) {
            let ticks = clock::passed(words);
            match stages.iter_mut().find(|(known, _)| known == shader) {
                Some((_, sum)) => *sum += ticks,
                None => stages.push((shader, ticks)),
            }
        }
    }
}

fn pipeline_of(dispatch: &Dispatch) -> Result<[usize; 2], DetectionError> {
    let Dispatch { shader, entry, .. } = *dispatch;
    shaders::find(shader, entry).ok_or(DetectionError::Unknown { shader, entry })
}

/// Groups consecutive dispatches of one file into a pass. A scan joins the pass before it, which it serves.
fn passes(dispatches: &[Dispatch]) -> Vec<(&'static str, Range<usize>)> {
    let mut passes: Vec<(&'static str, Range<usize>)> = Vec::new();
    for (number, dispatch) in dispatches.iter().enumerate() {
        let file = dispatch.shader.split(',').next().unwrap_or_default();
        match passes.last_mut() {
            Some((last, own)) if *last == file || file == SCAN.name => own.end = number + 1,
            _ => passes.push((file, number..number + 1)),
        }
    }
    passes
}
