//! Everything that a step reads and writes, as plain arrays with the layout of the GPU buffers.
//!
//! The CPU backend runs on a [`World`], the GPU backend is initialized from one, and tests compare worlds.

pub(crate) mod build;
mod constants;
pub(crate) mod frames;
pub(crate) mod muscles;
pub(crate) mod order;
mod rigid;
pub(crate) mod topology;
pub(crate) mod walls;

use bytemuck::{bytes_of, bytes_of_mut, cast_slice, cast_slice_mut};
use glam::{Vec2, Vec4};

use crate::model::buffer::Buffer;
use crate::model::impulse::Impulse;
use crate::model::layout::{
    FLAG_VERLET, HISTORY_BLOCK, HISTORY_WORDS, LAW_THESIS, LINE, NO_KEY, SERVO_ROWS, SLICE, words_of_rows,
};
use crate::model::muscles::MuscleClock;
use crate::model::rest::Rest;
use crate::model::status::Status;
use crate::model::step::{Aabb, Step};
use crate::user_laws::set::UserLaws;

/// The host arrays of the buffers in [`Buffer`], and the uniform block.
///
/// Scratch arrays (stage states 2 to 4, AABBs, cells, extents, lists, wrenches) may be empty in a world that runs on a device.
/// The device allocates these buffers from the object counts.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// The uniform block.
    pub step: Step,
    /// `Start`, `Y2`, `Y3`, `Y4`: [`Step::state_regions`] times `spheres` each.
    pub states: [Vec<Vec4>; 4],
    /// One AABB per object.
    pub aabbs: Vec<Aabb>,
    /// Topology and static objects.
    pub topology: Vec<u32>,
    /// The grid: levels, cells, block sums, keys, sorted objects, long movers.
    pub cells: Vec<u32>,
    /// Centre and largest half extent of the AABB of every object, in the order of the grid's keys. The half extent is negative
    /// for objects that are not spheres.
    pub extents: Vec<Vec4>,
    /// Counts, slice offsets, entries: `step.layout.entries_at` words and `step.layout.pair_rows` rows of [`SLICE`].
    pub lists: Vec<u32>,
    /// Impulses of the collision phase. Scratch of the CPU backend, without a buffer on the device.
    pub impulses: Vec<Impulse>,
    /// `4 * rods`: force and torque on end 1, force and torque on end 2. For laws with history, then `2 * spheres`: force and
    /// torque of contacts.
    pub wrenches: Vec<Vec4>,
    /// The springs of contacts (see [`Buffer::Histories`]); empty for the law of the thesis.
    pub histories: Vec<u32>,
    /// Velocity Verlet: acceleration and torque of every sphere (see [`Buffer::Rates`]); empty for other integrators.
    pub rates: Vec<f32>,
    /// The poses of bodies with a prescribed motion (see [`Buffer::Poses`]); empty without such bodies.
    pub poses: Vec<f32>,
    /// Displacement of the box above in a sheared scene at the step `pose_step`, in units of 2^-64 periods.
    pub(crate) shear_phase: u64,
    /// The state of rigid bodies, and scratch (see [`Buffer::RigidBodies`]).
    pub rigid_bodies: Vec<Vec4>,
    /// The servos (see [`Buffer::Servos`]); empty without walls that follow one.
    pub servos: Vec<Vec4>,
    /// What every sphere and rod contributes to every servo (see [`Buffer::ServoLoads`]). Scratch.
    pub servo_loads: Vec<Vec2>,
    /// Insertion index of the sphere in each memory slot; empty when slots and insertion indices are the same.
    pub order: Vec<u32>,
    /// `spheres` unit quaternions x, y, z, w.
    pub orientations: Vec<Vec4>,
    /// The status block.
    pub status: Status,
    /// Which spheres belong to this process, by insertion index, where several processes share a scene; empty if all do. The contacts
    /// of the others are not counted. [`World::set_own`] writes it.
    pub(crate) own: Vec<bool>,
    /// The spheres that are computed early, by insertion index.
    pub(crate) sent: Vec<u32>,
    /// The laws that the program gave.
    pub(crate) user_laws: UserLaws,
    /// The topology buffer has an external force for each sphere, in insertion order. Otherwise only for those with a force.
    pub(crate) has_force_on_each: bool,
    /// Whether stages may be joined that give the same together.
    pub(crate) joins_steps: bool,
    /// Counts steps without motion. Only the CPU backend does.
    pub(crate) rest: Option<Rest>,
    /// The clock for which the table of muscles was made.
    pub(crate) muscles_for: Option<MuscleClock>,
}

