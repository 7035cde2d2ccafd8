//! A world that stays on a device from frame to frame.

use std::sync::Arc;

use bytemuck::{bytes_of, cast_slice};
use glam::{Mat3, Quat, Vec3};

use crate::rigid::collide::MOST_POINTS;
use crate::rigid::common::{FrameReport, REPEATS};
use crate::rigid::gpu::arrays::Arrays;
use crate::rigid::gpu::assemble::{Assembly, Content, ROUNDS};
use crate::rigid::gpu::kernels::{
    APART, BODIES, CALM, COLLIDERS, CONSTANTS, COUNTS, HULLS, LAWS, LOADS, OLD_PAIRS, OLD_POINTS, OLD_STARTS, REPORT, SCALES,
    STORE, SUM_UP, SURFACES, WIDEN,
};
use crate::rigid::gpu::past::Past;
use crate::rigid::gpu::rows::{BodyRow, ConstantRow, FrameRow, FrameRows};
use crate::rigid::gpu::search::{COUNT_WORDS, Inputs, Search, scales_of};
use crate::rigid::gpu::{COLOURS, GpuFrame, MOST_ROUNDS, Plan, REPORT_WORDS, RigidGpu, call, joints, loads_bytes, springs};
use crate::rigid::joints::Joint;
use crate::rigid::laws::Laws;
use crate::rigid::shape::Shape;
use crate::rigid::springs::MuscleWords;
use crate::rigid::world::{Body, Kind, RigidWorld};

/// Frames with impacts after one that began anew because of an impact.
const STORM: u32 = 64;
/// Parts of a frame that are submitted together: two substeps.
const PARTS: usize = 14;
/// Least room for left-over blocks.
const LEAST_ROOM: u32 = 256;
/// Bytes of what is kept of a pair, and of its points.
const OLD_PAIR_BYTES: u64 = 32;
const OLD_POINTS_BYTES: u64 = 4 * 32;

/// The bodies and the contacts of a world on a device.
#[derive(Debug)]
pub(crate) struct GpuWorld {
    frame: GpuFrame,
    search: Search,
    assembly: Assembly,
    /// The bodies at the start of the frame.
    backup: wgpu::Buffer,
    counts: wgpu::Buffer,
    report: wgpu::Buffer,
    row: FrameRow,
    /// Room for left-over blocks.
    left_over: u32,
    /// Frames that are still solved with impacts. Without any, a block that is hit makes the frame begin anew, so that nothing depends
    /// on this number.
    stormy: u32,
    /// The substep of the impulses that are kept, in s.
    substep: f32,
    /// Pairs that are kept.
    kept: u32,
}

/// What the search of a frame came to.
#[derive(Clone, Copy, Debug)]
struct Counts {
    candidates: u32,
    pairs: u32,
    /// Blocks without a colour after the last round.
    waiting: u32,
    /// First block of each colour, of the left-over ones, and their end.
    colours: [u32; COLOURS as usize + 2],
}

impl GpuWorld {
    /// Uploads a world with what it remembers. `rows` has its bodies and colliders, without contacts.
    ///
    /// # Errors
    /// If the device has no buffers of that size.
    pub(crate) fn new(gpu: &Arc<RigidGpu>, world: &RigidWorld, rows: &FrameRows) -> Result<Self, String> {
        let bodies = world.bodies.len() as u32;
        let mut frame = gpu.frame(rows);
        frame.is_round = world.shapes.iter().any(Shape::is_round);
        let arrays = &mut frame.arrays;
        arrays.upload(SURFACES, cast_slice(&surface_rows(world)));
        arrays.make(OLD_STARTS, 4 * u64::from(bodies + 1));
        if !world.laws.is_empty() {
            let Laws { forces, base, time } = &world.laws;
            let text = forces.text_for_bodies().map_err(|error| error.to_string())?;
            arrays.laws = Some(gpu.law_kernel(&text));
            let numbers: Vec<f32> =
                base.to_array().into_iter().chain([*time]).chain(forces.parameters().iter().copied()).collect();
            arrays.upload(LAWS, cast_slice(&numbers));
        }
        frame.springs = springs::OnDevice::new(arrays, &world.springs, &rows.constants);
        frame.joints = joints::OnDevice::new(arrays, &world.joints, &world.with_mass());
        gpu.prepare(world, frame.arrays.kinds, [frame.is_round, frame.joints.is_grouped()]);
        let search = Search::new(gpu, world, 1.0 / 60.0, inputs(&frame.arrays));
        let reading = |words: u32| gpu.buffer("rigid counts", 4 * u64::from(words), wgpu::BufferUsages::MAP_READ);
        let mut this = Self {
            backup: gpu.storage(u64::from(bodies) * size_of::<BodyRow>() as u64),
            counts: reading(COUNT_WORDS),
            report: reading(REPORT_WORDS),
            row: FrameRow { gravity: world.gravity.to_array(), bodies, ..FrameRow::of_periods(&world.periods) },
            left_over: LEAST_ROOM,
            stormy: 0,
            substep: 0.0,
            kept: 0,
            assembly: Assembly::new(&mut frame.arrays, &search, Content::of(world)),
            frame,
            search,
        };
        this.make_arrays();
        this.put(world, rows)?;
        Ok(this)
    }

