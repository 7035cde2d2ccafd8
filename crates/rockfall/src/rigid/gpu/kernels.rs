//! The kernels of a frame: each is its own file and all files that it requires.

/// Most threads of a stage of one workgroup.
const MOST_THREADS: u32 = 1024;

/// A WGSL file.
struct Part {
    file: &'static str,
    text: &'static str,
}

macro_rules! parts {
    ($($file:literal)*) => {
        &[$(Part { file: $file, text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/", $file)) }),*]
    };
}

const PARTS: &[Part] = parts!(
    "physics/quaternion.wgsl"
    "physics/sine.wgsl"
    "rigid/collide/manifold.wgsl"
    "rigid/collide/reduce.wgsl"
    "rigid/collide/solid.wgsl"
    "rigid/collide/closest.wgsl"
    "rigid/collide/ball.wgsl"
    "rigid/collide/capsule.wgsl"
    "rigid/collide/round.wgsl"
    "rigid/collide/half_space.wgsl"
    "rigid/collide/box_box.wgsl"
    "rigid/collide/polyhedra.wgsl"
    "rigid/collide/collide.wgsl"
    "rigid/frame/colliders.wgsl"
    "rigid/frame/rows.wgsl"
    "rigid/frame/turn.wgsl"
    "rigid/frame/follow.wgsl"
    "rigid/frame/sweeps.wgsl"
    "rigid/frame/warm_start.wgsl"
    "rigid/frame/kick.wgsl"
    "rigid/frame/pass.wgsl"
    "rigid/frame/left_over.wgsl"
    "rigid/frame/drift.wgsl"
    "rigid/frame/refresh.wgsl"
    "rigid/frame/report.wgsl"
    "rigid/frame/settle.wgsl"
    "rigid/frame/states.wgsl"
    "rigid/frame/times.wgsl"
    "rigid/frame/reflect.wgsl"
    "rigid/frame/carry.wgsl"
    "rigid/frame/impacts.wgsl"
    "rigid/frame/left_over_impacts.wgsl"
    "rigid/frame/group.wgsl"
    "rigid/frame/impacts_at_once.wgsl"
    "rigid/frame/all_at_once.wgsl"
    "rigid/frame/scratch.wgsl"
    "rigid/frame/places.wgsl"
    "rigid/frame/renew.wgsl"
    "rigid/frame/search.wgsl"
    "rigid/frame/find.wgsl"
    "rigid/frame/known.wgsl"
    "rigid/frame/impacts_round.wgsl"
    "rigid/frame/wait.wgsl"
    "rigid/frame/spare.wgsl"
    "rigid/frame/expose.wgsl"
);

/// Bindings of the arrays. 0 and 1 are uniform.
pub(super) const BODIES: u32 = 2;
pub(super) const CONSTANTS: u32 = 3;
pub(super) const BLOCKS: u32 = 4;
pub(super) const PAIRS: u32 = 5;
pub(super) const POINTS: u32 = 6;
pub(super) const CONTACTS: u32 = 7;
pub(super) const LOADS: u32 = 8;
pub(super) const LISTS: u32 = 9;
pub(super) const REPORT: u32 = 10;
pub(super) const COLLIDERS: u32 = 11;
pub(super) const HULLS: u32 = 12;
/// One more than the last binding of a frame that the CPU has begun.
pub(super) const BINDINGS: u32 = 13;

/// An entry point.
pub(super) struct Stage {
    pub(super) name: &'static str,
    file: &'static str,
    pub(super) bindings: &'static [u32],
}

pub(super) const LOAD: usize = 0;
pub(super) const KICK: usize = 1;
pub(super) const SOLVE: usize = 2;
pub(super) const SOLVE_LEFT_OVER: usize = 3;
pub(super) const MEAN: usize = 4;
pub(super) const DRIFT: usize = 5;
pub(super) const REFRESH: usize = 6;
pub(super) const SETTLE: usize = 7;
pub(super) const ALL_AT_ONCE: usize = 8;
pub(super) const BEFORE_IMPACTS: usize = 9;
pub(super) const STRIKE: usize = 10;
pub(super) const FIND_LEFT_OVER: usize = 11;
pub(super) const COUNT_LEFT_OVER: usize = 12;
pub(super) const STRIKE_LEFT_OVER: usize = 13;
pub(super) const MEAN_OF_IMPACTS: usize = 14;
pub(super) const CARRY: usize = 15;
pub(super) const IMPACTS_AT_ONCE: usize = 16;
pub(super) const REFRESH_ROUND: usize = 17;
pub(super) const FIND_ROUND: usize = 18;
pub(super) const FIND_ALL_ROUND: usize = 19;
pub(super) const STRIKE_ROUND: usize = 20;
pub(super) const FIND_LEFT_OVER_ROUND: usize = 21;
pub(super) const STRIKE_LEFT_OVER_ROUND: usize = 22;
pub(super) const WAIT_ROUND: usize = 23;
pub(super) const CARRY_ROUND: usize = 24;
pub(super) const SPARE_ROUND: usize = 25;
pub(super) const EXPOSE: usize = 26;

const SOLVER: &[u32] = &[BODIES, BLOCKS, PAIRS, CONTACTS, LOADS];
const GEOMETRY: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, CONTACTS];
/// Of stages that find closest points anew.
const CLOSEST: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, CONTACTS, COLLIDERS, HULLS];
const HITS: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, LOADS, COLLIDERS, HULLS];
const STRUCK: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, LOADS, REPORT];
const ALL: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, CONTACTS, LOADS, LISTS];

