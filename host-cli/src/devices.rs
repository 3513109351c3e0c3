//! `muslin devices`: lists the processor and the graphics adapters.

use serde::Serialize;

use crate::args::DevicesArguments;
use crate::bench::cpu_name;
use crate::device::INSTALL;
use crate::failure::{Failure, print_data, print_json};

#[derive(Serialize)]
struct Devices {
    cpu: String,
    threads: usize,
    adapters: Vec<Adapter>,
}

/// A graphics adapter, with the limits that decide which scenes fit on it.
#[derive(Serialize)]
struct Adapter {
    name: String,
    backend: String,
    kind: String,
    driver: String,
    largest_buffer_bytes: u64,
    storage_buffers_per_stage: u32,
    workgroup_bytes: u32,
    workgroup_invocations: u32,
    timestamps: bool,
}

/// Prints the processor and all adapters.
pub fn print(arguments: &DevicesArguments) -> Result<(), Failure> {
    let adapters = pollster::block_on(muslin_gpu::device::adapters());
    let threads = std::thread::available_parallelism().map_or(1, Into::into);
    let devices = Devices { cpu: cpu_name(), threads, adapters: adapters.iter().map(describe).collect() };
    match arguments.json {
        true => print_json(&devices),
        false => print_data(&devices.lines()),
    }
}

fn describe(adapter: &muslin_gpu::wgpu::Adapter) -> Adapter {
    let (info, limits) = (adapter.get_info(), adapter.limits());
    Adapter {
        name: info.name,
        backend: info.backend.to_string(),
        kind: format!("{:?}", info.device_type),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        largest_buffer_bytes: limits.max_buffer_size.min(limits.max_storage_buffer_binding_size),
        storage_buffers_per_stage: limits.max_storage_buffers_per_shader_stage,
        workgroup_bytes: limits.max_compute_workgroup_storage_size,
        workgroup_invocations: limits.max_compute_invocations_per_workgroup,
        timestamps: adapter.features().contains(muslin_gpu::wgpu::Features::TIMESTAMP_QUERY),
    }
}

impl Devices {
    fn lines(&self) -> String {
        let mut lines = vec![format!("cpu  {}, {} threads", self.cpu, self.threads)];
        if self.adapters.is_empty() {
            lines.push(format!("no graphics adapter: {INSTALL}"));
        }
        for a in &self.adapters {
            lines.push(format!("gpu  {} ({}, {}; {})", a.name, a.kind, a.backend, a.driver));
            lines.push(format!(
                "     buffers of {} MiB, {} per shader; workgroups of {}, with {} KiB; {} timestamps",
                a.largest_buffer_bytes >> 20,
                a.storage_buffers_per_stage,
                a.workgroup_invocations,
                a.workgroup_bytes >> 10,
                if a.timestamps { "has" } else { "no" }
            ));
        }
        lines.join("\n")
    }
}
