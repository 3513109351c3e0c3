//! An adapter and what is asked of it.

use std::sync::{Arc, Mutex};

use wgpu::{
    Adapter, Backends, DeviceDescriptor, Features, Instance, InstanceDescriptor, InstanceFlags, Limits,
    PowerPreference, RequestAdapterOptions,
};

use crate::program::Program;
use crate::shaders;

/// A device that stages run on.
#[derive(Debug)]
pub struct Gpu {
    /// As the driver calls it.
    pub name: String,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// All stages, compiled once for all surfaces.
    pub(crate) programs: Vec<Program>,
    /// Bytes.
    pub(crate) largest_buffer: u64,
    /// Bytes, of what no stage works on.
    pub(crate) largest_readback: u64,
    /// ms from one tick of its clock to the next, where it has one.
    pub(crate) tick: Option<f64>,
    /// What was asked for.
    ask: Ask,
    /// What the driver refused last.
    refused: Arc<Mutex<Option<String>>>,
}

/// Why there is no device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoDevice(pub String);

impl core::fmt::Display for NoDevice {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}", self.0)
    }
}

impl core::error::Error for NoDevice {}

/// What may be asked of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// What every browser has, and clocks where there are any: to test with.
    Web,
    /// As much as the adapter gives.
    Most,
}

fn instance(ask: Ask) -> Instance {
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    if ask == Ask::Web {
        descriptor.flags = InstanceFlags::STRICT_WEBGPU_COMPLIANCE;
    }
    Instance::new(descriptor)
}

/// All adapters that there are.
pub async fn adapters() -> Vec<Adapter> {
    instance(Ask::Most).enumerate_adapters(Backends::all()).await
}

impl Gpu {
    /// The fastest adapter, opened, with all stages compiled.
    pub async fn open(ask: Ask) -> Result<Self, NoDevice> {
        let options =
            RequestAdapterOptions { power_preference: PowerPreference::HighPerformance, ..Default::default() };
        let adapter =
            // What wgpu says is a list of all that it was not built for.
            instance(ask).request_adapter(&options).await.map_err(|_| NoDevice("no adapter was found".into()))?;
        let required_limits = match ask {
            Ask::Web => Limits::defaults(),
            Ask::Most => adapter.limits(),
        };
        let required_features = adapter.features() & Features::TIMESTAMP_QUERY;
        let descriptor = DeviceDescriptor { required_limits, required_features, ..Default::default() };
        let opened = adapter.request_device(&descriptor).await;
        let (device, queue) = opened.map_err(|error| NoDevice(format!("no device: {error}")))?;
        let refused = Arc::new(Mutex::new(None));
        let keep = Arc::clone(&refused);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut kept) = keep.lock() {
                *kept = Some(error.to_string());
            }
        }));
        let has_clock = device.features().contains(Features::TIMESTAMP_QUERY);
        let tick = has_clock.then(|| 1e-6 * f64::from(queue.get_timestamp_period()));
        let limits = device.limits();
        let largest_readback = limits.max_buffer_size;
        let largest_buffer = largest_readback.min(limits.max_storage_buffer_binding_size);
        let programs = shaders::ALL.into_iter().map(|stage| Program::compile(&device, stage)).collect();
        let name = adapter.get_info().name;
        Ok(Self { name, device, queue, programs, largest_buffer, largest_readback, tick, ask, refused })
    }

    /// The same anew, where this one is lost.
    pub async fn reopen(&self) -> Result<Self, NoDevice> {
        Self::open(self.ask).await
    }

    /// Gives the device up: what is asked of it then fails, as where it is lost.
    pub fn close(&self) {
        self.device.destroy();
    }

    /// What the driver refused since it was last asked.
    pub(crate) fn error(&self) -> Option<String> {
        self.refused.lock().ok()?.take()
    }
}