impl World {
    /// Number of objects that have a list: spheres and rods.
    pub fn movers(&self) -> u32 {
        self.step.movers()
    }

    /// Number of all objects.
    pub fn objects(&self) -> u32 {
        self.step.objects()
    }

    /// Returns the insertion index of the sphere in a memory slot.
    pub fn insertion_index(&self, slot: usize) -> usize {
        self.order.get(slot).map_or(slot, |index| *index as usize)
    }

    /// Copies the order of memory from the topology buffer to `order`.
    pub(crate) fn take_order(&mut self) {
        if self.step.layout.insertion_indices_at != 0 {
            let count = self.order.len();
            self.order.copy_from_slice(&self.topology[self.step.layout.insertion_indices_at as usize..][..count]);
        }
    }

    /// The bytes of the host array of a buffer.
    pub fn bytes(&self, buffer: Buffer) -> &[u8] {
        match buffer {
            Buffer::Start => cast_slice(&self.states[0]),
            Buffer::Y2 => cast_slice(&self.states[1]),
            Buffer::Y3 => cast_slice(&self.states[2]),
            Buffer::Y4 => cast_slice(&self.states[3]),
            // These exist on the device only.
            Buffer::CollisionIndices | Buffer::Collisions => &[],
            Buffer::Aabbs => cast_slice(&self.aabbs),
            Buffer::Topology => cast_slice(&self.topology),
            Buffer::Cells => cast_slice(&self.cells),
            Buffer::Extents => cast_slice(&self.extents),
            Buffer::Lists => cast_slice(&self.lists),
            Buffer::Wrenches => cast_slice(&self.wrenches),
            Buffer::Orientations => cast_slice(&self.orientations),
            Buffer::Histories => cast_slice(&self.histories),
            Buffer::Rates => cast_slice(&self.rates),
            Buffer::Poses => cast_slice(&self.poses),
            Buffer::RigidBodies => cast_slice(&self.rigid_bodies),
            Buffer::Servos => cast_slice(&self.servos),
            Buffer::ServoLoads => cast_slice(&self.servo_loads),
            Buffer::Status => bytes_of(&self.status),
        }
    }

    /// The bytes of the host array of a buffer, for writing.
    pub fn bytes_mut(&mut self, buffer: Buffer) -> &mut [u8] {
        match buffer {
            Buffer::Start => cast_slice_mut(&mut self.states[0]),
            Buffer::Y2 => cast_slice_mut(&mut self.states[1]),
            Buffer::Y3 => cast_slice_mut(&mut self.states[2]),
            Buffer::Y4 => cast_slice_mut(&mut self.states[3]),
            Buffer::CollisionIndices | Buffer::Collisions => &mut [],
            Buffer::Aabbs => cast_slice_mut(&mut self.aabbs),
            Buffer::Topology => cast_slice_mut(&mut self.topology),
            Buffer::Cells => cast_slice_mut(&mut self.cells),
            Buffer::Extents => cast_slice_mut(&mut self.extents),
            Buffer::Lists => cast_slice_mut(&mut self.lists),
            Buffer::Wrenches => cast_slice_mut(&mut self.wrenches),
            Buffer::Orientations => cast_slice_mut(&mut self.orientations),
            Buffer::Histories => cast_slice_mut(&mut self.histories),
            Buffer::Rates => cast_slice_mut(&mut self.rates),
            Buffer::Poses => cast_slice_mut(&mut self.poses),
            Buffer::RigidBodies => cast_slice_mut(&mut self.rigid_bodies),
            Buffer::Servos => cast_slice_mut(&mut self.servos),
            Buffer::ServoLoads => cast_slice_mut(&mut self.servo_loads),
            Buffer::Status => bytes_of_mut(&mut self.status),
        }
    }

