//! A [`World`] on the GPU: its buffers.

use std::collections::HashMap;
use std::sync::Arc;

use bytemuck::bytes_of;

use crate::error::{Error, Result};
use crate::exec::gpu::array::Array;
use crate::exec::gpu::check::check_buffer;
use crate::exec::gpu::device::Gpu;
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::kernel::Kernel;
use crate::exec::gpu::memory::{UNIFORM, bytes_needed, check_sizes, chunk_bytes, make_buffer};
#[cfg(any(test, feature = "mpi"))]
use crate::exec::gpu::share::Link;
use crate::model::buffer::Buffer;
use crate::model::status::Status;
use crate::model::step::{Layout, Step};
use crate::model::world::World;
use crate::profile::BufferSize;
use crate::step::schedule::Run;
use crate::step::wgsl::Variant;
use crate::user_laws::set::KernelLaws;

/// What a world's buffers hold when a step begins; everything else is written before it is read.
const KEPT: [Buffer; 11] = [
    Buffer::Start,
    Buffer::Aabbs,
    Buffer::Topology,
    Buffer::Lists,
    Buffer::Orientations,
    Buffer::Histories,
    Buffer::Rates,
    Buffer::Poses,
    Buffer::RigidBodies,
    Buffer::Servos,
    Buffer::Status,
];

/// The buffers of a [`World`] on a device.
#[derive(Debug)]
pub struct GpuWorld {
    gpu: Gpu,
    pub(super) step: Step,
    pub(super) uniform: wgpu::Buffer,
    /// The blocks `pass_` that were needed so far, by pass.
    pub(super) passes: HashMap<u32, wgpu::Buffer>,
    arrays: Vec<Array>,
    /// The text of the program's laws, for kernels.
    pub(super) laws: KernelLaws,
    /// What was prepared: by stage and pass.
    pub(super) ready: HashMap<(&'static str, u32), (Arc<Kernel>, wgpu::BindGroup)>,
    /// Those that were submitted so far.
    pub(super) dispatches: u64,
    /// Takes the rows that other processes need from the early part of a step.
    #[cfg(any(test, feature = "mpi"))]
    pub(super) link: Option<Arc<Link>>,
}

impl GpuWorld {
    /// Makes the buffers of a world and fills them.
    ///
    /// # Errors
    /// [`Error::DeviceLimit`] when an array would be larger than the device allows (nothing is allocated then),
    /// [`Error::Device`] when memory runs out, the device is lost or its limits are too low, or the world's indices point
    /// outside of it.
    pub fn new(gpu: &Gpu, world: &World) -> Result<Self> {
        gpu.faults().check()?;
        gpu.check_limits()?;
        let device = gpu.device();
        let limits = device.limits();
        check_sizes(&limits, |buffer| bytes_needed(world, buffer))?;
        let uniform = make_buffer(device, "step", (size_of::<Step>() as u64).next_multiple_of(16), UNIFORM)?;
        let mut arrays = Vec::new();
        for buffer in Buffer::ALL {
            arrays.push(Array::new(device, buffer, bytes_needed(world, buffer), chunk_bytes(&limits))?);
        }
        let mut made = Self {
            gpu: gpu.clone(),
            step: world.step,
            uniform,
            passes: HashMap::new(),
            arrays,
            laws: world.user_laws.kernel_text()?,
            ready: HashMap::new(),
            dispatches: 0,
            #[cfg(any(test, feature = "mpi"))]
            link: None,
        };
        made.upload(world)?;
        Ok(made)
    }

    /// The device it lives on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// A buffer, for rendering and other kernels. It is replaced when an upload needs a larger one.
    ///
    /// # Errors
    /// [`Error::Device`] when the array is larger than one binding may be, so that it is stored in several buffers;
    /// [`GpuWorld::chunks`] returns them.
    pub fn buffer(&self, buffer: Buffer) -> Result<&wgpu::Buffer> {
        match self.chunks(buffer) {
            [whole] => Ok(whole),
            chunks => Err(Error::Device(format!(
                "{} is larger than one binding may be, so it is stored in {} buffers, which need a binding each; use fewer \
                 objects, or the CPU backend",
                buffer.label(),
                chunks.len()
            ))),
        }
    }

