//! The step as one ordered list of stages, run by either backend.
//!
//! A stage is a pair of files of one name: `stage/NAME.rs` says what it does, declares its bindings and holds the CPU
//! twin; `stage/NAME.wgsl` is the kernel. [`Phase::stages`] is the step's table of contents.
//! To add a physical effect, add or edit one pair (ARCHITECTURE.md walks through it).
//!
//! This module is public for tools and tests; it may change between minor versions.

use crate::layout::{CELL_BLOCK, DIGIT_BLOCK, SIZE_WORDS, Step, WIDE, WORKGROUP};
use crate::world::World;

mod advance;
mod apply_collisions;
mod bound_blocks;
mod build_grid;
mod clear_cells;
mod commit_and_turn;
mod commit_collisions;
mod commit_leap;
mod commit_rubs;
mod constrain;
mod count_cells;
mod count_digits;
mod count_long;
mod count_near;
mod count_pairs;
mod end_step;
mod fill_long;
mod fill_near;
mod fill_pairs;
mod find_collisions;
mod find_neighbours;
mod finish;
mod finish_and_turn;
mod gather_impulses;
mod key_spheres;
mod leap;
mod list_collisions;
mod measure_order;
mod permute_spheres;
mod plan_lists;
mod project_networks;
mod restore_lengths;
mod rod_forces;
mod rub_contacts;
mod run_steps;
mod scan_cells;
mod scan_pairs;
mod scatter_digits;
mod schedule;
mod settle_spheres;
mod sort_axis;
mod sort_cells;
mod sweep_at_once;
mod sweep_collisions;
mod turn;
mod update_aabbs;
mod weigh_collisions;
mod weigh_networks;

pub(crate) use run_steps::is_small;
#[cfg(feature = "gpu")]
pub(crate) use run_steps::{STAGE as RUN_STEPS, begun_with, followed_by, suits};
pub use schedule::{MEASURE_ORDER, Phase, Run, SORT_MEMORY, When};

/// A buffer that stages bind. `Start` is the state; `Y2`, `Y3`, `Y4` are the stage states of RK4, and scratch besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Buffer {
    /// The state of all spheres (`World::states[0]`).
    Start,
    /// Stage state 2; where collisions and symplectic Euler put the state before it is committed.
    Y2,
    /// Stage state 3; after the integration: old positions in region 0 and mean spins in region 2.
    Y3,
    /// Stage state 4.
    Y4,
    /// In small scenes without rods: all four side by side, for `run_steps`.
    States,
    /// AABBs of all objects.
    Aabbs,
    /// Rods, springs, tethers, boxes, polygons, tags, users, slots, batches, ends, adjacency.
    Words,
    /// The grid: levels, cells, sums of blocks, keys, sorted objects.
    Cells,
    /// Per object, in the order of the grid's keys: centre and largest half extent of its AABB, negative of what is no sphere.
    Extents,
    /// The pair lists.
    Lists,
    /// Where collisions are listed, by list entry: the number of the collision in [`Buffer::Collisions`].
    Slots,
    /// Where collisions are listed: a record of [`COLLISION_WORDS`](crate::layout::COLLISION_WORDS) words each.
    Collisions,
    /// Per rod: force and couple on end 1, force and couple on end 2.
    Wrenches,
    /// Unit quaternions (x, y, z, w) of the spheres' orientations.
    Orientations,
    /// In large scenes: workgroups of the dispatches that make lists, as they are in this step, then as they are when there is
    /// something to do.
    Sizes,
    /// The [`Status`](crate::layout::Status) block.
    Status,
}

impl Buffer {
    /// All buffers.
    pub const ALL: [Self; 16] = [
        Self::Start,
        Self::Y2,
        Self::Y3,
        Self::Y4,
        Self::States,
        Self::Aabbs,
        Self::Words,
        Self::Cells,
        Self::Extents,
        Self::Lists,
        Self::Slots,
        Self::Collisions,
        Self::Wrenches,
        Self::Orientations,
        Self::Sizes,
        Self::Status,
    ];

