//! The backend of a simulation, behind one set of calls.

use std::future::Future;
use std::ops::Range;

use crate::error::Result;
use crate::exec::cpu;
use crate::model::status::Status;
use crate::model::world::World;
use crate::options::{Backend, BackendInfo, Options};
use crate::profile::Recorder;
use crate::step::schedule::Run;

#[cfg(feature = "gpu")]
use crate::exec::gpu::{Gpu, GpuWorld, Mapped};
#[cfg(feature = "gpu")]
use crate::model::buffer::Buffer;

/// Where the stages run.
#[derive(Debug)]
pub(super) enum Engine {
    /// On the host, on the simulation's own [`World`].
    Cpu,
    /// On a device, on buffers of the same layout.
    #[cfg(feature = "gpu")]
    Gpu(Box<GpuWorld>),
}

/// The status after steps that were submitted.
#[derive(Debug)]
pub(super) enum Look {
    /// They are done.
    Known(Box<Status>),
    /// On its way from the device.
    #[cfg(feature = "gpu")]
    Coming(Mapped),
}

impl Look {
    /// Waits for it, where it is not there yet.
    pub(super) async fn status(self) -> Result<Status> {
        match self {
            Self::Known(status) => Ok(*status),
            #[cfg(feature = "gpu")]
            Self::Coming(status) => Ok(bytemuck::pod_read_unaligned(&status.bytes("the status").await?)),
        }
    }
}

/// What a blocking call has to poll while it waits.
#[cfg(feature = "gpu")]
pub(super) type Waiter = Option<wgpu::Device>;
/// What a blocking call has to poll while it waits.
#[cfg(not(feature = "gpu"))]
pub(super) type Waiter = Option<std::convert::Infallible>;

/// Does something on the device. The CPU backend runs on the host's world itself and has nothing to do.
macro_rules! on_gpu {
    ($engine:expr, $told:ident, $gpu:ident => $action:expr) => {{
        match $engine {
            Self::Cpu => {}
            #[cfg(feature = "gpu")]
            Self::Gpu($gpu) => $action,
        }
        // Without the GPU nobody asks for it.
        let _ = $told;
        Ok(())
    }};
}

impl Engine {
    #[cfg(feature = "gpu")]
    pub(super) async fn open(options: &Options, world: &World) -> Result<(Self, BackendInfo)> {
        let gpu = match options.backend {
            Backend::Cpu => return Ok((Self::Cpu, cpu_info("asked for"))),
            Backend::Gpu => Gpu::open(true).await?,
            Backend::Auto => match Gpu::open(false).await {
                Ok(gpu) => gpu,
                Err(crate::Error::NoAdapter(_)) => {
                    return Ok((Self::Cpu, cpu_info("no hardware GPU was found")));
                }
                Err(error) => return Ok((Self::Cpu, cpu_info(&format!("no GPU could be opened: {error}")))),
            },
        };
        let reason = if options.backend == Backend::Auto { "the best hardware GPU" } else { "asked for" };
        Self::on(&gpu, options, world, reason)
    }

    #[cfg(not(feature = "gpu"))]
    pub(super) async fn open(options: &Options, _world: &World) -> Result<(Self, BackendInfo)> {
        const WITHOUT: &str = "this build of rockfall is without the gpu feature";
        match options.backend {
            Backend::Cpu => Ok((Self::Cpu, cpu_info("asked for"))),
            Backend::Auto => Ok((Self::Cpu, cpu_info(WITHOUT))),
            Backend::Gpu => Err(crate::Error::NoAdapter(WITHOUT.to_owned())),
        }
    }

    #[cfg(feature = "gpu")]
    pub(super) fn on_device(
        options: &Options,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        world: &World,
    ) -> Result<(Self, BackendInfo)> {
        Self::on(&Gpu::on_device(device.clone(), queue.clone()), options, world, "the caller's device")
    }

    #[cfg(feature = "gpu")]
    fn on(gpu: &Gpu, options: &Options, world: &World, reason: &str) -> Result<(Self, BackendInfo)> {
        let mut there = GpuWorld::new(gpu, world)?;
        if let Some(join) = options.join_steps {
            there.join_steps(join);
        }
        Ok((Self::Gpu(Box::new(there)), gpu_info(gpu, reason)))
    }

    pub(super) fn waiter(&self) -> Waiter {
        match self {
            Self::Cpu => None,
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => Some(gpu.gpu().device().clone()),
        }
    }

    /// Whether a stage costs something where it has nothing to do.
    pub(super) fn dispatches(&self) -> bool {
        !matches!(self, Self::Cpu)
    }

