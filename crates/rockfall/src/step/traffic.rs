//! Computes the least number of bytes that a stage must move, from the counts alone.
//!
//! Every array that a stage must read or write is counted once for reading and once for writing, as if caches were perfect.
//! Reading a neighbour's position for every contact therefore adds nothing, because the neighbour's own thread reads it too. The
//! entries of the pair lists are counted with the padding of their slices, which is read with them. Data that only some bodies
//! need (weights of collisions, constraints of fixed rods, springs) is left out, so the sums are lower bounds.

use crate::model::layout::{SLICE, words_of_rows};
use crate::model::status::Status;
use crate::model::step::Step;
use crate::step::schedule::Run;

/// Least number of bytes that a run must move, with the counts of `step` and the list entries of `status`.
pub(crate) fn least_bytes(run: &Run, step: &Step, status: &Status) -> u64 {
    if run.workgroups(step) == 0 {
        return 0;
    }
    let moves = (run.stage.moves)(run.pass);
    let (spheres, rods) = (u64::from(step.layout.spheres), u64::from(step.layout.rods));
    let (movers, objects) = (u64::from(step.movers()), u64::from(step.objects()));
    moves.rows * 16 * spheres
        + moves.sphere_aabbs * 32 * spheres
        + moves.aabbs * 32 * objects
        + moves.tags * 4 * objects
        + moves.counts * 4 * (movers + movers.div_ceil(u64::from(SLICE)))
        + moves.entries * 4 * words_of_rows(status.pair_rows_needed)
        + moves.cells * 4 * u64::from(step.layout.cells)
        + moves.keys * 4 * objects
        + moves.extents * 16 * objects
        + moves.rods * 16 * rods
        + moves.wrenches * 64 * rods
        + moves.rates * 24 * spheres
        + if step.has_residues() { moves.residues * 16 * spheres } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::step::Layout;
    use crate::settings::{BroadPhase, Integrator};
    use crate::step::schedule::Phase;

    fn per_sphere(integrator: Integrator) -> u64 {
        let layout = Layout { spheres: 1 << 20, cells: 1 << 20, ..Layout::default() };
        let step = Step { layout, ..Step::default() };
        // Six entries per sphere.
        let status = Status { pair_rows_needed: (6 << 20) / SLICE, ..Status::default() };
        let runs = Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::Grid));
        runs.map(|run| least_bytes(run, &step, &status)).sum::<u64>() >> 20
    }

    #[test]
    fn a_step_moves_a_plausible_number_of_bytes() {
        let (rk4, euler) = (per_sphere(Integrator::Rk4), per_sphere(Integrator::SymplecticEuler));
        // Reading and writing six states in four evaluations takes more than 700 bytes. Lists and AABBs add to that.
        assert!((1000..2500).contains(&rk4), "{rk4}");
        assert!(euler < rk4 && euler > 500, "{euler}");
    }
}