    /// What it holds, in words.
    pub fn label(self) -> &'static str {
        match self {
            Self::Start => "the state",
            Self::Y2 => "stage state 2",
            Self::Y3 => "stage state 3",
            Self::Y4 => "stage state 4",
            Self::States => "the stage states of a small scene",
            Self::Aabbs => "the AABBs",
            Self::Words => "topology and static objects",
            Self::Cells => "the grid",
            Self::Extents => "the extents of sorted objects",
            Self::Lists => "the pair lists",
            Self::Slots => "the numbers of listed collisions",
            Self::Collisions => "the listed collisions",
            Self::Wrenches => "the forces on rods",
            Self::Orientations => "the orientations",
            Self::Sizes => "the sizes of dispatches",
            Self::Status => "the status",
        }
    }
}

/// What a binding of a stage refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// Always the same buffer.
    Fixed(Buffer),
    /// The stage state that pass p evaluates: `Start`, `Y2`, `Y3`, `Y4` for p = 0, 1, 2, 3.
    State,
    /// The stage state that pass p makes: `Y2`, `Y3`, `Y4` for p = 0, 1, 2.
    Next,
    /// What pass p of a sort begins with: `Y2` and `Y3` in turn.
    Unsorted,
    /// What it makes: the other one.
    Sorted,
}

impl Slot {
    /// The buffer in pass `pass`.
    pub fn buffer(self, pass: u32) -> Buffer {
        const STATES: [Buffer; 4] = [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4];
        match self {
            Self::Fixed(buffer) => buffer,
            Self::State => STATES[pass as usize],
            Self::Next => STATES[pass as usize + 1],
            Self::Unsorted => STATES[1 + pass as usize % 2],
            Self::Sorted => STATES[2 - pass as usize % 2],
        }
    }
}

/// How a kernel uses a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// `var<storage, read>`.
    Read,
    /// `var<storage, read_write>`.
    Write,
}

/// A storage buffer of a stage. Its number is 2 + its place in the stage's list (0 is `step`, 1 is `pass_`).
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// Its name in the WGSL.
    pub name: &'static str,
    /// Which buffer it is.
    pub slot: Slot,
    /// Read only or read and written.
    pub access: Access,
}

pub(crate) const fn read(name: &'static str, buffer: Buffer) -> Binding {
    Binding { name, slot: Slot::Fixed(buffer), access: Access::Read }
}

pub(crate) const fn write(name: &'static str, buffer: Buffer) -> Binding {
    Binding { name, slot: Slot::Fixed(buffer), access: Access::Write }
}

/// Workgroups that take turns, at most: as many as a large device runs side by side.
const MOST_TURNING: u32 = 1024;
/// The same over listed collisions, each of which is little work.
const MOST_AT_COLLISIONS: u32 = 4096;
/// In smaller scenes one for so many movers, of which few are long.
const MOVERS_A_TURN: u32 = 256;

/// What a stage has a thread for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threads {
    /// A thread per object.
    Objects,
    /// The same in workgroups of [`WIDE`]: where threads have little to do, it is workgroups that take the time.
    WideObjects,
    /// A thread per mover (sphere or rod).
    Movers,
    /// A thread per sphere.
    Spheres,
    /// A thread per sphere, but a workgroup for each of the large ones.
    SharedSpheres,
    /// A thread per mover, but a workgroup for each of the large spheres.
    SharedMovers,
    /// The same in workgroups of [`WIDE`].
    WideSpheres,
    /// A thread per rod.
    Rods,
    /// A workgroup per batch of fixed-length rods.
    Batches,
    /// A workgroup per network of fixed-length rods.
    Networks,
    /// A workgroup per large sphere.
    LargeSpheres,
    /// Workgroups that take turns over the listed collisions, of which the device alone knows how many there are.
    Collisions,
    /// A workgroup per block of the grid's cells.
    Blocks,
    /// A workgroup per block of spheres that are sorted.
    DigitBlocks,
    /// A workgroup per so many movers: they take turns over the long ones, of which the device alone knows how many there are.
    LongMovers,
    /// One workgroup.
    One,
}

impl Threads {
    /// Those of the stages that make lists in large scenes.
    pub const PLANNED: [Self; SIZE_WORDS as usize / 3] = [Self::WideObjects, Self::Blocks, Self::Movers, Self::LongMovers];

    /// Where the size of a dispatch of such a stage stands among [`Buffer::Sizes`], in bytes.
    pub fn size_at(self) -> Option<u64> {
        Self::PLANNED.iter().position(|threads| *threads == self).map(|place| 12 * place as u64)
    }

