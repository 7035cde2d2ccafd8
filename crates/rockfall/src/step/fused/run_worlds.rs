//! Runs many steps of many small worlds in one dispatch. A workgroup has one world, or several small ones, in its memory.
//!
//! The kernel is made of the same files as the stages, so that it computes the same. It takes worlds without rods, without
//! collisions as impulses and without friction impulses. In such worlds no step has to be repeated. It has no lists: each
//! thread keeps the objects near its sphere as bits. `exec/gpu/worlds.rs` binds and dispatches it.

use bytemuck::{Pod, Zeroable};

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::status::NO_BODY;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The kernel. Each of its arrays holds the data of all worlds; the buffers only say how they are bound. It has no twin on the CPU
/// and is not part of a step.
pub(crate) const STAGE: Stage = Stage {
    name: "run_worlds",
    wgsl: Wgsl::File(part!("step/fused/run_worlds.wgsl")),
    bindings: &[
        read("parameters", Buffer::Rates),
        write("starts", Buffer::Start),
        read("topology", Buffer::Topology),
        write("turns", Buffer::Orientations),
        write("results", Buffer::Status),
    ],
    threads: Threads::One,
    moves: |_| NONE,
    cpu: |_, _| {},
};

/// What a world reports: `WorldResult` of the kernel. Counts begin with the upload of the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct WorldResult {
    pub(crate) steps: u32,
    pub(crate) rejected: u32,
    pub(crate) contacts: u32,
    pub(crate) max_overlap: u32,
    pub(crate) total_bad: u32,
    pub(crate) first_bad: u32,
    pub(crate) bad_step: u32,
    /// Steps one after the other, up to now, at whose end no sphere moved.
    pub(crate) calm: u32,
}

impl WorldResult {
    /// Before the first step.
    pub(crate) const START: Self =
        Self { steps: 0, rejected: 0, contacts: 0, max_overlap: 0, total_bad: 0, first_bad: NO_BODY, bad_step: 0, calm: 0 };
}