    /// The arrays that grow with the room for pairs, but for those of the search and the assembly.
    fn make_arrays(&mut self) {
        let room = u64::from(self.assembly.room);
        let arrays = &mut self.frame.arrays;
        arrays.make(OLD_PAIRS, OLD_PAIR_BYTES * room);
        arrays.make(OLD_POINTS, OLD_POINTS_BYTES * room);
        self.make_loads();
    }

    fn make_loads(&mut self) {
        let room = self.assembly.room as usize;
        let round_points = if self.frame.is_round { MOST_POINTS * room } else { 0 };
        self.frame.arrays.make(LOADS, loads_bytes(room, self.left_over as usize, round_points));
    }

    /// Takes over the states of the bodies of a world and what it remembers. Its bodies, colliders and shapes are those of the start.
    ///
    /// # Errors
    /// If the device has no buffers for what the world remembers.
    pub(crate) fn put(&mut self, world: &RigidWorld, rows: &FrameRows) -> Result<(), String> {
        let past = Past::of(world);
        if past.pairs.len() > self.assembly.room as usize {
            self.make_room(0, past.pairs.len() as u32)?;
        }
        let write = |binding: u32, bytes: &[u8]| self.gpu().queue.write_buffer(self.frame.arrays.get(binding), 0, bytes);
        write(BODIES, cast_slice(&rows.bodies));
        write(CONSTANTS, cast_slice(&rows.constants));
        write(SCALES, cast_slice(&scales_of(world)));
        write(OLD_STARTS, cast_slice(&past.starts));
        write(OLD_PAIRS, cast_slice(&past.pairs));
        write(OLD_POINTS, cast_slice(&past.points));
        self.frame.joints.put(&self.frame.arrays, &world.joints.states);
        (self.substep, self.kept) = (world.history.substep, past.pairs.len() as u32);
        Ok(())
    }

    /// Sets the states of the bodies from number 1 on, which have no mass.
    pub(crate) fn drive(&self, bodies: &[Body]) {
        let rows: Vec<BodyRow> = bodies.iter().map(BodyRow::without_mass).collect();
        let place = size_of::<BodyRow>() as u64;
        self.gpu().queue.write_buffer(self.frame.arrays.get(BODIES), place, cast_slice(&rows));
    }

    /// Takes over the muscles of the next frame.
    pub(crate) fn set_muscles(&mut self, muscles: &[MuscleWords]) {
        self.frame.springs.set_muscles(muscles);
    }

    /// Takes over the time of the next frame for the forces of the program, in s.
    pub(crate) fn set_law_time(&self, time: f32) {
        if self.frame.arrays.laws.is_some() {
            self.gpu().queue.write_buffer(self.frame.arrays.get(LAWS), 12, bytes_of(&time));
        }
    }

    /// Takes over the drives of the next frame. The joints are those of the start.
    pub(crate) fn set_drives(&self, joints: &[Joint]) {
        self.frame.joints.set_drives(&self.frame.arrays, joints);
    }

