//! The backend of a simulation: one interface for the CPU and the GPU.

use std::future::Future;
use std::ops::Range;
#[cfg(all(feature = "gpu", any(test, feature = "mpi")))]
use std::sync::Arc;

use crate::error::Result;
use crate::exec::cpu;
use crate::model::status::Status;
use crate::model::world::World;
use crate::options::{Backend, BackendInfo, Options};
use crate::profile::Recorder;
#[cfg(feature = "gpu")]
use crate::settings::ContactLaw;
use crate::step::fused::small_positions::{stages_before, update_positions};
use crate::step::schedule::Run;
use crate::user_laws::set::UserLaws;

#[cfg(all(feature = "gpu", any(test, feature = "mpi")))]
use crate::exec::gpu::share::Link;
#[cfg(feature = "gpu")]
use crate::exec::gpu::{Gpu, GpuWorld, Mapped};
#[cfg(feature = "gpu")]
use crate::model::buffer::Buffer;

/// The backend that runs the stages.
#[derive(Debug)]
pub(super) enum Engine {
    /// Runs on the host, on the simulation's own [`World`]. The frames of the contact law `rigid` may run on a device.
    Cpu(FrameDevice),
    /// Runs on a device, on buffers of the same layout.
    #[cfg(feature = "gpu")]
    Gpu(Box<GpuWorld>),
}

/// The status after submitted steps.
#[derive(Debug)]
pub(super) enum PendingStatus {
    /// The steps are done and the status is known.
    Known(Box<Status>),
    /// The status has yet to arrive from the device.
    #[cfg(feature = "gpu")]
    Pending(Mapped),
}

impl PendingStatus {
    /// Waits for the status if it is still pending, and returns it.
    pub(super) async fn status(self) -> Result<Status> {
        match self {
            Self::Known(status) => Ok(*status),
            #[cfg(feature = "gpu")]
            Self::Pending(status) => Ok(bytemuck::pod_read_unaligned(&status.bytes("the status").await?)),
        }
    }
}

/// The device that a blocking call polls while it waits; `None` on the CPU.
#[cfg(feature = "gpu")]
pub(super) type Waiter = Option<wgpu::Device>;
/// The device that a blocking call polls while it waits: always `None` without the GPU.
#[cfg(not(feature = "gpu"))]
pub(super) type Waiter = Option<std::convert::Infallible>;

/// The device on which frames of the contact law `rigid` run, if one does.
#[cfg(feature = "gpu")]
pub(super) type FrameDevice = Option<Gpu>;
/// The device on which frames of the contact law `rigid` run: none without the GPU.
#[cfg(not(feature = "gpu"))]
pub(super) type FrameDevice = Option<std::convert::Infallible>;

/// Runs an action on the device. The CPU backend runs on the host's world itself and has nothing to do.
macro_rules! on_gpu {
    ($engine:expr, $input:ident, $gpu:ident => $action:expr) => {{
        match $engine {
            Self::Cpu(_) => {}
            #[cfg(feature = "gpu")]
            Self::Gpu($gpu) => $action,
        }
        // Without the GPU, the input is unused.
        let _ = $input;
        Ok(())
    }};
}

/// Number of spheres and rods up to which [`Backend::Auto`] chooses the CPU: launching the stages of a step on a GPU then takes longer
/// than computing it. Measured with 16 cores and an H200 (docs/performance.md). A browser has one thread, but learns milliseconds late
/// that a GPU has finished, and pages run a few steps per picture (docs/browser.md).
#[cfg(feature = "gpu")]
const FEW: u32 = if cfg!(target_family = "wasm") { 128 } else { 64 };
/// The same for the contact law `rigid`, in the time that a sphere takes.
#[cfg(feature = "gpu")]
const FEW_OF_RIGID: u32 = 2000;
/// The time that a box of a body takes, which has up to eight contacts with another one, in that of a sphere.
#[cfg(feature = "gpu")]
const TIME_OF_BOX: u32 = 21;

