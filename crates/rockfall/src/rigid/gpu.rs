//! A frame of the law `rigid` on a device (docs/physics chapter 11).
//!
//! | room | what it knows |
//! |---|---|
//! | [`rows`] | rows of the arrays |
//! | [`world`] | a world that stays on the device |
//! | `assemble` | blocks, pairs, points and lists from manifolds |
//! | `past` | what is kept from frame to frame |
//! | `arrays` | arrays by binding, dispatches over them |
//! | [`shapes`] | rows of colliders, lists of hulls |
//! | `kernels` | the kernels and their bindings |
//! | `springs` | springs, and the ends of each body |
//! | `joints` | joints, their states, and the bodies that they keep apart |
//! | [`search`] | the manifolds of a frame |
//! | [`scan`] | sums of all earlier words of an array |
//!
//! A [`world::GpuWorld`] does all of a frame on the device: it finds the manifolds (`search`), orders them into blocks, pairs and points
//! (`assemble`), and solves the substeps ([`GpuFrame`]). For tests, a frame may also begin with the contacts that the CPU has found
//! ([`FrameRows`]).

mod arrays;
mod assemble;
#[cfg(test)]
mod contacts;
mod joint_groups;
mod joints;
mod kernels;
mod past;
mod prepare;
pub(crate) mod rows;
pub(crate) mod scan;
pub(crate) mod search;
pub(crate) mod shapes;
mod springs;
pub(crate) mod world;

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use bytemuck::{Pod, bytes_of, cast_slice};

use arrays::Arrays;
use kernels::{
    ADD_LAWS, BEFORE_IMPACTS, BLOCKS, BODIES, CARRY, CARRY_ROUND, COLLIDERS, CONSTANTS, CONTACTS, COUNT_LEFT_OVER, DRIFT,
    EXPOSE, FIND_ALL_ROUND, FIND_LEFT_OVER, FIND_LEFT_OVER_ROUND, FIND_ROUND, HULLS, KICK, Kernel, Kinds, LISTS, LOAD, LOADS,
    MEAN, MEAN_OF_IMPACTS, PAIRS, POINTS, PULL, REFRESH, REFRESH_ROUND, REPORT, SEEK, SEEK_ROUND, SETTLE, SOLVE,
    SOLVE_LEFT_OVER, SPARE_ROUND, STAGES, STRIKE, STRIKE_LEFT_OVER, STRIKE_LEFT_OVER_ROUND, STRIKE_ROUND, WAIT_ROUND, join,
};
use rows::{BlockRow, BodyRow, ContactRow, FrameRow, FrameRows, PairRow, PointRow, ROUND};
use scan::ScanKernels;

use crate::user_laws::forces::PLACE_OF_BODIES;

/// Threads of a workgroup, but of the stages that say so.
const THREADS: u32 = 64;
/// Most workgroups along one dimension of a dispatch.
const MOST_GROUPS: u32 = 65_535;
/// Distance of the uniform blocks of the calls.
const CALL: u32 = 256;
/// Colours, without the left-over blocks.
const COLOURS: u32 = 16;
/// Most rounds in which blocks take colours.
const MOST_ROUNDS: u32 = 255;
/// Bytes of the load of a block, and of the copies of a left-over one.
const LOAD_BYTES: usize = 48;
const COPIES_BYTES: usize = 128;
/// Words of the report.
const REPORT_WORDS: u32 = 8;
/// Rounds of impacts.
const ROUNDS: usize = 2;

/// The kernels on a device, each compiled at its first use.
#[derive(Debug)]
pub(crate) struct RigidGpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// By stage and kinds of shapes.
    kernels: Vec<OnceLock<Kernel>>,
    scans: OnceLock<ScanKernels>,
    search_kernels: Mutex<HashMap<(usize, search::Content), Kernel>>,
    /// Kernels with forces of programs, by their text.
    law_kernels: Mutex<HashMap<String, Kernel>>,
    /// Whether a dispatch costs more than barriers in a workgroup, so that mechanisms share one. In software it does not.
    merges: bool,
    /// A text of the kernels, and what stands in its place. For tests of the comparison with the CPU.
    mistake: Option<[&'static str; 2]>,
}

/// How the substeps of a frame are dispatched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Plan {
    /// All stages.
    Stages,
    /// The same without impacts. The report says whether a block was hit: then the frame begins anew with another plan.
    Calm,
}

