//! Kernels with one plausible mistake each. The comparison of the backends must reject every one of them.

use std::cell::{LazyCell, RefCell};
use std::ops::Deref;
use std::slice;
use std::sync::{Mutex, OnceLock};

use rockfall::gpu::Gpu;
use rockfall::model::buffer::Buffer;
use rockfall::model::dispatch::Threads;
use rockfall::model::layout::SWEEPS_LISTED;
use rockfall::model::part::Part;
use rockfall::model::world::World;
use rockfall::step::schedule::Run;
use rockfall::step::stage::Stage;
use rockfall::step::wgsl::Wgsl;
use rockfall::{BroadPhase, ContactLaw, Integrator, Settings};

use crate::compare::{MEASURED, differences};
use crate::crossings;
use crate::decisions::entries;
use crate::device::{GPU, on_gpu, open};
use crate::trace::{Only, Plan, Scenario, Trace, trace};
use crate::verdicts::{Key, Verdicts};
use crate::{assert_scenario_matches, keys, passages, plan, rigid, rod_walls, servos, shear, walls, with_law};

/// A mistake in a kernel: the stage and its pass, the WGSL file, the correct text, the wrong text, and the buffer that must
/// differ.
pub(crate) struct Mistake(
    pub(crate) &'static str,
    pub(crate) u32,
    pub(crate) &'static str,
    pub(crate) &'static str,
    pub(crate) &'static str,
    pub(crate) Buffer,
);

impl Mistake {
    /// The stage, its pass, and what is changed.
    pub(crate) fn name(&self) -> String {
        let Self(stage, pass, file, right, wrong, _) = self;
        format!("{stage} {pass}, {file}: {right} -> {wrong}")
    }
}

