//! The kernels of a frame: each is its own file and all files that it requires.

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
    "physics/product.wgsl"
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
    "rigid/collide/exchange.wgsl"
    "rigid/frame/colliders.wgsl"
    "rigid/frame/rows.wgsl"
    "rigid/frame/turn.wgsl"
    "rigid/frame/follow.wgsl"
    "rigid/frame/halt.wgsl"
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
    "rigid/frame/found.wgsl"
    "rigid/frame/sort.wgsl"
    "rigid/frame/lay.wgsl"
    "rigid/frame/gather.wgsl"
    "rigid/frame/enlist.wgsl"
    "rigid/frame/past.wgsl"
    "rigid/frame/recall.wgsl"
    "rigid/frame/colours.wgsl"
    "rigid/frame/keep.wgsl"
    "rigid/frame/take.wgsl"
    "rigid/frame/arrange.wgsl"
    "rigid/frame/relist.wgsl"
    "rigid/frame/store.wgsl"
    "rigid/frame/margins.wgsl"
    "rigid/broad/search.wgsl"
    "rigid/broad/open.wgsl"
    "rigid/broad/bound.wgsl"
    "rigid/broad/scan.wgsl"
    "rigid/broad/apart.wgsl"
    "rigid/broad/pair_up.wgsl"
    "rigid/broad/narrow.wgsl"
    "rigid/broad/narrow_round.wgsl"
    "rigid/broad/narrow_boxes.wgsl"
    "rigid/broad/narrow_solids.wgsl"
    "rigid/frame/scratch.wgsl"
    "rigid/frame/places.wgsl"
    "rigid/frame/renew.wgsl"
    "rigid/frame/find.wgsl"
    "rigid/frame/known.wgsl"
    "rigid/frame/impacts_round.wgsl"
    "rigid/frame/wait.wgsl"
    "rigid/frame/spare.wgsl"
    "rigid/frame/expose.wgsl"
    "rigid/frame/springs.wgsl"
    "rigid/frame/laws.wgsl"
    "rigid/frame/arc.wgsl"
    "rigid/frame/belt.wgsl"
    "rigid/frame/joint.wgsl"
    "rigid/frame/block.wgsl"
    "rigid/frame/axis.wgsl"
    "rigid/frame/drive.wgsl"
    "rigid/frame/tensor.wgsl"
    "rigid/frame/joints.wgsl"
    "rigid/frame/joint_groups.wgsl"
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
pub(super) const ORDER: u32 = 33;
pub(super) const SORTED: u32 = 27;
pub(super) const TALLIES: u32 = 28;
pub(super) const MARKS: u32 = 29;
pub(super) const STATES: u32 = 30;
pub(super) const RANKS: u32 = 31;
pub(super) const TABLE: u32 = 32;
pub(super) const OLD_STARTS: u32 = 34;
pub(super) const OLD_PAIRS: u32 = 35;
pub(super) const OLD_POINTS: u32 = 36;
pub(super) const SURFACES: u32 = 37;
pub(super) const RAW: u32 = 38;
pub(super) const SPRINGS: u32 = 39;
pub(super) const ENDS_OF_SPRINGS: u32 = 40;
pub(super) const MUSCLES: u32 = 41;
pub(super) const JOINTS: u32 = 42;
pub(super) const JOINT_STATES: u32 = 43;
pub(super) const JOINT_ORDER: u32 = 44;
pub(super) const APART: u32 = 45;
pub(super) const LAWS: u32 = 46;
/// One more than the last binding.
pub(super) const BINDINGS: u32 = 47;
pub(super) const BOUNDS: u32 = 13;
pub(super) const CELLS: u32 = 14;
pub(super) const MEMBERS: u32 = 15;
pub(super) const CANDIDATES: u32 = 16;
pub(super) const FOUND: u32 = 17;
pub(super) const COUNTS: u32 = 18;
pub(super) const OWNED: u32 = 19;
/// Uniform.
pub(super) const SEARCH: u32 = 21;
pub(super) const SCALES: u32 = 22;
pub(super) const SCANNED: u32 = 23;
pub(super) const SUMS: u32 = 24;
/// Uniform.
pub(super) const SCAN: u32 = 25;
/// The array of `CELLS`, where it is only read.
pub(super) const ENDS: u32 = 26;

/// Arrays that are only read, but by the stages of [`WRITERS`].
const READ: &[u32] =
    &[CONSTANTS, LISTS, COLLIDERS, HULLS, SCALES, ENDS, SPRINGS, ENDS_OF_SPRINGS, JOINTS, JOINT_ORDER, APART, LAWS];

