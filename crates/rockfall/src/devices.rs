//! Listing what rockfall could run on.

/// A graphics adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DeviceInfo {
    /// Name of the device.
    pub name: String,
    /// Graphics API it is reached by, for example `vulkan`.
    pub backend: String,
    /// What it is: discrete, integrated or virtual GPU, or a CPU that plays one.
    pub kind: String,
    /// Driver and its version.
    pub driver: String,
    /// Whether it is a CPU that plays GPU; such a one is taken only when asked for.
    pub software: bool,
}

/// Driver and its version.
#[cfg(feature = "gpu")]
pub(crate) fn driver(info: &wgpu::AdapterInfo) -> String {
    format!("{} {}", info.driver, info.driver_info).trim().to_owned()
}

/// All adapters, the one that a simulation takes first; none without the feature `gpu`.
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
pub fn devices() -> Vec<DeviceInfo> {
    let info = |info: wgpu::AdapterInfo| DeviceInfo {
        driver: driver(&info),
        name: info.name,
        backend: info.backend.to_string(),
        kind: format!("{:?}", info.device_type),
        software: info.device_type == wgpu::DeviceType::Cpu,
    };
    crate::exec::gpu::Gpu::adapters_blocking().into_iter().map(info).collect()
}

/// All adapters, the one that a simulation takes first; none without the feature `gpu`.
#[cfg(not(all(feature = "gpu", not(target_family = "wasm"))))]
pub fn devices() -> Vec<DeviceInfo> {
    Vec::new()
}