    /// Number of vectors in `wrenches`.
    pub(crate) fn wrench_count(&self) -> usize {
        (4 * self.step.layout.rods + 2 * self.step.layout.spheres) as usize
    }

    /// Number of elements in `servo_loads`.
    pub(crate) fn servo_load_count(&self) -> usize {
        self.servos.len() / SERVO_ROWS as usize * self.movers() as usize
    }

    /// Number of vectors in a state.
    pub(crate) fn rows_of_state(&self, state: usize) -> usize {
        (self.step.state_regions(state) * self.step.layout.spheres) as usize
    }

    /// Whether a pass evaluates forces. Pass 0 of velocity Verlet does so only if the forces of the last step do not belong to the
    /// present state.
    pub(crate) fn needs_forces(&self, pass: u32) -> bool {
        pass == self.step.counted_pass() || self.step.constants.flags & FLAG_VERLET == 0 || self.status.forces_due != 0
    }

    /// Gives either table of springs a pool of `blocks` blocks, and keeps the springs before the step, whose chains must fit. With the
    /// law of the thesis there are no springs.
    pub fn set_history_pool(&mut self, blocks: u32) {
        let old = self.history_words();
        self.step.layout.history_pool = if self.step.layout.law == LAW_THESIS { 0 } else { blocks };
        let table = self.history_words();
        let mut histories = vec![NO_KEY; 2 * table];
        if self.histories.len() == 2 * old {
            // Links are numbers of blocks within a table, so they stay valid.
            let (kept, first) = (old.min(table), self.status.history_table as usize);
            histories[first * table..][..kept].copy_from_slice(&self.histories[first * old..][..kept]);
        }
        self.histories = histories;
    }

    /// Words of a table of springs: the blocks of the movers and those of the pool.
    pub(crate) fn history_words(&self) -> usize {
        let blocks = if self.step.layout.law == LAW_THESIS { 0 } else { self.step.history_table_blocks() };
        blocks as usize * (HISTORY_BLOCK * HISTORY_WORDS) as usize
    }

    /// Allocates `rows` rows of list entries. The contents of the lists are lost.
    pub fn set_pair_rows(&mut self, rows: u32) {
        self.set_pair_room(rows);
        self.lists = vec![0; self.list_words() as usize];
    }

    /// Number of words in the pair lists.
    pub(crate) fn list_words(&self) -> u64 {
        u64::from(self.step.layout.entries_at) + words_of_rows(self.step.layout.pair_rows)
    }

    /// Number of words in `Buffer::CollisionIndices`: one per word of the list entries; 0 without room for collisions.
    #[cfg(feature = "gpu")]
    pub(crate) fn collision_index_words(&self) -> u64 {
        if self.step.layout.collision_room > 0 { words_of_rows(self.step.layout.pair_rows) } else { 0 }
    }

    /// Sets the sizes and offsets for `rows` rows of list entries, but leaves the lists on the host empty. For a world that
    /// runs on a device.
    pub(crate) fn set_pair_room(&mut self, rows: u32) {
        let slices = self.movers().div_ceil(SLICE);
        self.step.layout.pair_rows = rows;
        self.step.layout.slices_at = slices * SLICE;
        self.step.layout.entries_at = (self.step.layout.slices_at + slices + 1).next_multiple_of(LINE);
        self.lists = Vec::new();
    }
}
