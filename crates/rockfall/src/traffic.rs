//! Computes the least number of bytes that a stage must move, from the counts alone.
//!
//! Every array that a stage must read or write is counted once for reading and once for writing, as if caches were perfect.
//! Reading a neighbour's position for every contact therefore costs nothing, because its cache line is needed anyway. The
//! entries of the pair lists are counted with the padding of their slices, which is read with them. Data that only some bodies
//! need (weights of collisions, constraints of fixed rods, springs) is left out, so the sums are lower bounds.

use crate::model::buffer::Buffer;
use crate::model::layout::{SLICE, words_of_rows};
use crate::model::status::Status;
use crate::model::step::Step;
use crate::step::schedule::Run;
use crate::step::stage::{Access, Stage};

/// How many times a stage must move the data of each kind.
#[derive(Clone, Copy, Default)]
struct Moves {
    /// Rows of 16 bytes per sphere: position and radius, velocity and inverse mass, angular momentum and inverse inertia,
    /// orientation.
    rows: u64,
    /// AABBs of spheres, 32 bytes each.
    sphere_aabbs: u64,
    /// AABBs of all objects.
    aabbs: u64,
    /// Tags of all objects, 4 bytes each.
    tags: u64,
    /// Counts of the pair lists, 4 bytes per mover, and slice offsets.
    counts: u64,
    /// Entries of the pair lists, 4 bytes each.
    entries: u64,
    /// Cells of the grid, 4 bytes each.
    cells: u64,
    /// Keys or ids of all objects in the grid, 4 bytes each.
    keys: u64,
    /// Extents of all objects, 16 bytes each.
    extents: u64,
    /// Records of the rods, 16 bytes each.
    rods: u64,
    /// Forces on rods, 64 bytes per rod.
    wrenches: u64,
}

const NONE: Moves = Moves {
    rows: 0,
    sphere_aabbs: 0,
    aabbs: 0,
    tags: 0,
    counts: 0,
    entries: 0,
    cells: 0,
    keys: 0,
    extents: 0,
    rods: 0,
    wrenches: 0,
};

/// Data that every force evaluation reads in addition to the state.
const FORCES: Moves = Moves { counts: 1, entries: 1, wrenches: 1, ..NONE };

/// The moves of a stage; `None` for a stage that this table does not contain.
#[rustfmt::skip]
fn moves(name: &str, pass: u32) -> Option<Moves> {
    Some(match name {
        // Reads position and velocity.
        "update_aabbs" => Moves { rows: 2, tags: 1, aabbs: 1, rods: 1, ..NONE },
        "count_pairs" => Moves { aabbs: 1, counts: 1, ..NONE },
        "scan_pairs" => Moves { counts: 1, ..NONE },
        "fill_pairs" => Moves { aabbs: 1, counts: 1, entries: 1, ..NONE },
        "sort_axis" => Moves { aabbs: 1, keys: 2, ..NONE },
        "bound_blocks" => Moves { aabbs: 1, keys: 1, ..NONE },
        "count_near" => Moves { aabbs: 1, keys: 1, counts: 1, ..NONE },
        "fill_near" => Moves { aabbs: 1, keys: 1, counts: 1, entries: 1, ..NONE },
        // The sum of the following five stages before `find_neighbours`.
        "build_grid" => Moves { aabbs: 2, cells: 6, keys: 3, extents: 1, ..NONE },
        "clear_cells" | "sum_blocks" => Moves { cells: 1, ..NONE },
        // Adds to its cell, which is read and written; writes the key.
        "count_cells" => Moves { aabbs: 1, cells: 2, keys: 1, ..NONE },
        "place_cells" => Moves { cells: 2, ..NONE },
        // Reads the key, writes the id and the extent.
        "sort_cells" => Moves { aabbs: 1, cells: 2, keys: 2, extents: 1, ..NONE },
        "find_neighbours" => Moves { aabbs: 1, cells: 1, keys: 1, extents: 1, counts: 1, entries: 1, ..NONE },
        // Few movers are long.
        "count_long" | "fill_long" => NONE,
        // Reads position, velocity and entries. Few entries change.
        "find_collisions" => Moves { rows: 2, sphere_aabbs: 1, counts: 1, entries: 1, ..NONE },
        // Few bodies collide. The counts show which ones do not.
        "list_collisions" | "apply_collisions" | "commit_collisions" => Moves { counts: 1, ..NONE },
        // These process the collisions only.
        "weigh_collisions" | "sweep_at_once" | "sweep_collisions" | "weigh_networks" | "project_networks" | "gather_impulses" => NONE,
        // Reads and writes 3 rows; reads the entries for pressed contacts.
        "apply_friction_impulses" => Moves { rows: 6, counts: 1, entries: 1, ..NONE },
        "commit_symplectic_euler" | "commit_friction_impulses" => Moves { rows: 6, sphere_aabbs: 1, ..NONE },
        // Also reads and writes the orientation.
        "commit_and_turn" => Moves { rows: 8, sphere_aabbs: 1, ..NONE },
        "rod_forces" => Moves { rods: 1, wrenches: 1, ..NONE },
        // Reads 3 rows, writes 3. Later passes also read the 3 rows of the starting state, and the last one AABBs.
        "advance" => Moves { rows: if pass == 0 { 6 } else { 9 }, sphere_aabbs: u64::from(pass == 2), ..FORCES },
        // Reads 3 rows of four states; writes 3, and the old position and mean spin.
        "finish" => Moves { rows: 17, ..FORCES },
        // The same without the last two, but reads and writes the orientation.
        "finish_and_turn" => Moves { rows: 17, ..FORCES },
        // Reads 3 rows, writes 3.
        "symplectic_euler" => Moves { rows: 6, sphere_aabbs: 1, ..FORCES },
        // Reads the mean spin, reads and writes the orientation.
        "turn" => Moves { rows: 3, ..NONE },
        // Not part of a step, or in place of other stages, and not timed.
        "run_steps" | "key_spheres" | "count_digits" | "scatter_digits" | "permute_spheres" | "settle_spheres" | "measure_order" => NONE,
        "plan_lists" | "end_step" | "restore_lengths" | "constrain" => NONE,
        _ => return None,
    })
}

