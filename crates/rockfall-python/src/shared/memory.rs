//! Memory of an NVIDIA card that Vulkan and CUDA both use: allocated by Vulkan, exported as a file descriptor and imported by the
//! CUDA driver. The driver library is loaded at run time, so rockfall needs no CUDA to be installed.

use std::fs::File;
use std::os::fd::FromRawFd;
use std::sync::Arc;

use ash::vk;
use cudarc::driver::{CudaContext, DevicePtr, DeviceSlice, DriverError, MappedBuffer, result, sys};
use rockfall::wgpu;
use rockfall::wgpu::hal::api::Vulkan;

const HANDLE: vk::ExternalMemoryHandleTypeFlags = vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD;

/// The reason why memory cannot be shared, for people.
pub(super) type Reason = String;

fn cuda_failed(error: DriverError) -> Reason {
    format!("the CUDA driver reports: {error}")
}

fn vulkan_failed(error: vk::Result) -> Reason {
    format!("Vulkan reports: {error}")
}

/// The CUDA side of the device that a simulation runs on.
#[allow(unsafe_code)]
pub(super) fn cuda_device_of(device: &wgpu::Device) -> Result<Arc<CudaContext>, Reason> {
    if !device.features().contains(wgpu::Features::VULKAN_EXTERNAL_MEMORY_FD) {
        return Err("the graphics driver does not export memory".to_owned());
    }
    let uuid = vulkan_uuid(device)?;
    // SAFETY: loading the CUDA driver runs its initialization, as any program that uses CUDA does.
    if !unsafe { sys::is_culib_present() } {
        return Err("there is no CUDA driver".to_owned());
    }
    let count = CudaContext::device_count().map_err(cuda_failed)?;
    for ordinal in 0..usize::try_from(count).unwrap_or(0) {
        result::init().map_err(cuda_failed)?;
        let cuda = result::device::get(ordinal as i32).and_then(result::device::get_uuid).map_err(cuda_failed)?;
        if cuda.bytes.map(|byte| byte as u8) == uuid {
            return CudaContext::new(ordinal).map_err(cuda_failed);
        }
    }
    Err("CUDA does not know the device".to_owned())
}

/// The number by which both APIs identify a card.
#[allow(unsafe_code)]
fn vulkan_uuid(device: &wgpu::Device) -> Result<[u8; 16], Reason> {
    // SAFETY: the handles are used while the device exists, and nothing is destroyed.
    unsafe {
        let device = device.as_hal::<Vulkan>().ok_or("the device does not use Vulkan")?;
        let mut id = vk::PhysicalDeviceIDProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut id);
        let instance = device.shared_instance().raw_instance();
        instance.get_physical_device_properties2(device.raw_physical_device(), &mut properties);
        Ok(id.device_uuid)
    }
}

/// Memory that both APIs address.
#[derive(Debug)]
pub(crate) struct Memory {
    /// The memory as Vulkan sees it.
    pub(super) buffer: wgpu::Buffer,
    /// The same memory as CUDA sees it. It is only kept here until the memory is dropped.
    mapped: MappedBuffer,
    /// Its address for CUDA.
    address: u64,
    cuda: Arc<CudaContext>,
}

// SAFETY: functions of the CUDA driver may be called from any thread. Those here bind the context to the calling thread first,
// and so does the drop of `mapped`, the only field that is neither `Send` nor `Sync` by itself.
#[allow(unsafe_code)]
unsafe impl Send for Memory {}
// SAFETY: as above. No method changes `mapped`.
#[allow(unsafe_code)]
unsafe impl Sync for Memory {}

impl Memory {
    pub(super) fn new(device: &wgpu::Device, cuda: &Arc<CudaContext>, bytes: u64) -> Result<Self, Reason> {
        let (buffer, file, size) = export(device, bytes)?;
        // SAFETY: `size` is the size of the exported allocation.
        #[allow(unsafe_code)]
        let imported = unsafe { cuda.import_external_memory(file, size) }.map_err(cuda_failed)?;
        let mapped = imported.map_all().map_err(cuda_failed)?;
        let address = mapped.device_ptr(mapped.stream()).0;
        Ok(Self { buffer, mapped, address, cuda: Arc::clone(cuda) })
    }

    pub(super) fn cuda(&self) -> &Arc<CudaContext> {
        &self.cuda
    }

    /// The address for CUDA.
    pub(super) fn address(&self) -> u64 {
        self.address
    }

