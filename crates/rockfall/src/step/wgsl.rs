//! Joins the WGSL files of a kernel.
//!
//! A kernel is the text of its own file and of all files that it requires. A file begins with lines such as
//!
//! ```text
//! // requires model/lists.wgsl physics/contact.wgsl
//! ```
//!
//! which name, by paths below `src/`, the files whose declarations it uses directly. [`Wgsl::parts`] collects the files. Their
//! order does not matter in WGSL. Shared files may also use names that each stage provides in its own way: the names of its
//! bindings, and the [`HOOKS`]. A [`Variant`] adapts the text to the kinds of objects in a scene. `tests/sources/wgsl.rs` checks that
//! no file uses a name without requiring its file, requires a file that it does not use, or declares a name twice.

use std::sync::LazyLock;

use crate::laws;
use crate::model::declared;
use crate::model::part::{Part, part};
use crate::model::status::COUNTER_BLOCKS;
use crate::model::step::Step;
pub use crate::model::world_batch::WorldBatch;
pub use crate::model::world_sizes::WorldSizes;
use crate::physics::forces;
use crate::settings::Integrator;

/// Names that a shared file uses without requiring a file that declares them, each with its meaning. The stage's own file
/// declares them, or requires one of several files that do.
pub const HOOKS: &[(&str, &str)] = &[
    ("GROUP_SIZE", "threads of a workgroup"),
    ("count", "number of entries of the list to sort"),
    ("early_changes", "part of stage states 2 and 3 in the sum for a vector of a sphere"),
    ("early_velocities", "part of stage states 2 and 3 in the sum for the mean velocity of a sphere"),
    ("early_momenta", "part of the start and of stage states 2 and 3 in the sum for the mean angular momentum of a sphere"),
    ("emit", "handles a pair that the broad phase finds"),
    ("evaluation", "number of the force evaluation of RK4, from 0; velocity Verlet: 0 for the state, 3 for stage state 4"),
    ("into", "start of the list to sort"),
    ("is_hidden_crossing", "whether another shape of the same surface hides a crossing at its time of contact"),
    ("is_put_off", "whether a contact does not collide because a crossing of one of its spheres came first"),
    ("low_at", "index of the low part of the position of a sphere in `state`"),
    ("low_row", "low part of the position of a sphere"),
    ("momentum_at", "index of the angular momentum of a sphere in `state`"),
    ("next_row", "reads a row of the state that replaces the present one"),
    ("part_of_entry", "effect of the collision of a list entry on its sphere"),
    ("residue_row", "residues of a sphere, and in the stage states of RK4 its increments so far, by region"),
    ("position_at", "index of the position of a sphere in `state`"),
    ("put_next", "writes a row of the next stage state"),
    ("put_start", "writes a row of the state"),
    ("start_row", "reads a row of the state at the start of the step"),
    ("velocity_at", "index of the velocity of a sphere in `state`"),
    ("y2_row", "reads a row of stage state 2"),
    ("y3_row", "reads a row of stage state 3"),
    ("y4_row", "reads a row of stage state 4"),
];

