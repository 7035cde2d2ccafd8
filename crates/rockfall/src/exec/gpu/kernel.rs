//! From a stage's WGSL parts to a pipeline.

use std::fmt::Write;

use crate::error::{Error, Result};
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::chunk_bytes;
use crate::exec::gpu::split::{Split, binding_numbers, split};
use crate::model::layout::WORKGROUP;
use crate::model::part::Part;
use crate::step::stage::{Access, Stage};
use crate::step::wgsl::Variant;

/// Subgroups of a workgroup that does whole steps, where the device allows so many: every barrier waits for all of them.
const GROUP_SUBGROUPS: u32 = 32;
/// The most threads of such a workgroup.
const MOST_THREADS: u32 = 1024;

/// A compiled stage.
#[derive(Debug)]
pub(crate) struct Kernel {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
}

/// The WGSL of a stage: its parts, one after the other.
pub fn join(parts: &[Part]) -> String {
    parts.iter().map(|part| part.text).collect()
}

/// Adds to a compiler's message where in the parts' own files the lines are that it names as `wgsl:LINE:COLUMN`.
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
                // A String takes what is written to it.
                let _ = write!(text, "\n  joined line {digits} is {}:{line}", part.file);
                break;
            }
            line -= lines;
        }
    }
    text
}

impl Kernel {
    /// The kernel of a stage, for such scenes, and for arrays of so many chunks, in the order of its bindings.
    pub(crate) fn new(device: &wgpu::Device, stage: &Stage, variant: Variant, chunks: &[u32]) -> Result<Self> {
        catch(device, || build(device, stage, variant, chunks)).map_err(|error| match error {
            Error::Device(text) => Error::Device(format!("kernel {}: {}", stage.name, locate_lines(&stage.parts(), &text))),
            other => other,
        })
    }
}

fn layout_entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

/// Threads of a workgroup of a stage that leaves their number to the device.
fn team(device: &wgpu::Device) -> u32 {
    let limits = device.limits();
    let wish = (GROUP_SUBGROUPS * device.adapter_info().subgroup_max_size).clamp(WORKGROUP, MOST_THREADS);
    wish.min(limits.max_compute_invocations_per_workgroup).min(limits.max_compute_workgroup_size_x)
}

#[allow(unsafe_code)]
fn build(device: &wgpu::Device, stage: &Stage, variant: Variant, chunks: &[u32]) -> Kernel {
    let text = split(&variant.apply(&join(&stage.parts())), &Split::of(stage, chunks, chunk_bytes(&device.limits())));
    let flag = |is_set: bool| f64::from(u8::from(is_set));
    let mut constants = vec![("MANY", flag(variant.many)), ("GROUP_SIZE", f64::from(team(device)))];
    constants.retain(|(name, _)| text.contains(&format!("override {name}:")));
    let module = wgpu::ShaderModuleDescriptor { label: Some(stage.name), source: wgpu::ShaderSource::Wgsl(text.into()) };
    // SAFETY: without run-time checks the kernels must stay inside their buffers by themselves, and end. They do: threads
    // past the count of what they work on return; ids, offsets and indices in `words` are checked by `gpu::check` before they
    // are uploaded, those in `lists` too, or were written by `fill_pairs`, `find_neighbours` or `fill_long`, whose ids are
    // below the number of objects and whose rows are below `pair_rows`, else the step is void and nobody reads them;
    // those in `cells` are sums of the counts of the objects, made from zero in the same step or not used; the uniform block
    // that holds counts and offsets is always that of the uploaded world, and the buffers are made to its sizes
    // (`GpuWorld::new`, `upload`); an index of an array in chunks that is inside the array is inside the chunk that `split`
    // has chosen for it. `extents` is read up to three rows past the last object, for which it has room. Sizes of dispatches that the
    // device tells are zero or those that `gpu::check` has seen. Loops run over counts from the same places, sweeps up to MAX_SWEEPS. Workgroup memory is written
    // before it is read. No integer is divided by anything that may be 0.
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
    fn lines_are_those_of_the_part() {
        let found = locate_lines(PARTS, "error at wgsl:4:7 and wgsl:1:1");
        assert!(found.contains("joined line 4 is two.wgsl:2"), "{found}");
        assert!(found.contains("joined line 1 is one.wgsl:1"), "{found}");
    }

    #[test]
    fn lines_past_the_end_are_left() {
        assert_eq!(locate_lines(PARTS, "wgsl:9:1"), "wgsl:9:1");
    }
}
