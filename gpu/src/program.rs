//! A shader on a device: one pipeline per entry point, and the binding of its columns.

use crate::params::Params;
use crate::shaders::Shader;

/// A compiled shader.
#[derive(Debug)]
pub struct Program {
    /// Its source, entry points and columns.
    pub shader: &'static Shader,
    layout: wgpu::BindGroupLayout,
    /// One pipeline per entry point, in the order of `shader.entries`.
    pub pipelines: Vec<wgpu::ComputePipeline>,
}

impl Program {
    /// Compiles all entry points.
    pub fn compile(device: &wgpu::Device, shader: &'static Shader) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(shader.name),
            source: wgpu::ShaderSource::Wgsl(shader.source().into()),
        });
        let entry = |binding: usize, ty| wgpu::BindGroupLayoutEntry {
            binding: binding as u32,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: binding == 0, min_binding_size: None },
            count: None,
        };
        let columns = shader
            .bindings
            .iter()
            .enumerate()
            .map(|(k, &(_, writes))| entry(k + 1, wgpu::BufferBindingType::Storage { read_only: !writes }));
        let entries: Vec<_> = core::iter::once(entry(0, wgpu::BufferBindingType::Uniform)).chain(columns).collect();
        let layout = device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(shader.name), entries: &entries });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(shader.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |entry: &&str| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        let pipelines = shader.entries.iter().map(pipeline).collect();
        Self { shader, layout, pipelines }
    }

    /// A bind group of the parameters and of the shader's columns, which are taken from `buffers`.
    pub fn bind(&self, device: &wgpu::Device, uniforms: &wgpu::Buffer, buffers: &[wgpu::Buffer]) -> wgpu::BindGroup {
        let params = wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: uniforms,
                offset: 0,
                size: core::num::NonZeroU64::new(size_of::<Params>() as u64),
            }),
        };
        let columns = self.shader.bindings.iter().enumerate().map(|(k, &(slot, _))| wgpu::BindGroupEntry {
            binding: k as u32 + 1,
            resource: buffers[slot as usize].as_entire_binding(),
        });
        let entries: Vec<_> = core::iter::once(params).chain(columns).collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.shader.name),
            layout: &self.layout,
            entries: &entries,
        })
    }
}
