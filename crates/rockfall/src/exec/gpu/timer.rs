//! The device's clock: timestamps around dispatches, and the bandwidth of a plain copy.

use std::ops::Range;
use std::slice::from_ref;

use crate::error::{Error, Result};
use crate::exec::gpu::device::Gpu;
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::{READ_BACK, make_buffer};
use crate::exec::gpu::wait::Mapped;
use crate::exec::gpu::world::GpuWorld;
use crate::model::dispatch::rows;
use crate::profile::{Clock, Times};
use crate::step::schedule::Run;

/// Maximum number of timestamps in one query set.
const SET: u32 = wgpu::QUERY_SET_MAX_QUERIES;
const TICK_BYTES: u64 = wgpu::QUERY_SIZE as u64;

/// The timestamps of one submission.
struct Ticks {
    gpu: Gpu,
    sets: Vec<wgpu::QuerySet>,
    count: u32,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl Ticks {
    fn new(gpu: &Gpu, count: u32) -> Result<Self> {
        let device = gpu.device();
        let bytes = u64::from(count) * TICK_BYTES;
        let resolve = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let make_set = |first: u32| {
            catch(device, || {
                device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("timestamps"),
                    ty: wgpu::QueryType::Timestamp,
                    count: SET.min(count - first),
                })
            })
        };
        Ok(Self {
            gpu: gpu.clone(),
            sets: (0..count).step_by(SET as usize).map(make_set).collect::<Result<_>>()?,
            count,
            resolved: make_buffer(device, "timestamps", bytes, resolve)?,
            staging: make_buffer(device, "timestamps read back", bytes, READ_BACK)?,
        })
    }

    /// Takes timestamp number `tick` when everything before it in the pass is done.
    fn write(&self, pass: &mut wgpu::ComputePass<'_>, tick: u32) {
        pass.write_timestamp(&self.sets[(tick / SET) as usize], tick % SET);
    }

    /// Begins a pass between the timestamps `first` and `first + 1`. `first` must be even.
    fn begin_pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder, first: u32) -> wgpu::ComputePass<'a> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("timed"),
            timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                query_set: &self.sets[(first / SET) as usize],
                beginning_of_pass_write_index: Some(first % SET),
                end_of_pass_write_index: Some(first % SET + 1),
            }),
        })
    }

    /// Records the copy of the timestamps to the staging buffer. Call it after everything that is timed.
    fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        for (set, first) in self.sets.iter().zip((0..).step_by(SET as usize)) {
            let count = SET.min(self.count - first);
            encoder.resolve_query_set(set, 0..count, &self.resolved, u64::from(first) * TICK_BYTES);
        }
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, self.resolved.size());
    }

    /// Reads the timestamps, in s since the first one.
    async fn read(&self) -> Result<Vec<f64>> {
        let view = Mapped::read(&self.staging, self.gpu.faults()).bytes("timestamps").await?;
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&view);
        // Differences to the first timestamp are taken as integers, so that no digits are lost.
        let seconds = 1e-9 * f64::from(self.gpu.queue().get_timestamp_period());
        let first = ticks.first().copied().unwrap_or_default();
        Ok(ticks.iter().map(|tick| tick.saturating_sub(first) as f64 * seconds).collect())
    }
}

/// Returns the kind of timestamps that a device supports.
///
/// # Errors
/// [`Error::Device`] when the device supports none.
pub(crate) fn clock(gpu: &Gpu) -> Result<Clock> {
    let features = gpu.device().features();
    if features.contains(wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES) {
        Ok(Clock::DeviceInPass)
    } else if features.contains(wgpu::Features::TIMESTAMP_QUERY) {
        Ok(Clock::DeviceAroundPasses)
    } else {
        Err(Error::Device(
            "stages cannot be timed: the device has no timestamp queries, or was opened without the feature TIMESTAMP_QUERY"
                .to_owned(),
        ))
    }
}

/// A batch of steps in which every dispatch is timed.
pub(crate) struct Timer {
    clock: Clock,
    ticks: Ticks,
    /// Indices of the runs that have work to do.
    live: Vec<usize>,
    steps: Range<u32>,
}