/// A part of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Points that another static shape covers.
    Expose,
    /// What the blocks add to the first warm start; the impulses of joints.
    Load,
    /// Springs, kick and warm start.
    Kick,
    /// Spare gaps of round pairs.
    Spare,
    Biased,
    Drift,
    Refresh,
    Relax,
    Impacts,
    /// Whether there are impacts.
    Seek,
    /// Momenta and margins; the loads of joints.
    Settle,
}

/// A frame on the device.
#[derive(Debug)]
pub(crate) struct GpuFrame {
    arrays: Arrays,
    /// It has pairs with balls or capsules.
    is_round: bool,
    springs: springs::OnDevice,
    joints: joints::OnDevice,
    bodies: u32,
    blocks: u32,
    points: u32,
    pairs: u32,
    colours: [u32; 20],
    substeps: u32,
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
        let merges = device.adapter_info().device_type != wgpu::DeviceType::Cpu;
        let (search_kernels, law_kernels) = (Mutex::default(), Mutex::default());
        Self { device, queue, kernels, scans: OnceLock::new(), search_kernels, law_kernels, merges, mistake: None }
    }

    /// The same device, on which mechanisms share a dispatch.
    #[cfg(test)]
    pub(crate) fn merging(&self) -> Arc<Self> {
        Arc::new(Self { merges: true, ..Self::new(self.device.clone(), self.queue.clone()) })
    }

    /// Kernels on the same device with another text in place of one that occurs.
    #[cfg(test)]
    pub(crate) fn with_mistake(&self, mistake: [&'static str; 2]) -> Arc<Self> {
        assert!(kernels::count(mistake[0]) > 0, "{} is in no kernel", mistake[0]);
        let other = Self::new(self.device.clone(), self.queue.clone());
        Arc::new(Self { mistake: Some(mistake), merges: self.merges, ..other })
    }

    /// The text of a kernel that is compiled.
    fn text(&self, text: String) -> String {
        match self.mistake {
            Some([right, wrong]) => text.replace(right, wrong),
            None => text,
        }
    }

    fn scans(&self) -> &ScanKernels {
        self.scans.get_or_init(|| ScanKernels::new(&self.device))
    }

    fn kernel(&self, stage: usize, kinds: Kinds) -> &Kernel {
        let kinds = if STAGES[stage].bindings.contains(&COLLIDERS) { kinds } else { Kinds::default() };
        let slot = &self.kernels[Kinds::COUNT * stage + kinds.number()];
        slot.get_or_init(|| {
            let stage = &STAGES[stage];
            let text = self.text(kinds.write(&join(stage.file)));
            Kernel::build(&self.device, stage, text, &[(0, false), (1, true)])
        })
    }

    /// The kernel with this text in the place of the forces of the program.
    fn law_kernel(&self, laws: &str) -> Kernel {
        let kernels = || self.law_kernels.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kernels().get(laws).cloned();
        known.unwrap_or_else(|| {
            let stage = &STAGES[ADD_LAWS];
            // The program's own text stays as it is.
            let text = self.text(join(stage.file)).replace(PLACE_OF_BODIES, laws);
            let kernel = Kernel::build(&self.device, stage, text, &[(0, false), (1, true)]);
            kernels().entry(laws.to_owned()).or_insert(kernel).clone()
        })
    }

    fn buffer(&self, label: &str, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        // No binding may be empty.
        let size = bytes.next_multiple_of(16).max(16);
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        self.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
    }

    fn storage(&self, bytes: u64) -> wgpu::Buffer {
        self.buffer("rigid", bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC)
    }

    /// Submits commands that write a staging buffer, waits for them and reads its first bytes.
    fn submit_and_read<T: Pod>(
        &self,
        encoder: wgpu::CommandEncoder,
        staging: &wgpu::Buffer,
        size: u64,
    ) -> Result<Vec<T>, String> {
        let submission = self.queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, ..size, move |result| sender.send(result).unwrap_or_default());
        let until = wgpu::PollType::Wait { submission_index: Some(submission), timeout: None };
        // wgpu panics when it polls a lost device. That must not abort the host program.
        let polled = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| self.device.poll(until)));
        polled.map_err(|_| "the device was lost".to_owned())?.map_err(|error| error.to_string())?;
        let mapped = receiver.recv().map_err(|error| error.to_string())?;
        mapped.map_err(|error| error.to_string())?;
        let view = staging.get_mapped_range(..size).map_err(|error| error.to_string())?;
        let values = view.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect();
        drop(view);
        staging.unmap();
        Ok(values)
    }

    /// Uploads a frame that the CPU has begun.
    pub(crate) fn frame(self: &Arc<Self>, rows: &FrameRows) -> GpuFrame {
        let left_over = (rows.frame.blocks - rows.frame.left_over) as usize;
        let is_round = rows.pairs.iter().any(|pair| pair.info & ROUND != 0);
        let has = |core: u32| rows.colliders.iter().any(|collider| collider.shape.core == core);
        let mut arrays = Arrays::new(Arc::clone(self), Kinds { capsules: has(4), hulls: has(3) });
        arrays.upload_uniform(0, bytes_of(&rows.frame));
        arrays.upload_uniform(1, &calls());
        arrays.upload(BODIES, cast_slice(&rows.bodies));
        arrays.upload(CONSTANTS, &constants(rows));
        arrays.upload(BLOCKS, cast_slice(&rows.blocks));
        arrays.upload(PAIRS, cast_slice(&rows.pairs));
        arrays.upload(POINTS, cast_slice(&rows.points));
        arrays.upload(CONTACTS, cast_slice(&rows.contacts));
        arrays.make(LOADS, loads_bytes(rows.blocks.len(), left_over, if is_round { rows.points.len() } else { 0 }));
        arrays.upload(LISTS, cast_slice(&rows.lists));
        arrays.upload(REPORT, &[0; 4 * REPORT_WORDS as usize]);
        arrays.upload(COLLIDERS, cast_slice(&rows.colliders));
        arrays.upload(HULLS, cast_slice(&rows.hulls));
        GpuFrame {
            arrays,
            is_round,
            springs: springs::OnDevice::default(),
            joints: joints::OnDevice::default(),
            bodies: rows.frame.bodies,
            blocks: rows.frame.blocks,
            points: rows.contacts.len() as u32,
            pairs: rows.pairs.len() as u32,
            colours: rows.frame.colours,
            substeps: rows.frame.substeps,
        }
    }
}