static MISTAKES: &[Mistake] = &[
    Mistake(
        "move_bodies",
        6,
        "move_bodies.wgsl",
        "torque += load.torque + cross(",
        "torque += load.torque - cross(",
        Buffer::RigidBodies,
    ),
    Mistake(
        "move_bodies",
        6,
        "move_bodies.wgsl",
        "pose.velocity + cross(spin, lever)",
        "pose.velocity - cross(spin, lever)",
        Buffer::Start,
    ),
    Mistake(
        "move_bodies",
        6,
        "free_rotation.wgsl",
        "let share = select(0.5, 1.0, k == 2u);",
        "let share = 1.0;",
        Buffer::RigidBodies,
    ),
    Mistake(
        "move_bodies",
        6,
        "free_rotation.wgsl",
        "dot(axis, momentum) * axis;\n    }",
        "dot(axis, momentum) * axis.zxy;\n    }",
        Buffer::Start,
    ),
    Mistake("move_bodies", 4, "move_bodies.wgsl", "select(1.0, 0.5, is_drift)", "1.0", Buffer::RigidBodies),
    Mistake("move_bodies", 5, "move_bodies.wgsl", "keep_rates(body, rates);", "", Buffer::Rates),
    Mistake("synchronise", 0, "synchronise.wgsl", "+ cross(turning, lever_on_body(record, i, 0.0))", "", Buffer::Start),
    Mistake("move_bodies", 7, "move_bodies.wgsl", "axis.xxy * axis.yzz", "axis.xyx * axis.yzz", Buffer::Topology),
    Mistake("loads", 0, "rigid_side.wgsl", "let across = cross(lever, found.n);", "let across = lever;", Buffer::Wrenches),
    Mistake("loads", 0, "rigid_side.wgsl", "reach * reach * float_at", "reach * float_at", Buffer::Wrenches),
    Mistake("loads", 0, "wall_damping.wgsl", "+ (radius - body.radius)", "", Buffer::Wrenches),
    Mistake("loads", 0, "wall_damping.wgsl", "+ turning(body, cross(moment, n))", "", Buffer::Wrenches),
    Mistake("loads", 0, "wall_damping.wgsl", "sqrt(radius * oj / (body.radius * o))", "1.0", Buffer::Wrenches),
    Mistake(
        "loads",
        0,
        "pair_damping.wgsl",
        "+ (turning(one, total.torque_a) + turning(other, total.torque_b))",
        "",
        Buffer::Wrenches,
    ),
    Mistake(
        "loads",
        0,
        "pair_damping.wgsl",
        "sqrt(radii.x * radii.y / (radii.x + radii.y) / reduced * met.w / o)",
        "1.0",
        Buffer::Wrenches,
    ),
    Mistake("move_bodies", 6, "move_bodies.wgsl", "put_vector(record + 14u, pose.orientation.xyz);", "", Buffer::Topology),
    Mistake("fill_pairs", 0, "rigid_parts.wgsl", "(body == rigid_body_of(b))", "(body != rigid_body_of(b))", Buffer::Lists),
    Mistake("kick", 3, "kick.wgsl", "| !is_free(i)", "", Buffer::Start),
    Mistake("update_aabbs", 0, "update_aabbs.wgsl", "1.0) * 0.02 +", "1.0) * 0.03 +", Buffer::Aabbs),
    Mistake("update_aabbs", 0, "travel.wgsl", "position + way", "position - way", Buffer::Aabbs),
    Mistake("count_pairs", 0, "pair_tiles.wgsl", "(own.id != tile[k].id)", "(own.id < tile[k].id)", Buffer::Lists),
    Mistake("scan_pairs", 0, "scan_pairs.wgsl", "k < SLICE;", "k < SLICE / 2u;", Buffer::Lists),
    Mistake("fill_pairs", 0, "pair_tiles.wgsl", "id | (feature <<", "id | ((11u - feature) <<", Buffer::Lists),
    Mistake("sort_axis", 1, "sort_axis.wgsl", "pass_.index * WORKGROUP", "0u", Buffer::Cells),
    Mistake("bound_blocks", 0, "bound_blocks.wgsl", "max(greatest[local]", "min(greatest[local]", Buffer::Extents),
    Mistake("count_near", 0, "near_tiles.wgsl", "their.x > interval.y", "their.x > interval.x", Buffer::Lists),
    Mistake("fill_near", 0, "heap.wgsl", "<= key {", ">= key {", Buffer::Lists),
    Mistake("clear_cells", 0, "clear_cells.wgsl", "k < CELL_BLOCK", "k < CELL_BLOCK / 2u", Buffer::Cells),
    Mistake("count_cells", 0, "cells.wgsl", "u32(z) * ROW_Z", "u32(z) * ROW_Y", Buffer::Cells),
    Mistake("count_cells", 0, "count_cells.wgsl", "max(out.x, max(out.y", "max(out.x, min(out.y", Buffer::Cells),
    Mistake("count_cells", 0, "count_cells.wgsl", "1u << level;", "1u;", Buffer::Cells),
    Mistake("sum_blocks", 0, "scan_cells.wgsl", "local == GROUP_SIZE - 1u", "local == 0u", Buffer::Cells),
    Mistake(
        "place_cells",
        0,
        "scan_cells.wgsl",
        "before + sums[local] - total(counts);",
        "before + sums[local];",
        Buffer::Cells,
    ),
    Mistake("place_cells", 0, "scan_cells.wgsl", "before += sums", "before -= sums", Buffer::Cells),
    Mistake("sort_cells", 0, "sort_cells.wgsl", "CELLS_AT + key], 1u", "CELLS_AT + key], 0u", Buffer::Cells),
    Mistake("find_neighbours", 0, "find_neighbours.wgsl", "(id != mover);", "(id >= mover);", Buffer::Lists),
    Mistake(
        "find_neighbours",
        0,
        "neighbours.wgsl",
        "if are_statics_tested_apart() {\n        for",
        "if !are_statics_tested_apart() {\n        for",
        Buffer::Lists,
    ),
    Mistake("find_neighbours", 0, "neighbours.wgsl", "return !aabbs_meet", "return aabbs_meet", Buffer::Lists),
    Mistake("find_neighbours", 0, "find_neighbours.wgsl", "(key >> PLACE_BITS) != before", "key != before", Buffer::Lists),
    Mistake("find_neighbours", 0, "sort.wgsl", "max(s.b, s.d)", "min(s.b, s.d)", Buffer::Lists),
    Mistake("find_neighbours", 0, "neighbours.wgsl", "> touching * touching", "> 0.9 * touching * touching", Buffer::Lists),
    Mistake("count_cells", 0, "count_cells.wgsl", "& is_long(aabb)", "| is_long(aabb)", Buffer::Cells),
    Mistake("count_cells", 0, "count_cells.wgsl", "if mine > atomicLoad", "if mine < atomicLoad", Buffer::Cells),
    Mistake("count_long", 0, "count_long.wgsl", "atomicStore(&all_found, 0u)", "atomicStore(&all_found, 1u)", Buffer::Lists),
    Mistake("count_long", 0, "neighbours.wgsl", "y += portion.across;", "y += 1;", Buffer::Lists),
    Mistake(
        "find_neighbours",
        0,
        "find_neighbours.wgsl",
        "entries = head_of(mover)",
        "entries = head_of(mover) + 1u",
        Buffer::Status,
    ),
    Mistake("fill_long", 0, "bitonic.wgsl", "2u * stride - 1u", "stride", Buffer::Lists),
    Mistake("fill_long", 0, "fill_long.wgsl", "sums[local] - 1u", "sums[local]", Buffer::Lists),
    Mistake("find_collisions", 0, "escape.wgsl", "radius - room", "radius - 0.5 * room", Buffer::Status),
    Mistake(
        "find_collisions",
        0,
        "classify_contacts.wgsl",
        "(any_bits & ENTRY_COLLIDES)",
        "(any_bits & ENTRY_OVERLAPS)",
        Buffer::Lists,
    ),
    Mistake("update_aabbs", 0, "travel.wgsl", "(step.lead + 1.0)", "step.lead", Buffer::Aabbs),
    Mistake("find_crossings", 0, "crossings.wgsl", "reach * reach - dot", "reach - dot", Buffer::Y3),
    Mistake(
        "find_crossings",
        0,
        "crossings.wgsl",
        "time += found.overlap / closing",
        "time -= found.overlap / closing",
        Buffer::Y3,
    ),
    Mistake(
        "find_crossings",
        0,
        "hidden_crossing.wgsl",
        "nearer.overlap > found.overlap",
        "nearer.overlap < found.overlap",
        Buffer::Y3,
    ),
    Mistake("find_crossings", 0, "find_crossings.wgsl", "&& (time > earliest.time)", "&& (time > 0.0)", Buffer::Y3),
    Mistake("find_crossings", 0, "lone.wgsl", "var tau = start;", "var tau = 0.0;", Buffer::Y3),
    Mistake("find_collisions", 0, "find_collisions.wgsl", "return has_handled_crossing(b);", "return false;", Buffer::Lists),
    Mistake("commit_collisions", 0, "crossing_rows.wgsl", ".other == id", ".other != id", Buffer::Start),
    Mistake("commit_collisions", 0, "commit_collisions.wgsl", "crossings[i].xyz);", "-crossings[i].xyz);", Buffer::Start),
    Mistake("loads", 0, "sphere_push.wgsl", "(time >= 0.0) && !is_hidden", "(time >= 9.0) && !is_hidden", Buffer::Wrenches),
    Mistake("find_collisions", 0, "find_collisions.wgsl", "begin += WORKGROUP", "begin += 2u * WORKGROUP", Buffer::Lists),
    Mistake("find_collisions", 0, "workgroup_per_sphere.wgsl", "(workgroup - step.large)", "workgroup", Buffer::Lists),
    Mistake("find_collisions", 0, "classify_contacts.wgsl", "min(radius, ", "max(radius, ", Buffer::Lists),
    Mistake("find_collisions", 0, "geometry.wgsl", "nn <= 1e-8 *", "nn < 0.0 *", Buffer::Lists),
    Mistake("commit_collisions", 0, "commit_next_state.wgsl", "region < regions", "region < 1u", Buffer::Start),
    Mistake("commit_collisions", 0, "commit_collisions.wgsl", "collided, 2u", "collided, 1u", Buffer::Status),
    Mistake("constrain", 4, "lengths.wgsl", "move_end(ends.y, -w2", "move_end(ends.y, w2", Buffer::Start),
    Mistake("rod_loads", 0, "rod_load.wgsl", "+= at * torque", "+= (1.0 - at) * torque", Buffer::Wrenches),
    Mistake("rod_loads", 3, "geometry.wgsl", "nn <= 1e-8 *", "nn <= 0.3 *", Buffer::Wrenches),
    Mistake("loads", 0, "contact.wgsl", "select(overlap, 0.5 *", "select(overlap, 0.4 *", Buffer::Wrenches),
    Mistake("loads", 1, "ordered_sums.wgsl", "local] = one.y", "local] = one.x", Buffer::Wrenches),
    Mistake("loads", 1, "contact.wgsl", "sqrt(sqrt(tt))", "sqrt(tt)", Buffer::Wrenches),
    Mistake(
        "loads",
        1,
        "contact.wgsl",
        "overlap / sqrt(sqrt(tt)), most)",
        "overlap / sqrt(sqrt(tt)), 4.0 * most)",
        Buffer::Wrenches,
    ),
    Mistake("advance", 2, "next_state.wgsl", "() == 2u", "() == 1u", Buffer::Y4),
    Mistake("finish", 3, "finished.wgsl", "step.dt / 6.0", "step.dt / 3.0", Buffer::Start),
    Mistake("finish", 3, "rotation.wgsl", "0.5 * rate", "rate", Buffer::Orientations),
    Mistake("symplectic_euler", 0, "motion.wgsl", "step.dt * new_.velocity)", "step.dt * before.velocity)", Buffer::Start),
    Mistake("loads", 0, "contact.wgsl", "(inverse_mass + turning) * step.dt", "inverse_mass * step.dt", Buffer::Wrenches),
    Mistake("symplectic_euler", 0, "symplectic_euler.wgsl", "state[region * step.spheres + i]", "state[i]", Buffer::Start),
    Mistake("advance", 0, "linear_damping.wgsl", "acceleration -= step", "acceleration += step", Buffer::Y2),
    Mistake("symplectic_euler", 0, "angular_damping.wgsl", "torque -= step", "torque += step", Buffer::Start),
    Mistake("loads", 1, "muscle.wgsl", "(evaluation() + 1u) / 2u", "0u", Buffer::Wrenches),
    Mistake("loads", 0, "muscle.wgsl", "(quarter & 1u) == 1u", "(quarter & 1u) == 0u", Buffer::Wrenches),
    Mistake("loads", 3, "muscle.wgsl", "select(value, -value", "select(value, value", Buffer::Wrenches),
    Mistake("loads", 0, "muscle.wgsl", "return length * fma(", "return length * -fma(", Buffer::Wrenches),
    Mistake("finish", 3, "gravity.wgsl", "+= step.gravity", "-= step.gravity", Buffer::Start),
    Mistake(
        "symplectic_euler",
        0,
        "symplectic_euler_state.wgsl",
        "after.momentum * old_momentum.w",
        "after.momentum",
        Buffer::Orientations,
    ),
    Mistake("constrain", 0, "constrain.wgsl", "correction / step.dt", "correction * step.dt", Buffer::Start),
    Mistake("turn", 0, "turn.wgsl", "cross((spins + orbit) / across", "cross((spins - orbit) / across", Buffer::Start),
    Mistake("turn", 0, "turn.wgsl", "0.5 * step.dt * (change", "step.dt * (change", Buffer::Start),
    Mistake("turn", 0, "quaternion.wgsl", "cross(a.xyz, b.xyz)", "cross(b.xyz, a.xyz)", Buffer::Orientations),
    Mistake("kick", 3, "put_rates.wgsl", "= rates.torque[k]", "= rates.acceleration[k]", Buffer::Rates),
    Mistake("drift", 0, "drift.wgsl", "status.forces_due != 0u", "status.forces_due == 0u", Buffer::Y4),
    Mistake("drift", 0, "drift.wgsl", "0.5 * step.dt, i)", "step.dt, i)", Buffer::Y4),
    Mistake("drift", 0, "model/rates.wgsl", "kept_rates[at + 4u]", "kept_rates[at + 1u]", Buffer::Y4),
    Mistake("drift", 0, "drift.wgsl", "vec4f(after.momentum * momentum.w, 0.0)", "vec4f(after.momentum, 0.0)", Buffer::Y3),
    Mistake("loads", 0, "escape.wgsl", "radius - room", "radius - 0.5 * room", Buffer::Status),
    Mistake("loads", 3, "loads.wgsl", "evaluation() == 3u", "evaluation() == 2u", Buffer::Status),
    Mistake("loads", 0, "surface.wgsl", "front >= distance -", "front >= 9.0 * distance -", Buffer::Wrenches),
    Mistake("loads", 0, "surfaces_of_list.wgsl", "count < 2u", "count < 99u", Buffer::Wrenches),
    Mistake("find_collisions", 0, "surface.wgsl", "front >= distance -", "front >= 0.9 * distance -", Buffer::Lists),
    Mistake("find_collisions", 0, "classify_contacts.wgsl", "if is_hidden {", "if false {", Buffer::Lists),
    Mistake("loads", 0, "chain.wgsl", "towards > 0.5 + AT_END", "towards > 0.3", Buffer::Wrenches),
    Mistake("rod_loads", 0, "chain.wgsl", "if radius * radius > part", "if 4.0 * radius * radius > part", Buffer::Wrenches),
    Mistake("find_collisions", 0, "chain.wgsl", "> INSIDE_ROD *", "> -INSIDE_ROD *", Buffer::Lists),
    Mistake("move_walls", 1, "move_walls.wgsl", "(pass_.index + 1u) / 2u", "pass_.index / 2u", Buffer::Topology),
    Mistake(
        "move_walls",
        1,
        "move_walls.wgsl",
        "let around = cross(spin, corner",
        "let around = cross(corner, spin",
        Buffer::Topology,
    ),
    Mistake("loads", 0, "walls.wgsl", "dot(wall.surface, n) * n", "0.0 * n", Buffer::Wrenches),
    Mistake("servo_loads", 0, "servo_loads.wgsl", "along * along", "along", Buffer::ServoLoads),
    Mistake(
        "servo_loads",
        3,
        "servo_loads.wgsl",
        "pliancy.stiffness + pliancy.damping / step.dt",
        "pliancy.stiffness",
        Buffer::ServoLoads,
    ),
    Mistake(
        "drive_servos",
        0,
        "drive_servos.wgsl",
        "0.5 * f32(half_steps) * step.dt",
        "f32(half_steps) * step.dt",
        Buffer::Poses,
    ),
    Mistake("drive_servos", 1, "drive_servos.wgsl", "target_force - load.x", "target_force + load.x", Buffer::Servos),
    Mistake("loads", 0, "period.wgsl", "round(rest / max(", "floor(rest / max(", Buffer::Wrenches),
    Mistake("loads", 1, "period.wgsl", "(pass_.index % EARLY + 1u) / 2u", "0u * pass_.index", Buffer::Wrenches),
    Mistake("loads", 0, "period.wgsl", "-(boxes * step.shear_speed)", "(boxes * step.shear_speed)", Buffer::Wrenches),
    Mistake("loads", 0, "fine.wgsl", "fine_moved(rest, -part.high)", "fine_moved(rest, part.high)", Buffer::Wrenches),
    Mistake(
        "loads",
        0,
        "sphere_push.wgsl",
        "vec3f(0.0), image_velocity(i, id), is_first",
        "vec3f(0.0), vec3f(0.0), is_first",
        Buffer::Wrenches,
    ),
    Mistake("update_aabbs", 0, "update_aabbs.wgsl", "floor(boxes_in(centre", "round(boxes_in(centre", Buffer::Aabbs),
    Mistake("fill_pairs", 0, "meet.wgsl", "way = way_of(", "way = periods() * (", Buffer::Lists),
    Mistake("loads", 0, "fine.wgsl", "apart.high - to_middle", "apart.high + to_middle", Buffer::Wrenches),
    Mistake("update_aabbs", 0, "update_aabbs.wgsl", "floor(before_slide(above", "round(before_slide(above", Buffer::Aabbs),
    Mistake("count_pairs", 0, "meet.wgsl", "b.max - way", "b.max + way", Buffer::Lists),
    Mistake("loads", 0, "smooth.wgsl", "face.left - slope * out", "face.left + slope * out", Buffer::Wrenches),
    Mistake("loads", 0, "smooth.wgsl", "-side * meridian.normal", "side * meridian.normal", Buffer::Wrenches),
    Mistake("loads", 0, "smooth.wgsl", "clamp(parameter_on(meridian), 0.0, 1.0)", "parameter_on(meridian)", Buffer::Wrenches),
    Mistake("find_collisions", 0, "smooth.wgsl", "side * (distance.x - size.x)", "side * distance.x - size.x", Buffer::Lists),
    Mistake("count_pairs", 0, "meet.wgsl", "select(4u, 3u,", "select(3u, 4u,", Buffer::Lists),
    Mistake("rod_loads", 0, "rod_polygon.wgsl", "clamp(b, 0.0, 1.0), is_vertex)", "b, is_vertex)", Buffer::Wrenches),
    Mistake("rod_loads", 0, "rod_polygon.wgsl", "(cone.end - cone.start)", "(cone.start - cone.end)", Buffer::Wrenches),
    Mistake("rod_loads", 0, "rims_of_list.wgsl", "rim.inward + v) <= BENT", "rim.inward - v) <= BENT", Buffer::Wrenches),
    Mistake("find_collisions", 0, "rims_of_list.wgsl", "(feature < rim.feature)", "(feature > rim.feature)", Buffer::Lists),
    Mistake("update_aabbs", 0, "smooth.wgsl", "axis.along - end", "axis.along + end", Buffer::Aabbs),
    Mistake("update_aabbs", 0, "update_aabbs.wgsl", "is_open = !differs", "is_open = differs", Buffer::Aabbs),
    Mistake("loads", 0, "geometry.wgsl", "on_third.y < least", "on_third.y > least", Buffer::Wrenches),
    Mistake(
        "loads",
        0,
        "geometry.wgsl",
        "unit_interval(place.x + place.y)",
        "unit_interval(place.x - place.y)",
        Buffer::Wrenches,
    ),
    Mistake("kick", 3, "kick.wgsl", "let half = 0.5 * step.dt", "let half = step.dt", Buffer::Start),
    Mistake("kick", 3, "kick.wgsl", "forces_due = 0u", "forces_due = 1u", Buffer::Status),
    Mistake("loads", 3, "net_force.wgsl", "3u * u32(VERLET)", "0u", Buffer::Status),
    Mistake("kick", 3, "kick.wgsl", "var spin = momentum.xyz * momentum.w", "var spin = momentum.xyz", Buffer::Orientations),
    Mistake("rod_loads", 0, "due.wgsl", "(status.forces_due != 0u)", "(status.forces_due == 0u)", Buffer::Wrenches),
    Mistake("loads", 0, "mover_contact.wgsl", "== is_a) & advances_springs()", "== is_a)", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "return !VERLET |", "return true |", Buffer::Wrenches),
    Mistake("loads", 3, "history.wgsl", "select(0.0, step.dt, advances_springs())", "0.0", Buffer::Histories),
    Mistake("constrain", 3, "constrain.wgsl", "correction / step.dt", "correction * step.dt", Buffer::Y4),
    Mistake("key_spheres", 0, "key_spheres.wgsl", "axes.y << 1u", "axes.y << 2u", Buffer::Y2),
    Mistake("count_digits", 1, "digits.wgsl", "digit * ((step", "digit + ((step", Buffer::Cells),
    Mistake("scatter_digits", 0, "scatter_digits.wgsl", "counts[at] += 1u", "counts[at] += 0u", Buffer::Y3),
    Mistake("scatter_digits", 7, "digits.wgsl", "* DIGIT_BITS", "* 3u", Buffer::Y2),
    Mistake("permute_spheres", 0, "permute_spheres.wgsl", "topology[step.insertion_indices_at + from_]", "from_", Buffer::Y4),
    Mistake("settle_spheres", 0, "settle_spheres.wgsl", "follow(at + 1u);", "", Buffer::Topology),
    Mistake("settle_spheres", 0, "settle_spheres.wgsl", "= moved.y", "= moved.x", Buffer::Topology),
    Mistake(
        "settle_spheres",
        0,
        "settle_spheres.wgsl",
        "step.slots_at + own.y] = i",
        "step.slots_at + i] = own.y",
        Buffer::Topology,
    ),
    Mistake("measure_order", 0, "measure_order.wgsl", "32u - count", "31u - count", Buffer::Status),
    Mistake("loads", 0, "passage.wgsl", "> FAST_WAY * radius", "> 999.0 * radius", Buffer::Status),
    Mistake("find_passages", 3, "find_passages.wgsl", "& (heights.x < 0.0))", "& (heights.x >= 0.0))", Buffer::Status),
    Mistake(
        "find_passages",
        3,
        "find_passages.wgsl",
        "select(max(left, right), left + right,",
        "select(max(left, right), left,",
        Buffer::Status,
    ),
    Mistake("find_passages", 3, "find_passages.wgsl", "+ 0.5 * step.dt * y2", "- 0.5 * step.dt * y2", Buffer::Status),
    Mistake("find_passages", 3, "find_passages.wgsl", "along -= step.dt", "along += step.dt", Buffer::Status),
    Mistake(
        "end_step",
        0,
        "close_step.wgsl",
        "status.total_passages += passages",
        "status.total_passages = 0u",
        Buffer::Status,
    ),
    Mistake("end_step", 0, "close_step.wgsl", "atomicLoad(&max_overlap)", "atomicLoad(&contacts)", Buffer::Status),
    Mistake("synchronise", 0, "synchronise.wgsl", "0.5 * step.dt", "step.dt", Buffer::Start),
    Mistake("synchronise", 0, "synchronise.wgsl", "length(acceleration)", "acceleration.x", Buffer::Topology),
    Mistake("find_collisions", 0, "contact.wgsl", "select(2.0, 4.0, HALF_STEP) * free", "0.0 * free", Buffer::Lists),
    Mistake("find_collisions", 0, "collision.wgsl", "(at - capsule.centre) * cross", "at * cross", Buffer::Lists),
    Mistake("find_collisions", 0, "list_collisions.wgsl", "low = middle + 1u", "high = middle", Buffer::Start),
    Mistake("find_collisions", 0, "list_collisions.wgsl", "pair.y | (feature << ENTRY_ID_BITS)", "pair.y", Buffer::Start),
    Mistake("find_collisions", 0, "collision.wgsl", "select(vec3f(0.0), v1.xyz, v1.w > 0.0)", "v1.xyz", Buffer::Start),
    Mistake("weigh_networks", 0, "weigh_networks.wgsl", "vec4f(weight, ", "vec4f(2.0 * weight, ", Buffer::Start),
    Mistake(
        "weigh_networks",
        0,
        "weigh_networks.wgsl",
        "select(0.0, 1.0 - at, ends.x == sphere)",
        "select(0.0, at, ends.x == sphere)",
        Buffer::Start,
    ),
    Mistake("weigh_networks", 0, "networks.wgsl", "row.y -= along * row.w", "row.y += along * row.w", Buffer::Start),
    Mistake(
        "weigh_collisions",
        0,
        "other_collisions.wgsl",
        "PERPENDICULAR: f32 = 0.001",
        "PERPENDICULAR: f32 = 0.5",
        Buffer::Start,
    ),
    Mistake(
        "weigh_collisions",
        0,
        "weigh_collisions.wgsl",
        "one.weight * inverse_mass(k.a_id)",
        "inverse_mass(k.a_id)",
        Buffer::Start,
    ),
    Mistake(
        "weigh_collisions",
        0,
        "weigh_collisions.wgsl",
        "f32(1u + company.others) * inverse_mass",
        "inverse_mass",
        Buffer::Start,
    ),
    Mistake("weigh_collisions", 0, "lone.wgsl", "0.5 * tau * tau", "2000.0 * tau * tau", Buffer::Start),
    Mistake("weigh_collisions", 0, "lone.wgsl", "poise.v1 - tau * pull.a1", "poise.v1 + tau * pull.a1", Buffer::Start),
    Mistake("weigh_collisions", 0, "lone.wgsl", "(turn.x / rate) * q", "(turn.x * rate) * q", Buffer::Start),
    Mistake("weigh_collisions", 0, "touch.wgsl", "half.at > 0.5", "half.at < 0.5", Buffer::Start),
    Mistake(
        "weigh_collisions",
        0,
        "lone.wgsl",
        "found.overlap += dot(centre_of",
        "found.overlap -= dot(centre_of",
        Buffer::Start,
    ),
    Mistake("loads", 0, "geometry.wgsl", "select(0.0, 1.0, place > 0.5)", "select(1.0, 0.0, place > 0.5)", Buffer::Wrenches),
    Mistake("find_collisions", 0, "geometry.wgsl", "clamp(along, 0.0, 1.0)", "along", Buffer::Lists),
    Mistake("loads", 0, "geometry.wgsl", "if found.w < least {", "if found.w >= least {", Buffer::Wrenches),
    Mistake("weigh_collisions", 0, "collision.wgsl", "select(1.0, 1.0 - half.at,", "select(1.0, half.at,", Buffer::Start),
    Mistake("sweep_at_once", 0, "sweep_at_once.wgsl", "sweeps < SWEEPS;", "sweeps < SWEEPS / 2u;", Buffer::Start),
    Mistake("sweep_at_once", 0, "cluster.wgsl", "max(0.0, fma(fma", "max(-1e9, fma(fma", Buffer::Start),
    Mistake("sweep_at_once", 0, "cluster.wgsl", "SWEEP_SIZES[sweeps / 2u]", "SWEEP_SIZES[3u - sweeps / 2u]", Buffer::Start),
    Mistake("sweep_at_once", 0, "cluster.wgsl", "-(by * their_wanted)) / margin", "by * their_wanted) / margin", Buffer::Start),
    Mistake("sweep_at_once", 0, "cluster.wgsl", "fma(own, their, -(by * by))", "fma(own, their, by * by)", Buffer::Start),
    Mistake("sweep_at_once", 0, "cluster.wgsl", "place + 1u < count", "place + 1u < 0u", Buffer::Start),
    Mistake(
        "weigh_collisions",
        0,
        "weigh_collisions.wgsl",
        "side * velocity.w * part_on",
        "velocity.w * part_on",
        Buffer::Start,
    ),
    // Never using ONLY would make no difference: the last two sweeps have factor 1, and for a collision that is the only one
    // on its bodies they correct everything that the other sweeps left (docs/physics section 3.8: p(1) = 0).
    Mistake("weigh_collisions", 0, "couplings.wgsl", "select(0u, ONLY, is_only)", "ONLY", Buffer::Start),
    Mistake("sweep_collisions", 0, "sweep_collisions.wgsl", "(sweeps != 0u)", "(sweeps > 1u)", Buffer::Start),
    Mistake(
        "sweep_collisions",
        0,
        "cluster.wgsl",
        "fma(1.0 + restitution, approach",
        "fma(restitution, approach",
        Buffer::Start,
    ),
    Mistake(
        "project_networks",
        1,
        "project_networks.wgsl",
        "impulses_on(sphere, pass_.index)",
        "impulses_on(sphere, pass_.index + 1u)",
        Buffer::Start,
    ),
    Mistake("project_networks", 1, "networks.wgsl", "rod_ends(rod).x == sphere", "rod_ends(rod).y == sphere", Buffer::Start),
    Mistake("project_networks", 1, "networks.wgsl", "ROUNDS_PER_ROD: u32 = 16u", "ROUNDS_PER_ROD: u32 = 0u", Buffer::Status),
    Mistake("gather_impulses", 1, "gather_impulses.wgsl", "inverse_mass(sphere) * sum", "sum", Buffer::Start),
    Mistake("gather_impulses", 1, "impulses.wgsl", "select(1.0, -1.0, is_a)", "select(1.0, 1.0, is_a)", Buffer::Start),
    Mistake("gather_impulses", 1, "impulses.wgsl", "select(1.0, -1.0, is_a)", "select(-1.0, -1.0, is_a)", Buffer::Start),
    Mistake("weigh_collisions", 0, "weigh_collisions.wgsl", "two.weight * inverse_mass(k.b_id)", "two.weight", Buffer::Start),
    Mistake(
        "apply_collisions",
        0,
        "apply_collisions.wgsl",
        "velocity * max(impulse.tau, 0.0)",
        "velocity * impulse.tau",
        Buffer::Start,
    ),
    Mistake("apply_collisions", 0, "apply_collisions.wgsl", "min(count - begin, WORKGROUP)", "1u", Buffer::Start),
    Mistake("apply_collisions", 0, "ordered_sums.wgsl", "6u + component / 3u", "6u", Buffer::Start),
    Mistake("apply_collisions", 0, "objects.wgsl", "select(end, NONE, end == SOME_RODS)", "NONE", Buffer::Start),
    Mistake(
        "apply_collisions",
        0,
        "capsule_changes.wgsl",
        "cross(spin, back.d), impulse.tau",
        "cross(spin, back.d), -impulse.tau",
        Buffer::Start,
    ),
    Mistake(
        "apply_collisions",
        0,
        "capsule_changes.wgsl",
        "momentum.xyz + kick.spin / momentum.w",
        "momentum.xyz",
        Buffer::Start,
    ),
    Mistake(
        "apply_collisions",
        0,
        "impulses.wgsl",
        "select(at, 1.0 - at, rod_ends",
        "select(1.0 - at, at, rod_ends",
        Buffer::Start,
    ),
    Mistake(
        "apply_friction_impulses",
        0,
        "friction_impulses.wgsl",
        "found += countOneBits",
        "found = countOneBits",
        Buffer::Start,
    ),
    Mistake(
        "apply_friction_impulses",
        0,
        "friction_impulses.wgsl",
        "in_contacts * step.dt * force",
        "in_contacts * force",
        Buffer::Start,
    ),
    Mistake(
        "apply_friction_impulses",
        0,
        "friction_impulses.wgsl",
        "limit = in_collisions * impulse_at",
        "limit = impulse_at",
        Buffer::Start,
    ),
    Mistake("apply_friction_impulses", 0, "friction_impulses.wgsl", "part * part * (w", "part * (w", Buffer::Start),
    Mistake(
        "apply_friction_impulses",
        0,
        "apply_friction_impulses.wgsl",
        "select(-share, share, is_a)",
        "select(share, -share, is_a)",
        Buffer::Start,
    ),
    Mistake(
        "apply_friction_impulses",
        0,
        "apply_friction_impulses.wgsl",
        "inverse_roll(ends) * rubbed.rolling",
        "rubbed.rolling",
        Buffer::Start,
    ),
    Mistake("weigh_collisions", 0, "pairs.wgsl", "one * step.materials + other", "one * step.materials", Buffer::Start),
    Mistake("weigh_collisions", 0, "pairs.wgsl", "a, b, 0u, step.restitution", "a, b, 1u, step.restitution", Buffer::Start),
    Mistake("weigh_collisions", 0, "couplings.wgsl", "bitcast<u32>(restitution)", "0u", Buffer::Start),
    Mistake("loads", 0, "contact.wgsl", "min(friction_of(a, b)", "min(step.friction", Buffer::Wrenches),
    Mistake("apply_friction_impulses", 0, "pairs.wgsl", "given < 0.0", "given <= 0.0", Buffer::Start),
    Mistake("loads", 0, "hertz_mindlin.wgsl", "8.0 * a", "4.0 * a", Buffer::Wrenches),
    Mistake("loads", 0, "linear.wgsl", "constants.y, 1.0", "constants.x, 1.0", Buffer::Wrenches),
    Mistake("loads", 0, "linear.wgsl", "15.0 / 16.0 *", "16.0 / 15.0 *", Buffer::Wrenches),
    Mistake("loads", 0, "hertz_mindlin.wgsl", "unloading = sqrt(", "unloading = (", Buffer::Histories),
    Mistake("loads", 0, "laws/contact.wgsl", "* unloading * turned", "* turned", Buffer::Histories),
    // The law that the program defines: missing, with exchanged arguments, of another pair, and its derived quantities.
    Mistake(
        "loads",
        0,
        "laws/user.wgsl",
        "return Response(0.0, 0.0, 0.0)",
        "return Response(0.0, 0.0, 0.0 )",
        Buffer::Wrenches,
    ),
    Mistake(
        "loads",
        0,
        "laws/user.wgsl",
        "UserContact(contact.overlap, contact.approach",
        "UserContact(contact.approach, contact.overlap",
        Buffer::Wrenches,
    ),
    Mistake("loads", 0, "laws/user.wgsl", "radius, contact.mass, con", "mass, contact.radius, con", Buffer::Wrenches),
    Mistake("loads", 0, "laws/user.wgsl", "constants.x, constants.y);", "constants.y, constants.x);", Buffer::Wrenches),
    Mistake("loads", 0, "pairs.wgsl", "step.pairs_at) / PAIR_WORDS", "step.pairs_at) / PAIR_WORDS * 0u", Buffer::Wrenches),
    Mistake("loads", 0, "laws/user.wgsl", "stiff.tangential / old", "old / stiff.tangential", Buffer::Histories),
    Mistake("loads", 0, "laws/user.wgsl", "other.speed = 0.0", "other.speed = contact.speed", Buffer::Wrenches),
    Mistake("loads", 0, "laws/user.wgsl", "(2.0 * reach)", "reach", Buffer::Wrenches),
    Mistake(
        "loads",
        0,
        "laws/contact.wgsl",
        "shift = spring_time() * slip",
        "shift = -spring_time() * slip",
        Buffer::Histories,
    ),
    Mistake("loads", 0, "laws/contact.wgsl", "rub *= limit / size", "rub *= 1.0", Buffer::Wrenches),
    Mistake("loads", 0, "laws/contact.wgsl", "- dot(before.shift, n) * n", "", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "key_of_record(record) == key", "key_of_record(record) != key", Buffer::Wrenches),
    Mistake("loads", 0, "history.wgsl", "bitcast<vec3u>(spring.moment)", "vec3u(0u)", Buffer::Histories),
    Mistake("loads", 0, "mover_contact.wgsl", "select(-law.moment,", "select(law.moment,", Buffer::Wrenches),
    Mistake("loads", 0, "laws/contact.wgsl", "push - radius", "push + radius", Buffer::Wrenches),
    Mistake("loads", 0, "laws/contact.wgsl", "bond.pull * elastic;", "0.5 * bond.pull * elastic;", Buffer::Wrenches),
    Mistake("loads", 0, "laws/contact.wgsl", "(1.0 - 0.5 * bond.pull)", "(1.0 - bond.pull)", Buffer::Histories),
    Mistake("loads", 0, "laws/contact.wgsl", "overlap = bond.depth", "overlap = overlap", Buffer::Histories),
    Mistake("loads", 0, "jkr.wgsl", "k < 3;", "k < 0;", Buffer::Histories),
    Mistake("loads", 0, "jkr.wgsl", "2.0 * root + radius", "root + radius", Buffer::Histories),
    Mistake("loads", 0, "jkr.wgsl", "<= -reach", "<= 0.0", Buffer::Histories),
    Mistake("loads", 0, "jkr.wgsl", "b, feature).overlap <= 0.0", "b, feature).overlap < -1.0", Buffer::Histories),
    Mistake("update_aabbs", 0, "update_aabbs.wgsl", "radius + step.neck * radius", "radius", Buffer::Aabbs),
    Mistake("loads", 0, "resistance.wgsl", "roll_scale = stiff.unloading", "roll_scale = twist_scale", Buffer::Histories),
    Mistake("loads", 0, "resistance.wgsl", "moment - c * spin", "moment + c * spin", Buffer::Wrenches),
    Mistake("loads", 0, "resistance.wgsl", "-min(most, stopping)", "-max(most, stopping)", Buffer::Wrenches),
    Mistake("loads", 0, "resistance.wgsl", "sign(moment) * most", "most", Buffer::Histories),
    Mistake(
        "loads",
        0,
        "resistance.wgsl",
        "most / size * moment, most / size",
        "most / size * moment, 1.1 * most / size",
        Buffer::Histories,
    ),
    Mistake("loads", 0, "history.wgsl", "radii.y > radii.x", "radii.y < radii.x", Buffer::Histories),
    Mistake("loads", 0, "mover_contact.wgsl", "select(-law.contact.force,", "select(law.contact.force,", Buffer::Wrenches),
    Mistake("symplectic_euler", 0, "model/load_rows.wgsl", "2u * sphere", "sphere", Buffer::Start),
    Mistake(
        "loads",
        0,
        "history.wgsl",
        "let at = first_vector(1u) + 2u * record",
        "let at = first_vector(0u) + 2u * record",
        Buffer::Histories,
    ),
    Mistake("loads", 0, "history.wgsl", "let at = first_vector(0u)", "let at = first_vector(1u)", Buffer::Wrenches),
    Mistake("end_step", 0, "close_step.wgsl", "status.history_table ^= 1u", "status.history_table = 1u", Buffer::Status),
    Mistake("commit_friction_impulses", 0, "commit_next_state.wgsl", "region < regions", "region < 1u", Buffer::Start),
    Mistake("loads", 1, "contact.wgsl", "fresh | (approach < -threshold)", "fresh", Buffer::Wrenches),
];

