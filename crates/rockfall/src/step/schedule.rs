//! The order of the stages. [`Phase::stages`] lists the stages of each phase of a step.

use crate::model::dispatch::Threads;
use crate::model::layout::{
    AFTER_DRIFT, AFTER_EULER, AFTER_KICK, BEFORE_STEP, EARLY, RESTORING, SERVO_END, SWEEPS, SWEEPS_FEW, SWEEPS_ON,
};
use crate::model::step::Step;
use crate::model::world::World;
use crate::settings::{BroadPhase, Integrator};
use crate::step::aabbs::update_aabbs;
use crate::step::bodies::move_bodies;
use crate::step::broad_phase::brute_force::{count_pairs, fill_pairs};
use crate::step::broad_phase::grid::{
    clear_cells, count_cells, count_long, fill_long, find_neighbours, scan_cells, sort_cells,
};
use crate::step::broad_phase::scan_pairs;
use crate::step::broad_phase::sort_and_skip::{bound_blocks, count_near, fill_near, sort_axis};
use crate::step::collisions::{
    apply_collisions, apply_friction_impulses, commit_collisions, commit_friction_impulses, find_collisions, find_crossings,
    gather_impulses, project_networks, sweep_at_once, sweep_collisions, synchronise, weigh_collisions, weigh_networks,
};
use crate::step::forces::{loads, rod_loads};
use crate::step::integrate::{advance, constrain, drift, end_step, find_passages, finish, kick, symplectic_euler, turn};
use crate::step::reorder::{count_digits, key_spheres, measure_order, permute_spheres, scatter_digits, settle_spheres};
use crate::step::stage::Stage;
use crate::step::walls::{drive_servos, move_walls, servo_loads};

/// The scenes that need a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// All scenes.
    Always,
    /// Scenes with rods.
    Rods,
    /// Scenes with networks of fixed-length rods, if collisions are solved by sweeps with a dispatch for each sweep.
    Networks,
    /// Scenes whose collisions share bodies, or did so recently (`SWEEPS_ON`). Each sweep is a dispatch.
    Swept,
    /// Scenes like [`When::Swept`] but with few collisions (`SWEEPS_FEW`). One dispatch makes all sweeps.
    SweptAtOnce,
    /// Scenes with large spheres, if collisions are solved by sweeps with a dispatch for each sweep.
    Gathered,
    /// Scenes whose contacts get friction impulses.
    FrictionImpulses,
    /// Scenes in which contacts that begin and end within a step are handled.
    Continuous,
    /// Scenes whose phase of collisions needs the accelerations by everything but contacts.
    Accelerated,
    /// Scenes with bodies much larger than most.
    LongMovers,
    /// Scenes in which boxes or polygons move.
    Walls,
    /// Scenes in which walls follow servos.
    Servos,
    /// Scenes in which passages through walls are counted.
    Passages,
    /// Scenes with rigid bodies.
    Rigid,
    /// Scenes that several processes share, on a GPU.
    Shared,
    /// Scenes in which orientations are updated after the integration: those with rods or rigid bodies.
    Turned,
}

/// One run of a stage: its pass, the scenes that need it, and how often it is run.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// The stage.
    pub stage: &'static Stage,
    /// The pass: 0..4 for the force evaluations of RK4, and for `move_walls` before them, 0 and 3 for those of velocity Verlet,
    /// 0 and 1 for `sort_axis` and `drive_servos`, 0..8 for the digits of a sort, 0..8 for `sweep_collisions`, 1..=8 for
    /// `project_networks` and `gather_impulses`, else 0. [`EARLY`] is added in passes that compute only the spheres of which
    /// other processes have copies.
    pub pass: u32,
    /// The scenes in which the stage is run.
    pub when: When,
    /// The stage is run in the steps whose number is a multiple of this (see [`Run::is_in`]).
    pub every: u32,
}

impl Run {
    /// Returns whether the run is part of a step with these parameters.
    pub fn applies(&self, step: &Step) -> bool {
        let (traits, sweeps) = (step.traits(), step.constants.sweeps);
        match self.when {
            When::Always => true,
            When::Rods => traits.rods,
            When::Networks => traits.networks && sweeps == SWEEPS_ON,
            When::Swept => sweeps == SWEEPS_ON,
            When::SweptAtOnce => sweeps == SWEEPS_FEW,
            When::Gathered => traits.large && sweeps == SWEEPS_ON,
            When::FrictionImpulses => traits.friction_impulses,
            When::Continuous => traits.continuous,
            When::Accelerated => synchronise::is_needed(&traits),
            When::LongMovers => traits.long_movers,
            When::Walls => traits.walls,
            When::Servos => traits.servos,
            When::Passages => traits.counts_passages(),
            When::Rigid => traits.rigid,
            When::Shared => step.layout.sent > 0,
            When::Turned => traits.turns_late(),
        }
    }

