//! A frame of the law `rigid` on a device (docs/physics.md chapter 11).
//!
//! | room | what it knows |
//! |---|---|
//! | [`rows`] | rows of the arrays |
//! | [`shapes`] | rows of colliders, lists of hulls |
//! | `kernels` | the kernels and their bindings |
//! | [`search`] | the manifolds of a frame |
//! | [`scan`] | sums of all earlier words of an array |
//!
//! A frame begins with the contacts that the CPU has found ([`FrameRows`]). The device solves all substeps of it.

mod kernels;
pub(crate) mod rows;
pub(crate) mod scan;
pub(crate) mod search;
pub(crate) mod shapes;

use bytemuck::{Pod, bytes_of, cast_slice};

use kernels::{
    ALL_AT_ONCE, BEFORE_IMPACTS, BINDINGS, BLOCKS, BODIES, CARRY, COLLIDERS, CONSTANTS, CONTACTS, COUNT_LEFT_OVER, DRIFT,
    FIND_LEFT_OVER, HULLS, IMPACTS_AT_ONCE, KICK, Kernel, LISTS, LOAD, LOADS, MEAN, MEAN_OF_IMPACTS, PAIRS, POINTS, REFRESH, REPORT, SETTLE, SOLVE,
    SOLVE_LEFT_OVER, STAGES, STRIKE, STRIKE_LEFT_OVER,
};
use rows::{BlockRow, BodyRow, ContactRow, FrameRows, PairRow};

/// Threads of a workgroup, but of the stage for small scenes.
const THREADS: u32 = 64;
/// Most workgroups along one dimension of a dispatch.
const MOST_GROUPS: u32 = 65_535;
/// Distance of the uniform blocks of the calls.
const CALL: u32 = 256;
/// Colours, without the left-over blocks.
const COLOURS: u32 = 16;
/// Bytes of the load of a block, and of the copies of a left-over one.
const LOAD_BYTES: usize = 48;
const COPIES_BYTES: usize = 128;
/// Rounds of impacts.
const ROUNDS: usize = 2;

/// The kernels on a device.
#[derive(Debug)]
pub(crate) struct RigidGpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    kernels: Vec<Kernel>,
}

/// How the substeps of a frame are dispatched. All give the same bits on software Vulkan. A driver may fuse products in one kernel
/// and not in another: on an H200 two runs with one plan have the same bits, but two plans have not. So the plan has to follow from
/// the scene alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Plan {
    /// Each stage and each colour is a dispatch.
    Stages,
    /// One workgroup looks for impacts, all others are stages.
    ImpactsAtOnce,
    /// One workgroup solves all substeps.
    AllAtOnce,
}

/// A part of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// What the blocks add to the first warm start.
    Load,
    /// Kick and warm start.
    Kick,
    Biased,
    Drift,
    Refresh,
    Relax,
    Impacts,
    /// The impacts of a substep in one dispatch.
    ImpactsAtOnce,
    /// The geometry and all substeps in one dispatch.
    AllAtOnce,
    /// Momenta and margins.
    Settle,
}

/// The arrays of a frame on the device.
#[derive(Debug)]
pub(crate) struct GpuFrame<'a> {
    gpu: &'a RigidGpu,
    /// By binding.
    buffers: Vec<wgpu::Buffer>,
    groups: Vec<wgpu::BindGroup>,
    bodies: u32,
    blocks: u32,
    points: u32,
    pairs: u32,
    colours: [u32; 20],
    substeps: u32,
    /// Dispatches so far.
    pub(crate) dispatches: u32,
}

/// What a frame has come to.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Outcome {
    pub(crate) bodies: Vec<BodyRow>,
    pub(crate) blocks: Vec<BlockRow>,
    pub(crate) pairs: Vec<PairRow>,
    pub(crate) contacts: Vec<ContactRow>,
    /// Bodies whose path is longer than their margin.
    pub(crate) beyond: u32,
    /// Bodies whose state stopped being finite: their number, and the first one.
    pub(crate) stopped: Option<(u32, u32)>,
}

impl RigidGpu {
    pub(crate) fn new(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let kernels = STAGES.iter().map(|stage| Kernel::new(&device, stage)).collect();
        Self { device, queue, kernels }
    }

    fn buffer(&self, label: &str, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        // No binding may be empty.
        let size = bytes.next_multiple_of(16).max(16);
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        self.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
    }

