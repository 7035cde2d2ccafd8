//! Chooses an adapter and opens it.

use std::cmp::Reverse;
use std::collections::HashMap;
#[cfg(not(target_family = "wasm"))]
use std::sync::OnceLock;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::error::{Error, Result};
use crate::exec::gpu::copiers::Copiers;
use crate::exec::gpu::fault::{Faults, catch};
use crate::exec::gpu::kernel::Kernel;
#[cfg(not(target_family = "wasm"))]
use crate::exec::gpu::sharing::{share, shared};
use crate::model::layout::WORKGROUP;
#[cfg(not(target_family = "wasm"))]
use crate::rigid::gpu::RigidGpu;
use crate::step::stage::Stage;
use crate::step::wgsl::Variant;
use crate::user_laws::set::KernelLaws;

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
    kernels: Mutex<HashMap<KernelKey, KernelSlot>>,
    /// By the first of their entry points.
    copiers: Mutex<HashMap<&'static str, Arc<Copiers>>>,
    /// The kernels of the contact law `rigid`.
    #[cfg(not(target_family = "wasm"))]
    rigid: OnceLock<Arc<RigidGpu>>,
}

/// Name of the stage, variant, number of chunks of each array, text of the program's laws.
/// A kernel, once it is compiled. A thread that compiles it holds the lock, so that no other one does the same.
type KernelSlot = Arc<Mutex<Option<Arc<Kernel>>>>;
type KernelKey = (&'static str, Variant, Vec<u32>, KernelLaws);

/// A limit of a device: its name in WebGPU, and a function that reads it.
type Limit = (&'static str, fn(&wgpu::Limits) -> u32);

/// Limits that the kernels need. WebGPU guarantees at least these values.
const NEEDED: [(Limit, u32); 3] = [
    (("max_storage_buffers_per_shader_stage", |limits| limits.max_storage_buffers_per_shader_stage), 8),
    (("max_compute_invocations_per_workgroup", |limits| limits.max_compute_invocations_per_workgroup), WORKGROUP),
    (("max_compute_workgroup_size_x", |limits| limits.max_compute_workgroup_size_x), WORKGROUP),
];

#[cfg(target_family = "wasm")]
const HELP: &str = "use a browser with WebGPU, and check that hardware acceleration is switched on, or use the CPU backend";
#[cfg(not(target_family = "wasm"))]
const HELP: &str = "install a graphics driver with Vulkan, Metal or DX12 (on Linux: mesa-vulkan-drivers, or the \
                    proprietary driver with its Vulkan part), see what `rockfall devices` lists, or use --backend cpu";

/// The wgpu instance that lists the adapters. It respects the environment variables of wgpu.
pub fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    // wgpu would name every object in debug builds. The Vulkan loader sometimes crashes on that while another thread closes a
    // device, because it walks its list of devices without a lock (issue 5270 of wgpu). WGPU_DEBUG=1 still turns names on.
    descriptor.flags.remove(wgpu::InstanceFlags::DEBUG);
    wgpu::Instance::new(descriptor.with_env())
}

/// The graphics APIs to search: all, or those that the environment variable `WGPU_BACKEND` names.
#[cfg(not(target_family = "wasm"))]
fn apis() -> wgpu::Backends {
    wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all())
}

/// The adapters that [`Gpu::open`] may choose from.
#[cfg(not(target_family = "wasm"))]
async fn candidates() -> Vec<wgpu::Adapter> {
    instance().enumerate_adapters(apis()).await
}

/// The adapter that the browser chooses. A browser offers only one. It may be the slower one of two without the preference.
#[cfg(target_family = "wasm")]
async fn candidates() -> Vec<wgpu::Adapter> {
    let power_preference = wgpu::PowerPreference::HighPerformance;
    let options = wgpu::RequestAdapterOptions { power_preference, ..Default::default() };
    instance().request_adapter(&options).await.into_iter().collect()
}

/// The adapters that [`Gpu::open`] may choose from, the best first.
async fn ranked() -> Vec<wgpu::Adapter> {
    let mut found = candidates().await;
    found.sort_by_key(|adapter| Reverse(preference(&adapter.get_info())));
    found
}

/// All adapters, including software ones. The first is the one that [`Gpu::open`] tries first.
pub async fn adapters() -> Vec<wgpu::AdapterInfo> {
    ranked().await.iter().map(wgpu::Adapter::get_info).collect()
}

