//! The buffers that shaders read: those of the physics, or copies of the host's arrays on the CPU backend.

use rockfall::model::buffer::Buffer;
use rockfall::model::step::Step;
use rockfall::{Result, Scene, Simulation, wgpu};

use crate::draw::layouts::STORAGE;
use crate::draw::looks::Looks;

/// The buffers of the physics that shaders read, in the order of their bindings: state, orientations, topology.
const PHYSICS_BUFFERS: [Buffer; 3] = [Buffer::Start, Buffer::Orientations, Buffer::Topology];

/// The buffers of bind group 0.
#[derive(Debug, Default)]
pub(crate) struct SceneBuffers {
    /// State, orientations, topology.
    physics: Vec<wgpu::Buffer>,
    /// Positions and orientations to blend from.
    old: Vec<wgpu::Buffer>,
    /// One value per sphere, by memory slot, then the colours of rods, springs, boxes and polygons, or
    /// those of rods and the tensions of springs and tethers.
    values: Option<wgpu::Buffer>,
    /// One bit per sphere, by insertion index, then from a new word on one bit per rod: whether it is part of a capsule; then the
    /// looks, if an object has one.
    capsule_bits: Option<wgpu::Buffer>,
    /// For each box, then for each polygon, whether it is drawn.
    drawn: Option<wgpu::Buffer>,
    /// Whether an object has a look.
    pub(crate) has_looks: bool,
    /// Whether an object is of glass.
    pub(crate) has_glass: bool,
    /// Most corners of triangles of a box or hull of a rigid body.
    pub(crate) block_corners: u32,
    /// Memory version of the simulation when the buffers were allocated.
    allocated_version: Option<u64>,
    /// Memory version of the simulation when `old` was copied.
    old_version: Option<u64>,
    /// The buffers that `group` binds.
    bound: Vec<wgpu::Buffer>,
    pub(crate) group: Option<wgpu::BindGroup>,
}

const STORED: wgpu::BufferUsages =
    wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_DST).union(wgpu::BufferUsages::COPY_SRC);

fn make(device: &wgpu::Device, label: &str, bytes: u64) -> wgpu::Buffer {
    // WebGPU cannot bind an empty buffer.
    let size = bytes.next_multiple_of(16).max(16);
    device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage: STORED, mapped_at_creation: false })
}

impl SceneBuffers {
    /// Whether objects were added or removed since the buffers were allocated.
    pub(crate) fn is_stale(&self, simulation: &Simulation) -> bool {
        self.allocated_version != Some(simulation.memory_version())
    }

    /// Uploads which spheres and rods belong to capsules, and the looks of all objects.
    pub(crate) fn mark(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene) {
        let counts = scene.counts();
        let rods_at = counts.spheres.div_ceil(32);
        let mut bits = vec![0_u32; rods_at + counts.rods.div_ceil(32)];
        let mut mark = |at: usize, index: usize| bits[at + index / 32] |= 1 << (index % 32);
        if counts.capsules > 0 {
            use std::collections::HashSet;
            let capsules = scene.capsules();
            let ends: HashSet<_> = capsules.iter().flat_map(|capsule| [capsule.end1, capsule.end2]).collect();
            let rods: HashSet<_> = capsules.iter().map(|capsule| capsule.rod).collect();
            scene.sphere_ids().zip(0..).filter(|(id, _)| ends.contains(id)).for_each(|(_, index)| mark(0, index));
            scene.rod_ids().zip(0..).filter(|(id, _)| rods.contains(id)).for_each(|(_, index)| mark(rods_at, index));
        }
        let of_hulls = scene.shapes().iter().flat_map(|shape| &shape.hulls).map(|hull| 3 * hull.triangles().count());
        self.block_corners = of_hulls.fold(36, usize::max) as u32;
        let looks = Looks::of(scene);
        (self.has_looks, self.has_glass) = (!looks.words.is_empty(), looks.glass);
        bits.extend(looks.words);
        let bytes: &[u8] = bytemuck::cast_slice(&bits);
        let capsule_bits = make(device, "capsules", bytes.len() as u64);
        queue.write_buffer(&capsule_bits, 0, bytes);
        self.capsule_bits = Some(capsule_bits);
    }

    /// Creates the buffers that suit the objects of the scene.
    pub(crate) fn allocate(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, simulation: &Simulation) {
        let counts = simulation.scene().counts();
        let coloured = counts.spheres + counts.rods + counts.springs + counts.boxes + counts.polygons + counts.tethers;
        self.values = Some(make(device, "values", 4 * coloured as u64));
        let [positions, orientations] = ["old positions", "old orientations"];
        self.old = [positions, orientations].map(|label| make(device, label, 16 * counts.spheres as u64)).to_vec();
        self.drawn = Some(make(device, "drawn", 4 * (counts.boxes + counts.polygons) as u64));
        self.set_drawn(queue, &vec![1; counts.boxes + counts.polygons]);
        self.old_version = None;
        self.allocated_version = Some(simulation.memory_version());
    }