    /// The buffers of an array, one after the other: more than one where it is larger than the device's
    /// `max_storage_buffer_binding_size`. All have as many elements as the first but the last, which may have fewer.
    pub fn chunks(&self, buffer: Buffer) -> &[wgpu::Buffer] {
        self.array(buffer).chunks()
    }

    pub(super) fn array(&self, buffer: Buffer) -> &Array {
        &self.arrays[buffer as usize]
    }

    /// The size of every buffer.
    pub fn buffer_sizes(&self) -> Vec<BufferSize> {
        let uniforms = self.uniform.size() + self.passes.values().map(wgpu::Buffer::size).sum::<u64>();
        let storage = Buffer::ALL.map(|buffer| BufferSize::new(buffer.label(), self.array(buffer).size()));
        storage.into_iter().chain([BufferSize::new("the uniform blocks", uniforms)]).collect()
    }

    /// Dispatches that were submitted so far: what a small scene's step costs.
    pub fn dispatches(&self) -> u64 {
        self.dispatches
    }

    /// The uniform block of the last upload or run.
    pub fn step(&self) -> &Step {
        &self.step
    }

    /// Uploads all that a step begins with; scratch (stage states, wrenches) is left as it is, and so are AABBs that the world
    /// does not have. Lists that it does not have are empty after it. Buffers that are too small for the world, for example
    /// after [`World::set_pair_rows`], are made anew.
    ///
    /// # Errors
    /// As for [`GpuWorld::new`].
    pub fn upload(&mut self, world: &World) -> Result<()> {
        self.gpu.faults().check()?;
        for buffer in KEPT {
            check_buffer(world, buffer)?;
        }
        for buffer in Buffer::ALL {
            self.fit(world, buffer)?;
        }
        self.take_laws(world)?;
        if Variant::of(&world.step) != Variant::of(&self.step) {
            // They have kernels of their own.
            self.ready.clear();
        }
        self.step = world.step;
        for buffer in KEPT {
            self.write(buffer, world.bytes(buffer))?;
        }
        if world.lists.is_empty() {
            self.clear_lists()?;
        }
        self.write_uniforms(&world.step)
    }

    /// Uploads one buffer, scratch or not, of a world of the same counts, offsets and room for pairs.
    ///
    /// # Errors
    /// [`Error::Device`] when the world is another one or its indices point outside of it, or for the device's reasons.
    pub fn upload_buffer(&mut self, world: &World, buffer: Buffer) -> Result<()> {
        self.gpu.faults().check()?;
        if self.step.layout != world.step.layout {
            return Err(Error::Device("the world's counts or offsets changed: upload it as a whole".to_owned()));
        }
        check_buffer(world, buffer)?;
        self.fit(world, buffer)?;
        self.write(buffer, world.bytes(buffer))
    }

    /// Uploads words whose offsets in the uniform block may have changed; the counts of spheres and of objects, and the
    /// pair lists, are still the same.
    ///
    /// # Errors
    /// As for [`GpuWorld::upload_buffer`].
    pub fn upload_topology(&mut self, world: &World) -> Result<()> {
        self.gpu.faults().check()?;
        let counts = |step: &Step| {
            (step.layout.spheres, step.layout.rods, step.layout.boxes, step.layout.polygons, step.layout.pair_rows)
        };
        if counts(&world.step) != counts(&self.step) {
            return Err(Error::Device("the world's counts changed: upload it as a whole".to_owned()));
        }
        check_buffer(world, Buffer::Topology)?;
        if Variant::of(&world.step) != Variant::of(&self.step) {
            // A spring may have got the first muscle.
            self.ready.clear();
        }
        self.take_laws(world)?;
        self.fit(world, Buffer::Topology)?;
        self.write(Buffer::Topology, world.bytes(Buffer::Topology))?;
        for buffer in [Buffer::Servos, Buffer::ServoLoads] {
            self.fit(world, buffer)?;
        }
        self.write(Buffer::Servos, world.bytes(Buffer::Servos))?;
        if Variant::of(&world.step) != Variant::of(&self.step) {
            // They have kernels of their own.
            self.ready.clear();
        }
        self.step = world.step;
        self.write_uniforms(&world.step)
    }

    /// Takes over the program's laws.
    fn take_laws(&mut self, world: &World) -> Result<()> {
        let laws = world.user_laws.kernel_text()?;
        if laws != self.laws {
            // The kernels contain them.
            self.ready.clear();
            self.laws = laws;
        }
        Ok(())
    }

