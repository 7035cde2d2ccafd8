//! The CPU backend: runs the same stages over the same arrays, in plain Rust with rayon.
//!
//! It is written from the formulas of docs/physics, never translated from the WGSL, so that each of the two can reveal errors in
//! the other.

use crate::model::world::World;
use crate::step::broad_phase::grid::cells;
use crate::step::schedule::Run;

/// Number of pairs of objects that the grid compares to build the lists of a world. Call it after the stages of the grid broad
/// phase. The number grows in proportion to the number of objects, which a test checks.
pub fn pair_tests(world: &World) -> u64 {
    cells::pair_tests(world)
}

/// The largest number of objects that one thread of a kernel compares to build the list of its mover. Call it after the stages
/// of the grid broad phase. Long movers are left out, because a whole workgroup searches for each of them.
pub fn longest_search(world: &World) -> u64 {
    cells::longest_search(world)
}

/// Runs stages in order.
pub fn run(world: &mut World, runs: &[Run]) {
    for run in runs {
        run.on_cpu(world);
    }
}

/// Runs stages in order and returns the time of each, in s. `None` stands for a stage without work.
pub(crate) fn run_timed(world: &mut World, stages: &[Run]) -> Vec<Option<f64>> {
    let timed = |run: &Run| {
        if run.workgroups(&world.step) == 0 {
            return None;
        }
        let watch = Watch::start();
        run.on_cpu(world);
        Some(watch.seconds())
    };
    stages.iter().map(timed).collect()
}

/// A stopwatch on the host's clock. In a browser it always reads 0.
pub(crate) struct Watch {
    #[cfg(not(target_family = "wasm"))]
    start: std::time::Instant,
}

impl Watch {
    pub(crate) fn start() -> Self {
        Self {
            #[cfg(not(target_family = "wasm"))]
            start: std::time::Instant::now(),
        }
    }

    pub(crate) fn seconds(&self) -> f64 {
        #[cfg(not(target_family = "wasm"))]
        return self.start.elapsed().as_secs_f64();
        #[cfg(target_family = "wasm")]
        0.0
    }
}
