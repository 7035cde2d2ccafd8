//! A frame of the law `rigid` on a device (docs/physics.md chapter 11).
//!
//! | room | what it knows |
//! |---|---|
//! | [`rows`] | rows of the arrays |
//! | [`shapes`] | rows of colliders, lists of hulls |
//! | `kernels` | the kernels and their bindings |
//!
//! A frame begins with the contacts that the CPU has found ([`FrameRows`]). The device solves all substeps of it.

mod kernels;
pub(crate) mod rows;
pub(crate) mod shapes;

use std::sync::OnceLock;

use bytemuck::{Pod, bytes_of, cast_slice};

use kernels::{
    ALL_AT_ONCE, BEFORE_IMPACTS, BINDINGS, BLOCKS, BODIES, CARRY, CARRY_ROUND, COLLIDERS, CONSTANTS, CONTACTS, COUNT_LEFT_OVER,
    DRIFT, EXPOSE, FIND_ALL_ROUND, FIND_LEFT_OVER, FIND_LEFT_OVER_ROUND, FIND_ROUND, HULLS, IMPACTS_AT_ONCE, KICK, Kernel, Kinds,
    LISTS, LOAD, LOADS, MEAN, MEAN_OF_IMPACTS, PAIRS, POINTS, REFRESH, REFRESH_ROUND, REPORT, SETTLE, SOLVE, SOLVE_LEFT_OVER,
    SPARE_ROUND, STAGES, STRIKE, STRIKE_LEFT_OVER, STRIKE_LEFT_OVER_ROUND, STRIKE_ROUND, WAIT_ROUND,
};
use rows::{BlockRow, BodyRow, ContactRow, FrameRows, PairRow, PointRow, ROUND};

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
    /// By stage and kinds of shapes, compiled when they are first used.
    kernels: Vec<OnceLock<Kernel>>,
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
    /// Points that another static shape covers.
    Expose,
    /// What the blocks add to the first warm start.
    Load,
    /// Kick and warm start.
    Kick,
    /// Spare gaps of round pairs.
    Spare,
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
    /// By stage.
    groups: Vec<OnceLock<wgpu::BindGroup>>,
    kinds: Kinds,
    /// It has pairs with balls or capsules.
    is_round: bool,
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
    pub(crate) points: Vec<PointRow>,
    pub(crate) contacts: Vec<ContactRow>,
    /// Bodies whose path is longer than their margin.
    pub(crate) beyond: u32,
    /// Bodies whose state stopped being finite: their number, and the first one.
    pub(crate) stopped: Option<(u32, u32)>,
}

impl RigidGpu {
    pub(crate) fn new(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let kernels = (0..STAGES.len() * Kinds::COUNT).map(|_| OnceLock::new()).collect();
        Self { device, queue, kernels }
    }

    fn kernel(&self, stage: usize, kinds: Kinds) -> &Kernel {
        let kinds = if STAGES[stage].bindings.contains(&COLLIDERS) { kinds } else { Kinds::default() };
        let slot = &self.kernels[Kinds::COUNT * stage + kinds.number()];
        slot.get_or_init(|| Kernel::new(&self.device, &STAGES[stage], kinds))
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
        let is_round = rows.pairs.iter().any(|pair| pair.info & ROUND != 0);
        // What is found of impacts: a row of each block, and two of each point.
        let found = if is_round { rows.blocks.len() + 2 * rows.points.len() } else { 0 };
        let loads = LOAD_BYTES * rows.blocks.len() + COPIES_BYTES * left_over + 16 * found;
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
        let has = |core: u32| rows.colliders.iter().any(|collider| collider.shape.core == core);
        GpuFrame {
            gpu: self,
            buffers,
            groups: STAGES.iter().map(|_| OnceLock::new()).collect(),
            kinds: Kinds { capsules: has(4), hulls: has(3) },
            is_round,
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
        // The stages of one workgroup know no round pairs.
        let plan = if self.is_round { Plan::Stages } else { plan };
        if plan == Plan::AllAtOnce {
            parts.push(Part::AllAtOnce);
        } else {
            parts.extend([Part::Refresh, Part::Load]);
            let impacts = if plan == Plan::Stages { Part::Impacts } else { Part::ImpactsAtOnce };
            for _ in 0..self.substeps {
                parts.extend([impacts, Part::Kick, Part::Spare, Part::Biased, Part::Drift, Part::Refresh, Part::Relax]);
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
            Part::Expose => self.dispatch(pass, EXPOSE, self.blocks, 0),
            Part::Load => self.dispatch(pass, LOAD, self.blocks, 0),
            Part::Kick => self.dispatch(pass, KICK, self.bodies, 0),
            Part::Spare if self.is_round => self.dispatch(pass, SPARE_ROUND, self.blocks, 0),
            Part::Spare => (),
            Part::Biased | Part::Relax => self.encode_pass(pass, part == Part::Biased),
            Part::Drift => self.dispatch(pass, DRIFT, self.bodies, 0),
            Part::Refresh => self.dispatch(pass, if self.is_round { REFRESH_ROUND } else { REFRESH }, self.blocks, 0),
            Part::Impacts if self.is_round => self.encode_round_impacts(pass),
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

    /// Each block is first searched for its hit, with the geometry there, and then reflected.
    fn encode_round_impacts(&mut self, pass: &mut wgpu::ComputePass<'_>) {
        let left_over = self.left_over();
        self.dispatch(pass, BEFORE_IMPACTS, self.bodies, 0);
        for _ in 0..ROUNDS {
            for colour in 0..COLOURS {
                self.dispatch(pass, FIND_ROUND, self.blocks_of(colour), call(colour, false));
                self.dispatch(pass, STRIKE_ROUND, self.blocks_of(colour), call(colour, false));
            }
            if left_over > 0 {
                self.dispatch(pass, FIND_ROUND, left_over, call(COLOURS, false));
                self.dispatch(pass, FIND_LEFT_OVER_ROUND, left_over, 0);
                self.dispatch(pass, COUNT_LEFT_OVER, self.bodies, 0);
                self.dispatch(pass, STRIKE_LEFT_OVER_ROUND, left_over, 0);
                self.dispatch(pass, MEAN_OF_IMPACTS, self.bodies, 0);
            }
        }
        self.dispatch(pass, FIND_ALL_ROUND, self.blocks, 0);
        self.dispatch(pass, WAIT_ROUND, self.blocks, 0);
        self.dispatch(pass, CARRY_ROUND, self.blocks, 0);
        self.dispatch(pass, LOAD, self.blocks, 0);
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
        let kernel = self.gpu.kernel(stage, self.kinds);
        let group = self.groups[stage].get_or_init(|| self.gpu.group(STAGES[stage].bindings, kernel, &self.buffers));
        pass.set_pipeline(&kernel.pipeline);
        pass.set_bind_group(0, group, &[offset]);
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
            points: self.read_array(POINTS, self.points),
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