/// Whether a part is the given file, which may be the end of a path. `changes.wgsl` does not match `has_changes.wgsl`.
fn is_file(part: &Part, file: &str) -> bool {
    part.file == file || part.file.ends_with(&format!("/{file}"))
}

/// Returns a run whose stage has a rewritten file, if the file is part of the stage. The memory is leaked, because stages are
/// `'static`.
pub(crate) fn rewritten(run: Run, file: &str, rewrite: impl Fn(&str) -> String) -> Run {
    let mut parts = run.stage.parts();
    if let Some(part) = parts.iter_mut().find(|part| is_file(part, file)) {
        part.text = rewrite(part.text).leak();
    }
    let stage = Stage { wgsl: Wgsl::Parts(parts.leak()), ..*run.stage };
    Run { stage: Box::leak(Box::new(stage)), ..run }
}

/// Returns the runs with a mistake in one of their stages. `made` caches the stage with the mistake from the first call on, so
/// that the device compiles it only once.
pub(crate) fn with_mistake(runs: &[Run], mistake: &Mistake, made: &mut Option<&'static Stage>) -> Vec<Run> {
    let Mistake(name, _, file, right, wrong, _) = mistake;
    let mut one = |run: &Run| {
        if run.stage.name != *name {
            return *run;
        }
        // All passes share one stage. It has a unique name, because a device caches kernels by name.
        let stage = *made.get_or_insert_with(|| {
            let mistaken = rewritten(*run, file, |text| text.replacen(right, wrong, 1));
            // The name is the same in every run of the test, so that a driver with a cache on disk can reuse the kernel.
            let new_name = format!("{name}_{:x}", Key::of_code(&[file, right, wrong]).value()).leak();
            let (entry, new_entry) = (format!("fn {name}("), format!("fn {new_name}("));
            let renamed =
                rewritten(mistaken, &format!("{}.wgsl", entry_file(name)), |text| text.replacen(&entry, &new_entry, 1));
            Box::leak(Box::new(Stage { name: new_name, ..*renamed.stage }))
        });
        Run { stage, ..*run }
    };
    runs.iter().map(&mut one).collect()
}