    /// Uploads a frame.
    pub(crate) fn frame(&self, rows: &FrameRows) -> GpuFrame<'_> {
        let left_over = (rows.frame.blocks - rows.frame.left_over) as usize;
        let loads = LOAD_BYTES * rows.blocks.len() + COPIES_BYTES * left_over;
        let constants: Vec<u8> = [cast_slice::<_, u8>(&rows.constants), cast_slice(&rows.belts)].concat();
        // The pass is in the first word of a block of 17 calls, its colour in the second one.
        let mut calls = vec![0_u8; (2 * (COLOURS + 1) * CALL) as usize];
        for biased in 0..2 {
            for colour in 0..=COLOURS {
                let at = (call(colour, biased == 1)) as usize;
                calls[at..at + 8].copy_from_slice(cast_slice(&[colour, biased]));
            }
        }
        let arrays: [(u32, &[u8]); BINDINGS as usize] = [
            (0, bytes_of(&rows.frame)),
            (1, &calls),
            (BODIES, cast_slice(&rows.bodies)),
            (CONSTANTS, &constants),
            (BLOCKS, cast_slice(&rows.blocks)),
            (PAIRS, cast_slice(&rows.pairs)),
            (POINTS, cast_slice(&rows.points)),
            (CONTACTS, cast_slice(&rows.contacts)),
            (LOADS, &[]),
            (LISTS, cast_slice(&rows.lists)),
            (REPORT, &[0; 16]),
            (COLLIDERS, cast_slice(&rows.colliders)),
            (HULLS, cast_slice(&rows.hulls)),
        ];
        let buffers: Vec<_> = arrays
            .into_iter()
            .map(|(binding, bytes)| {
                let usage = if binding < BODIES { wgpu::BufferUsages::UNIFORM } else { wgpu::BufferUsages::STORAGE };
                let size = if binding == LOADS { loads } else { bytes.len() };
                let buffer = self.buffer("rigid", size as u64, usage | wgpu::BufferUsages::COPY_SRC);
                self.queue.write_buffer(&buffer, 0, bytes);
                buffer
            })
            .collect();
        let groups =
            STAGES.iter().zip(&self.kernels).map(|(stage, kernel)| self.group(stage.bindings, kernel, &buffers)).collect();
        GpuFrame {
            gpu: self,
            buffers,
            groups,
            bodies: rows.frame.bodies,
            blocks: rows.frame.blocks,
            points: rows.contacts.len() as u32,
            pairs: rows.pairs.len() as u32,
            colours: rows.frame.colours,
            substeps: rows.frame.substeps,
            dispatches: 0,
        }
    }

    fn group(&self, bindings: &[u32], kernel: &Kernel, buffers: &[wgpu::Buffer]) -> wgpu::BindGroup {
        let call = wgpu::BufferBinding { buffer: &buffers[1], offset: 0, size: wgpu::BufferSize::new(8) };
        let mut entries = vec![
            wgpu::BindGroupEntry { binding: 0, resource: buffers[0].as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Buffer(call) },
        ];
        entries.extend(bindings.iter().map(|binding| wgpu::BindGroupEntry {
            binding: *binding,
            resource: buffers[*binding as usize].as_entire_binding(),
        }));
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &kernel.layout, entries: &entries })
    }
}

/// Offset of the uniform block of a call.
fn call(colour: u32, biased: bool) -> u32 {
    CALL * (colour + (COLOURS + 1) * u32::from(biased))
}