/// The stages that write an array that the others only read.
const WRITERS: &[&str] = &["gather", "enlist", "take", "relist", "calm", "widen", "pull", "add_laws"];

/// An entry point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    pub(super) name: &'static str,
    pub(super) file: &'static str,
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
pub(super) const BEFORE_IMPACTS: usize = 8;
pub(super) const STRIKE: usize = 9;
pub(super) const FIND_LEFT_OVER: usize = 10;
pub(super) const COUNT_LEFT_OVER: usize = 11;
pub(super) const STRIKE_LEFT_OVER: usize = 12;
pub(super) const MEAN_OF_IMPACTS: usize = 13;
pub(super) const CARRY: usize = 14;
pub(super) const BUCKET: usize = 15;
pub(super) const RANK: usize = 16;
pub(super) const LAY: usize = 17;
pub(super) const GATHER: usize = 18;
pub(super) const ENLIST: usize = 19;
pub(super) const RECALL: usize = 20;
pub(super) const KEEP: usize = 21;
pub(super) const TAKE: usize = 22;
pub(super) const COUNT_COLOURS: usize = 23;
pub(super) const ARRANGE: usize = 24;
pub(super) const RELIST: usize = 25;
pub(super) const SUM_UP: usize = 26;
pub(super) const STORE: usize = 27;
pub(super) const CALM: usize = 28;
pub(super) const WIDEN: usize = 29;
pub(super) const SEEK: usize = 30;
pub(super) const REFRESH_ROUND: usize = 31;
pub(super) const FIND_ROUND: usize = 32;
pub(super) const FIND_ALL_ROUND: usize = 33;
pub(super) const STRIKE_ROUND: usize = 34;
pub(super) const FIND_LEFT_OVER_ROUND: usize = 35;
pub(super) const STRIKE_LEFT_OVER_ROUND: usize = 36;
pub(super) const WAIT_ROUND: usize = 37;
pub(super) const CARRY_ROUND: usize = 38;
pub(super) const SPARE_ROUND: usize = 39;
pub(super) const EXPOSE: usize = 40;
pub(super) const SEEK_ROUND: usize = 41;
pub(super) const PULL: usize = 42;
pub(super) const OPEN_JOINTS: usize = 43;
pub(super) const WARM_JOINTS: usize = 44;
pub(super) const PUSH_JOINTS: usize = 45;
pub(super) const RELAX_JOINTS: usize = 46;
pub(super) const CLOSE_JOINTS: usize = 47;
pub(super) const PUSH_JOINTS_AGAIN: usize = 48;
pub(super) const RELAX_JOINTS_AGAIN: usize = 49;
pub(super) const PUSH_GROUPS: usize = 50;
pub(super) const RELAX_GROUPS: usize = 51;
pub(super) const WARM_GROUPS: usize = 52;
pub(super) const ADD_LAWS: usize = 53;