impl Timer {
    /// # Errors
    /// [`Error::Device`] when the device has no timestamps or no memory for them.
    pub(crate) fn new(world: &GpuWorld, runs: &[Run], steps: Range<u32>) -> Result<Self> {
        let clock = clock(world.gpu())?;
        let live: Vec<usize> = (0..runs.len()).filter(|at| !world.is_idle(&runs[*at])).collect();
        let dispatches = live.iter().map(|at| steps.clone().filter(|step| runs[*at].is_in(*step)).count() as u32).sum::<u32>();
        let count = match clock {
            Clock::DeviceInPass => dispatches + 1,
            _ => 2 * dispatches,
        };
        Ok(Self { clock, ticks: Ticks::new(world.gpu(), count.max(1))?, live, steps })
    }

    /// Records the steps with timestamps.
    pub(crate) fn encode(&self, encoder: &mut wgpu::CommandEncoder, world: &GpuWorld, runs: &[Run]) -> Result<()> {
        let all = self.steps.clone().flat_map(|step| self.live_in(runs, step)).map(|at| from_ref(&runs[at])).zip(0..);
        if self.clock == Clock::DeviceInPass {
            let mut pass =
                encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("timed steps"), timestamp_writes: None });
            self.ticks.write(&mut pass, 0);
            for (run, number) in all {
                world.encode(&mut pass, run, 0..1)?;
                self.ticks.write(&mut pass, number + 1);
            }
        } else {
            for (run, number) in all {
                world.encode(&mut self.ticks.begin_pass(encoder, 2 * number), run, 0..1)?;
            }
        }
        self.ticks.resolve(encoder);
        Ok(())
    }

    /// Indices of the runs that are dispatched in a step.
    fn live_in<'a>(&'a self, runs: &'a [Run], step: u32) -> impl Iterator<Item = usize> + 'a {
        self.live.iter().copied().filter(move |at| runs[*at].is_in(step))
    }

    /// The time of every recorded dispatch, in s. Waits until the device has finished them.
    pub(crate) async fn read(&self, runs: &[Run]) -> Result<Times> {
        let ticks = self.ticks.read().await?;
        let mut times = vec![vec![None; runs.len()]; self.steps.len()];
        let mut dispatch = 0;
        for (step, times) in self.steps.clone().zip(&mut times) {
            for at in self.live_in(runs, step) {
                let first = if self.clock == Clock::DeviceInPass { dispatch } else { 2 * dispatch };
                times[at] = Some((ticks[first + 1] - ticks[first]).max(0.0));
                dispatch += 1;
            }
        }
        Ok(times)
    }
}

const COPY: &str = "
@group(0) @binding(0) var<storage, read> source: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> copied: array<vec4f>;

@compute @workgroup_size(256)
fn copy(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = (group.y * groups.x + group.x) * 256u + local;
    if i < arrayLength(&source) {
        copied[i] = source[i];
    }
}
";
/// Much larger than any cache.
const COPY_BYTES: u64 = 512 << 20;
/// The same for software adapters, whose caches are those of a CPU.
const SOFTWARE_COPY_BYTES: u64 = 64 << 20;
const COPIES: u32 = 10;