/// Bytes of the loads of blocks, the copies of left-over ones, and of what is found of impacts with round pairs: a row of each block and
/// two of each point, of which there are none without round pairs.
fn loads_bytes(blocks: usize, left_over: usize, round_points: usize) -> u64 {
    let found = if round_points > 0 { blocks + 2 * round_points } else { 0 };
    (LOAD_BYTES * blocks + COPIES_BYTES * left_over + 16 * found) as u64
}

/// The uniform blocks of all calls: the colour in the first word, 1 for the biased pass in the second one. Then the rounds in which
/// blocks take colours, from 1 on.
fn calls() -> Vec<u8> {
    let mut calls = vec![0_u8; round_call(MOST_ROUNDS) as usize];
    for round in 0..MOST_ROUNDS {
        let at = round_call(round) as usize;
        calls[at..at + 4].copy_from_slice(&(round + 1).to_ne_bytes());
    }
    for biased in 0..2 {
        for colour in 0..=COLOURS {
            let at = (call(colour, biased == 1)) as usize;
            calls[at..at + 8].copy_from_slice(cast_slice(&[colour, biased]));
        }
    }
    calls
}

/// Constants of the bodies, then the velocities of the surfaces of the colliders.
fn constants(rows: &FrameRows) -> Vec<u8> {
    [cast_slice::<_, u8>(&rows.constants), cast_slice(&rows.belts)].concat()
}

/// Offset of the uniform block of a call.
fn call(colour: u32, biased: bool) -> u32 {
    CALL * (colour + (COLOURS + 1) * u32::from(biased))
}

/// Offset of the uniform block of a round in which blocks take colours, counted from 0.
fn round_call(round: u32) -> u32 {
    CALL * (2 * (COLOURS + 1) + round)
}

impl GpuFrame {
    /// Takes over the numbers of a frame that the device has begun.
    fn begin(&mut self, row: &FrameRow) {
        (self.blocks, self.colours, self.substeps) = (row.blocks, row.colours, row.substeps);
        self.springs.begin(&self.arrays);
    }

    /// The parts of all substeps.
    fn parts(&self, plan: Plan) -> Vec<Part> {
        let impacts = if plan == Plan::Calm { Part::Seek } else { Part::Impacts };
        let mut parts = vec![Part::Refresh, Part::Load];
        for _ in 0..self.substeps {
            parts.extend([impacts, Part::Kick, Part::Spare, Part::Biased, Part::Drift, Part::Refresh, Part::Relax]);
        }
        parts.push(Part::Settle);
        parts
    }