    /// The world on the device.
    #[cfg(feature = "gpu")]
    pub(super) fn gpu_world(&self) -> Option<&GpuWorld> {
        match self {
            Self::Cpu => None,
            Self::Gpu(gpu) => Some(gpu),
        }
    }

    /// Runs `stages` once with the status of `world`, and reads the status back into it.
    pub(super) async fn run(&mut self, world: &mut World, stages: &[Run]) -> Result<()> {
        self.begin(world)?;
        world.status = self.submit(world, stages, 0..1, None).await?.status().await?;
        Ok(())
    }

    /// Compiles what these stages need.
    pub(super) fn prepare(&mut self, stages: &[Run]) -> Result<()> {
        on_gpu!(self, stages, gpu => gpu.prepare_plain(stages)?)
    }

    /// Takes over the status of `world`.
    pub(super) fn begin(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.set_status(&world.status)?)
    }

    /// Runs `stages` so many steps on, numbered for [`Run::is_in`], or until one is void. With a recorder, every stage is timed,
    /// which takes waiting.
    pub(super) async fn submit(
        &mut self,
        world: &mut World,
        stages: &[Run],
        steps: Range<u32>,
        recorder: Option<&mut Recorder>,
    ) -> Result<Look> {
        match (self, recorder) {
            (Self::Cpu, recorder) => {
                run_on_cpu(world, stages, steps, recorder);
                Ok(Look::Known(Box::new(world.status)))
            }
            #[cfg(feature = "gpu")]
            (Self::Gpu(gpu), None) => Ok(Look::Coming(gpu.run_and_look(stages, &world.step, steps)?)),
            #[cfg(feature = "gpu")]
            (Self::Gpu(gpu), Some(recorder)) => {
                let timer = gpu.run_timed(stages, &world.step, steps)?;
                let before = std::mem::replace(&mut world.status, gpu.read_status().await?);
                let done = world.status.steps.wrapping_sub(before.steps);
                recorder.book(stages, &timer.read(stages).await?, done, &world.step, &world.status);
                Ok(Look::Known(Box::new(world.status)))
            }
        }
    }

    /// Gives a world the scratch that the CPU backend runs on; a device has its own.
    pub(super) fn complete(&self, world: &mut World) {
        match self {
            Self::Cpu => world.add_scratch(),
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => {}
        }
    }

    /// Takes over a world that was packed anew, or whose lists have a new capacity and are void.
    pub(super) fn replace(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.upload(world)?)
    }

    /// The lists of the world have a new capacity; what they held is void.
    pub(super) fn resize_lists(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.resize_lists(world)?)
    }

    /// The world has another room for listed collisions.
    pub(super) fn resize_collisions(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.resize_collisions(world)?)
    }

    /// The words of the world changed, and with them offsets in the uniform block.
    pub(super) fn upload_words(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.upload_words(world)?)
    }

    /// The state of the spheres changed.
    pub(super) fn upload_spheres(&mut self, world: &World) -> Result<()> {
        on_gpu!(self, world, gpu => {
            gpu.upload_buffer(world, Buffer::Start)?;
            gpu.upload_buffer(world, Buffer::Orientations)?;
        })
    }

    /// Reads the words back into `world`.
    pub(super) async fn download_words(&mut self, world: &mut World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.download(world, &[Buffer::Topology]).await?)
    }

    /// Reads the state of the spheres back into `world`.
    pub(super) async fn download_spheres(&mut self, world: &mut World) -> Result<()> {
        on_gpu!(self, world, gpu => gpu.download(world, &[Buffer::Start, Buffer::Orientations]).await?)
    }
}

fn run_on_cpu(world: &mut World, stages: &[Run], steps: Range<u32>, recorder: Option<&mut Recorder>) {
    let (before, mut taken, timed) = (world.status.steps, Vec::new(), recorder.is_some());
    // On a thread of the pool from the start: to wake one in every stage costs more than a small scene's step.
    rayon::scope(|_| {
        for _ in steps {
            if timed {
                taken.push(cpu::run_timed(world, stages));
            } else {
                cpu::run(world, stages);
            }
            if world.status.rejected != 0 {
                break;
            }
        }
    });
    if let Some(recorder) = recorder {
        let done = world.status.steps.wrapping_sub(before);
        recorder.book(stages, &taken, done, &world.step, &world.status);
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
        device: format!("{} ({}{software})", info.name, info.backend),
        driver: crate::devices::driver(&info),
        reason: reason.to_owned(),
    }
}

/// Drives a future to its end on this thread.
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

/// Drives a future to its end on this thread; without a device, it never waits for anything.
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