    /// Returns the number of workgroups in a step with these parameters, or 0 if there is nothing to do.
    pub fn workgroups(&self, step: &Step) -> u32 {
        let threads = if self.pass < EARLY { self.stage.threads } else { Threads::Sent };
        if self.applies(step) { threads.workgroups(step) } else { 0 }
    }

    /// Returns whether the run is part of the step with this number. Numbers begin at 0 where steps are first
    /// submitted, after a rejected step, and where the interval of lists changes.
    pub fn is_in(&self, step: u32) -> bool {
        step.is_multiple_of(self.every)
    }

    /// Runs the CPU twin, if the run is part of the step.
    pub fn on_cpu(&self, world: &mut World) {
        if self.applies(&world.step) {
            world.at_time_of_pass(self.pass, |world| (self.stage.cpu)(world, self.pass));
        }
    }

    const fn when(self, when: When) -> Self {
        Self { when, ..self }
    }
}

const fn run(stage: &'static Stage) -> Run {
    pass(stage, 0)
}

const fn pass(stage: &'static Stage, pass: u32) -> Run {
    Run { stage, pass, when: When::Always, every: 1 }
}

/// Puts walls where they are in pass `pass`.
const fn walls(pass: u32) -> Run {
    self::pass(&move_walls::STAGE, pass).when(When::Walls)
}

/// Finds the loads of servos in pass `pass`.
const fn servo_loads(pass: u32) -> Run {
    self::pass(&servo_loads::STAGE, pass).when(When::Servos)
}

/// Moves servos: pass 0 at the start of a step, [`SERVO_END`] at its end.
const fn servos(pass: u32) -> Run {
    self::pass(&drive_servos::STAGE, pass).when(When::Servos)
}

/// Computes only the spheres of which other processes have copies, so that their new state can be sent while the others are computed.
const fn early(stage: &'static Stage, pass: u32) -> Run {
    self::pass(stage, EARLY + pass).when(When::Shared)
}

/// Moves rigid bodies in pass `pass`.
const fn bodies(pass: u32) -> Run {
    self::pass(&move_bodies::STAGE, pass).when(When::Rigid)
}

/// Puts walls and the records of rigid bodies where they are at the start of the step. Runs first in every step, so that they are there
/// whatever happened to the step before.
pub const PLACE: &[Run] = &[servos(0), walls(0), bodies(BEFORE_STEP)];

/// A phase of a step. Each phase can be run on its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Computes the AABBs of all objects.
    UpdateAabbs,
    /// Builds the pair lists.
    BroadPhase,
    /// Finds collisions and applies their impulses.
    HandleCollisions,
    /// Computes forces, integrates, and applies constraints.
    UpdatePositions,
}

impl Phase {
    /// The phases of a step, in the order of the thesis. Whole steps run `HandleCollisions` first.
    pub const STEP: [Self; 4] = [Self::UpdateAabbs, Self::BroadPhase, Self::HandleCollisions, Self::UpdatePositions];

    /// Returns whether the phase only builds AABBs and lists for later phases. Results do not depend on how often it is run.
    pub fn makes_lists(self) -> bool {
        matches!(self, Self::UpdateAabbs | Self::BroadPhase)
    }

