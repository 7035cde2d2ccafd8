//! Sums of all earlier words of an array of `u32`, in place.

use wgpu::BufferUsages;

use crate::rigid::gpu::MOST_GROUPS;
use crate::rigid::gpu::kernels::{Kernel, SCAN, SCAN_STAGES, SCANNED, SUMS, join};

/// Words of a tile, in `rigid/broad/scan.wgsl`.
const TILE: u32 = 4096;

/// The kernels of all scans on a device.
#[derive(Clone, Debug)]
pub(crate) struct ScanKernels {
    kernels: [Kernel; 2],
}

/// A scan of one array.
#[derive(Debug)]
pub(crate) struct Scan {
    kernels: ScanKernels,
    groups: [wgpu::BindGroup; 2],
    tiles: u32,
}

impl ScanKernels {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let kernel = |k: usize| Kernel::build(device, &SCAN_STAGES[k], join(SCAN_STAGES[k].file), &[(SCAN, false)]);
        Self { kernels: [kernel(0), kernel(1)] }
    }
}

impl Scan {
    /// A scan of the first `length` words of a storage buffer: each word becomes the sum of all before it, modulo 2^32.
    ///
    /// # Panics
    ///
    /// If the buffer is shorter.
    pub(crate) fn new(device: &wgpu::Device, kernels: &ScanKernels, buffer: &wgpu::Buffer, length: u32) -> Self {
        assert!(4 * u64::from(length) <= buffer.size(), "the array has all words of the scan");
        let tiles = length.div_ceil(TILE);
        let create = |label, size: u64, usage, mapped_at_creation| {
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation })
        };
        let sums = create("rigid sums", 4 * u64::from(tiles.max(1)), BufferUsages::STORAGE, false);
        let row = create("rigid scan", 16, BufferUsages::UNIFORM, true);
        row.slice(..4).get_mapped_range_mut().expect("a mapped buffer").copy_from_slice(&length.to_ne_bytes());
        row.unmap();
        let group = |kernel: &Kernel| {
            let entry = |binding, buffer: &wgpu::Buffer| (binding, buffer.clone());
            let entries = [entry(SCAN, &row), entry(SCANNED, buffer), entry(SUMS, &sums)];
            let entries = entries
                .each_ref()
                .map(|(binding, buffer)| wgpu::BindGroupEntry { binding: *binding, resource: buffer.as_entire_binding() });
            let layout = &kernel.layout;
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("rigid scan"), layout, entries: &entries })
        };
        Self { kernels: kernels.clone(), groups: kernels.kernels.each_ref().map(group), tiles }
    }

    /// Adds the two dispatches of the scan.
    pub(crate) fn encode(&self, pass: &mut wgpu::ComputePass<'_>) {
        if self.tiles == 0 {
            return;
        }
        let rows = self.tiles.div_ceil(MOST_GROUPS);
        // One tile has no earlier ones.
        let stages = if self.tiles > 1 { 2 } else { 1 };
        for (kernel, group) in self.kernels.kernels.iter().zip(&self.groups).take(stages) {
            pass.set_pipeline(&kernel.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(self.tiles.div_ceil(rows), rows, 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sums that a device finds.
    fn scanned(device: &wgpu::Device, queue: &wgpu::Queue, kernels: &ScanKernels, words: &[u32]) -> Vec<u32> {
        let size = 4 * words.len() as u64;
        let buffer =
            |usage| device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
        let array = buffer(BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC);
        let back = buffer(BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        queue.write_buffer(&array, 0, bytemuck::cast_slice(words));
        // The last word is not part of it.
        let scan = Scan::new(device, kernels, &array, words.len() as u32 - 1);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        scan.encode(&mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()));
        encoder.copy_buffer_to_buffer(&array, 0, &back, 0, size);
        queue.submit([encoder.finish()]);
        back.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        device.poll(wgpu::PollType::wait_indefinitely()).expect("it runs");
        bytemuck::cast_slice(&back.get_mapped_range(..).expect("a range")).to_vec()
    }

    #[test]
    fn words_become_sums_of_all_before() {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter =
            pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).expect("an adapter");
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("a device");
        let kernels = ScanKernels::new(&device);
        // The last one has more than 1000 tiles.
        for length in [0, 1, 15, 16, 17, 255, 256, 257, 4095, 4096, 4097, 100_000, 4_500_001] {
            let words: Vec<u32> = (0..=length).map(|k| ((k * 2_654_435_761_u64) >> 7) as u32 % 5).collect();
            let mut wanted = words.clone();
            let mut sum = 0;
            for word in &mut wanted[..length as usize] {
                (sum, *word) = (sum + *word, sum);
            }
            assert!(scanned(&device, &queue, &kernels, &words) == wanted, "{length} words");
        }
    }
}
