//! The CPU backend: the same stages over the same arrays, in plain Rust with rayon.
//!
//! It is written from the formulas of physics.md, never translated from the WGSL, so that the two can catch each other.

pub(crate) mod balls;
pub(crate) mod broad;
pub(crate) mod collision;
pub(crate) mod contact;
pub(crate) mod forces;
pub(crate) mod geometry;
pub(crate) mod grid;
pub(crate) mod lanes;
pub(crate) mod lengths;
pub(crate) mod lists;
pub(crate) mod rubbing;
pub(crate) mod state;
pub(crate) mod tally;
pub(crate) mod touch;
pub(crate) mod travel;
pub(crate) mod view;

use crate::stage::Run;
use crate::world::World;

/// Bodies that a thread takes at least: handing over fewer costs more than doing them.
pub(crate) const GRAIN: usize = 64;

/// How many pairs of objects the grid compares to make the lists of a world, after the stages of its broad phase. It grows as
/// the number of objects, and a test counts that it does.
pub fn pair_tests(world: &World) -> u64 {
    grid::pair_tests(world)
}

/// The most objects that a thread of a kernel looks at to make the list of its mover, after the stages of the grid broad phase. Long
/// movers are left out: a workgroup looks around for each.
pub fn longest_search(world: &World) -> u64 {
    grid::longest_search(world)
}

/// Runs stages in their order.
pub fn run(world: &mut World, runs: &[Run]) {
    for run in runs {
        run.on_cpu(world);
    }
}
