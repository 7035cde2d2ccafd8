//! Which stages run when: [`Phase::stages`] is the step's table of contents.

use crate::model::layout::{CELL_BLOCK, SWEEPS, SWEEPS_FEW, SWEEPS_OFF, SWEEPS_ON};
use crate::model::step::Step;
use crate::model::world::World;
use crate::settings::{BroadPhase, Integrator};
use crate::step::aabbs::update_aabbs;
use crate::step::broad_phase::brute_force::{count_pairs, fill_pairs};
use crate::step::broad_phase::grid::{
    build_grid, clear_cells, count_cells, count_long, fill_long, find_neighbours, plan_lists, scan_cells, sort_cells,
};
use crate::step::broad_phase::scan_pairs;
use crate::step::broad_phase::sort_and_skip::{bound_blocks, count_near, fill_near, sort_axis};
use crate::step::collisions::{
    apply_collisions, apply_friction_impulses, commit_collisions, commit_friction_impulses, find_collisions, gather_impulses,
    list_collisions, project_networks, sweep_at_once, sweep_collisions, weigh_collisions, weigh_networks,
};
use crate::step::forces::rod_forces;
use crate::step::integrate::{
    advance, commit_and_turn, commit_symplectic_euler, constrain, end_step, finish, finish_and_turn, restore_lengths,
    symplectic_euler, turn,
};
use crate::step::reorder::{count_digits, key_spheres, measure_order, permute_spheres, scatter_digits, settle_spheres};
use crate::step::stage::Stage;

/// In which scenes a run has something to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// In all.
    Always,
    /// In those with rods.
    Rods,
    /// In those without.
    NoRods,
    /// In those whose collisions are listed before they are applied.
    Listed,
    /// In those with networks of fixed-length rods, whose collisions are solved by sweeps.
    Networks,
    /// In those whose collisions share bodies, or did so not long ago: a dispatch a sweep.
    Swept,
    /// The same where they are few: one dispatch for all sweeps.
    SweptAtOnce,
    /// In those with large spheres, whose collisions are solved by sweeps.
    LargeSwept,
    /// In those whose contacts get friction impulses.
    FrictionImpulses,
    /// In small ones, whose grid is one block of cells.
    OneBlock,
    /// In larger ones.
    ManyBlocks,
    /// In those with bodies much larger than most.
    LongMovers,
    /// In those so large that stages with nothing to do take time.
    Planned,
}

/// A stage, the pass it is run for, in which scenes and how often.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// The stage.
    pub stage: &'static Stage,
    /// 0..4 for the force evaluations of RK4, 0 and 1 for `sort_axis`, 0..8 for the digits of a sort, else 0.
    pub pass: u32,
    /// Where it is left out.
    pub when: When,
    /// In which steps of a batch: every so many-th, from the first on.
    pub every: u32,
    /// Whether `plan_lists` decides how many workgroups there are, where it is part of the step.
    pub planned: bool,
}

impl Run {
    /// Whether it is part of the step in a world of these counts.
    pub fn applies(&self, step: &Step) -> bool {
        match self.when {
            When::Always => true,
            When::Rods => step.rods > 0,
            When::NoRods => step.rods == 0,
            When::Listed => step.sweeps != SWEEPS_OFF,
            When::Networks => step.networks > 0 && step.sweeps == SWEEPS_ON,
            When::Swept => step.sweeps == SWEEPS_ON,
            When::SweptAtOnce => step.sweeps == SWEEPS_FEW,
            When::LargeSwept => step.large > 0 && step.sweeps == SWEEPS_ON,
            When::FrictionImpulses => step.has_friction_impulses(),
            When::OneBlock => step.cells == CELL_BLOCK,
            When::ManyBlocks => step.cells != CELL_BLOCK,
            When::LongMovers => step.long_at != 0,
            When::Planned => step.planned != 0,
        }
    }

    /// Workgroups in a world of these counts; 0: there is nothing to do.
    pub fn workgroups(&self, step: &Step) -> u32 {
        if self.applies(step) { self.stage.threads.workgroups(step) } else { 0 }
    }

    /// Whether it is part of a step of a batch, counted from 0.
    pub fn is_in(&self, step: u32) -> bool {
        step.is_multiple_of(self.every)
    }

    /// The CPU twin, where it applies.
    pub fn on_cpu(&self, world: &mut World) {
        if self.applies(&world.step) {
            (self.stage.cpu)(world, self.pass);
        }
    }

    const fn when(self, when: When) -> Self {
        Self { when, ..self }
    }

    const fn planned(self) -> Self {
        Self { planned: true, ..self }
    }
}

const fn run(stage: &'static Stage) -> Run {
    pass(stage, 0)
}

const fn pass(stage: &'static Stage, pass: u32) -> Run {
    Run { stage, pass, when: When::Always, every: 1, planned: false }
}

/// The phases of a step, each callable alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// AABBs of all objects.
    UpdateAabbs,
    /// Pair lists.
    BroadPhase,
    /// Impulses.
    HandleCollisions,
    /// Forces, integration, constraints.
    UpdatePositions,
}

impl Phase {
    /// A step's phases, in their order.
    pub const STEP: [Self; 4] = [Self::UpdateAabbs, Self::BroadPhase, Self::HandleCollisions, Self::UpdatePositions];

    /// Whether it only makes what later phases look up: no result depends on how often.
    pub fn makes_lists(self) -> bool {
        matches!(self, Self::UpdateAabbs | Self::BroadPhase)
    }

