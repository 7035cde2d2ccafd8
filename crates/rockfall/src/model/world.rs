//! Everything a step reads and writes, as plain arrays of the layout that the GPU has too.
//!
//! A [`World`] is what the CPU backend runs on, what the GPU backend is filled from, and what tests compare.

pub(crate) mod build;
pub(crate) mod frames;
pub(crate) mod order;
pub(crate) mod topology;

use bytemuck::{bytes_of, bytes_of_mut, cast_slice, cast_slice_mut};
use glam::Vec4;

use crate::model::buffer::Buffer;
use crate::model::impulse::Impulse;
use crate::model::layout::{LINE, SLICE, words_of};
use crate::model::status::Status;
use crate::model::step::{Aabb, Step};

/// The buffers of [`Buffer`], on the host, and the uniform block.
///
/// What is scratch (stage states 2 to 4, AABBs, cells, extents, lists, wrenches) may be empty in a world that runs on a device:
/// that one has room for it from the counts.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// The uniform block.
    pub step: Step,
    /// `Start`, `Y2`, `Y3`, `Y4`: `3 * spheres` each.
    pub states: [Vec<Vec4>; 4],
    /// One an object.
    pub aabbs: Vec<Aabb>,
    /// Topology and static objects.
    pub topology: Vec<u32>,
    /// The grid's levels, cells, sums of blocks, keys, sorted objects.
    pub cells: Vec<u32>,
    /// One an object, in the order of the grid's keys: centre and largest half extent of its AABB, negative of what is no sphere.
    pub extents: Vec<Vec4>,
    /// Counts, slice offsets, entries: `step.entries_at` words and `step.pair_rows` rows of [`SLICE`].
    pub lists: Vec<u32>,
    /// What the collision phase of the CPU backend gave its contacts; scratch, which no device has.
    pub impulses: Vec<Impulse>,
    /// `4 * rods`: force and couple on end 1, force and couple on end 2.
    pub wrenches: Vec<Vec4>,
    /// The index in order of addition of the sphere in each memory slot; empty: they are the same.
    pub order: Vec<u32>,
    /// `spheres` unit quaternions x, y, z, w.
    pub orientations: Vec<Vec4>,
    /// Sizes of the dispatches that make lists, x, y and z each: as they are in this step, then as they are when there is something
    /// to do.
    pub sizes: Vec<u32>,
    /// The status block.
    pub status: Status,
}

impl World {
    /// Objects that have a list: spheres and rods.
    pub fn movers(&self) -> u32 {
        self.step.movers()
    }

    /// All objects.
    pub fn objects(&self) -> u32 {
        self.step.objects()
    }

    /// The index in order of addition of the sphere in a memory slot.
    pub fn user(&self, slot: usize) -> usize {
        self.order.get(slot).map_or(slot, |user| *user as usize)
    }

    /// Takes the order of memory from the words.
    pub(crate) fn take_order(&mut self) {
        if self.step.insertion_indices_at != 0 {
            let count = self.order.len();
            self.order.copy_from_slice(&self.topology[self.step.insertion_indices_at as usize..][..count]);
        }
    }

    /// The host's array of a buffer.
    pub fn bytes(&self, buffer: Buffer) -> &[u8] {
        match buffer {
            Buffer::Start => cast_slice(&self.states[0]),
            Buffer::Y2 => cast_slice(&self.states[1]),
            Buffer::Y3 => cast_slice(&self.states[2]),
            Buffer::Y4 => cast_slice(&self.states[3]),
            // A device alone has them.
            Buffer::States | Buffer::CollisionIndices | Buffer::Collisions => &[],
            Buffer::Aabbs => cast_slice(&self.aabbs),
            Buffer::Topology => cast_slice(&self.topology),
            Buffer::Cells => cast_slice(&self.cells),
            Buffer::Extents => cast_slice(&self.extents),
            Buffer::Lists => cast_slice(&self.lists),
            Buffer::Wrenches => cast_slice(&self.wrenches),
            Buffer::Orientations => cast_slice(&self.orientations),
            Buffer::DispatchSizes => cast_slice(&self.sizes),
            Buffer::Status => bytes_of(&self.status),
        }
    }

    /// The same, to write to.
    pub fn bytes_mut(&mut self, buffer: Buffer) -> &mut [u8] {
        match buffer {
            Buffer::Start => cast_slice_mut(&mut self.states[0]),
            Buffer::Y2 => cast_slice_mut(&mut self.states[1]),
            Buffer::Y3 => cast_slice_mut(&mut self.states[2]),
            Buffer::Y4 => cast_slice_mut(&mut self.states[3]),
            Buffer::States | Buffer::CollisionIndices | Buffer::Collisions => &mut [],
            Buffer::Aabbs => cast_slice_mut(&mut self.aabbs),
            Buffer::Topology => cast_slice_mut(&mut self.topology),
            Buffer::Cells => cast_slice_mut(&mut self.cells),
            Buffer::Extents => cast_slice_mut(&mut self.extents),
            Buffer::Lists => cast_slice_mut(&mut self.lists),
            Buffer::Wrenches => cast_slice_mut(&mut self.wrenches),
            Buffer::Orientations => cast_slice_mut(&mut self.orientations),
            Buffer::DispatchSizes => cast_slice_mut(&mut self.sizes),
            Buffer::Status => bytes_of_mut(&mut self.status),
        }
    }

    /// Makes room for so many rows of list entries; the lists are void after it.
    pub fn set_pair_rows(&mut self, rows: u32) {
        self.set_pair_room(rows);
        self.lists = vec![0; self.list_words() as usize];
    }

    /// Words of the pair lists.
    pub(crate) fn list_words(&self) -> u64 {
        u64::from(self.step.entries_at) + words_of(self.step.pair_rows)
    }

    /// Words of the numbers of listed collisions: as many as of list entries, where there is room for collisions.
    #[cfg(feature = "gpu")]
    pub(crate) fn slot_words(&self) -> u64 {
        if self.step.collision_room > 0 { words_of(self.step.pair_rows) } else { 0 }
    }

    /// [`World::set_pair_rows`] for a world that runs on a device: the host's lists are empty.
    pub(crate) fn set_pair_room(&mut self, rows: u32) {
        let slices = self.movers().div_ceil(SLICE);
        self.step.pair_rows = rows;
        self.step.slices_at = slices * SLICE;
        self.step.entries_at = (self.step.slices_at + slices + 1).next_multiple_of(LINE);
        self.lists = Vec::new();
    }
}