    /// Runs parts of a frame in order.
    pub(crate) fn run(&self, parts: &[Part]) {
        let gpu = &self.arrays.gpu;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            for part in parts {
                self.encode(&mut pass, *part);
            }
        }
        gpu.queue.submit([encoder.finish()]);
    }

    fn encode(&self, pass: &mut wgpu::ComputePass<'_>, part: Part) {
        match part {
            Part::Expose => self.dispatch(pass, EXPOSE, self.blocks, 0),
            Part::Load => {
                self.dispatch(pass, LOAD, self.blocks, 0);
                self.joints.encode(&self.arrays, pass, part);
            }
            Part::Kick => {
                self.dispatch(pass, PULL, self.springs.bodies(), 0);
                if self.arrays.laws.is_some() {
                    self.dispatch(pass, ADD_LAWS, self.springs.bodies(), 0);
                }
                self.dispatch(pass, KICK, self.bodies, 0);
                self.joints.encode(&self.arrays, pass, part);
            }
            Part::Spare if self.is_round => self.dispatch(pass, SPARE_ROUND, self.blocks, 0),
            Part::Spare => (),
            Part::Biased | Part::Relax => {
                self.joints.encode(&self.arrays, pass, part);
                self.encode_pass(pass, part == Part::Biased);
            }
            Part::Drift => self.dispatch(pass, DRIFT, self.bodies, 0),
            Part::Refresh => self.dispatch(pass, if self.is_round { REFRESH_ROUND } else { REFRESH }, self.blocks, 0),
            Part::Impacts if self.is_round => self.encode_round_impacts(pass),
            Part::Impacts => self.encode_impacts(pass),
            Part::Seek if self.is_round => {
                self.dispatch(pass, FIND_ALL_ROUND, self.blocks, 0);
                self.dispatch(pass, SEEK_ROUND, self.blocks, 0);
            }
            Part::Seek => self.dispatch(pass, SEEK, self.blocks, 0),
            Part::Settle => {
                self.dispatch(pass, SETTLE, self.bodies, 0);
                self.joints.encode(&self.arrays, pass, part);
            }
        }
    }

    fn encode_impacts(&self, pass: &mut wgpu::ComputePass<'_>) {
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
    fn encode_round_impacts(&self, pass: &mut wgpu::ComputePass<'_>) {
        let left_over = self.left_over();
        self.dispatch(pass, BEFORE_IMPACTS, self.bodies, 0);
        // The second word of the calls that follow says that what was found stands while the bodies were not reflected.
        self.dispatch(pass, FIND_ALL_ROUND, self.blocks, call(0, false));
        for _ in 0..ROUNDS {
            for colour in 0..COLOURS {
                self.dispatch(pass, FIND_ROUND, self.blocks_of(colour), call(colour, true));
                self.dispatch(pass, STRIKE_ROUND, self.blocks_of(colour), call(colour, false));
            }
            if left_over > 0 {
                self.dispatch(pass, FIND_ROUND, left_over, call(COLOURS, true));
                self.dispatch(pass, FIND_LEFT_OVER_ROUND, left_over, 0);
                self.dispatch(pass, COUNT_LEFT_OVER, self.bodies, 0);
                self.dispatch(pass, STRIKE_LEFT_OVER_ROUND, left_over, 0);
                self.dispatch(pass, MEAN_OF_IMPACTS, self.bodies, 0);
            }
        }
        self.dispatch(pass, FIND_ALL_ROUND, self.blocks, call(0, true));
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

    fn encode_pass(&self, pass: &mut wgpu::ComputePass<'_>, biased: bool) {
        for colour in 0..COLOURS {
            self.dispatch(pass, SOLVE, self.blocks_of(colour), call(colour, biased));
        }
        let left_over = self.left_over();
        if left_over > 0 {
            self.dispatch(pass, SOLVE_LEFT_OVER, left_over, call(COLOURS, biased));
            self.dispatch(pass, MEAN, self.bodies, 0);
        }
    }

    fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, stage: usize, threads: u32, offset: u32) {
        self.arrays.dispatch(pass, stage, threads, offset);
    }

    /// Waits for the device and reads the state.
    ///
    /// # Errors
    /// What the device says if it is lost.
    pub(crate) fn read(&self) -> Result<Outcome, String> {
        let report: Vec<u32> = self.arrays.read(REPORT, REPORT_WORDS)?;
        let stopped = (report[1] > 0).then(|| (report[1], u32::MAX - report[2]));
        Ok(Outcome {
            bodies: self.arrays.read(BODIES, self.bodies)?,
            blocks: self.arrays.read(BLOCKS, self.blocks)?,
            pairs: self.arrays.read(PAIRS, self.pairs)?,
            points: self.arrays.read(POINTS, self.points)?,
            contacts: self.arrays.read(CONTACTS, self.points)?,
            beyond: report[0],
            stopped,
        })
    }
}