/// For a stage that `moves` does not contain: counts each of its bindings once, whole.
fn moves_by_bindings(stage: &Stage, pass: u32) -> Moves {
    let mut moves = NONE;
    for binding in stage.bindings {
        match (binding.slot.buffer(pass), binding.access) {
            (Buffer::Start | Buffer::Y2 | Buffer::Y3 | Buffer::Y4, _) => moves.rows += 3,
            (Buffer::Orientations, _) => moves.rows += 1,
            (Buffer::Aabbs, _) => moves.aabbs += 1,
            (Buffer::Lists, Access::Read) => (moves.counts, moves.entries) = (moves.counts + 1, moves.entries + 1),
            (Buffer::Lists, Access::Write) => moves.counts += 1,
            (Buffer::Cells, _) => moves.cells += 1,
            (Buffer::Extents, _) => moves.extents += 1,
            (Buffer::Wrenches, _) => moves.wrenches += 1,
            _ => {}
        }
    }
    moves
}

/// Least number of bytes that a run must move, with the counts of `step` and the list entries of `status`.
pub(crate) fn least_bytes(run: &Run, step: &Step, status: &Status) -> u64 {
    if run.workgroups(step) == 0 {
        return 0;
    }
    let moves = moves(run.stage.name, run.pass).unwrap_or_else(|| moves_by_bindings(run.stage, run.pass));
    let (spheres, rods) = (u64::from(step.spheres), u64::from(step.rods));
    let (movers, objects) = (u64::from(step.movers()), u64::from(step.objects()));
    moves.rows * 16 * spheres
        + moves.sphere_aabbs * 32 * spheres
        + moves.aabbs * 32 * objects
        + moves.tags * 4 * objects
        + moves.counts * 4 * (movers + movers.div_ceil(u64::from(SLICE)))
        + moves.entries * 4 * words_of_rows(status.pair_rows_needed)
        + moves.cells * 4 * u64::from(step.cells)
        + moves.keys * 4 * objects
        + moves.extents * 16 * objects
        + moves.rods * 16 * rods
        + moves.wrenches * 64 * rods
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{BroadPhase, Integrator};
    use crate::step::catalog::ALL;
    use crate::step::schedule::{Phase, When};

    fn per_sphere(integrator: Integrator) -> u64 {
        let step = Step { spheres: 1 << 20, cells: 1 << 20, ..Step::default() };
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

    #[test]
    fn unknown_stages_are_estimated_by_their_bindings() {
        let step = Step { spheres: 100, rods: 1, ..Step::default() };
        for stage in ALL.into_iter().filter(|stage| stage.name == "commit_symplectic_euler") {
            let by_bindings = moves_by_bindings(stage, 0).rows;
            assert_eq!(Some(by_bindings), moves(stage.name, 0).map(|moves| moves.rows));
            // Six rows of 16 bytes and an AABB of 32.
            assert_eq!(
                least_bytes(&Run { stage, pass: 0, when: When::Rods, every: 1, planned: false }, &step, &Status::default()),
                12_800
            );
        }
    }
}
