//! A device: an adapter opened with the requested limits.

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
    /// Name of the adapter, from the driver.
    pub name: String,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// All stages, compiled once for all surfaces.
    pub(crate) programs: Vec<Program>,
    /// Size of the largest buffer that a stage can bind, bytes.
    pub(crate) largest_buffer: u64,
    /// Size of the largest buffer that no stage binds, bytes.
    pub(crate) largest_readback: u64,
    /// Length of a tick of its timestamps, ms; `None` if it has no timestamps.
    pub(crate) tick: Option<f64>,
    /// The requested limits.
    ask: Ask,
    /// The last error of the driver.
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

/// Limits to request from an adapter. Timestamps are requested in both cases, if the adapter has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// The default limits, which every browser provides; for tests.
    Web,
    /// The limits of the adapter.
    Most,
}

fn instance(ask: Ask) -> Instance {
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    if ask == Ask::Web {
        descriptor.flags = InstanceFlags::STRICT_WEBGPU_COMPLIANCE;
    }
    Instance::new(descriptor)
}

/// All adapters of this machine.
pub async fn adapters() -> Vec<Adapter> {
    instance(Ask::Most).enumerate_adapters(Backends::all()).await
}

impl Gpu {
    /// Opens the adapter with the highest performance and compiles all stages.
    pub async fn open(ask: Ask) -> Result<Self, NoDevice> {
        let options =
            RequestAdapterOptions { power_preference: PowerPreference::HighPerformance, ..Default::default() };
        let adapter =
            // The message of wgpu only lists the backends that it was built without.
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
        let programs = shaders::ALL.iter().map(|shader| Program::compile(&device, shader)).collect();
        let name = adapter.get_info().name;
        Ok(Self { name, device, queue, programs, largest_buffer, largest_readback, tick, ask, refused })
    }

    /// Opens the device again with the same limits, after this one was lost.
    pub async fn reopen(&self) -> Result<Self, NoDevice> {
        Self::open(self.ask).await
    }

    /// Destroys the device. Later calls fail as if it were lost.
    pub fn close(&self) {
        self.device.destroy();
    }

    /// The last error of the driver since the previous call.
    pub(crate) fn error(&self) -> Option<String> {
        self.refused.lock().ok()?.take()
    }
}