const SOLVER: &[u32] = &[BODIES, BLOCKS, PAIRS, CONTACTS, LOADS];
const GEOMETRY: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, CONTACTS];
/// Of stages that find closest points anew.
const CLOSEST: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, CONTACTS, COLLIDERS, HULLS];
const HITS: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, LOADS, COLLIDERS, HULLS];
const STRUCK: &[u32] = &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, LOADS, REPORT];
const LINKED: &[u32] = &[BODIES, JOINTS, JOINT_STATES, JOINT_ORDER];
const LINKS: &[u32] = &[JOINTS, JOINT_STATES, JOINT_ORDER, REPORT];

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
    Stage { name: "bucket", file: "rigid/frame/sort.wgsl", bindings: &[BODIES, FOUND, COUNTS, OWNED, ORDER] },
    Stage { name: "rank", file: "rigid/frame/sort.wgsl", bindings: &[BODIES, FOUND, COUNTS, OWNED, ORDER, SORTED, TALLIES] },
    Stage {
        name: "lay",
        file: "rigid/frame/lay.wgsl",
        bindings: &[BODIES, PAIRS, POINTS, COLLIDERS, FOUND, COUNTS, SORTED, SURFACES],
    },
    Stage {
        name: "gather",
        file: "rigid/frame/gather.wgsl",
        bindings: &[BODIES, PAIRS, LISTS, COUNTS, SORTED, TALLIES, MARKS, RAW],
    },
    Stage { name: "enlist", file: "rigid/frame/enlist.wgsl", bindings: &[BODIES, LISTS, TALLIES, RAW] },
    Stage {
        name: "recall",
        file: "rigid/frame/recall.wgsl",
        bindings: &[BODIES, PAIRS, POINTS, CONTACTS, COUNTS, OLD_STARTS, OLD_PAIRS, OLD_POINTS],
    },
    Stage {
        name: "keep",
        file: "rigid/frame/keep.wgsl",
        bindings: &[BODIES, TALLIES, MARKS, STATES, RANKS, OLD_STARTS, OLD_PAIRS, RAW],
    },
    Stage { name: "take", file: "rigid/frame/take.wgsl", bindings: &[BODIES, LISTS, TALLIES, STATES, RANKS, RAW] },
    Stage { name: "count_colours", file: "rigid/frame/arrange.wgsl", bindings: &[COUNTS, TALLIES, STATES, TABLE] },
    Stage {
        name: "arrange",
        file: "rigid/frame/arrange.wgsl",
        bindings: &[BLOCKS, PAIRS, COUNTS, TALLIES, STATES, RANKS, TABLE, RAW],
    },
    Stage { name: "relist", file: "rigid/frame/relist.wgsl", bindings: &[BODIES, LISTS, COUNTS, RANKS] },
    Stage { name: "sum_up", file: "rigid/frame/store.wgsl", bindings: &[PAIRS, CONTACTS, REPORT, COUNTS] },
    Stage {
        name: "store",
        file: "rigid/frame/store.wgsl",
        bindings: &[PAIRS, POINTS, CONTACTS, COUNTS, OWNED, OLD_STARTS, OLD_PAIRS, OLD_POINTS],
    },
    Stage { name: "calm", file: "rigid/frame/margins.wgsl", bindings: &[BODIES, SCALES] },
    Stage { name: "widen", file: "rigid/frame/margins.wgsl", bindings: &[BODIES, SCALES] },
    Stage { name: "seek", file: "rigid/frame/impacts.wgsl", bindings: &[BODIES, CONSTANTS, BLOCKS, PAIRS, POINTS, REPORT] },
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
    Stage { name: "seek_round", file: "rigid/frame/wait.wgsl", bindings: &[LOADS, REPORT] },
    Stage { name: "pull", file: "rigid/frame/springs.wgsl", bindings: &[BODIES, CONSTANTS, SPRINGS, ENDS_OF_SPRINGS, MUSCLES] },
    Stage { name: "open_joints", file: "rigid/frame/joints.wgsl", bindings: LINKED },
    Stage { name: "warm_joints", file: "rigid/frame/joints.wgsl", bindings: LINKED },
    Stage { name: "push_joints", file: "rigid/frame/joints.wgsl", bindings: LINKED },
    Stage { name: "relax_joints", file: "rigid/frame/joints.wgsl", bindings: LINKED },
    Stage { name: "close_joints", file: "rigid/frame/joints.wgsl", bindings: LINKS },
    Stage { name: "push_joints_again", file: "rigid/frame/joints.wgsl", bindings: LINKED },
    Stage { name: "relax_joints_again", file: "rigid/frame/joints.wgsl", bindings: LINKED },
    Stage { name: "push_groups", file: "rigid/frame/joint_groups.wgsl", bindings: LINKED },
    Stage { name: "relax_groups", file: "rigid/frame/joint_groups.wgsl", bindings: LINKED },
    Stage { name: "warm_groups", file: "rigid/frame/joint_groups.wgsl", bindings: LINKED },
    Stage { name: "add_laws", file: "rigid/frame/laws.wgsl", bindings: &[BODIES, CONSTANTS, ENDS_OF_SPRINGS, MUSCLES, LAWS] },
];

pub(super) const OPEN: usize = 0;
pub(super) const BOUND: usize = 1;
pub(super) const SCATTER: usize = 2;
pub(super) const PAIR_UP: usize = 3;
pub(super) const NARROW_BOXES: usize = 4;
pub(super) const NARROW_SOLIDS: usize = 5;
pub(super) const NARROW_ROUND: usize = 6;

const NARROW: &[u32] = &[BODIES, COLLIDERS, HULLS, CANDIDATES, FOUND, COUNTS, OWNED];

/// The stages of the search, by the numbers above.
pub(super) const SEARCH_STAGES: &[Stage] = &[
    Stage { name: "open", file: "rigid/broad/open.wgsl", bindings: &[BODIES, CONSTANTS, SCALES] },
    Stage {
        name: "bound",
        file: "rigid/broad/bound.wgsl",
        bindings: &[BODIES, COLLIDERS, HULLS, BOUNDS, CELLS, MEMBERS, COUNTS],
    },
    Stage { name: "scatter", file: "rigid/broad/bound.wgsl", bindings: &[BOUNDS, CELLS, MEMBERS] },
    Stage {
        name: "pair_up",
        file: "rigid/broad/pair_up.wgsl",
        bindings: &[BODIES, COLLIDERS, BOUNDS, ENDS, MEMBERS, CANDIDATES, COUNTS, APART],
    },
    Stage { name: "narrow", file: "rigid/broad/narrow_boxes.wgsl", bindings: NARROW },
    Stage { name: "narrow", file: "rigid/broad/narrow_solids.wgsl", bindings: NARROW },
    Stage { name: "narrow", file: "rigid/broad/narrow_round.wgsl", bindings: NARROW },
];