/// Bandwidth of a kernel that copies a large buffer, in bytes read plus bytes written per second: the best of 10 copies.
///
/// # Errors
/// [`Error::Device`] when the device has no timestamps, or no memory for the buffers.
pub(crate) async fn copy_bandwidth(gpu: &Gpu) -> Result<f64> {
    clock(gpu)?;
    let (device, limits) = (gpu.device(), gpu.device().limits());
    let wanted_bytes = if gpu.is_software() { SOFTWARE_COPY_BYTES } else { COPY_BYTES };
    let bytes = wanted_bytes.min(limits.max_storage_buffer_binding_size).min(limits.max_buffer_size) & !0xffff;
    let source = make_buffer(device, "copy source", bytes, wgpu::BufferUsages::STORAGE)?;
    let copied = make_buffer(device, "copy target", bytes, wgpu::BufferUsages::STORAGE)?;
    let ticks = Ticks::new(gpu, 2 * COPIES)?;
    catch(device, || {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("copy"),
            source: wgpu::ShaderSource::Wgsl(COPY.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("copy"),
            layout: None,
            module: &module,
            entry_point: Some("copy"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("copy"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[(0, &source), (1, &copied)]
                .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }),
        });
        let groups = (bytes / 16).div_ceil(256) as u32;
        let [x, y, z] = rows(groups, limits.max_compute_workgroups_per_dimension);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for number in 0..COPIES {
            let mut pass = ticks.begin_pass(&mut encoder, 2 * number);
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(x, y, z);
        }
        ticks.resolve(&mut encoder);
        gpu.queue().submit([encoder.finish()]);
    })?;
    let ticks = ticks.read().await?;
    let times = ticks.chunks_exact(2).map(|pair| pair[1] - pair[0]).filter(|time| *time > 0.0);
    let best = times.fold(f64::INFINITY, f64::min);
    source.destroy();
    copied.destroy();
    Ok(2.0 * bytes as f64 / best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::gpu::{adapters, block_on, drive, instance};
    use crate::generate::Benchmark;
    use crate::model::world::World;
    use crate::settings::{BroadPhase, Integrator};
    use crate::step::schedule::Phase;

    /// Opens the first adapter's device with these features only.
    fn device(features: wgpu::Features) -> Gpu {
        let open = async {
            assert!(!adapters().await.is_empty(), "no adapter; scripts/test installs one");
            let adapter = instance().enumerate_adapters(wgpu::Backends::VULKAN).await.remove(0);
            let descriptor =
                wgpu::DeviceDescriptor { required_features: features, required_limits: adapter.limits(), ..Default::default() };
            adapter.request_device(&descriptor).await.unwrap()
        };
        let (device, queue) = drive(open, || Ok(())).unwrap();
        Gpu::on_device(device, queue)
    }

    /// Times of the AABB update and of two stages for rods, in a scene without rods.
    fn times(gpu: &Gpu, steps: u32) -> Result<Times> {
        let world = World::build(&Benchmark::Lattice.generate(100, 0)?)?;
        let phases = [Phase::UpdateAabbs, Phase::UpdatePositions];
        let stages = |phase: &Phase| phase.stages(Integrator::Rk4, BroadPhase::BruteForce).iter().take(2).copied();
        let runs: Vec<Run> = phases.iter().flat_map(stages).collect();
        let mut gpu_world = GpuWorld::new(gpu, &world)?;
        let timer = gpu_world.run_timed(&runs, &world.step, 0..steps)?;
        block_on(gpu.device(), timer.read(&runs))
    }

    #[track_caller]
    fn check(features: wgpu::Features, expected: Clock, steps: u32) {
        let gpu = device(features);
        assert_eq!(clock(&gpu).unwrap(), expected);
        let times = times(&gpu, steps).unwrap();
        assert_eq!(times.len(), steps as usize);
        for step in &times {
            assert!(step[0].is_some_and(|time| (0.0..60.0).contains(&time)), "{step:?}");
            assert_eq!(step[1..], [None, None]);
        }
        assert!(times.iter().filter(|step| step[0] > Some(0.0)).count() > times.len() / 2);
        let bandwidth = block_on(gpu.device(), copy_bandwidth(&gpu)).unwrap();
        assert!((1e3..1e14).contains(&bandwidth), "{bandwidth}");
    }

    #[test]
    fn timestamps_inside_passes_fill_more_than_one_set() {
        let features = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES;
        check(features, Clock::DeviceInPass, SET + 100);
    }

    #[test]
    fn timestamps_around_passes_are_enough() {
        check(wgpu::Features::TIMESTAMP_QUERY, Clock::DeviceAroundPasses, SET / 2 + 50);
    }

    #[test]
    fn a_device_without_timestamps_is_an_error() {
        let gpu = device(wgpu::Features::empty());
        let message = times(&gpu, 1).unwrap_err().to_string();
        assert!(message.contains("no timestamp queries"), "{message}");
        assert!(block_on(gpu.device(), copy_bandwidth(&gpu)).is_err());
    }
}
