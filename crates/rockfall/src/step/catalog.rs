//! The list of all stages.

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
use crate::step::fused::run_worlds;
use crate::step::integrate::{advance, constrain, drift, end_step, find_passages, finish, kick, symplectic_euler, turn};
use crate::step::reorder::{count_digits, key_spheres, measure_order, permute_spheres, scatter_digits, settle_spheres};
use crate::step::stage::Stage;
use crate::step::walls::{drive_servos, move_walls, servo_loads};

/// All stages, each once.
pub const ALL: [&Stage; 50] = [
    &drive_servos::STAGE,
    &move_walls::STAGE,
    &update_aabbs::STAGE,
    &count_pairs::STAGE,
    &scan_pairs::STAGE,
    &fill_pairs::STAGE,
    &sort_axis::STAGE,
    &bound_blocks::STAGE,
    &count_near::STAGE,
    &fill_near::STAGE,
    &clear_cells::STAGE,
    &count_cells::STAGE,
    &scan_cells::SUM,
    &scan_cells::PLACE,
    &sort_cells::STAGE,
    &count_long::STAGE,
    &find_neighbours::STAGE,
    &fill_long::STAGE,
    &find_crossings::STAGE,
    &find_collisions::STAGE,
    &weigh_networks::STAGE,
    &weigh_collisions::STAGE,
    &sweep_at_once::STAGE,
    &sweep_collisions::STAGE,
    &gather_impulses::STAGE,
    &project_networks::STAGE,
    &apply_collisions::STAGE,
    &commit_collisions::STAGE,
    &synchronise::STAGE,
    &apply_friction_impulses::STAGE,
    &commit_friction_impulses::STAGE,
    &rod_loads::STAGE,
    &loads::STAGE,
    &servo_loads::STAGE,
    &advance::STAGE,
    &finish::STAGE,
    &symplectic_euler::STAGE,
    &drift::STAGE,
    &kick::STAGE,
    &constrain::STAGE,
    &turn::STAGE,
    &move_bodies::STAGE,
    &find_passages::STAGE,
    &end_step::STAGE,
    &key_spheres::STAGE,
    &count_digits::STAGE,
    &scatter_digits::STAGE,
    &permute_spheres::STAGE,
    &settle_spheres::STAGE,
    &measure_order::STAGE,
];

/// Kernels that are not part of a step of one world, and have no twin on the CPU.
pub const OUTSIDE: [&Stage; 1] = [&run_worlds::STAGE];