/// Returns the name of the file with the entry point of a stage.
fn entry_file(stage: &str) -> &str {
    match stage {
        "sum_blocks" | "place_cells" => "scan_cells",
        _ => stage,
    }
}

/// Plans of the traces that must reveal the mistakes.
fn plans() -> [Plan; 17] {
    let (rk4, euler, verlet) = (Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet);
    // Friction so strong that its bound limits it.
    let rough = Settings::default().with(|settings| {
        settings.friction = 5000.0;
        settings.linear_damping = 3.0;
        settings.angular_damping = 4.0;
    });
    // Gravity so strong that it sets the threshold velocity (docs/physics section 3.1).
    let heavy = rough.with(|settings| settings.gravity = 100.0);
    let both = Settings::default().with(|settings| {
        settings.coulomb_friction = 0.3;
        settings.collision_friction = 0.2;
    });
    [
        // Plans without rods come first, because software Vulkan takes long to compile the kernels with rods.
        Plan { rods: false, only: Only::Lone, settings: rough, ..plan(6, euler) },
        Plan { rods: false, settings: heavy, ..plan(3, rk4) },
        Plan { rods: false, settings: both, ..plan(4, euler) },
        Plan { rods: false, only: Only::Few, ..plan(7, euler) },
        Plan { rods: false, only: Only::Few, materials: true, settings: both, ..plan(8, euler) },
        Plan { rods: false, ..with_law(plan(9, euler), ContactLaw::HertzMindlin) },
        Plan { rods: false, ..with_law(plan(12, euler), ContactLaw::Linear) },
        Plan { rods: false, ..with_law(plan(16, euler), ContactLaw::User) },
        Plan { rods: false, ..plan(13, verlet) },
        plan(14, verlet),
        Plan { rods: false, ..with_law(plan(15, verlet), ContactLaw::HertzMindlin) },
        plan(0, rk4),
        Plan { settings: both, ..plan(1, euler) },
        plan(2, rk4),
        // Contact forces have a torque, and so change angular momenta, only without Coulomb friction.
        Plan { only: Only::Few, settings: rough, ..plan(5, euler) },
        // So few boxes and polygons that they are tested apart from the grid.
        Plan { rods: false, clusters: 14, ..plan(19, rk4) },
        // A sphere above a polygon, with a neck.
        Plan { rods: false, ..with_law(plan(132, euler), ContactLaw::HertzMindlin) },
    ]
}

