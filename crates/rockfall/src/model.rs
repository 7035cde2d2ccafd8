//! The memory that both backends share: plain structs and the offsets of what the buffers hold.
//!
//! Every buffer of the GPU has a host array of the same layout in [`World`](world::World). The WGSL side of
//! these declarations is `model/step.wgsl`; a test reflects it and compares names, offsets, types and sizes.
//!
//! ```text
//! object ids   spheres, then rods, then boxes, then polygons, each in order of addition; spheres may stand in another
//!              order in memory (`insertion_indices_at`), then a sphere's id is its memory slot
//! movers       spheres and rods: the objects that have a list of pairs
//! state        3 n vec4 for n spheres: n x (position, radius), n x (velocity, inverse mass),
//!              n x (angular momentum, inverse inertia)
//! words        u32: rods, springs, tethers, boxes, polygons, tags, users, slots, batches, ends, adjacency (see the WORDS
//!              constants)
//! lists        u32, in rows of SLICE words: counts (one a mover, padded to whole slices; the top bit is a mark), slice
//!              offsets in rows (one a slice and the end, padded to whole rows), entries
//! row sums     f32, in scenes with rods: one a word of the list entries, of those that collide
//! ```

pub mod buffer;
pub(crate) mod counters;
pub mod dispatch;
pub mod impulse;
pub(crate) mod lanes;
pub mod layout;
pub(crate) mod lists;
pub(crate) mod state;
pub mod status;
pub mod step;
pub(crate) mod view;
pub mod world;
