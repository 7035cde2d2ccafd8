//! Choosing an adapter and opening it.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::{Error, Result};
use crate::exec::gpu::fault::Faults;
use crate::exec::gpu::kernel::Kernel;
use crate::model::layout::WORKGROUP;
use crate::step::stage::Stage;
use crate::step::wgsl::Variant;

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
    kernels: Mutex<HashMap<KernelKey, Arc<Kernel>>>,
}

/// Stage, whether there are rods, chunks of each array.
type KernelKey = (&'static str, Variant, Vec<u32>);

/// A limit of a device by its name in WebGPU.
type Limit = (&'static str, fn(&wgpu::Limits) -> u32);

/// What the kernels need, which is what WebGPU promises or less.
const NEEDED: [(Limit, u32); 3] = [
    (("max_storage_buffers_per_shader_stage", |limits| limits.max_storage_buffers_per_shader_stage), 8),
    (("max_compute_invocations_per_workgroup", |limits| limits.max_compute_invocations_per_workgroup), WORKGROUP),
    (("max_compute_workgroup_size_x", |limits| limits.max_compute_workgroup_size_x), WORKGROUP),
];

const HELP: &str = "install a graphics driver with Vulkan, Metal or DX12 (on Linux: mesa-vulkan-drivers, or the \
                    proprietary driver with its Vulkan part), see what `rockfall devices` lists, or take --backend cpu";

/// What adapters are asked for from, as the environment variables of wgpu wish.
pub fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    // Debug builds would name every object, which the Vulkan loader now and then does not survive while another thread closes a
    // device: it walks its list of devices without a lock (issue 5270 of wgpu). WGPU_DEBUG=1 asks for names all the same.
    descriptor.flags.remove(wgpu::InstanceFlags::DEBUG);
    wgpu::Instance::new(descriptor.with_env())
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

/// The first limit that is too low for the kernels.
fn lacks(limits: &wgpu::Limits) -> Option<String> {
    let low = NEEDED.into_iter().find(|((_, limit), needed)| limit(limits) < *needed);
    low.map(|((name, limit), needed)| format!("{name} is {}, rockfall needs {needed}", limit(limits)))
}

/// Why an adapter cannot be used.
fn unable(adapter: &wgpu::Adapter, allow_software: bool) -> Option<String> {
    let info = adapter.get_info();
    let computes = adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS);
    let why = if !computes {
        Some("it has no compute shaders".to_owned())
    } else if !allow_software && info.device_type == wgpu::DeviceType::Cpu {
        Some("it is software".to_owned())
    } else {
        lacks(&adapter.limits())
    };
    why.map(|why| format!("{} ({}): {why}", info.name, info.backend))
}

impl Gpu {
    /// Opens the best adapter: hardware, high-performance. A software adapter (a CPU that plays GPU) is taken only where
    /// `allow_software` is set and there is no hardware.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] when there is none, [`Error::Device`] when it cannot be opened.
    pub async fn open(allow_software: bool) -> Result<Self> {
        let mut candidates = instance().enumerate_adapters(apis()).await;
        let mut reasons = Vec::new();
        candidates.retain(|adapter| {
            let reason = unable(adapter, allow_software);
            reasons.extend(reason.clone());
            reason.is_none()
        });
        candidates.sort_by_key(|adapter| Reverse(preference(&adapter.get_info())));
        if candidates.is_empty() {
            let found = if reasons.is_empty() { "no adapter was found".to_owned() } else { reasons.join("; ") };
            return Err(Error::NoAdapter(format!("{found}; {HELP}")));
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
        crate::exec::gpu::wait::drive(Self::open(allow_software), || {
            std::thread::yield_now();
            Ok(())
        })?
    }

    /// [`adapters`] for native callers.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn adapters_blocking() -> Vec<wgpu::AdapterInfo> {
        crate::exec::gpu::wait::drive(adapters(), || {
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

    /// Whether it is a CPU that plays GPU.
    pub fn is_software(&self) -> bool {
        self.info().device_type == wgpu::DeviceType::Cpu
    }

    /// # Errors
    /// [`Error::Device`] when the device, which may be the caller's, was opened with limits that are too low.
    pub(crate) fn check_limits(&self) -> Result<()> {
        match lacks(&self.device().limits()) {
            None => Ok(()),
            Some(low) => Err(Error::Device(format!(
                "the device does not do: {low}; open it with `wgpu::Limits::default()` or the adapter's own, or take the CPU \
                 backend"
            ))),
        }
    }

    pub(crate) fn faults(&self) -> &Faults {
        &self.inner.faults
    }

    /// How many kernels were compiled so far.
    #[cfg(test)]
    pub(crate) fn compiled(&self) -> usize {
        self.inner.kernels.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// The kernel of a stage, compiled at its first use, for such scenes, and for arrays of so many chunks.
    pub(crate) fn kernel(&self, stage: &'static Stage, variant: Variant, chunks: Vec<u32>) -> Result<Arc<Kernel>> {
        let mut kernels = self.inner.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (stage.name, variant, chunks);
        if let Some(kernel) = kernels.get(&key) {
            return Ok(Arc::clone(kernel));
        }
        let kernel = Arc::new(Kernel::new(self.device(), stage, variant, &key.2)?);
        kernels.insert(key, Arc::clone(&kernel));
        Ok(kernel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_that_are_too_low_are_named() {
        assert_eq!(lacks(&wgpu::Limits::default()), None);
        let limits = wgpu::Limits { max_storage_buffers_per_shader_stage: 4, ..Default::default() };
        let told = lacks(&limits).unwrap();
        assert_eq!(told, "max_storage_buffers_per_shader_stage is 4, rockfall needs 8");
        let limits = wgpu::Limits { max_compute_workgroup_size_x: 0, ..Default::default() };
        assert!(lacks(&limits).is_some());
    }
}