    /// The stages of this phase, in their order. [`BroadPhase::Auto`] stands for brute force here.
    pub fn stages(self, integrator: Integrator, broad_phase: BroadPhase) -> &'static [Run] {
        match (self, integrator, broad_phase) {
            (Self::UpdateAabbs, _, BroadPhase::Grid) => {
                const { &[run(&plan_lists::STAGE).when(When::Planned), run(&update_aabbs::STAGE).planned()] }
            }
            (Self::UpdateAabbs, _, _) => const { &[run(&update_aabbs::STAGE)] },
            (Self::BroadPhase, _, BroadPhase::Grid) => {
                const {
                    &[
                        run(&plan_lists::STAGE).when(When::Planned),
                        run(&build_grid::STAGE).when(When::OneBlock),
                        run(&clear_cells::STAGE).when(When::ManyBlocks).planned(),
                        run(&count_cells::STAGE).when(When::ManyBlocks).planned(),
                        run(&scan_cells::SUM).when(When::ManyBlocks).planned(),
                        run(&scan_cells::PLACE).when(When::ManyBlocks).planned(),
                        run(&sort_cells::STAGE).when(When::ManyBlocks).planned(),
                        run(&count_long::STAGE).when(When::LongMovers).planned(),
                        run(&find_neighbours::STAGE).planned(),
                        run(&fill_long::STAGE).when(When::LongMovers).planned(),
                    ]
                }
            }
            (Self::BroadPhase, _, BroadPhase::SortAndSkip) => {
                const {
                    &[
                        pass(&sort_axis::STAGE, 0),
                        pass(&sort_axis::STAGE, 1),
                        run(&bound_blocks::STAGE),
                        run(&count_near::STAGE),
                        run(&scan_pairs::STAGE),
                        run(&fill_near::STAGE),
                    ]
                }
            }
            (Self::BroadPhase, _, _) => const { &[run(&count_pairs::STAGE), run(&scan_pairs::STAGE), run(&fill_pairs::STAGE)] },
            (Self::HandleCollisions, _, _) => HANDLE_COLLISIONS,
            (Self::UpdatePositions, Integrator::Rk4, _) => {
                const {
                    &[
                        run(&restore_lengths::STAGE),
                        pass(&rod_forces::STAGE, 0),
                        pass(&advance::STAGE, 0),
                        pass(&rod_forces::STAGE, 1),
                        pass(&advance::STAGE, 1),
                        pass(&rod_forces::STAGE, 2),
                        pass(&advance::STAGE, 2),
                        pass(&rod_forces::STAGE, 3),
                        pass(&finish::STAGE, 3).when(When::Rods),
                        run(&constrain::STAGE),
                        run(&turn::STAGE).when(When::Rods),
                        pass(&finish_and_turn::STAGE, 3).when(When::NoRods),
                        run(&end_step::STAGE),
                    ]
                }
            }
            (Self::UpdatePositions, Integrator::SymplecticEuler, _) => {
                const {
                    &[
                        run(&restore_lengths::STAGE),
                        run(&rod_forces::STAGE),
                        run(&symplectic_euler::STAGE),
                        run(&commit_symplectic_euler::STAGE).when(When::Rods),
                        run(&constrain::STAGE),
                        run(&turn::STAGE).when(When::Rods),
                        run(&commit_and_turn::STAGE).when(When::NoRods),
                        run(&end_step::STAGE),
                    ]
                }
            }
        }
    }
}

/// Finds collisions, and solves those that share bodies by sweeps: each is followed by what it makes of networks.
const HANDLE_COLLISIONS: &[Run] = &{
    const FIRST: usize = 5;
    const LAST: usize = FIRST + 3 * SWEEPS as usize;
    let mut runs = [run(&find_collisions::STAGE); LAST + 4];
    runs[1] = run(&list_collisions::STAGE).when(When::Listed);
    runs[2] = run(&weigh_networks::STAGE).when(When::Networks);
    runs[3] = run(&weigh_collisions::STAGE).when(When::Listed);
    runs[4] = run(&sweep_at_once::STAGE).when(When::SweptAtOnce);
    let mut sweep = 0;
    while sweep < SWEEPS as usize {
        let at = FIRST + 3 * sweep;
        runs[at] = pass(&sweep_collisions::STAGE, sweep as u32).when(When::Swept);
        runs[at + 1] = pass(&project_networks::STAGE, sweep as u32 + 1).when(When::Networks);
        runs[at + 2] = pass(&gather_impulses::STAGE, sweep as u32 + 1).when(When::LargeSwept);
        sweep += 1;
    }
    runs[LAST] = run(&apply_collisions::STAGE);
    runs[LAST + 1] = run(&commit_collisions::STAGE);
    runs[LAST + 2] = run(&apply_friction_impulses::STAGE).when(When::FrictionImpulses);
    runs[LAST + 3] = run(&commit_friction_impulses::STAGE).when(When::FrictionImpulses);
    runs
};

/// Puts spheres into spatial order in memory; lists and AABBs are void after it. Not part of a step.
pub const SORT_MEMORY: &[Run] = &{
    // 3 x 10 binary digits in eight passes; an even number ends where it began.
    let mut runs = [run(&key_spheres::STAGE); 35];
    let mut digit = 0;
    while digit < 8 {
        let at = 1 + 4 * digit;
        runs[at] = pass(&count_digits::STAGE, digit as u32);
        runs[at + 1] = run(&scan_cells::SUM);
        runs[at + 2] = run(&scan_cells::PLACE);
        runs[at + 3] = pass(&scatter_digits::STAGE, digit as u32);
        digit += 1;
    }
    runs[33] = run(&permute_spheres::STAGE);
    runs[34] = run(&settle_spheres::STAGE);
    runs
};

/// Tells how good the order of memory is, by the lists as they are. Not part of a step.
pub const MEASURE_ORDER: &[Run] = &[run(&measure_order::STAGE)];