    /// Takes over the external forces and torques of the bodies in the rows of their constants.
    pub(crate) fn set_loads(&self, constants: &[ConstantRow]) {
        self.gpu().queue.write_buffer(self.frame.arrays.get(CONSTANTS), 0, cast_slice(constants));
        self.frame.springs.set_bases(&self.frame.arrays, constants);
    }

    fn gpu(&self) -> &Arc<RigidGpu> {
        &self.frame.arrays.gpu
    }

    /// Advances all bodies by a frame of `dt` seconds in `substeps` substeps, as the frames of the CPU do.
    ///
    /// # Errors
    /// What the device says if it is lost.
    pub(crate) fn advance(&mut self, dt: f32, substeps: u32, keeps_going: bool) -> Result<FrameReport, String> {
        let h = dt / substeps as f32;
        let mut repeats = 0;
        loop {
            let counts = self.search(dt, substeps)?;
            let is_calm = self.stormy == 0;
            let words = self.solve(&counts, if is_calm { Plan::Calm } else { Plan::Stages })?;
            if is_calm && words[7] > 0 {
                self.stormy = STORM;
                self.restore();
                continue;
            }
            if repeats < REPEATS && words[0] > 0 {
                self.widen(repeats);
                repeats += 1;
                continue;
            }
            let stopped = (words[1] > 0).then(|| (words[1], u32::MAX - words[2]));
            if stopped.is_some() && !keeps_going {
                self.restore();
                return Ok(FrameReport { repeats, stopped, ..FrameReport::default() });
            }
            self.stormy = self.stormy.saturating_sub(1);
            self.keep(&counts, h);
            if words[6] > 0 {
                self.frame.joints.release(&self.frame.arrays)?;
            }
            let (contacts, max_overlap, broken) = (words[4], f32::from_bits(words[5]), words[6]);
            return Ok(FrameReport { repeats, contacts, max_overlap, stopped, broken });
        }
    }

    /// Finds the contacts of a frame. Where there is too little room, there will be more.
    fn search(&mut self, dt: f32, substeps: u32) -> Result<Counts, String> {
        let h = dt / substeps as f32;
        let scale = if self.substep > 0.0 && self.substep != h { h / self.substep } else { 1.0 };
        let mut soft = FrameRow::softness_of_both(h);
        soft[0][3] = scale;
        // The assembly does not know yet how many blocks there are.
        self.row = FrameRow { h, substeps, soft, blocks: self.assembly.room, ..self.row };
        self.put_row();
        self.search.set_dt(dt);
        loop {
            let counts = self.find()?;
            let [candidates, pairs] = self.search.rooms();
            if counts.candidates <= candidates && counts.pairs <= pairs {
                return if counts.waiting > 0 { self.colour() } else { Ok(counts) };
            }
            self.make_room(counts.candidates, counts.pairs)?;
        }
    }

    /// The search and the assembly. Where blocks still wait for a colour, they are not yet in their last order.
    fn find(&mut self) -> Result<Counts, String> {
        let mut encoder = self.encoder();
        encoder.copy_buffer_to_buffer(self.frame.arrays.get(BODIES), 0, &self.backup, 0, self.backup.size());
        self.frame.joints.save(&self.frame.arrays, &mut encoder);
        self.search.encode(&mut encoder);
        self.gpu().queue.submit([encoder.finish()]);
        let mut encoder = self.encoder();
        let arrays = &self.frame.arrays;
        self.assembly.clear(arrays, &mut encoder);
        self.encode(&mut encoder, |pass| {
            self.assembly.encode_blocks(arrays, pass);
            self.assembly.encode_rounds(arrays, pass, 0..ROUNDS);
            self.assembly.encode_order(arrays, pass, false);
        });
        self.read_counts(encoder)
    }