    /// Takes over the room for pairs of `world`, after [`World::set_pair_rows`]. The lists are empty after it.
    ///
    /// # Errors
    /// As for [`GpuWorld::new`].
    pub fn resize_lists(&mut self, world: &World) -> Result<()> {
        self.gpu.faults().check()?;
        let sized = Layout { pair_rows: world.step.layout.pair_rows, ..self.step.layout };
        self.take_sizes(world, sized, &[Buffer::Lists, Buffer::CollisionIndices])?;
        self.clear_lists()
    }

    /// Takes over the room for listed collisions of `world`.
    ///
    /// # Errors
    /// As for [`GpuWorld::new`].
    pub(crate) fn resize_collisions(&mut self, world: &World) -> Result<()> {
        self.gpu.faults().check()?;
        let sized = Layout { collision_room: world.step.layout.collision_room, ..self.step.layout };
        self.take_sizes(world, sized, &[Buffer::CollisionIndices, Buffer::Collisions])
    }

    /// Takes over the room for springs of contacts of `world`, and the springs.
    ///
    /// # Errors
    /// As for [`GpuWorld::new`].
    pub(crate) fn resize_histories(&mut self, world: &World) -> Result<()> {
        self.gpu.faults().check()?;
        check_buffer(world, Buffer::Histories)?;
        let sized = Layout { history_pool: world.step.layout.history_pool, ..self.step.layout };
        self.take_sizes(world, sized, &[Buffer::Histories])?;
        self.write(Buffer::Histories, world.bytes(Buffer::Histories))
    }

    /// Takes over the layout of `world`, which differs from the present one in the size of some buffers alone.
    fn take_sizes(&mut self, world: &World, sized: Layout, buffers: &[Buffer]) -> Result<()> {
        if sized != world.step.layout {
            return Err(Error::Device("the world's counts or offsets changed: upload it as a whole".to_owned()));
        }
        for buffer in buffers {
            self.fit(world, *buffer)?;
        }
        self.step.layout = sized;
        Ok(())
    }

    fn fit(&mut self, world: &World, buffer: Buffer) -> Result<()> {
        let needed = bytes_needed(world, buffer);
        if needed <= self.array(buffer).size() {
            return Ok(());
        }
        let limits = self.gpu.device().limits();
        check_sizes(&limits, |other| if other == buffer { needed } else { self.array(other).size() })?;
        self.ready.clear();
        // First, so that there is room for the new one.
        self.array(buffer).chunks().iter().for_each(wgpu::Buffer::destroy);
        let made = Array::new(self.gpu.device(), buffer, needed, chunk_bytes(&limits));
        if let Err(Error::Device(text)) = &made {
            // The old one is gone: whatever is asked of this world from now on is answered by this.
            self.gpu.faults().record(text.clone());
        }
        self.arrays[buffer as usize] = made?;
        Ok(())
    }

    /// Takes the constants and the list settings from `step`. The layout stays that of the upload, on which the kernels rely.
    ///
    /// # Errors
    /// [`Error::Device`] when the device is lost.
    pub fn write_uniforms(&mut self, step: &Step) -> Result<()> {
        let step = Step { layout: self.step.layout, ..*step };
        if Variant::of(&step) != Variant::of(&self.step) {
            // A setting has changed that kernels are compiled for.
            self.ready.clear();
        }
        self.step = step;
        catch(self.gpu.device(), || {
            self.gpu.queue().write_buffer(&self.uniform, 0, bytes_of(&self.step));
        })
    }

    /// Sets the status block. Where `REJECTED_PAIRS` is taken back, the broad phase must run before anything that reads lists.
    ///
    /// # Errors
    /// [`Error::Device`] when the device is lost.
    pub fn set_status(&mut self, status: &Status) -> Result<()> {
        catch(self.gpu.device(), || {
            for buffer in self.chunks(Buffer::Status) {
                self.gpu.queue().write_buffer(buffer, 0, bytes_of(status));
            }
        })
    }

    /// Whether a stage has nothing to do for this world, so that it is not dispatched.
    pub(crate) fn is_idle(&self, run: &Run) -> bool {
        run.workgroups(&self.step) == 0
    }
}