/// The files that stages share.
const SHARED: &[Part] = &[
    part!("model/collision_state.wgsl"),
    part!("model/counters.wgsl"),
    part!("model/early.wgsl"),
    part!("model/entries.wgsl"),
    part!("model/lists.wgsl"),
    part!("model/load_rows.wgsl"),
    part!("model/objects.wgsl"),
    part!("model/one_state.wgsl"),
    part!("model/order.wgsl"),
    part!("model/put_head.wgsl"),
    part!("model/put_next.wgsl"),
    part!("model/put_rates.wgsl"),
    part!("model/rates.wgsl"),
    part!("model/stage_states.wgsl"),
    part!("model/state_rows.wgsl"),
    part!("model/two_states.wgsl"),
    part!("physics/chain.wgsl"),
    part!("physics/collision.wgsl"),
    part!("physics/collision/capsule_changes.wgsl"),
    part!("physics/collision/changes.wgsl"),
    part!("physics/collision/cluster.wgsl"),
    part!("physics/collision/couplings.wgsl"),
    part!("physics/collision/crossings.wgsl"),
    part!("physics/collision/hidden_crossing.wgsl"),
    part!("physics/collision/impulses.wgsl"),
    part!("physics/collision/lone.wgsl"),
    part!("physics/collision/networks.wgsl"),
    part!("physics/collision/other_collisions.wgsl"),
    part!("physics/collision/plain.wgsl"),
    part!("physics/collision/pushed.wgsl"),
    part!("physics/contact.wgsl"),
    part!("physics/escape.wgsl"),
    part!("physics/fine.wgsl"),
    part!("physics/forces/attached.wgsl"),
    part!("physics/forces/due.wgsl"),
    part!("physics/forces/free.wgsl"),
    part!("physics/forces/load.wgsl"),
    part!("physics/forces/muscle.wgsl"),
    part!("physics/forces/net_force.wgsl"),
    part!("physics/forces/rates.wgsl"),
    part!("physics/forces/rod_load.wgsl"),
    part!("physics/forces/sphere_load.wgsl"),
    part!("physics/forces/sphere_push.wgsl"),
    part!("physics/forces/sphere_rates.wgsl"),
    part!("physics/friction_impulses.wgsl"),
    part!("physics/free_rotation.wgsl"),
    part!("physics/geometry.wgsl"),
    part!("physics/scale.wgsl"),
    part!("physics/laws/before.wgsl"),
    part!("physics/laws/contact.wgsl"),
    part!("physics/laws/history.wgsl"),
    part!("physics/laws/jkr.wgsl"),
    part!("physics/laws/mover_contact.wgsl"),
    part!("physics/laws/resistance.wgsl"),
    part!("physics/laws/shared.wgsl"),
    part!("physics/laws/stiffness.wgsl"),
    part!("physics/lengths.wgsl"),
    part!("physics/motion.wgsl"),
    part!("physics/pair_damping.wgsl"),
    part!("physics/pairs.wgsl"),
    part!("physics/passage.wgsl"),
    part!("physics/period.wgsl"),
    part!("physics/product.wgsl"),
    part!("physics/residue.wgsl"),
    part!("physics/quaternion.wgsl"),
    part!("physics/rigid.wgsl"),
    part!("physics/rigid_form.wgsl"),
    part!("physics/rigid_lever.wgsl"),
    part!("physics/rigid_parts.wgsl"),
    part!("physics/rigid_side.wgsl"),
    part!("physics/rotation.wgsl"),
    part!("physics/sine.wgsl"),
    part!("physics/rims_of_list.wgsl"),
    part!("physics/rod_polygon.wgsl"),
    part!("physics/round_pair.wgsl"),
    part!("physics/smooth.wgsl"),
    part!("physics/seams_of_list.wgsl"),
    part!("physics/surface.wgsl"),
    part!("physics/surfaces_of_list.wgsl"),
    part!("physics/touch.wgsl"),
    part!("physics/travel.wgsl"),
    part!("physics/wall_bounds.wgsl"),
    part!("physics/wall_damping.wgsl"),
    part!("physics/walls.wgsl"),
    part!("step/bodies/body_rows.wgsl"),
    part!("step/broad_phase/brute_force/pair_tiles.wgsl"),
    part!("step/broad_phase/grid/bitonic.wgsl"),
    part!("step/broad_phase/grid/cells.wgsl"),
    part!("step/broad_phase/grid/long.wgsl"),
    part!("step/broad_phase/grid/neighbours.wgsl"),
    part!("step/broad_phase/grid/scan.wgsl"),
    part!("step/broad_phase/grid/sort.wgsl"),
    part!("step/broad_phase/due.wgsl"),
    part!("step/broad_phase/heap.wgsl"),
    part!("step/broad_phase/meet.wgsl"),
    part!("step/broad_phase/sort_and_skip/axis.wgsl"),
    part!("step/broad_phase/sort_and_skip/near_tiles.wgsl"),
    part!("step/collisions/classify_contacts.wgsl"),
    part!("step/collisions/crossing_rows.wgsl"),
    part!("step/collisions/has_changes.wgsl"),
    part!("step/collisions/list_collisions.wgsl"),
    part!("step/collisions/record_of.wgsl"),
    part!("step/collisions/records.wgsl"),
    part!("step/collisions/report_clusters.wgsl"),
    part!("step/collisions/rows.wgsl"),
    part!("step/commit_next_state.wgsl"),
    part!("step/fused/world_contacts.wgsl"),
    part!("step/fused/world_memory.wgsl"),
    part!("step/fused/world_springs.wgsl"),
    part!("step/integrate/close_step.wgsl"),
    part!("step/integrate/early_stages.wgsl"),
    part!("step/integrate/finished.wgsl"),
    part!("step/integrate/next_state.wgsl"),
    part!("step/integrate/symplectic_euler_state.wgsl"),
    part!("step/large_spheres/large_sphere_load.wgsl"),
    part!("step/large_spheres/ordered_sums.wgsl"),
    part!("step/large_spheres/workgroup_per_sphere.wgsl"),
    part!("step/reorder/digits.wgsl"),
];

