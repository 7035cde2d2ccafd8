//! The memory that both backends share: plain structs, and the layouts of the buffers.
//!
//! Every GPU buffer that the CPU backend uses too has a host array of the same layout in [`World`](world::World). The WGSL
//! of these declarations is `model/step.wgsl` and what `model/declared.rs` generates from the Rust side.
//!
//! ```text
//! object ids   spheres, then rods, then boxes, then polygons, each in insertion order. Spheres may be stored in another
//!              order (`insertion_indices_at`); then the id of a sphere is its memory slot.
//! movers       spheres and rods: the objects that have a pair list
//! state        3 n vec4 for n spheres: n x (position, radius), n x (velocity, inverse mass),
//!              n x (angular momentum, inverse inertia); with double precision also n x (low part of the position, 0)
//! topology     u32: rods, springs, tethers, external forces, muscles, boxes, polygons, tags, pairs, insertion indices, slots,
//!              batches, ends, networks, adjacency (record sizes: the WORDS constants of `layout`)
//! lists        u32, in rows of SLICE words: counts (one per mover, padded to whole slices; the top bit is a flag),
//!              slice offsets in rows (one per slice and one for the end, padded to whole rows), entries
//! ```

pub mod buffer;
pub(crate) mod counters;
pub(crate) mod declare;
pub(crate) mod declared;
pub mod dispatch;
pub mod impulse;
pub(crate) mod lanes;
pub mod layout;
pub(crate) mod lists;
pub(crate) mod muscles;
pub mod part;
pub(crate) mod period;
pub(crate) mod residue;
pub(crate) mod rest;
pub(crate) mod rigid;
pub(crate) mod servo;
#[cfg(any(test, feature = "mpi"))]
pub(crate) mod shared;
pub(crate) mod state;
pub mod status;
pub mod step;
pub mod traits;
pub(crate) mod view;
pub mod world;
#[cfg_attr(
    any(not(feature = "gpu"), target_family = "wasm"),
    allow(dead_code, reason = "only the native GPU backend runs worlds")
)]
pub(crate) mod world_batch;
#[cfg_attr(
    any(not(feature = "gpu"), target_family = "wasm"),
    allow(dead_code, reason = "only the native GPU backend runs worlds")
)]
pub(crate) mod world_sizes;
