//! Compiles the WGSL parts of a stage to a pipeline.

use std::fmt::Write;

use crate::error::{Error, Result};
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::chunk_bytes;
use crate::exec::gpu::split::{Split, binding_numbers, split};
use crate::model::layout::WORKGROUP;
use crate::model::part::Part;
use crate::step::prune::prune;
use crate::step::stage::{Access, Stage};
use crate::step::wgsl::Variant;
use crate::user_laws::set::KernelLaws;

/// Number of subgroups of a workgroup that computes whole steps, if the device allows that many. More would be slower, because
/// every barrier waits for all of them.
const GROUP_SUBGROUPS: u32 = 32;
/// Maximum number of threads of such a workgroup.
const MOST_THREADS: u32 = 1024;

/// A compiled stage.
#[derive(Debug)]
pub(crate) struct Kernel {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
}

/// The WGSL of a stage: its parts joined in order.
pub fn join(parts: &[Part]) -> String {
    parts.iter().map(|part| part.text).collect()
}

/// Adds source positions to a compiler's message: for every `wgsl:LINE:COLUMN` in it, the file and line of the part.
pub fn locate_lines(parts: &[Part], message: &str) -> String {
    let mut text = message.to_owned();
    for place in message.split("wgsl:").skip(1) {
        let digits = place.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default();
        let Ok(mut line) = digits.parse::<usize>() else {
            continue;
        };
        for part in parts {
            let lines = part.text.matches('\n').count();
            if line <= lines {
                // Writing to a String cannot fail.
                let _ = write!(text, "\n  joined line {digits} is {}:{line}", part.file);
                break;
            }
            line -= lines;
        }
    }
    text
}

impl Kernel {
    /// Compiles the kernel of a stage for a variant. `chunks` holds the number of chunks of each array, in the order of the
    /// stage's bindings. `laws` is the text of the program's laws.
    pub(crate) fn new(
        device: &wgpu::Device,
        stage: &Stage,
        variant: Variant,
        chunks: &[u32],
        laws: &KernelLaws,
    ) -> Result<Self> {
        catch(device, || build(device, stage, variant, chunks, laws)).map_err(|error| match error {
            Error::Device(text) => Error::Device(format!("kernel {}: {}", stage.name, locate_lines(&stage.parts(), &text))),
            other => other,
        })
    }
}

pub(super) fn layout_entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

/// Number of threads per workgroup for stages that leave it to the device.
fn threads_of_workgroup(device: &wgpu::Device) -> u32 {
    let limits = device.limits();
    let wanted = (GROUP_SUBGROUPS * device.adapter_info().subgroup_max_size).clamp(WORKGROUP, MOST_THREADS);
    wanted.min(limits.max_compute_invocations_per_workgroup).min(limits.max_compute_workgroup_size_x)
}

#[allow(unsafe_code)]
fn build(device: &wgpu::Device, stage: &Stage, variant: Variant, chunks: &[u32], laws: &KernelLaws) -> Kernel {
    let text = prune(&variant.apply(&join(&stage.parts())));
    let text = split(&text, &Split::of(stage, chunks, chunk_bytes(&device.limits())));
    // After all other changes, which must not apply to the program's own text.
    let text = laws.put_into(&text);
    let flag = |is_set: bool| f64::from(u8::from(is_set));
    let mut constants = vec![("MANY", flag(variant.many)), ("GROUP_SIZE", f64::from(threads_of_workgroup(device)))];
    constants.retain(|(name, _)| text.contains(&format!("override {name}:")));
    let module = wgpu::ShaderModuleDescriptor { label: Some(stage.name), source: wgpu::ShaderSource::Wgsl(text.into()) };
    // SAFETY: without run-time checks the kernels themselves must stay inside their buffers, and they must terminate. They do:
    // - Threads whose number is not below the count of their objects return at once.
    // - Ids, offsets and indices in the topology buffer are checked by `gpu::check` before they are uploaded.
    // - Those in the lists are checked there too, or were written by `fill_pairs`, `find_neighbours` or `fill_long`. Their ids
    //   are below the number of objects and their rows are below `pair_rows`; otherwise the step is rejected and no stage reads
    //   the lists.
    // - Indices in `cells` are sums of the counts of the objects, computed from zero in the same step, or they are not used.
    // - The uniform block with the counts and offsets is always that of the uploaded world, and the buffers have its sizes
    //   (`GpuWorld::new`, `upload`).
    // - An index inside an array that is stored in chunks is inside the chunk that `split` chooses for it.
    // - `extents` is read up to three rows past the last object, and it has room for them.
    // - Loops run over counts from the same places; sweeps run up to MAX_SWEEPS times.
    // - Workgroup memory is written before it is read.
    // - `run_worlds` gets worlds that `WorldSizes::of` accepts, so that their spheres, springs and topology fit its arrays, and it
    //   has a bit for each of their objects. It calls no function that reads its placeholders `lists` and `orientations`.
    // - No integer is divided by a value that may be 0.
    // - The program's laws have no arrays, no indices that are not constant, and a limit to the rounds of their loops
    //   (`user_laws::compile`).
    let module = unsafe { device.create_shader_module_trusted(module, wgpu::ShaderRuntimeChecks::unchecked()) };
    let mut entries =
        vec![layout_entry(0, wgpu::BufferBindingType::Uniform), layout_entry(1, wgpu::BufferBindingType::Uniform)];
    for (binding, numbers) in stage.bindings.iter().zip(binding_numbers(chunks)) {
        let read_only = binding.access == Access::Read;
        entries.extend(numbers.iter().map(|number| layout_entry(*number, wgpu::BufferBindingType::Storage { read_only })));
    }
    let layout =
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(stage.name), entries: &entries });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(stage.name),
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(stage.name),
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some(stage.name),
        compilation_options: wgpu::PipelineCompilationOptions {
            zero_initialize_workgroup_memory: false,
            constants: &constants,
        },
        cache: None,
    });
    Kernel { pipeline, layout }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARTS: &[Part] = &[Part { file: "one.wgsl", text: "a\nb\n" }, Part { file: "two.wgsl", text: "c\nd\n" }];

    #[test]
    fn lines_are_located_in_their_part() {
        let found = locate_lines(PARTS, "error at wgsl:4:7 and wgsl:1:1");
        assert!(found.contains("joined line 4 is two.wgsl:2"), "{found}");
        assert!(found.contains("joined line 1 is one.wgsl:1"), "{found}");
    }

    #[test]
    fn lines_past_the_end_are_not_located() {
        assert_eq!(locate_lines(PARTS, "wgsl:9:1"), "wgsl:9:1");
    }
}