    /// As many more rounds of colours as it takes, then the order that comes of them.
    fn colour(&self) -> Result<Counts, String> {
        let arrays = &self.frame.arrays;
        let mut rounds = ROUNDS;
        loop {
            let more = (rounds + ROUNDS).min(MOST_ROUNDS);
            let mut encoder = self.encoder();
            encoder.clear_buffer(arrays.get(COUNTS), 4 * 8, Some(4));
            self.encode(&mut encoder, |pass| {
                self.assembly.encode_rounds(arrays, pass, rounds..more);
                self.assembly.encode_order(arrays, pass, more == MOST_ROUNDS);
            });
            let counts = self.read_counts(encoder)?;
            if counts.waiting == 0 || more == MOST_ROUNDS {
                return Ok(counts);
            }
            rounds = more;
        }
    }

    fn read_counts(&self, mut encoder: wgpu::CommandEncoder) -> Result<Counts, String> {
        let size = 4 * u64::from(COUNT_WORDS);
        encoder.copy_buffer_to_buffer(self.frame.arrays.get(COUNTS), 0, &self.counts, 0, size);
        let words: Vec<u32> = self.gpu().submit_and_read(encoder, &self.counts, size)?;
        let mut colours = [0; COLOURS as usize + 2];
        colours.copy_from_slice(&words[16..16 + COLOURS as usize + 2]);
        Ok(Counts { candidates: words[0], pairs: words[1], waiting: words[8], colours })
    }

    /// Solves all substeps and reads the report.
    fn solve(&mut self, counts: &Counts, plan: Plan) -> Result<Vec<u32>, String> {
        let blocks = counts.colours[COLOURS as usize + 1];
        self.row.blocks = blocks;
        self.row.left_over = counts.colours[COLOURS as usize];
        self.row.colours[..COLOURS as usize + 2].copy_from_slice(&counts.colours);
        let left_over = blocks - self.row.left_over;
        if left_over > self.left_over {
            self.left_over = with_spare(left_over);
            self.make_loads();
        }
        self.put_row();
        self.frame.begin(&self.row);
        let mut encoder = self.encoder();
        encoder.clear_buffer(self.frame.arrays.get(REPORT), 0, None);
        for parts in self.frame.parts(plan).chunks(PARTS) {
            // The device begins while the rest is encoded.
            self.encode(&mut encoder, |pass| parts.iter().for_each(|part| self.frame.encode(pass, *part)));
            let done = std::mem::replace(&mut encoder, self.encoder());
            self.gpu().queue.submit([done.finish()]);
        }
        self.encode(&mut encoder, |pass| self.frame.arrays.dispatch(pass, SUM_UP, counts.pairs, 0));
        let size = 4 * u64::from(REPORT_WORDS);
        encoder.copy_buffer_to_buffer(self.frame.arrays.get(REPORT), 0, &self.report, 0, size);
        self.gpu().submit_and_read(encoder, &self.report, size)
    }

    /// Keeps what a frame has come to.
    fn keep(&mut self, counts: &Counts, h: f32) {
        let arrays = &self.frame.arrays;
        let mut encoder = self.encoder();
        self.encode(&mut encoder, |pass| {
            arrays.dispatch(pass, CALM, self.row.bodies, 0);
            arrays.dispatch(pass, STORE, counts.pairs.max(self.row.bodies + 1), 0);
        });
        self.gpu().queue.submit([encoder.finish()]);
        (self.substep, self.kept) = (h, counts.pairs);
    }

    /// Widens the margins of bodies whose path has left them, and goes back to the start of the frame.
    fn widen(&mut self, repeats: u32) {
        let arrays = &self.frame.arrays;
        let mut encoder = self.encoder();
        self.encode(&mut encoder, |pass| {
            arrays.dispatch(pass, WIDEN, self.row.bodies, call(0, repeats >= 3));
        });
        self.gpu().queue.submit([encoder.finish()]);
        self.restore();
    }

    /// Goes back to the start of the frame.
    fn restore(&self) {
        let bodies = self.frame.arrays.get(BODIES);
        let mut encoder = self.encoder();
        encoder.copy_buffer_to_buffer(&self.backup, 0, bodies, 0, self.backup.size());
        self.frame.joints.restore(&self.frame.arrays, &mut encoder);
        self.gpu().queue.submit([encoder.finish()]);
    }