impl Engine {
    #[cfg(feature = "gpu")]
    pub(super) async fn open(options: &Options, world: &World) -> Result<(Self, BackendInfo)> {
        let is_rigid = world.step.layout.law == ContactLaw::Rigid.number();
        let few = if is_rigid { FEW_OF_RIGID } else { FEW };
        let load = world.movers() + (TIME_OF_BOX - 1) * world.boxes_of_bodies();
        if options.backend == Backend::Auto && (1..=few).contains(&load) {
            return Ok((Self::Cpu(None), cpu_info(&format!("it is faster than a GPU for up to {few} spheres and rods"))));
        }
        if is_rigid && cfg!(target_family = "wasm") {
            return Ok((Self::Cpu(None), cpu_info("the contact law rigid in a browser")));
        }
        match open_device(options).await? {
            (Some(gpu), info) => Ok((Self::on(&gpu, world)?, info)),
            (None, info) => Ok((Self::Cpu(None), info)),
        }
    }

    #[cfg(not(feature = "gpu"))]
    pub(super) async fn open(options: &Options, _world: &World) -> Result<(Self, BackendInfo)> {
        const WITHOUT: &str = "this build of rockfall does not have the gpu feature";
        match options.backend {
            Backend::Cpu => Ok((Self::Cpu(None), cpu_info("requested"))),
            Backend::Auto => Ok((Self::Cpu(None), cpu_info(WITHOUT))),
            Backend::Gpu => Err(crate::Error::NoAdapter(WITHOUT.to_owned())),
        }
    }

    #[cfg(feature = "gpu")]
    pub(super) fn on_device(device: &wgpu::Device, queue: &wgpu::Queue, world: &World) -> Result<(Self, BackendInfo)> {
        let gpu = Gpu::on_device(device.clone(), queue.clone());
        Ok((Self::on(&gpu, world)?, gpu_info(&gpu, "the caller's device")))
    }

    #[cfg(feature = "gpu")]
    pub(super) fn on(gpu: &Gpu, world: &World) -> Result<Self> {
        if world.step.layout.law == ContactLaw::Rigid.number() {
            return Ok(Self::Cpu(Some(gpu.clone())));
        }
        Ok(Self::Gpu(Box::new(GpuWorld::new(gpu, world)?)))
    }

    /// The device on which frames of the contact law `rigid` run, if one does.
    #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
    pub(super) fn frame_device(&self) -> Option<&Gpu> {
        match self {
            Self::Cpu(device) => device.as_ref(),
            Self::Gpu(_) => None,
        }
    }

    pub(super) fn waiter(&self) -> Waiter {
        match self {
            Self::Cpu(_) => None,
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => Some(gpu.gpu().device().clone()),
        }
    }

    /// Checks that this backend was opened for frames of the contact law `rigid`, or for steps.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) if a device was opened for the others.
    pub(super) fn check_frames(&self, is_rigid: bool) -> Result<()> {
        let fits = match self {
            Self::Cpu(device) => is_rigid || device.is_none(),
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => !is_rigid,
        };
        let expected = "the law of the start: on a GPU, rigid and other laws do not replace each other";
        let value = if is_rigid { "rigid" } else { "another law after rigid" }.to_owned();
        if fits { Ok(()) } else { Err(crate::Error::Invalid { field: "contact_law", value, expected }) }
    }

    /// Checks that this backend can evaluate the program's laws.
    pub(super) fn check_laws(&self, laws: &UserLaws) -> Result<()> {
        on_gpu!(self, laws, _gpu => laws.kernel_text().map(drop)?)
    }

    /// Whether a stage costs a dispatch even when it has no work.
    pub(super) fn dispatches(&self) -> bool {
        !matches!(self, Self::Cpu(_))
    }

    /// Gives the world on the device the rows that other processes need.
    #[cfg(all(feature = "gpu", any(test, feature = "mpi")))]
    pub(super) fn set_link(&mut self, link: Arc<Link>) {
        if let Self::Gpu(gpu) = self {
            gpu.set_link(link);
        }
    }

    /// The world on the device.
    #[cfg(feature = "gpu")]
    pub(super) fn gpu_world(&self) -> Option<&GpuWorld> {
        match self {
            Self::Cpu(_) => None,
            Self::Gpu(gpu) => Some(gpu),
        }
    }

    /// Runs `stages` once, starting with the status of `world`, and reads the status back into `world`.
    pub(super) async fn run(&mut self, world: &mut World, stages: &[Run]) -> Result<()> {
        self.begin(world)?;
        world.status = self.submit(world, stages, 0..1, None).await?.status().await?;
        Ok(())
    }