/// All stages, by the numbers above.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "load", file: "rigid/frame/warm_start.wgsl", bindings: SOLVER },
    Stage { name: "kick", file: "rigid/frame/kick.wgsl", bindings: &[BODIES, CONSTANTS, LOADS, LISTS] },
    Stage { name: "solve", file: "rigid/frame/pass.wgsl", bindings: SOLVER },
    Stage { name: "solve_left_over", file: "rigid/frame/left_over.wgsl", bindings: SOLVER },
    Stage { name: "mean", file: "rigid/frame/left_over.wgsl", bindings: &[BODIES, LOADS, LISTS] },
    Stage { name: "drift", file: "rigid/frame/drift.wgsl", bindings: &[BODIES, CONSTANTS] },
    Stage { name: "refresh", file: "rigid/frame/refresh.wgsl", bindings: GEOMETRY },
    Stage { name: "settle", file: "rigid/frame/settle.wgsl", bindings: &[BODIES, CONSTANTS, REPORT] },
    Stage { name: "all_at_once", file: "rigid/frame/all_at_once.wgsl", bindings: ALL },
    Stage { name: "before_impacts", file: "rigid/frame/impacts.wgsl", bindings: &[BODIES, CONSTANTS, REPORT] },
    Stage { name: "strike", file: "rigid/frame/impacts.wgsl", bindings: &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, REPORT] },
    Stage {
        name: "find_left_over",
        file: "rigid/frame/impacts.wgsl",
        bindings: &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, LOADS],
    },
    Stage { name: "count_left_over", file: "rigid/frame/impacts.wgsl", bindings: &[BODIES, LOADS, LISTS] },
    Stage {
        name: "strike_left_over",
        file: "rigid/frame/impacts.wgsl",
        bindings: &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, LOADS, REPORT],
    },
    Stage { name: "mean_of_impacts", file: "rigid/frame/impacts.wgsl", bindings: &[BODIES, CONSTANTS, LOADS, LISTS] },
    Stage {
        name: "carry",
        file: "rigid/frame/impacts.wgsl",
        bindings: &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, CONTACTS, LOADS, REPORT],
    },
    Stage { name: "impacts_at_once", file: "rigid/frame/impacts_at_once.wgsl", bindings: ALL },
    Stage { name: "refresh_round", file: "rigid/frame/renew.wgsl", bindings: CLOSEST },
    Stage { name: "find_round", file: "rigid/frame/find.wgsl", bindings: HITS },
    Stage { name: "find_all_round", file: "rigid/frame/find.wgsl", bindings: HITS },
    Stage { name: "strike", file: "rigid/frame/impacts_round.wgsl", bindings: STRUCK },
    Stage { name: "find_left_over", file: "rigid/frame/impacts_round.wgsl", bindings: &[BLOCKS, LOADS] },
    Stage { name: "strike_left_over", file: "rigid/frame/impacts_round.wgsl", bindings: STRUCK },
    Stage { name: "wait_round", file: "rigid/frame/wait.wgsl", bindings: &[BLOCKS, PAIRS, CONTACTS, LOADS, REPORT] },
    Stage { name: "carry_round", file: "rigid/frame/renew.wgsl", bindings: CLOSEST },
    Stage { name: "spare_round", file: "rigid/frame/spare.wgsl", bindings: CLOSEST },
    Stage {
        name: "expose",
        file: "rigid/frame/expose.wgsl",
        bindings: &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, COLLIDERS, HULLS],
    },
];

/// What shapes a scene has. Kernels leave out the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Kinds {
    pub(super) capsules: bool,
    pub(super) hulls: bool,
}

impl Kinds {
    /// How many there are.
    pub(super) const COUNT: usize = 4;