/// Rank of an adapter; a greater rank is better. Hardware precedes software, discrete GPUs precede integrated ones, and GL
/// comes last.
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

/// Describes the first limit that is too low for the kernels, or returns `None`.
fn too_low_limit(limits: &wgpu::Limits) -> Option<String> {
    let low = NEEDED.into_iter().find(|((_, limit), needed)| limit(limits) < *needed);
    low.map(|((name, limit), needed)| format!("{name} is {}, rockfall needs {needed}", limit(limits)))
}

/// The reason why an adapter cannot be used, or `None`.
fn reason_unusable(adapter: &wgpu::Adapter, allow_software: bool) -> Option<String> {
    let info = adapter.get_info();
    let computes = adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS);
    let why = if !computes {
        Some("it has no compute shaders".to_owned())
    } else if !allow_software && info.device_type == wgpu::DeviceType::Cpu {
        Some("it is a software adapter".to_owned())
    } else {
        too_low_limit(&adapter.limits())
    };
    why.map(|why| format!("{} ({}): {why}", info.name, info.backend))
}

impl Gpu {
    /// Opens the best adapter, preferring discrete GPUs. A software adapter (a CPU that emulates a GPU) is used only if
    /// `allow_software` is set and there is no hardware adapter.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] when there is no usable adapter, [`Error::Device`] when none can be opened.
    pub async fn open(allow_software: bool) -> Result<Self> {
        #[cfg(not(target_family = "wasm"))]
        if let Some(gpu) = shared().filter(|gpu| allow_software || !gpu.is_software()) {
            return Ok(gpu);
        }
        let gpu = Self::open_another(allow_software).await?;
        #[cfg(not(target_family = "wasm"))]
        share(&gpu);
        Ok(gpu)
    }

    /// Opens the adapter with a number in the list of [`adapters`], also a software adapter.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] when there is no such adapter or it cannot be used, [`Error::Device`] when it cannot be opened.
    pub async fn open_number(number: usize) -> Result<Self> {
        let candidates = ranked().await;
        let count = candidates.len();
        let Some(adapter) = candidates.get(number) else {
            let found = format!("there is no GPU {number}, `rockfall devices` lists {count}, numbered from 0");
            return Err(Error::NoAdapter(found));
        };
        if let Some(reason) = reason_unusable(adapter, true) {
            return Err(Error::NoAdapter(reason));
        }
        let refused = |error| Error::Device(format!("{}: {error}", adapter.get_info().name));
        Self::open_adapter(adapter).await.map_err(refused)
    }

    async fn open_another(allow_software: bool) -> Result<Self> {
        let mut candidates = ranked().await;
        let mut reasons = Vec::new();
        candidates.retain(|adapter| {
            let reason = reason_unusable(adapter, allow_software);
            reasons.extend(reason.clone());
            reason.is_none()
        });
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
        // Lets other programs on the device, such as PyTorch, use memory that `Simulation::read_table` writes.
        let sharing = wgpu::Features::VULKAN_EXTERNAL_MEMORY_FD;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("rockfall"),
                required_features: adapter.features() & (timing | sharing),
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await?;
        let faults = Faults::default();
        faults.watch(&device);
        Ok(Self::with(device, queue, faults))
    }

    /// Blocking version of [`Gpu::open`] for native callers.
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