    /// Waits for what CUDA does with this memory and any other.
    pub(super) fn wait_for_cuda(&self) -> Result<(), Reason> {
        self.cuda.synchronize().map_err(cuda_failed)
    }

    /// Copies the first numbers to the host.
    #[allow(unsafe_code)]
    pub(super) fn download(&self, into: &mut [f32]) -> Result<(), Reason> {
        assert!(size_of_val(into) <= self.mapped.len(), "a table is larger than its memory");
        self.cuda.bind_to_thread().map_err(cuda_failed)?;
        // SAFETY: the memory has room for these numbers, and every bit pattern is an f32. The call waits for the copy.
        unsafe { result::memcpy_dtoh_sync(into, self.address) }.map_err(cuda_failed)
    }

    /// Copies numbers from an address on the device, and waits for the copy.
    ///
    /// # Safety
    /// `bytes` bytes from `address` on must be memory of the same device that stays valid during the call.
    #[allow(unsafe_code)]
    pub(super) unsafe fn copy_from(&self, address: u64, bytes: usize) -> Result<(), Reason> {
        assert!(bytes <= self.mapped.len(), "a table is larger than its memory");
        self.cuda.bind_to_thread().map_err(cuda_failed)?;
        // SAFETY: the caller vouches for the source, and the target has room.
        unsafe { result::memcpy_dtod_sync(self.address, address, bytes) }.map_err(cuda_failed)?;
        // A copy within the device returns before it is done.
        self.wait_for_cuda()
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        // Work of CUDA that still uses the memory. There is nobody to tell of an error.
        let _ = self.cuda.synchronize();
    }
}

/// Allocates memory on the device. Returns it as a buffer and as a file, with the size of the allocation.
#[allow(unsafe_code)]
fn export(device: &wgpu::Device, bytes: u64) -> Result<(wgpu::Buffer, File, u64), Reason> {
    use wgpu::BufferUsages as Usage;
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST;
    let mut external = vk::ExternalMemoryBufferCreateInfo::default().handle_types(HANDLE);
    let info = vk::BufferCreateInfo::default().size(bytes).usage(usage).push_next(&mut external);
    // SAFETY: all objects are made by this device, which exists. The buffer and its memory are handed to wgpu, which destroys
    // both; before that, every path that fails destroys them here. CUDA takes over the file, and holds the memory on its own.
    unsafe {
        let hal = device.as_hal::<Vulkan>().ok_or("the device does not use Vulkan")?;
        let (raw, instance) = (hal.raw_device(), hal.shared_instance().raw_instance());
        let buffer = raw.create_buffer(&info, None).map_err(vulkan_failed)?;
        let needed = raw.get_buffer_memory_requirements(buffer);
        let types = instance.get_physical_device_memory_properties(hal.raw_physical_device());
        let local = |kind: &u32| {
            let flags = types.memory_types[*kind as usize].property_flags;
            needed.memory_type_bits & 1 << kind != 0 && flags.contains(vk::MemoryPropertyFlags::DEVICE_LOCAL)
        };
        let Some(kind) = (0..types.memory_type_count).find(local) else {
            raw.destroy_buffer(buffer, None);
            return Err("no memory of the device can be exported".to_owned());
        };
        let mut exported = vk::ExportMemoryAllocateInfo::default().handle_types(HANDLE);
        let allocation =
            vk::MemoryAllocateInfo::default().allocation_size(needed.size).memory_type_index(kind).push_next(&mut exported);
        let memory = raw.allocate_memory(&allocation, None).map_err(|error| {
            raw.destroy_buffer(buffer, None);
            vulkan_failed(error)
        })?;
        let files = ash::khr::external_memory_fd::Device::new(instance, raw);
        let wanted = vk::MemoryGetFdInfoKHR::default().memory(memory).handle_type(HANDLE);
        let file = raw.bind_buffer_memory(buffer, memory, 0).and_then(|()| files.get_memory_fd(&wanted)).map_err(|error| {
            raw.destroy_buffer(buffer, None);
            raw.free_memory(memory, None);
            vulkan_failed(error)
        })?;
        let owned = wgpu::hal::vulkan::Buffer::from_raw_managed(buffer, memory, 0, needed.size);
        let usage = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: Some("shared"), size: bytes, usage, mapped_at_creation: false };
        let buffer = device.create_buffer_from_hal::<Vulkan>(owned, &descriptor);
        Ok((buffer, File::from_raw_fd(file), needed.size))
    }
}