/// Declarations for every kernel: a file, with those that Rust has too.
static STEP: LazyLock<String> = LazyLock::new(|| part!("model/step.wgsl").text.to_owned() + &declared::wgsl());

/// Calls of the functions of the contact law of the kernel.
static CHOSEN_LAW: LazyLock<String> = LazyLock::new(laws::chosen);

/// Every file that stages share, including the files of the body forces, the generated `body_forces.wgsl`, the files of the
/// contact laws and the generated `chosen.wgsl`.
pub fn shared() -> impl Iterator<Item = Part> {
    let step = Part { file: "model/step.wgsl", text: &STEP };
    let chosen = Part { file: "laws/chosen.wgsl", text: &CHOSEN_LAW };
    let laws = laws::WGSL.iter().map(|&(.., file, text)| Part { file, text });
    SHARED.iter().chain(forces::PARTS).copied().chain(laws).chain([step, chosen])
}

/// The files that a file requires directly.
///
/// # Panics
/// When one of them is not in [`shared`].
pub fn requires(part: Part) -> impl Iterator<Item = Part> {
    let lines = part.text.lines().map_while(|line| line.strip_prefix("// requires "));
    lines.flat_map(str::split_whitespace).map(move |file| {
        let found = shared().find(|part| part.file == file);
        found.unwrap_or_else(|| panic!("{} requires {file}, which is not a shared WGSL file", part.file))
    })
}

/// The text of a kernel.
#[derive(Clone, Copy, Debug)]
pub enum Wgsl {
    /// A file, with those that it requires.
    File(Part),
    /// All files of the kernel, used unchanged. For tests that modify some of the files.
    Parts(&'static [Part]),
}

impl Wgsl {
    /// Returns the files to join: those that are required, directly or indirectly, each once, and the stage's own file last.
    pub fn parts(&self) -> Vec<Part> {
        fn add(part: Part, parts: &mut Vec<Part>) {
            if !parts.contains(&part) {
                requires(part).for_each(|required| add(required, parts));
                parts.push(part);
            }
        }
        match self {
            Self::File(part) => {
                let mut parts = Vec::new();
                add(*part, &mut parts);
                parts
            }
            Self::Parts(parts) => parts.to_vec(),
        }
    }
}

/// The scenes that a kernel is compiled for. Kernels for scenes without some objects are smaller and faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    /// There may be rods.
    pub rods: bool,
    /// There may be large spheres, each of which gets a workgroup.
    pub large: bool,
    /// The number of the contact law: its place in [`ContactLaw::ALL`](crate::ContactLaw::ALL).
    pub law: u32,
    /// There may be springs with muscles.
    pub muscles: bool,
    /// Boxes or polygons may move.
    pub walls: bool,
    /// There may be rigid bodies.
    pub rigid: bool,
    /// Passages through polygons are counted.
    pub passages: bool,
    /// There may be triangles.
    pub triangles: bool,
    /// There may be smooth walls.
    pub smooth: bool,
    /// There may be rods and polygons.
    pub rod_polygons: bool,
    /// The scene is periodic.
    pub periodic: bool,
    /// The scene is sheared.
    pub sheared: bool,
    /// There may be pairs of materials.
    pub materials: bool,
    /// There may be pairs with rolling or twisting resistance.
    pub resistance: bool,
    /// There may be pairs with cohesion.
    pub cohesion: bool,
    /// The integrator is velocity Verlet.
    pub verlet: bool,
    /// The integrator is symplectic Euler.
    pub half_step: bool,
    /// Springs, tethers or forces act.
    pub free_table: bool,
    /// Geometry uses the low parts of positions.
    pub double: bool,
    /// Velocities have residues.
    pub residues: bool,
    /// Contacts that begin and end within a step are handled.
    pub continuous: bool,
    /// There may be so many objects that a sort key of `find_neighbours` has no room for more than an insertion index.
    pub many: bool,
    /// The kernel is `run_worlds`. Each world has a block `step` and one block of counters in workgroup memory.
    pub worlds: Option<WorldBatch>,
}