/// Returns the scenarios that run the stage and pass of a mistake. Those that are most likely to reveal it come first: one of
/// each special kind, such as with large spheres, with long movers or with networks. All others follow.
fn likely<'a>(trials: &'a [Trial], Mistake(stage, pass, ..): &Mistake) -> Vec<&'a Trial> {
    let runs_stage = |trial: &&Trial| {
        let Scenario { runs, before } = &trial.scenario;
        let has_work = |run: &Run| run.stage.threads != Threads::LongMovers || before.cells[3] > 0;
        runs.iter().any(|run| run.stage.name == *stage && run.pass == *pass && run.applies(&before.step) && has_work(run))
    };
    let all: Vec<&Trial> = trials.iter().filter(runs_stage).collect();
    let first = |is_meant: fn(&World) -> bool| all.iter().find(move |trial| is_meant(&trial.scenario.before));
    let with_long_movers = first(|before| before.cells[3] > 0);
    let with_large = first(|before| before.step.layout.large > 0);
    let large_without_rods = first(|before| before.step.layout.large > 0 && before.step.layout.rods == 0);
    let without_sweeps = first(|before| before.step.constants.sweeps == SWEEPS_LISTED);
    let with_rods = first(|before| before.step.layout.rods > 0);
    let with_networks = first(|before| before.step.layout.networks > 0);
    let mut chosen: Vec<&Trial> = Vec::new();
    let likely = [all.first(), without_sweeps, large_without_rods, with_large, with_long_movers, with_rods, with_networks];
    for trial in likely.into_iter().flatten().chain(&all) {
        if !chosen.iter().any(|other| std::ptr::eq(*other, *trial)) {
            chosen.push(trial);
        }
    }
    assert!(!chosen.is_empty(), "no trace has pass {pass} of {stage}");
    chosen
}