    /// Compiles the kernels that these stages need.
    pub(super) fn prepare(&mut self, stages: &[Run]) -> Result<()> {
        on_gpu!(self, stages, gpu => gpu.prepare_plain(stages)?)
    }

    /// Sets the engine's status to that of `world`.
    pub(super) fn begin(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.set_status(&world.status)?)
    }

    /// Runs `stages` for `steps`, numbered as in [`Run::is_in`], or until a step is rejected that only the host can repeat. With a recorder every stage is
    /// timed, and the call waits for the steps.
    pub(super) async fn submit(
        &mut self,
        world: &mut World,
        stages: &[Run],
        steps: Range<u32>,
        recorder: Option<&mut Recorder>,
    ) -> Result<PendingStatus> {
        match (self, recorder) {
            (Self::Cpu(_), recorder) => {
                run_on_cpu(world, stages, steps, recorder);
                Ok(PendingStatus::Known(Box::new(world.status)))
            }
            #[cfg(feature = "gpu")]
            (Self::Gpu(gpu), None) => Ok(PendingStatus::Pending(gpu.run_and_read_status(stages, &world.step, steps)?)),
            #[cfg(feature = "gpu")]
            (Self::Gpu(gpu), Some(recorder)) => {
                let timer = gpu.run_timed(stages, &world.step, steps)?;
                let before = std::mem::replace(&mut world.status, gpu.read_status().await?);
                let done = world.status.steps.wrapping_sub(before.steps);
                recorder.book(stages, &timer.read(stages).await?, done, &world.step, &world.status);
                Ok(PendingStatus::Known(Box::new(world.status)))
            }
        }
    }

    /// Adds to a world the scratch arrays of the CPU backend. A device has scratch buffers of its own.
    pub(super) fn complete(&self, world: &mut World) {
        match self {
            Self::Cpu(_) => world.add_scratch(),
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => {}
        }
    }

    /// Uploads a world that was packed again, or whose lists have a new capacity and are invalid.
    pub(super) fn replace(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.upload(world)?)
    }

    /// Resizes the lists on the device to the capacity of the world's lists. Their contents become invalid.
    pub(super) fn resize_lists(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.resize_lists(world)?)
    }

    /// Resizes the buffers of listed collisions on the device to the capacity of the world.
    pub(super) fn resize_collisions(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.resize_collisions(world)?)
    }

    /// Uploads the topology buffer after a change, with the offsets in the uniform block.
    pub(super) fn upload_topology(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.upload_topology(world)?)
    }

    /// Uploads the state of the spheres and rigid bodies after a change.
    pub(super) fn upload_spheres(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => {
            gpu.upload_buffer(world, Buffer::Start)?;
            gpu.upload_buffer(world, Buffer::Orientations)?;
            gpu.upload_buffer(world, Buffer::RigidBodies)?;
        })
    }

    /// Uploads the poses of moving walls, for the steps that are submitted next.
    pub(super) fn upload_poses(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => {
            if !world.poses.is_empty() {
                gpu.upload_buffer(world, Buffer::Poses)?;
            }
        })
    }

    /// Reads the topology buffer back into `world`.
    pub(super) async fn download_topology(&mut self, world: &mut World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.download(world, &[Buffer::Topology]).await?)
    }

    /// Resizes the springs of contacts on the device to the size of those of the world, and uploads them.
    pub(super) fn resize_histories(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.resize_histories(world)?)
    }

    /// Reads the springs of contacts back into `world`.
    pub(super) async fn download_histories(&mut self, world: &mut World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.download(world, &[Buffer::Histories]).await?)
    }

    /// Reads the rates of velocity Verlet back into `world`.
    pub(super) async fn download_rates(&mut self, world: &mut World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.download(world, &[Buffer::Rates]).await?)
    }

    /// Reads the state of the spheres and rigid bodies back into `world`.
    pub(super) async fn download_spheres(&mut self, world: &mut World) -> Result<()> {
        on_gpu!(self, world, gpu => {
            gpu.download(world, &[Buffer::Start, Buffer::Orientations, Buffer::RigidBodies, Buffer::Servos]).await?;
        })
    }
}