    /// Takes the buffers of the present state, or uploads it, and returns its uniform block, which describes the buffers. An
    /// array that is split into several buffers is an error.
    pub(crate) fn update(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, simulation: &Simulation) -> Result<Step> {
        if let Some(view) = simulation.gpu_view() {
            self.physics = PHYSICS_BUFFERS.into_iter().map(|buffer| view.buffer(buffer).cloned()).collect::<Result<_>>()?;
            return Ok(*view.step());
        }
        let Some(world) = simulation.cpu_view() else {
            return Ok(Step::default());
        };
        self.physics.resize_with(PHYSICS_BUFFERS.len(), || make(device, "empty", 0));
        for (copy, buffer) in self.physics.iter_mut().zip(PHYSICS_BUFFERS) {
            let bytes = world.bytes(buffer);
            if copy.size() < bytes.len() as u64 {
                *copy = make(device, buffer.label(), bytes.len() as u64);
            }
            queue.write_buffer(copy, 0, bytes);
        }
        Ok(world.step)
    }

    /// Uploads the values of the spheres, which are given in insertion order.
    pub(crate) fn set_values(&self, queue: &wgpu::Queue, simulation: &Simulation, values: impl ExactSizeIterator<Item = f32>) {
        let mut by_slot = vec![0.0_f32; values.len()];
        for (index, value) in values.enumerate() {
            by_slot[simulation.slot(index)] = value;
        }
        if let Some(buffer) = &self.values {
            queue.write_buffer(buffer, 0, bytemuck::cast_slice(&by_slot));
        }
    }

    /// Uploads what follows the values of the spheres: the colours of rods, springs, boxes and polygons, or the tensions of springs
    /// and tethers after as many zeros as there are rods, each in insertion order.
    pub(crate) fn set_colours(&self, queue: &wgpu::Queue, spheres: usize, colours: &[f32]) {
        if let Some(buffer) = self.values.as_ref().filter(|_| !colours.is_empty()) {
            queue.write_buffer(buffer, 4 * spheres as u64, bytemuck::cast_slice(colours));
        }
    }

    /// Uploads whether each box and then each polygon is drawn, in insertion order.
    pub(crate) fn set_drawn(&self, queue: &wgpu::Queue, drawn: &[u32]) {
        if let Some(buffer) = &self.drawn {
            queue.write_buffer(buffer, 0, bytemuck::cast_slice(drawn));
        }
    }

    /// Returns the buffer of the present state.
    pub(crate) fn state(&self) -> Option<&wgpu::Buffer> {
        self.physics.first()
    }

    pub(crate) fn remember(&mut self, encoder: &mut wgpu::CommandEncoder, spheres: u32) {
        let bytes = 16 * u64::from(spheres);
        for (from, to) in self.physics.iter().zip(&self.old) {
            if bytes > 0 {
                encoder.copy_buffer_to_buffer(from, 0, to, 0, bytes);
            }
        }
        self.old_version = self.allocated_version;
    }

    /// Whether there is a state to blend from whose spheres are in the present memory order.
    pub(crate) fn can_blend(&self) -> bool {
        self.old_version.is_some() && self.old_version == self.allocated_version
    }

    /// Returns the storage buffers of group 0 in the order of their bindings, which start at 1.
    pub(crate) fn bound_buffers(&self) -> &[wgpu::Buffer] {
        &self.bound
    }

    /// Creates the bind group if the buffers have changed, and returns whether they have.
    pub(crate) fn bind(&mut self, device: &wgpu::Device, layout: &wgpu::BindGroupLayout, uniform: &wgpu::Buffer) -> bool {
        let own = self.old.iter().chain(&self.values).chain(&self.capsule_bits).chain(&self.drawn);
        let buffers: Vec<wgpu::Buffer> = self.physics.iter().chain(own).cloned().collect();
        if buffers == self.bound && self.group.is_some() || buffers.len() != STORAGE as usize {
            return false;
        }
        let uniform = wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() };
        let storage = (1..).zip(&buffers);
        let storage = storage.map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        let entries: Vec<_> = [uniform].into_iter().chain(storage).collect();
        self.group =
            Some(device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("bodies"), layout, entries: &entries }));
        self.bound = buffers;
        true
    }
}
