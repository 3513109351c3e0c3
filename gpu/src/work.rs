//! Dispatches in a row, bound to columns and told what they need.

use crate::buffer::{Failed, buffer};
use crate::device::Gpu;
use crate::params::Params;
use crate::schedule::Dispatch;

/// Groups in a row of a dispatch, the most that the web allows.
const ROW: usize = 65_535;

/// Bytes from one dispatch's params to the next: what uniforms must be aligned to.
const STRIDE: usize = 256;

/// What is to be run.
#[derive(Debug, Default)]
pub struct Work {
    dispatches: Vec<Dispatch>,
    /// The params of all dispatches.
    told: Option<wgpu::Buffer>,
    /// The columns of every stage.
    groups: Vec<wgpu::BindGroup>,
}

impl Work {
    /// Binds columns, one buffer a slot.
    pub fn new(gpu: &Gpu, dispatches: Vec<Dispatch>, buffers: &[wgpu::Buffer]) -> Result<Self, Failed> {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let told = buffer(gpu, "told", STRIDE * dispatches.len().max(1), usage)?;
        let groups = gpu.programs.iter().map(|program| program.bind(&gpu.device, &told, buffers)).collect();
        let mut work = Self { dispatches, told: Some(told), groups };
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
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        for (number, dispatch) in self.dispatches.iter().enumerate() {
            let at = gpu.programs.iter().position(|program| program.stage.name == dispatch.stage).unwrap_or(0);
            pass.set_pipeline(gpu.programs[at].entry(dispatch.entry));
            pass.set_bind_group(0, &self.groups[at], &[(STRIDE * number) as u32]);
            let groups = dispatch.groups.max(1);
            pass.dispatch_workgroups(groups.min(ROW) as u32, groups.div_ceil(ROW) as u32, 1);
        }
    }
}