/// A scenario that rejects correct kernels would also reject every mistake, and prove nothing.
#[test]
fn kernels_without_a_mistake_are_accepted() {
    for plan in plans() {
        trace(&plan).scenarios.iter().for_each(|scenario| assert_scenario_matches(plan.seed, scenario));
    }
}

/// A scenario and the key of its input, which is computed when it is needed.
struct Trial {
    scenario: Scenario,
    key: OnceLock<Key>,
}

/// Whether the comparison rejects a mistake: in at least one scenario, the expected buffer differs.
fn is_rejected(verdicts: &Verdicts, gpu: &impl Deref<Target = Gpu>, trials: &[Trial], mistake: &Mistake) -> bool {
    let made = RefCell::new(None);
    let broken = |scenario: &Scenario| with_mistake(&scenario.runs, mistake, &mut made.borrow_mut());
    let key = |Trial { scenario, key }: &&Trial| {
        let Scenario { runs, before } = scenario;
        let input = key.get_or_init(|| keys::of_input(keys::code(include_str!("broken.rs")), runs, before, MEASURED));
        keys::of_kernels(*input, &broken(scenario), before, mistake)
    };
    let rejects = |Trial { scenario, .. }: &&Trial| {
        let after = on_gpu(gpu, &scenario.before, &broken(scenario));
        let found = differences(&scenario.runs, &scenario.before, &after, MEASURED);
        found.iter().any(|difference| difference.buffer == mistake.5)
    };
    verdicts.rejects(&mistake.name(), likely(trials, mistake).into_iter(), key, rejects)
}