    fn copy(&self, from: &wgpu::Buffer, to: &wgpu::Buffer) {
        let mut encoder = self.encoder();
        encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size().min(to.size()));
        self.gpu().queue.submit([encoder.finish()]);
    }

    fn put_row(&self) {
        self.gpu().queue.write_buffer(self.frame.arrays.get(0), 0, bytes_of(&self.row));
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, stages: impl FnOnce(&mut wgpu::ComputePass<'_>)) {
        stages(&mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()));
    }

    /// Room for so many candidates and pairs.
    fn make_room(&mut self, candidates: u32, pairs: u32) -> Result<(), String> {
        if !self.search.grow(candidates, pairs) {
            return Err(format!("it has no buffers for {} contacts", candidates.max(pairs)));
        }
        let arrays = &mut self.frame.arrays;
        let old = [OLD_PAIRS, OLD_POINTS].map(|binding| arrays.get(binding).clone());
        self.assembly = Assembly::new(arrays, &self.search, self.assembly.content);
        self.make_arrays();
        for (old, binding) in old.iter().zip([OLD_PAIRS, OLD_POINTS]) {
            self.copy(old, self.frame.arrays.get(binding));
        }
        Ok(())
    }

    /// Writes the states of the bodies and of the joints to a world.
    ///
    /// # Errors
    /// What the device says if it is lost.
    pub(crate) fn download(&self, world: &mut RigidWorld) -> Result<(), String> {
        let arrays = &self.frame.arrays;
        let rows: Vec<BodyRow> = arrays.read(BODIES, self.row.bodies)?;
        let scales: Vec<f32> = arrays.read(SCALES, 4 * self.row.bodies)?;
        let (scales, periods) = scales.split_at(rows.len());
        let states = world.bodies.iter_mut().zip(&rows).zip(scales).zip(periods.chunks_exact(3));
        for (((body, row), scale), periods) in states.filter(|(((body, _), _), _)| body.kind != Kind::World) {
            body.pose.position = Vec3::from_array(row.position);
            body.pose.turn = Quat::from_array(row.turn);
            if body.inverse_mass > 0.0 && body.kind == Kind::Dynamic {
                (body.velocity, body.spin, body.momentum) = (row.velocity.into(), row.spin.into(), row.momentum.into());
                body.inverse_inertia = tensor(row);
                body.margin_scale = *scale;
                body.periods = Vec3::from_slice(periods).as_ivec3();
            }
        }
        world.joints.states = self.frame.joints.read(arrays)?;
        Ok(())
    }

    /// Writes to a world what is remembered of its contacts.
    ///
    /// # Errors
    /// What the device says if it is lost.
    pub(crate) fn download_history(&self, world: &mut RigidWorld) -> Result<(), String> {
        let arrays = &self.frame.arrays;
        let past = Past {
            starts: arrays.read(OLD_STARTS, self.row.bodies + 1)?,
            pairs: arrays.read(OLD_PAIRS, self.kept)?,
            points: arrays.read(OLD_POINTS, 4 * self.kept)?,
        };
        world.history = past.history(self.substep);
        Ok(())
    }
}

fn inputs(arrays: &Arrays) -> Inputs {
    let [frame, bodies, constants, colliders, hulls, apart] =
        [0, BODIES, CONSTANTS, COLLIDERS, HULLS, APART].map(|binding| arrays.get(binding).clone());
    Inputs { frame, bodies, constants, colliders, hulls, apart }
}

fn tensor(row: &BodyRow) -> Mat3 {
    let ([xx, yy, zz], [xy, xz, yz]) = (row.diagonal, row.beside);
    Mat3::from_cols(Vec3::new(xx, xy, xz), Vec3::new(xy, yy, yz), Vec3::new(xz, yz, zz))
}

/// A quarter more, so that there is seldom need for more.
fn with_spare(count: u32) -> u32 {
    count.saturating_add(count / 4).max(LEAST_ROOM)
}

/// The number of materials, 0; then the constants of each two materials.
fn surface_rows(world: &RigidWorld) -> Vec<[f32; 2]> {
    let surfaces = world.surfaces.iter().map(|surface| [surface.friction, surface.restitution]);
    std::iter::once([world.materials as f32, 0.0]).chain(surfaces).collect()
}
