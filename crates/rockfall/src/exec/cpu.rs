//! The CPU backend: the same stages over the same arrays, in plain Rust with rayon.
//!
//! It is written from the formulas of physics.md, never translated from the WGSL, so that the two can catch each other.

use crate::model::world::World;
use crate::step::broad_phase::grid::cells;
use crate::step::schedule::Run;

/// How many pairs of objects the grid compares to make the lists of a world, after the stages of its broad phase. It grows as
/// the number of objects, and a test counts that it does.
pub fn pair_tests(world: &World) -> u64 {
    cells::pair_tests(world)
}

/// The most objects that a thread of a kernel looks at to make the list of its mover, after the stages of the grid broad phase. Long
/// movers are left out: a workgroup looks around for each.
pub fn longest_search(world: &World) -> u64 {
    cells::longest_search(world)
}

/// Runs stages in their order.
pub fn run(world: &mut World, runs: &[Run]) {
    for run in runs {
        run.on_cpu(world);
    }
}

/// Runs stages in their order; gives the time of each, in s.
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

/// The host's clock, which stands still in a browser.
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