    /// Returns the stages of this phase, in their order. [`BroadPhase::Auto`] is treated as brute force here.
    pub fn stages(self, integrator: Integrator, broad_phase: BroadPhase) -> &'static [Run] {
        match (self, integrator, broad_phase) {
            (Self::UpdateAabbs, _, _) => const { &[run(&update_aabbs::STAGE)] },
            (Self::BroadPhase, _, BroadPhase::Grid) => {
                const {
                    &[
                        run(&clear_cells::STAGE),
                        run(&count_cells::STAGE),
                        run(&scan_cells::SUM),
                        run(&scan_cells::PLACE),
                        run(&sort_cells::STAGE),
                        run(&count_long::STAGE).when(When::LongMovers),
                        run(&find_neighbours::STAGE),
                        run(&fill_long::STAGE).when(When::LongMovers),
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
                        pass(&constrain::STAGE, RESTORING),
                        pass(&rod_loads::STAGE, 0),
                        pass(&loads::STAGE, 0),
                        servo_loads(0),
                        pass(&advance::STAGE, 0),
                        walls(1),
                        pass(&rod_loads::STAGE, 1),
                        pass(&loads::STAGE, 1),
                        pass(&advance::STAGE, 1),
                        pass(&rod_loads::STAGE, 2),
                        pass(&loads::STAGE, 2),
                        pass(&advance::STAGE, 2),
                        walls(3),
                        pass(&rod_loads::STAGE, 3),
                        pass(&loads::STAGE, 3),
                        pass(&finish::STAGE, 3),
                        run(&constrain::STAGE),
                        run(&turn::STAGE).when(When::Turned),
                        pass(&find_passages::STAGE, 3).when(When::Passages),
                        servos(SERVO_END),
                        run(&end_step::STAGE),
                    ]
                }
            }
            (Self::UpdatePositions, Integrator::SymplecticEuler, _) => {
                const {
                    &[
                        pass(&constrain::STAGE, RESTORING),
                        run(&rod_loads::STAGE),
                        early(&loads::STAGE, 0),
                        early(&symplectic_euler::STAGE, 0),
                        run(&loads::STAGE),
                        servo_loads(0),
                        walls(3),
                        run(&symplectic_euler::STAGE),
                        run(&constrain::STAGE),
                        run(&turn::STAGE).when(When::Turned),
                        bodies(AFTER_EULER),
                        pass(&find_passages::STAGE, 3).when(When::Passages),
                        servos(SERVO_END),
                        run(&end_step::STAGE),
                    ]
                }
            }
            (Self::UpdatePositions, Integrator::VelocityVerlet, _) => {
                const {
                    &[
                        pass(&constrain::STAGE, RESTORING),
                        run(&rod_loads::STAGE),
                        run(&loads::STAGE),
                        run(&drift::STAGE),
                        pass(&constrain::STAGE, 3),
                        bodies(AFTER_DRIFT),
                        walls(3),
                        pass(&rod_loads::STAGE, 3),
                        early(&loads::STAGE, 3),
                        early(&kick::STAGE, 3),
                        pass(&loads::STAGE, 3),
                        servo_loads(3),
                        pass(&kick::STAGE, 3),
                        run(&constrain::STAGE),
                        run(&turn::STAGE).when(When::Turned),
                        bodies(AFTER_KICK),
                        pass(&find_passages::STAGE, 3).when(When::Passages),
                        servos(SERVO_END),
                        run(&end_step::STAGE),
                    ]
                }
            }
        }
    }
}

/// Finds collisions, solves those that share bodies by sweeps, and applies the impulses. After each sweep `project_networks`
/// computes the changes of velocity in networks, and `gather_impulses` those of large spheres. Crossings are found first, because
/// the other contacts of their spheres do not collide, and applied last, to spheres that no other collision changes.
const HANDLE_COLLISIONS: &[Run] = &{
    const FIRST: usize = 6;
    const LAST: usize = FIRST + 3 * SWEEPS as usize;
    let mut runs = [run(&synchronise::STAGE).when(When::Accelerated); LAST + 4];
    runs[1] = run(&find_crossings::STAGE).when(When::Continuous);
    runs[2] = run(&find_collisions::STAGE);
    runs[3] = run(&weigh_networks::STAGE).when(When::Networks);
    runs[4] = run(&weigh_collisions::STAGE);
    runs[5] = run(&sweep_at_once::STAGE).when(When::SweptAtOnce);
    let mut sweep = 0;
    while sweep < SWEEPS as usize {
        let at = FIRST + 3 * sweep;
        runs[at] = pass(&sweep_collisions::STAGE, sweep as u32).when(When::Swept);
        runs[at + 1] = pass(&project_networks::STAGE, sweep as u32 + 1).when(When::Networks);
        runs[at + 2] = pass(&gather_impulses::STAGE, sweep as u32 + 1).when(When::Gathered);
        sweep += 1;
    }
    runs[LAST] = run(&apply_collisions::STAGE);
    runs[LAST + 1] = run(&commit_collisions::STAGE);
    runs[LAST + 2] = run(&apply_friction_impulses::STAGE).when(When::FrictionImpulses);
    runs[LAST + 3] = run(&commit_friction_impulses::STAGE).when(When::FrictionImpulses);
    runs
};

/// Puts spheres into spatial order in memory. Lists and AABBs are invalid afterwards. Not part of a step.
pub const SORT_MEMORY: &[Run] = &{
    // A key has 32 bits: 3 x 10 bits of the Z-order curve and 2 bits of the size class. Each of the eight passes sorts by 4
    // bits. The number of passes is even, so that the sorted pairs end in the buffer that they began in.
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

/// Measures how well memory is ordered, from the current lists. Not part of a step.
pub const MEASURE_ORDER: &[Run] = &[run(&measure_order::STAGE)];
