//! Choosing an adapter and opening it.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::{Error, Result};
use crate::gpu::fault::Faults;
use crate::gpu::kernel::Kernel;
use crate::stage::Stage;

/// An opened device and the kernels compiled for it. Clones share both.
#[derive(Clone, Debug)]
pub struct Gpu {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    device: wgpu::Device,
    queue: wgpu::Queue,
    faults: Faults,
    kernels: Mutex<HashMap<(&'static str, bool), Arc<Kernel>>>,
}

/// Storage buffers that a stage may bind.
const STORAGE_BUFFERS: u32 = 8;

const HELP: &str = "install a graphics driver with Vulkan, Metal or DX12 (on Linux: mesa-vulkan-drivers, or the \
                    proprietary driver with its Vulkan part), see what `rockfall devices` lists, or take --backend cpu";

fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

/// The graphics APIs to look at: all, or those that the environment variable `WGPU_BACKEND` names.
fn apis() -> wgpu::Backends {
    wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all())
}

/// Every adapter there is, software ones too, the one that [`Gpu::open`] would take first.
pub async fn adapters() -> Vec<wgpu::AdapterInfo> {
    let mut found: Vec<_> = instance().enumerate_adapters(apis()).await.iter().map(wgpu::Adapter::get_info).collect();
    found.sort_by_key(|info| Reverse(preference(info)));
    found
}

/// The greater, the better: hardware before software, a graphics card before what is built in, GL last.
fn preference(info: &wgpu::AdapterInfo) -> (u32, u32) {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 4,
        wgpu::DeviceType::IntegratedGpu => 3,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 1,
        wgpu::DeviceType::Cpu => 0,
    };
    (kind, u32::from(info.backend != wgpu::Backend::Gl))
}

fn is_able(adapter: &wgpu::Adapter) -> bool {
    let compute = wgpu::DownlevelFlags::COMPUTE_SHADERS;
    adapter.get_downlevel_capabilities().flags.contains(compute)
        && adapter.limits().max_storage_buffers_per_shader_stage >= STORAGE_BUFFERS
}

impl Gpu {
    /// Opens the best adapter: hardware, high-performance. A software adapter (a CPU that plays GPU) is taken only where
    /// `allow_software` is set and there is no hardware.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] when there is none, [`Error::Device`] when it cannot be opened.
    pub async fn open(allow_software: bool) -> Result<Self> {
        let mut candidates = instance().enumerate_adapters(apis()).await;
        let seen = candidates.len();
        candidates
            .retain(|adapter| is_able(adapter) && (allow_software || adapter.get_info().device_type != wgpu::DeviceType::Cpu));
        candidates.sort_by_key(|adapter| Reverse(preference(&adapter.get_info())));
        if candidates.is_empty() {
            return Err(Error::NoAdapter(format!("none of the {seen} adapters found is usable; {HELP}")));
        }
        let mut refused = String::new();
        for adapter in candidates {
            match Self::open_adapter(&adapter).await {
                Ok(gpu) => return Ok(gpu),
                Err(error) => refused = format!("{}: {error}", adapter.get_info().name),
            }
        }
        Err(Error::Device(refused))
    }

    async fn open_adapter(adapter: &wgpu::Adapter) -> Result<Self, wgpu::RequestDeviceError> {
        let timing = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("rockfall"),
                required_features: adapter.features() & timing,
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await?;
        let faults = Faults::default();
        faults.watch(&device);
        Ok(Self::with(device, queue, faults))
    }

    /// [`Gpu::open`] for native callers.
    ///
    /// # Errors
    /// Those of [`Gpu::open`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open_blocking(allow_software: bool) -> Result<Self> {
        crate::gpu::wait::drive(Self::open(allow_software), || {
            std::thread::yield_now();
            Ok(())
        })?
    }

    /// [`adapters`] for native callers.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn adapters_blocking() -> Vec<wgpu::AdapterInfo> {
        crate::gpu::wait::drive(adapters(), || {
            std::thread::yield_now();
            Ok(())
        })
        .unwrap_or_default()
    }

    /// Uses the caller's device. Its error handlers are left alone: what goes wrong in a call of this module comes back
    /// from that call or from the next that waits.
    pub fn on_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self::with(device, queue, Faults::default())
    }

    fn with(device: wgpu::Device, queue: wgpu::Queue, faults: Faults) -> Self {
        Self { inner: Arc::new(Inner { device, queue, faults, kernels: Mutex::default() }) }
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.inner.device
    }

    /// The device's queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.inner.queue
    }

    /// Name, backend, kind and driver.
    pub fn info(&self) -> wgpu::AdapterInfo {
        self.inner.device.adapter_info()
    }

    pub(crate) fn faults(&self) -> &Faults {
        &self.inner.faults
    }

    /// The kernel of a stage, compiled at its first use, for scenes with or without rods.
    pub(crate) fn kernel(&self, stage: &'static Stage, rods: bool) -> Result<Arc<Kernel>> {
        let mut kernels = self.inner.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kernel) = kernels.get(&(stage.name, rods)) {
            return Ok(Arc::clone(kernel));
        }
        let kernel = Arc::new(Kernel::new(self.device(), stage, rods)?);
        kernels.insert((stage.name, rods), Arc::clone(&kernel));
        Ok(kernel)
    }
}
