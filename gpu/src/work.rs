//! Dispatches in a row, bound to columns and told what they need, in passes that are timed.

use std::ops::Range;

use crate::buffer::{Failed, buffer};
use crate::clock::{self, Clock};
use crate::device::Gpu;
use crate::params::Params;
use crate::schedule::Dispatch;
use crate::stages::{self, SCAN};

/// Groups in a row of a dispatch, the most that the web allows.
const ROW: usize = 65_535;

/// Bytes from one dispatch's params to the next: what uniforms must be aligned to.
const STRIDE: usize = 256;

/// What is to be run.
#[derive(Debug, Default)]
pub struct Work {
    dispatches: Vec<Dispatch>,
    /// Stage and entry of each, as places in the table.
    places: Vec<[usize; 2]>,
    /// Dispatches that are timed together, and what they are called.
    passes: Vec<(&'static str, Range<usize>)>,
    /// The params of all dispatches.
    told: Option<wgpu::Buffer>,
    /// The columns of every stage.
    groups: Vec<wgpu::BindGroup>,
    clock: Option<Clock>,
}

impl Work {
    /// Binds columns, one buffer a slot. Fails where a dispatch is of no stage or entry of the table.
    pub fn new(gpu: &Gpu, dispatches: Vec<Dispatch>, buffers: &[wgpu::Buffer]) -> Result<Self, Failed> {
        let places = dispatches.iter().map(place).collect::<Result<_, _>>()?;
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let told = buffer(gpu, "told", STRIDE * dispatches.len().max(1), usage)?;
        let groups = gpu.programs.iter().map(|program| program.bind(&gpu.device, &told, buffers)).collect();
        let passes = passes(&dispatches);
        let clock = Clock::new(gpu, passes.len())?;
        let mut work = Self { dispatches, places, passes, told: Some(told), groups, clock };
        work.tell(gpu, |_| ());
        Ok(work)
    }

    /// Changes what all dispatches are told.
    pub fn tell(&mut self, gpu: &Gpu, change: impl Fn(&mut Params)) {
        let mut bytes = vec![0; STRIDE * self.dispatches.len()];
        for (dispatch, bytes) in self.dispatches.iter_mut().zip(bytes.chunks_mut(STRIDE)) {
            change(&mut dispatch.params);
            bytes[..size_of::<Params>()].copy_from_slice(bytemuck::bytes_of(&dispatch.params));
        }
        if let Some(told) = &self.told {
            gpu.queue.write_buffer(told, 0, &bytes);
        }
    }

    /// Adds all dispatches to what is to be handed in.
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
        let [stage, entry] = self.places[number];
        pass.set_pipeline(&gpu.programs[stage].pipelines[entry]);
        pass.set_bind_group(0, &self.groups[stage], &[(STRIDE * number) as u32]);
        let groups = self.dispatches[number].groups.max(1);
        pass.dispatch_workgroups(groups.min(ROW) as u32, groups.div_ceil(ROW) as u32, 1);
    }

    /// Words that the ticks of all passes take.
    pub fn tick_words(&self) -> usize {
        self.clock.as_ref().map_or(0, |_| clock::WORDS * self.passes.len())
    }

    /// Copies the ticks of all passes to an answer.
    pub fn copy_ticks(&self, encoder: &mut wgpu::CommandEncoder, answer: &wgpu::Buffer, words: Range<usize>) {
        if let Some(clock) = &self.clock {
            clock.copy(encoder, answer, words);
        }
    }

    /// Adds the ticks of all passes to those of their stages.
    pub fn add_ticks(&self, words: &[u32], stages: &mut Vec<(&'static str, u64)>) {
        for ((stage, _), words) in self.passes.iter().zip(words.as_chunks().0) {
            let ticks = clock::passed(words);
            match stages.iter_mut().find(|(known, _)| known == stage) {
                Some((_, sum)) => *sum += ticks,
                None => stages.push((stage, ticks)),
            }
        }
    }
}

fn place(dispatch: &Dispatch) -> Result<[usize; 2], Failed> {
    let Dispatch { stage, entry, .. } = *dispatch;
    stages::find(stage, entry).ok_or(Failed::Unknown { stage, entry })
}

/// Neighbours of one file; a scan counts to what it is made for.
fn passes(dispatches: &[Dispatch]) -> Vec<(&'static str, Range<usize>)> {
    let mut passes: Vec<(&'static str, Range<usize>)> = Vec::new();
    for (number, dispatch) in dispatches.iter().enumerate() {
        let file = dispatch.stage.split(',').next().unwrap_or_default();
        match passes.last_mut() {
            Some((last, own)) if *last == file || file == SCAN.name => own.end = number + 1,
            _ => passes.push((file, number..number + 1)),
        }
    }
    passes
}
