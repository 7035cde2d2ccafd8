//! Broad phase, 2 of 3: where the slices begin, and whether the entries fit.
//!
//! A slice is as wide as its longest list: slice offsets are the exclusive sums of `SLICE * max(counts of the slice)`,
//! the last one is the total. More than `pair_capacity` voids the step (`VOID_PAIRS`, `pairs_needed`).

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "scan_pairs",
    parts: &[part!("wgsl/step.wgsl"), part!("stage/scan_pairs.wgsl")],
    bindings: &[write("lists", Buffer::Lists), write("status", Buffer::Status)],
    threads: Threads::One,
    cpu: scan_pairs,
};

fn scan_pairs(_world: &mut World, _pass: u32) {
    unimplemented!()
}