/// The two stages of a scan.
pub(super) const SCAN_STAGES: &[Stage] = &[
    Stage { name: "scan_tiles", file: "rigid/broad/scan.wgsl", bindings: &[SCANNED, SUMS] },
    Stage { name: "add_tiles", file: "rigid/broad/scan.wgsl", bindings: &[SCANNED, SUMS] },
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

    pub(super) fn write(self, text: &str) -> String {
        let constant = |name: &str, value: bool| format!("const {name}: bool = {value};");
        [("CAPSULES", self.capsules), ("HULLS", self.hulls)]
            .iter()
            .fold(text.to_string(), |text, (name, value)| text.replace(&constant(name, true), &constant(name, *value)))
    }
}

fn is_read_only(stage: &Stage, binding: u32) -> bool {
    READ.contains(&binding) && !([LISTS, SCALES, CONSTANTS].contains(&binding) && WRITERS.contains(&stage.name))
}

/// A compiled stage.
#[derive(Clone, Debug)]
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

/// How often a text occurs in the files of the kernels.
#[cfg(test)]
pub(super) fn count(text: &str) -> usize {
    PARTS.iter().map(|part| part.text.matches(text).count()).sum()
}

impl Kernel {
    /// A stage with this text and with uniform blocks at these bindings. They may have a dynamic offset.
    #[allow(unsafe_code)]
    pub(super) fn build(device: &wgpu::Device, stage: &Stage, text: String, uniforms: &[(u32, bool)]) -> Self {
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
        // - In the search, bodies of colliders and lists of hulls come from the world. Its numbers of colliders are those of the arrays
        //   (`Search::new`). A slot is taken modulo the length of the table. The starts and ends of slots are sums of the numbers of
        //   their colliders, which are as many as `bound` has counted, and `scatter` puts as many. The large colliders are at most
        //   all, and have their own half of `members`. Candidates and manifolds are written below the room, and read below both the
        //   count and the room. Of a manifold at most four points are written. A collider looks into at most 27 cells of a level.
        // - Springs have bodies of the world, and lists of ends have springs of the world and muscles that exist (`springs::OnDevice`).
        // - Laws of the program have no arrays and a limit to the rounds of their loops (`user_laws::compile`), and `laws` has all their
        //   parameters (`GpuWorld::new`).
        // - Joints have bodies of the world, and those of a colour share none with mass. Their order has each joint once, and their calls
        //   end at its end; lists of bodies that are apart have a start for each body of the world (`joints::OnDevice`).
        // - A scan reads and writes below its length (`Scan::new`), and has a sum for each tile.
        // - In the assembly, threads return beyond the count of the manifolds, which is 0 if there was no room for all (`pair_count`), and
        //   beyond that of the blocks. Owners have as many manifolds as `narrow` has counted, so the sums of these counts are places
        //   below the room, and each place is taken once. A block has at least one pair, so there are not more blocks than pairs, and
        //   the lists have two entries for each. Places in the order of colours are sums of what `count_colours` has counted. What is
        //   remembered has the same form: `Past` makes it from colliders that exist, with four points for each pair.
        let module = unsafe { device.create_shader_module_trusted(module, wgpu::ShaderRuntimeChecks::unchecked()) };
        let uniform = |has_dynamic_offset| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: None,
        };
        let storage = |binding: &u32| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: is_read_only(stage, *binding) },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let entry =
            |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None };
        let mut entries: Vec<_> = uniforms.iter().map(|(binding, has_offset)| entry(*binding, uniform(*has_offset))).collect();
        entries.extend(stage.bindings.iter().map(|binding| entry(*binding, storage(binding))));
        let layout =
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(stage.name), entries: &entries });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(stage.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        // Threads of the stages of one workgroup.
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(stage.name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(stage.name),
            compilation_options: wgpu::PipelineCompilationOptions { zero_initialize_workgroup_memory: false, constants: &[] },
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
        for stage in [STAGES, SEARCH_STAGES, SCAN_STAGES].concat() {
            let text = join(stage.file);
            assert!(text.lines().count() <= 1500, "{}", stage.file);
            assert!(stage.bindings.len() <= 8, "{}", stage.name);
            all += &text;
        }
        for part in PARTS {
            assert!(all.contains(&code(part.text)), "{} is part of no stage", part.file);
        }
    }
}