/// Opens the GPU that the options ask for; `None` for the CPU.
#[cfg(feature = "gpu")]
pub(super) async fn open_device(options: &Options) -> Result<(Option<Gpu>, BackendInfo)> {
    let (gpu, reason) = match options.backend {
        Backend::Cpu if options.device.is_some() => {
            let value = options.device.unwrap_or_default().to_string();
            return Err(crate::Error::Invalid { field: "device", value, expected: "no device with the backend cpu" });
        }
        _ if options.device.is_some() => (Gpu::open_number(options.device.unwrap_or_default()).await?, "requested"),
        Backend::Cpu => return Ok((None, cpu_info("requested"))),
        Backend::Gpu => (Gpu::open(true).await?, "requested"),
        Backend::Auto => match Gpu::open(false).await {
            Ok(gpu) => (gpu, "the best hardware GPU"),
            Err(crate::Error::NoAdapter(_)) => return Ok((None, cpu_info("no hardware GPU was found"))),
            Err(error) => return Ok((None, cpu_info(&format!("no GPU could be opened: {error}")))),
        },
    };
    let info = gpu_info(&gpu, reason);
    Ok((Some(gpu), info))
}

fn run_on_cpu(world: &mut World, stages: &[Run], steps: Range<u32>, recorder: Option<&mut Recorder>) {
    let (before, mut times, timed) = (world.status.steps, Vec::new(), recorder.is_some());
    // The steps start inside the pool, because waking a pool thread in every stage costs more than a step of a small scene.
    rayon::scope(|_| {
        let before_positions = stages_before(world, stages).filter(|_| !timed);
        for _ in steps {
            let repeats = world.status.repeats;
            if timed {
                times.push(cpu::run_timed(world, stages));
            } else if let Some(count) = before_positions {
                cpu::run(world, &stages[..count]);
                update_positions(world);
            } else {
                cpu::run(world, stages);
            }
            // The step was rejected, or it only built the lists with which the next step repeats the rejected one. The host
            // decides how to go on.
            if world.status.rejected != 0 || world.status.repeats != repeats {
                break;
            }
            if let Some(rest) = &mut world.rest {
                rest.note(&world.states[0]);
            }
        }
    });
    if let Some(recorder) = recorder {
        let done = world.status.steps.wrapping_sub(before);
        recorder.book(stages, &times, done, &world.step, &world.status);
    }
}

fn cpu_info(reason: &str) -> BackendInfo {
    let threads = rayon::current_num_threads();
    let plural = if threads == 1 { "" } else { "s" };
    BackendInfo {
        kind: Backend::Cpu,
        device: format!("CPU, {threads} thread{plural}"),
        driver: String::new(),
        reason: reason.to_owned(),
    }
}

#[cfg(feature = "gpu")]
fn gpu_info(gpu: &Gpu, reason: &str) -> BackendInfo {
    let info = gpu.info();
    let software = if gpu.is_software() { ", software" } else { "" };
    BackendInfo {
        kind: Backend::Gpu,
        device: format!("{} ({}{software})", if info.name.is_empty() { "unnamed" } else { &info.name }, info.backend),
        driver: crate::devices::driver(&info),
        reason: reason.to_owned(),
    }
}

/// Drives a future to completion on this thread.
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
pub(super) fn block_on<T>(waiter: Waiter, future: impl Future<Output = Result<T>>) -> Result<T> {
    match waiter {
        Some(device) => crate::exec::gpu::block_on(&device, future),
        None => crate::exec::gpu::drive(future, || {
            std::thread::yield_now();
            Ok(())
        })?,
    }
}

/// Polls a future once, because a browser cannot block. Nothing waits on the CPU backend, nor for a state that was read already.
///
/// # Errors
/// Those of the future, and [`Error::Device`](crate::Error::Device) when it waits for the device.
#[cfg(all(feature = "gpu", target_family = "wasm"))]
pub(super) fn block_on<T>(_waiter: Waiter, future: impl Future<Output = Result<T>>) -> Result<T> {
    const WAITS: &str =
        "a browser cannot block until the GPU is done: await the `_async` function first, for example sync_async";
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match std::pin::pin!(future).poll(&mut context) {
        std::task::Poll::Ready(value) => value,
        std::task::Poll::Pending => Err(crate::Error::Device(WAITS.to_owned())),
    }
}

/// Drives a future to completion on this thread. Without a device it never waits.
#[cfg(not(feature = "gpu"))]
pub(super) fn block_on<T>(_waiter: Waiter, future: impl Future<Output = Result<T>>) -> Result<T> {
    let mut future = std::pin::pin!(future);
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    loop {
        if let std::task::Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return value;
        }
    }
}