    /// Workgroups that a stage has in a world of these counts; 0: it has nothing to do.
    pub fn workgroups(self, step: &Step) -> u32 {
        let movers = step.movers();
        match self {
            Self::Objects => step.objects().div_ceil(WORKGROUP),
            Self::WideObjects => step.objects().div_ceil(WIDE),
            Self::Movers => movers.div_ceil(WORKGROUP),
            Self::Spheres => step.spheres.div_ceil(WORKGROUP),
            Self::SharedSpheres => step.large + (step.spheres - step.large).div_ceil(WORKGROUP),
            Self::SharedMovers => step.large + (movers - step.large).div_ceil(WORKGROUP),
            Self::WideSpheres => step.spheres.div_ceil(WIDE),
            Self::Rods => step.rods.div_ceil(WORKGROUP),
            Self::Batches => step.batches,
            Self::Networks => step.networks,
            Self::LargeSpheres => step.large,
            Self::Collisions => step.collision_room.div_ceil(WORKGROUP).min(MOST_AT_COLLISIONS),
            Self::Blocks => step.cells / CELL_BLOCK,
            Self::DigitBlocks => step.spheres.div_ceil(DIGIT_BLOCK),
            Self::LongMovers => movers.div_ceil(MOVERS_A_TURN).min(MOST_TURNING),
            Self::One => 1,
        }
    }
}

/// So many workgroups as rows of nearly the same length, of at most `across`: what is too much in the last one is begun, too.
pub fn rows(workgroups: u32, across: u32) -> [u32; 3] {
    let rows = workgroups.div_ceil(across).max(1);
    [workgroups.div_ceil(rows), rows, 1]
}

/// A piece of WGSL and the file it stands in.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Path below `src/`.
    pub file: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! part {
    ($file:literal) => {
        $crate::stage::Part { file: $file, text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/", $file)) }
    };
}
pub(crate) use part;

/// The WGSL for scenes with or without rods, and with or without large spheres. Not by constants of the pipeline, for the sizes of
/// arrays depend on them.
pub fn for_scenes(text: &str, rods: bool, large: bool) -> String {
    let told = |name: &str, is_so: bool| (format!("const {name}: bool = true;"), format!("const {name}: bool = {is_so};"));
    [told("RODS", rods), told("LARGE", large)].iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// One stage of the step.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// Name of the pair of files and of the kernel's entry point.
    pub name: &'static str,
    /// The WGSL, joined in this order.
    pub parts: &'static [Part],
    /// The storage buffers, at most 8.
    pub bindings: &'static [Binding],
    /// How many threads it has.
    pub threads: Threads,
    /// The CPU twin; the second argument is the pass.
    pub cpu: fn(&mut World, u32),
}

/// Every stage there is, once.
pub const ALL: [&Stage; 48] = [
    &update_aabbs::STAGE,
    &count_pairs::STAGE,
    &scan_pairs::STAGE,
    &fill_pairs::STAGE,
    &sort_axis::STAGE,
    &bound_blocks::STAGE,
    &count_near::STAGE,
    &fill_near::STAGE,
    &plan_lists::STAGE,
    &build_grid::STAGE,
    &clear_cells::STAGE,
    &count_cells::STAGE,
    &scan_cells::SUM,
    &scan_cells::PLACE,
    &sort_cells::STAGE,
    &count_long::STAGE,
    &find_neighbours::STAGE,
    &fill_long::STAGE,
    &find_collisions::STAGE,
    &list_collisions::STAGE,
    &weigh_networks::STAGE,
    &weigh_collisions::STAGE,
    &sweep_at_once::STAGE,
    &sweep_collisions::STAGE,
    &gather_impulses::STAGE,
    &project_networks::STAGE,
    &apply_collisions::STAGE,
    &commit_collisions::STAGE,
    &rub_contacts::STAGE,
    &commit_rubs::STAGE,
    &restore_lengths::STAGE,
    &rod_forces::STAGE,
    &advance::STAGE,
    &finish::STAGE,
    &finish_and_turn::STAGE,
    &leap::STAGE,
    &commit_leap::STAGE,
    &commit_and_turn::STAGE,
    &constrain::STAGE,
    &turn::STAGE,
    &end_step::STAGE,
    &run_steps::STAGE,
    &key_spheres::STAGE,
    &count_digits::STAGE,
    &scatter_digits::STAGE,
    &permute_spheres::STAGE,
    &settle_spheres::STAGE,
    &measure_order::STAGE,
];