    /// Blocking version of [`adapters`] for native callers.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn adapters_blocking() -> Vec<wgpu::AdapterInfo> {
        crate::exec::gpu::wait::drive(adapters(), || {
            std::thread::yield_now();
            Ok(())
        })
        .unwrap_or_default()
    }

    /// Uses the caller's device and leaves its error handlers alone. An error in a call of this module is returned by that call
    /// or by the next one that waits.
    pub fn on_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self::with(device, queue, Faults::default())
    }

    fn with(device: wgpu::Device, queue: wgpu::Queue, faults: Faults) -> Self {
        let (kernels, copiers) = (Mutex::default(), Mutex::default());
        #[cfg(not(target_family = "wasm"))]
        let rigid = OnceLock::new();
        let inner = Inner {
            device,
            queue,
            faults,
            kernels,
            copiers,
            #[cfg(not(target_family = "wasm"))]
            rigid,
        };
        Self { inner: Arc::new(inner) }
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.inner.device
    }

    /// The device's queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.inner.queue
    }

    /// Name, graphics API, kind and driver of the adapter.
    pub fn info(&self) -> wgpu::AdapterInfo {
        self.inner.device.adapter_info()
    }

    /// Whether the adapter is a CPU that emulates a GPU.
    pub fn is_software(&self) -> bool {
        self.info().device_type == wgpu::DeviceType::Cpu
    }

    /// # Errors
    /// [`Error::Device`] when the device, which may be the caller's, was opened with limits that are too low.
    /// Checks that the limits of the device are high enough for the kernels.
    pub(crate) fn check_limits(&self) -> Result<()> {
        match too_low_limit(&self.device().limits()) {
            None => Ok(()),
            Some(low) => Err(Error::Device(format!(
                "the limits of the device are too low: {low}; open it with `wgpu::Limits::default()` or the adapter's \
                 limits, or use the CPU backend"
            ))),
        }
    }

    pub(crate) fn faults(&self) -> &Faults {
        &self.inner.faults
    }

    /// The kernels of the contact law `rigid`, each compiled at its first use.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn rigid(&self) -> Arc<RigidGpu> {
        let new = || Arc::new(RigidGpu::new(self.device().clone(), self.queue().clone()));
        Arc::clone(self.inner.rigid.get_or_init(new))
    }

    /// The kernels of [`Table`](crate::exec::gpu::Table), compiled at their first use.
    pub(super) fn exchangers(&self) -> Result<Arc<Copiers>> {
        self.copiers(wgpu::include_wgsl!("exchange.wgsl"), 5, ["gather", "scatter", "check"])
    }

    /// The kernels for the rows of spheres that several processes share, compiled at their first use.
    #[cfg(any(test, feature = "mpi"))]
    pub(super) fn sharers(&self) -> Result<Arc<Copiers>> {
        self.copiers(wgpu::include_wgsl!("share.wgsl"), 8, ["take", "put", "look"])
    }

    fn copiers(
        &self,
        file: wgpu::ShaderModuleDescriptor<'_>,
        bindings: u32,
        entry_points: [&'static str; 3],
    ) -> Result<Arc<Copiers>> {
        let mut copiers = self.inner.copiers.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = copiers.get(entry_points[0]) {
            return Ok(Arc::clone(known));
        }
        let made = Arc::new(catch(self.device(), || Copiers::new(self.device(), file, bindings, entry_points))?);
        copiers.insert(entry_points[0], Arc::clone(&made));
        Ok(made)
    }

    fn kernels(&self) -> MutexGuard<'_, HashMap<KernelKey, KernelSlot>> {
        self.inner.kernels.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of kernels compiled so far.
    #[cfg(test)]
    pub(crate) fn compiled(&self) -> usize {
        let slots: Vec<KernelSlot> = self.kernels().values().cloned().collect();
        slots.iter().filter(|slot| slot.lock().unwrap_or_else(PoisonError::into_inner).is_some()).count()
    }

    /// The kernel of a stage for a variant, compiled at its first use. `chunks` holds the number of chunks of each array, in
    /// the order of the stage's bindings. `laws` is the text of the program's laws.
    pub(crate) fn kernel(
        &self,
        stage: &'static Stage,
        variant: Variant,
        chunks: Vec<u32>,
        laws: &KernelLaws,
    ) -> Result<Arc<Kernel>> {
        let laws = laws.used_by(|| stage.parts().iter().map(|part| part.text).collect());
        let key = (stage.name, variant, chunks, laws);
        let slot = Arc::clone(self.kernels().entry(key.clone()).or_default());
        let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kernel) = &*slot {
            return Ok(Arc::clone(kernel));
        }
        let kernel = Arc::new(Kernel::new(self.device(), stage, variant, &key.2, &key.3)?);
        *slot = Some(Arc::clone(&kernel));
        Ok(kernel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_that_are_too_low_are_named() {
        assert_eq!(too_low_limit(&wgpu::Limits::default()), None);
        let limits = wgpu::Limits { max_storage_buffers_per_shader_stage: 4, ..Default::default() };
        let message = too_low_limit(&limits).unwrap();
        assert_eq!(message, "max_storage_buffers_per_shader_stage is 4, rockfall needs 8");
        let limits = wgpu::Limits { max_compute_workgroup_size_x: 0, ..Default::default() };
        assert!(too_low_limit(&limits).is_some());
    }
}