impl Variant {
    /// Returns the variant for a scene with these counts.
    pub fn of(step: &Step) -> Self {
        let traits = step.traits();
        Self {
            law: traits.law,
            rods: traits.rods,
            large: traits.large,
            muscles: traits.muscles,
            walls: traits.walls,
            rigid: traits.rigid,
            passages: traits.counts_passages(),
            triangles: traits.triangles,
            smooth: traits.smooth,
            rod_polygons: traits.rod_polygons,
            periodic: traits.periodic,
            sheared: traits.sheared,
            materials: traits.materials,
            resistance: traits.resistance,
            cohesion: traits.cohesion,
            verlet: traits.integrator == Integrator::VelocityVerlet,
            half_step: traits.integrator == Integrator::SymplecticEuler,
            free_table: traits.free_table,
            double: traits.double,
            residues: traits.residues,
            continuous: traits.continuous,
            many: traits.many,
            worlds: None,
        }
    }

    /// Returns the WGSL of this variant. It replaces constants in the text, because the sizes of arrays depend on `RODS` and
    /// `LARGE` and so these cannot be pipeline-overridable constants.
    pub fn apply(self, text: &str) -> String {
        let constants = [
            ("RODS", self.rods),
            ("LARGE", self.large),
            ("MUSCLES", self.muscles),
            ("WALLS", self.walls),
            ("RIGID_BODIES", self.rigid),
            ("PASSAGES", self.passages & self.worlds.is_none()),
            ("TRIANGLES", self.triangles),
            ("SMOOTH", self.smooth),
            ("ROD_POLYGONS", self.rod_polygons),
            ("PERIODIC", self.periodic),
            ("SHEARED", self.sheared),
            ("MATERIALS", self.materials),
            ("RESISTANCE", self.resistance),
            ("COHESION", self.cohesion),
            ("ESCAPES", self.worlds.is_none()),
            ("BY_FIELD", self.worlds.is_some()),
            ("VERLET", self.verlet),
            ("HALF_STEP", self.half_step),
            ("FREE_TABLE", self.free_table),
            ("DOUBLE", self.double),
            ("RESIDUES", self.residues),
            ("CONTINUOUS", self.continuous),
        ];
        let text = text.replace("const LAW: u32 = 1u;", &format!("const LAW: u32 = {}u;", self.law));
        let replaced = constants.iter().fold(text, |text, (name, is_set)| {
            text.replace(&format!("const {name}: bool = true;"), &format!("const {name}: bool = {is_set};"))
        });
        let Some(batch) = self.worlds else { return replaced };
        let block = format!("const COUNTER_BLOCKS: u32 = {COUNTER_BLOCKS}u;");
        let replaced = batch.apply(&replaced);
        let replaced = replaced
            .replace("@group(0) @binding(0) var<uniform> step: Step;", "")
            .replace("topology[", "topology[world_topology + ")
            .replace(&block, "const COUNTER_BLOCKS: u32 = 1u;");
        let replaced = replace_variable(&replaced, "step.", "world_steps[own_world].");
        replace_variable(&replaced, "status.", "world_statuses[own_world].")
    }
}

/// Replaces the name of a variable, with the dot behind it, where it is not the end of a longer name.
fn replace_variable(text: &str, name: &str, by: &str) -> String {
    let mut pieces = text.split(name);
    let mut replaced = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let is_longer = replaced.ends_with(|before: char| before.is_alphanumeric() || "_/.".contains(before));
        replaced.push_str(if is_longer { name } else { by });
        replaced.push_str(piece);
    }
    replaced
}