#[test]
fn every_kernel_with_a_mistake_is_rejected() {
    let mut traces: Vec<Trace> = plans().iter().map(trace).collect();
    traces.push(crossings::trace(1, false));
    traces.push(walls::trace(1, Integrator::Rk4, false, false));
    traces.push(walls::trace(3, Integrator::Rk4, false, true));
    traces.push(shear::trace(5, ContactLaw::Thesis, Integrator::Rk4, BroadPhase::BruteForce));
    traces.push(rod_walls::trace(1, Integrator::Rk4));
    traces.push(servos::trace(1, ContactLaw::Thesis, Integrator::Rk4, [false, false]));
    traces.push(servos::trace(2, ContactLaw::HertzMindlin, Integrator::VelocityVerlet, [false, false]));
    traces.push(rigid::trace(2, Integrator::SymplecticEuler, ContactLaw::Linear, rigid::Parts::Balls));
    traces.push(rigid::trace(3, Integrator::VelocityVerlet, ContactLaw::HertzMindlin, rigid::Parts::Rods));
    traces.push(rigid::trace_of_accelerations(13));
    traces.push(passages::trace(1, Integrator::Rk4, false));
    let scenarios = traces.into_iter().flat_map(|trace| trace.scenarios);
    let trials: Vec<Trial> = scenarios.map(|scenario| Trial { scenario, key: OnceLock::new() }).collect();
    let verdicts = Verdicts::of("parity");
    let (left, accepted) = (Mutex::new(MISTAKES.iter()), Mutex::new(Vec::new()));
    let check = |next: fn(&mut slice::Iter<'static, Mistake>) -> Option<&'static Mistake>| {
        let gpu = LazyCell::new(open);
        loop {
            let mistake = next(&mut left.lock().unwrap());
            let Some(mistake) = mistake else { return };
            if !is_rejected(&verdicts, &gpu, &trials, mistake) {
                accepted.lock().unwrap().push(mistake.name());
            }
        }
    };
    // Nearly all of the time goes into compiling kernels, which takes one thread per device. Two devices start at opposite ends, so that
    // they do not compile the same unchanged kernels at the same time.
    std::thread::scope(|scope| {
        let check = &check;
        for thread in 0..verdicts.threads() {
            scope.spawn(move || check(if thread % 2 == 0 { slice::Iter::next } else { slice::Iter::next_back }));
        }
    });
    verdicts.finish();
    let accepted = accepted.into_inner().unwrap();
    assert!(accepted.is_empty(), "the comparison accepts these mistakes: {accepted:#?}");
}

/// A change of a kernel can make a mistake meaningless. This test finds all of them before any kernel is compiled.
#[test]
fn mistakes_quote_the_present_kernels() {
    for Mistake(name, _, file, right, wrong, _) in MISTAKES {
        let stage = rockfall::step::catalog::ALL.iter().find(|stage| stage.name == *name);
        let parts = stage.unwrap_or_else(|| panic!("no stage has the name {name}")).parts();
        let part = parts.iter().find(|part| is_file(part, file)).unwrap_or_else(|| panic!("{name} has no {file}"));
        assert!(part.text.contains(right), "{file} of {name} does not contain '{right}'");
        assert_ne!(right, wrong, "{file} of {name}");
    }
}

#[test]
fn every_stage_has_a_mistake() {
    for stage in rockfall::step::catalog::ALL {
        assert!(MISTAKES.iter().any(|mistake| mistake.0 == stage.name), "MISTAKES has no entry for {}", stage.name);
    }
}

/// A sort key holds an insertion index and, if there is room, the place of the object's id. With too many objects there is no
/// room, and the kernel looks up the ids. Both ways must give the same lists.
#[test]
fn pair_lists_do_not_depend_on_the_layout_of_sort_keys() {
    let trace = trace(&plan(1, Integrator::Rk4));
    let Scenario { runs, before } = trace.scenarios.iter().find(|scenario| scenario.is("find_neighbours")).expect("a stage");
    let (right, wrong) = ("override MANY: bool = false", "const MANY: bool = true");
    let many = Mistake("find_neighbours", 0, "find_neighbours.wgsl", right, wrong, Buffer::Lists);
    let words = |world: &World| entries(world).iter().map(|entry| (entry.mover, entry.word)).collect::<Vec<_>>();
    let found = words(&on_gpu(&GPU, before, &with_mistake(runs, &many, &mut None)));
    assert!(found.len() > 1000, "{} entries", found.len());
    assert_eq!(found, words(&on_gpu(&GPU, before, runs)));
}