impl GpuFrame<'_> {
    /// Solves the frame.
    pub(crate) fn solve(&mut self, plan: Plan) {
        let mut parts = Vec::new();
        if plan == Plan::AllAtOnce {
            parts.push(Part::AllAtOnce);
        } else {
            parts.extend([Part::Refresh, Part::Load]);
            let impacts = if plan == Plan::Stages { Part::Impacts } else { Part::ImpactsAtOnce };
            for _ in 0..self.substeps {
                parts.extend([impacts, Part::Kick, Part::Biased, Part::Drift, Part::Refresh, Part::Relax]);
            }
        }
        parts.push(Part::Settle);
        self.run(&parts);
    }

    /// Runs parts of a frame in order.
    pub(crate) fn run(&mut self, parts: &[Part]) {
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            for part in parts {
                self.encode(&mut pass, *part);
            }
        }
        self.gpu.queue.submit([encoder.finish()]);
    }

    fn encode(&mut self, pass: &mut wgpu::ComputePass<'_>, part: Part) {
        match part {
            Part::Load => self.dispatch(pass, LOAD, self.blocks, 0),
            Part::Kick => self.dispatch(pass, KICK, self.bodies, 0),
            Part::Biased | Part::Relax => self.encode_pass(pass, part == Part::Biased),
            Part::Drift => self.dispatch(pass, DRIFT, self.bodies, 0),
            Part::Refresh => self.dispatch(pass, REFRESH, self.blocks, 0),
            Part::Impacts => self.encode_impacts(pass),
            Part::ImpactsAtOnce => self.dispatch(pass, IMPACTS_AT_ONCE, 1, 0),
            Part::AllAtOnce => self.dispatch(pass, ALL_AT_ONCE, 1, 0),
            Part::Settle => self.dispatch(pass, SETTLE, self.bodies, 0),
        }
    }

    fn encode_impacts(&mut self, pass: &mut wgpu::ComputePass<'_>) {
        let left_over = self.left_over();
        self.dispatch(pass, BEFORE_IMPACTS, self.bodies, 0);
        for _ in 0..ROUNDS {
            for colour in 0..COLOURS {
                self.dispatch(pass, STRIKE, self.blocks_of(colour), call(colour, false));
            }
            if left_over > 0 {
                self.dispatch(pass, FIND_LEFT_OVER, left_over, 0);
                self.dispatch(pass, COUNT_LEFT_OVER, self.bodies, 0);
                self.dispatch(pass, STRIKE_LEFT_OVER, left_over, 0);
                self.dispatch(pass, MEAN_OF_IMPACTS, self.bodies, 0);
            }
        }
        self.dispatch(pass, CARRY, self.blocks, 0);
    }

    fn blocks_of(&self, colour: u32) -> u32 {
        self.colours[colour as usize + 1] - self.colours[colour as usize]
    }

    fn left_over(&self) -> u32 {
        self.blocks - self.colours[COLOURS as usize]
    }

    fn encode_pass(&mut self, pass: &mut wgpu::ComputePass<'_>, biased: bool) {
        for colour in 0..COLOURS {
            self.dispatch(pass, SOLVE, self.blocks_of(colour), call(colour, biased));
        }
        let left_over = self.left_over();
        if left_over > 0 {
            self.dispatch(pass, SOLVE_LEFT_OVER, left_over, call(COLOURS, biased));
            self.dispatch(pass, MEAN, self.bodies, 0);
        }
    }

    /// A dispatch of at least so many threads; none for 0.
    fn dispatch(&mut self, pass: &mut wgpu::ComputePass<'_>, stage: usize, threads: u32, offset: u32) {
        if threads == 0 {
            return;
        }
        let groups = threads.div_ceil(THREADS);
        let rows = groups.div_ceil(MOST_GROUPS);
        pass.set_pipeline(&self.gpu.kernels[stage].pipeline);
        pass.set_bind_group(0, &self.groups[stage], &[offset]);
        pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
        self.dispatches += 1;
    }

    /// Waits for the device and reads the state.
    pub(crate) fn read(&self) -> Outcome {
        let report: Vec<u32> = self.read_array(REPORT, 4);
        let stopped = (report[1] > 0).then(|| (report[1], u32::MAX - report[2]));
        Outcome {
            bodies: self.read_array(BODIES, self.bodies),
            blocks: self.read_array(BLOCKS, self.blocks),
            pairs: self.read_array(PAIRS, self.pairs),
            contacts: self.read_array(CONTACTS, self.points),
            beyond: report[0],
            stopped,
        }
    }

    fn read_array<T: Pod>(&self, binding: u32, count: u32) -> Vec<T> {
        let size = u64::from(count) * size_of::<T>() as u64;
        if size == 0 {
            return Vec::new();
        }
        let device = &self.gpu.device;
        let usage = wgpu::BufferUsages::MAP_READ;
        let staging = self.gpu.buffer("rigid read", size, usage);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.buffers[binding as usize], 0, &staging, 0, size);
        self.gpu.queue.submit([encoder.finish()]);
        staging.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("the device maps a buffer"));
        device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        let view = staging.slice(..size).get_mapped_range();
        view.expect("a mapped buffer").chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
    }
}