    pub(super) fn number(self) -> usize {
        usize::from(self.capsules) + 2 * usize::from(self.hulls)
    }

    fn write(self, text: &str) -> String {
        let constant = |name: &str, value: bool| format!("const {name}: bool = {value};");
        [("CAPSULES", self.capsules), ("HULLS", self.hulls)]
            .iter()
            .fold(text.to_string(), |text, (name, value)| text.replace(&constant(name, true), &constant(name, *value)))
    }
}

/// A compiled stage.
#[derive(Debug)]
pub(super) struct Kernel {
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
}

/// A text without its empty lines and those that are comments.
fn code(text: &str) -> String {
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    text.split_inclusive('\n').filter(is_code).collect()
}

/// The text of a kernel. A part may stand instead of another one that is required later.
pub(super) fn join(file: &str) -> String {
    fn add(file: &str, taken: &mut Vec<&'static str>, text: &mut String) {
        let part = PARTS.iter().find(|part| part.file == file).unwrap_or_else(|| panic!("{file} is no part of a kernel"));
        if taken.contains(&part.file) {
            return;
        }
        taken.push(part.file);
        taken.extend(part.text.lines().filter_map(|line| line.strip_prefix("// instead of ")));
        let lines = part.text.lines().map_while(|line| line.strip_prefix("// requires "));
        lines.flat_map(str::split_whitespace).for_each(|file| add(file, taken, text));
        text.push_str(&code(part.text));
    }
    let (mut taken, mut text) = (Vec::new(), String::new());
    add(file, &mut taken, &mut text);
    text
}

impl Kernel {
    #[allow(unsafe_code)]
    pub(super) fn new(device: &wgpu::Device, stage: &Stage, kinds: Kinds) -> Self {
        let text = kinds.write(&join(stage.file));
        let has_group = text.contains("override GROUP:");
        let module = wgpu::ShaderModuleDescriptor { label: Some(stage.name), source: wgpu::ShaderSource::Wgsl(text.into()) };
        // SAFETY: without run-time checks the kernels themselves must stay inside their buffers, and they must terminate. They do:
        // - Threads whose number is not below the count of their bodies or blocks return at once. The counts and the starts of the
        //   colours are those of the uploaded arrays (`RigidGpu::frame`).
        // - The bodies and pairs of blocks, the first points and colliders of pairs, and the entries of lists come from the contacts of a
        //   frame of the CPU, which have the lengths of the arrays. No stage writes them. The number of points of a pair stays within
        //   its room: round pairs have at most so many as there is room for, and others only lose points.
        // - What is found of impacts has a row of each block and two of each point, for which `RigidGpu::frame` makes room.
        // - Lists of hulls are those of the shapes of the colliders. Arrays of hidden pairs have an index below their length.
        // - Copies are those of left-over blocks, for which `RigidGpu::frame` makes room.
        // - `kept` has an index below its length.
        // - Loops run over counts from the same places, or for a fixed number of times.
        // - Workgroup memory is written before it is read.
        let module = unsafe { device.create_shader_module_trusted(module, wgpu::ShaderRuntimeChecks::unchecked()) };
        let uniform = |has_dynamic_offset| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: None,
        };
        let storage = |binding: &u32| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: [CONSTANTS, LISTS, COLLIDERS, HULLS].contains(binding) },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let entry =
            |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None };
        let mut entries = vec![entry(0, uniform(false)), entry(1, uniform(true))];
        entries.extend(stage.bindings.iter().map(|binding| entry(*binding, storage(binding))));
        let layout =
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(stage.name), entries: &entries });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(stage.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        // Threads of the stages of one workgroup.
        let limits = device.limits();
        let most = limits.max_compute_invocations_per_workgroup.min(limits.max_compute_workgroup_size_x).min(MOST_THREADS);
        let constants = [("GROUP", f64::from(most))];
        let constants: &[_] = if has_group { &constants } else { &[] };
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(stage.name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(stage.name),
            compilation_options: wgpu::PipelineCompilationOptions { zero_initialize_workgroup_memory: false, constants },
            cache: None,
        });
        Self { pipeline, layout }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every stage may be joined, within the limits of the project and of WebGPU, and every file is part of one.
    #[test]
    fn stages_are_small() {
        let mut all = String::new();
        for stage in STAGES {
            let text = join(stage.file);
            assert!(text.lines().count() <= 1500, "{}", stage.name);
            assert!(stage.bindings.len() <= 8, "{}", stage.name);
            all += &text;
        }
        assert!(PARTS.iter().all(|part| all.contains(&code(part.text))));
    }
}
