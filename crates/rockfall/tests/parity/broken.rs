//! Kernels with one plausible mistake each, which the comparison must tell: a comparison is worth what it rejects.

use rockfall::layout::LEAPS;
use rockfall::stage::{Buffer, Part, Run, Stage, Threads};
use rockfall::world::World;
use rockfall::{Integrator, Settings};

use crate::compare::{MEASURED, differences};
use crate::decisions::entries;
use crate::device::{on_gpu, open};
use crate::plan;
use crate::trace::{COLLISIONS, POSITIONS, Plan, Scenario, trace};

/// A mistake: in which stage and pass, the file, the text and what it becomes, and the buffer that it shows in.
struct Mistake(&'static str, u32, &'static str, &'static str, &'static str, Buffer);

const MISTAKES: [Mistake; 86] = [
    Mistake("update_aabbs", 0, "update_aabbs.wgsl", "0.02 * radius", "0.03 * radius", Buffer::Aabbs),
    Mistake("update_aabbs", 0, "travel.wgsl", "length(fourth - third)", "length(fourth)", Buffer::Aabbs),
    Mistake("update_aabbs", 0, "travel.wgsl", "position + way", "position - way", Buffer::Aabbs),
    Mistake("count_pairs", 0, "pair_tiles.wgsl", "(own.id != tile[k].id)", "(own.id < tile[k].id)", Buffer::Lists),
    Mistake("scan_pairs", 0, "scan_pairs.wgsl", "k < SLICE;", "k < SLICE / 2u;", Buffer::Lists),
    Mistake("fill_pairs", 0, "pair_tiles.wgsl", "id | feature <<", "id | (11u - feature) <<", Buffer::Lists),
    Mistake("sort_axis", 1, "sort_axis.wgsl", "pass_.index * WORKGROUP", "0u", Buffer::Cells),
    Mistake("bound_blocks", 0, "bound_blocks.wgsl", "max(greatest[local]", "min(greatest[local]", Buffer::Extents),
    Mistake("count_near", 0, "near_tiles.wgsl", "their.x > interval.y", "their.x > interval.x", Buffer::Lists),
    Mistake("fill_near", 0, "heap.wgsl", "<= key {", ">= key {", Buffer::Lists),
    Mistake("clear_cells", 0, "clear_cells.wgsl", "k < CELL_BLOCK", "k < CELL_BLOCK / 2u", Buffer::Cells),
    Mistake("count_cells", 0, "grid.wgsl", "u32(z) * ROW_Z", "u32(z) * ROW_Y", Buffer::Cells),
    Mistake("count_cells", 0, "count_object.wgsl", "max(out.x, max(out.y", "max(out.x, min(out.y", Buffer::Cells),
    Mistake("build_grid", 0, "count_object.wgsl", "1u << level);", "1u);", Buffer::Cells),
    Mistake("plan_lists", 0, "plan_lists.wgsl", "status.rebuild != 0u", "status.rebuild == 0u", Buffer::Sizes),
    Mistake("sum_blocks", 0, "scan_cells.wgsl", "local == TEAM - 1u", "local == 0u", Buffer::Cells),
    Mistake(
        "place_cells",
        0,
        "scan_cells.wgsl",
        "before + sums[local] - total(counts);",
        "before + sums[local];",
        Buffer::Cells,
    ),
    Mistake("place_cells", 0, "scan_cells.wgsl", "before += sums", "before -= sums", Buffer::Cells),
    Mistake("sort_cells", 0, "place_object.wgsl", "CELLS_AT + key], 1u", "CELLS_AT + key], 0u", Buffer::Cells),
    Mistake("find_neighbours", 0, "find_neighbours.wgsl", "(id != mover);", "(id >= mover);", Buffer::Lists),
    Mistake("find_neighbours", 0, "neighbours.wgsl", "if statics_stand_apart", "if !statics_stand_apart", Buffer::Lists),
    Mistake("find_neighbours", 0, "find_neighbours.wgsl", "(key >> PLACE_BITS) != before", "key != before", Buffer::Lists),
    Mistake("find_neighbours", 0, "sort.wgsl", "max(s.b, s.d)", "min(s.b, s.d)", Buffer::Lists),
    Mistake("find_neighbours", 0, "neighbours.wgsl", "> touching * touching", "> 0.9 * touching * touching", Buffer::Lists),
    Mistake("count_cells", 0, "count_object.wgsl", "& is_long(aabb)", "| is_long(aabb)", Buffer::Cells),
    Mistake("count_cells", 0, "count_object.wgsl", "if mine > atomicLoad", "if mine < atomicLoad", Buffer::Cells),
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
    Mistake("find_collisions", 0, "margin.wgsl", "radius - room", "radius - 0.5 * room", Buffer::Status),
    Mistake("find_collisions", 0, "judge.wgsl", "(any_bits & ENTRY_COLLIDES)", "(any_bits & ENTRY_OVERLAPS)", Buffer::Lists),
    Mistake("find_collisions", 0, "find_collisions.wgsl", "e += WORKGROUP", "e += 2u * WORKGROUP", Buffer::Lists),
    Mistake("find_collisions", 0, "teams.wgsl", "(workgroup - step.large)", "workgroup", Buffer::Lists),
    Mistake("find_collisions", 0, "judge.wgsl", "min(radius, ", "max(radius, ", Buffer::Lists),
    Mistake("find_collisions", 0, "geometry.wgsl", "nn <= 1e-8 * aa * bb", "nn < 0.0", Buffer::Lists),
    Mistake("weigh_collisions", 0, "weights.wgsl", "ALONE: f32 = 1.001", "ALONE: f32 = 1.5", Buffer::RowSums),
    Mistake("weigh_collisions", 0, "weights.wgsl", "velocity.w * abs(dot", "abs(dot", Buffer::RowSums),
    Mistake("weigh_collisions", 0, "weigh_large.wgsl", "if entry_id(entry) != other", "if entry != NONE", Buffer::RowSums),
    Mistake("weigh_collisions", 0, "weigh_large.wgsl", "if is_second {", "if !has_one {", Buffer::RowSums),
    Mistake("weigh_collisions", 0, "coupled.wgsl", "sqrt(l.inverse_mass)", "l.inverse_mass", Buffer::RowSums),
    Mistake("weigh_collisions", 0, "weigh_collisions.wgsl", "low = middle + 1u", "high = middle", Buffer::RowSums),
    Mistake("weigh_collisions", 0, "weigh_collisions.wgsl", "(*task).next = 0u", "(*task).next = 1u", Buffer::RowSums),
    Mistake(
        "apply_collisions",
        0,
        "stored_sums.wgsl",
        "row_sums[row_of_sums(slot)][slot.y]",
        "1.01 * row_sums[row_of_sums(slot)][slot.y]",
        Buffer::Y2,
    ),
    Mistake("apply_collisions", 0, "changes.wgsl", "1.0 + step.rest", "1.0 - step.rest", Buffer::Y2),
    Mistake("apply_collisions", 0, "ordered_sums.wgsl", "6u + component / 3u", "6u", Buffer::Y2),
    Mistake("apply_collisions", 0, "apply_collisions.wgsl", "min(count - begin, WORKGROUP)", "1u", Buffer::Y2),
    Mistake("commit_collisions", 0, "take_next.wgsl", "region < 3u", "region < 1u", Buffer::Start),
    Mistake("commit_collisions", 0, "collided.wgsl", "collided, 2u", "collided, 1u", Buffer::Status),
    Mistake("restore_lengths", 0, "lengths.wgsl", "move_end(ends.y, -w2", "move_end(ends.y, w2", Buffer::Start),
    Mistake("rod_forces", 0, "rod_forces.wgsl", "+= at * couple", "+= (1.0 - at) * couple", Buffer::Wrenches),
    Mistake("rod_forces", 3, "geometry.wgsl", "nn <= 1e-8 * aa * bb", "nn <= 0.3 * aa * bb", Buffer::Wrenches),
    Mistake("advance", 0, "contact.wgsl", "select(overlap, 0.5 *", "select(overlap, 0.4 *", Buffer::Y2),
    Mistake("advance", 1, "ordered_sums.wgsl", "local] = one.y", "local] = one.x", Buffer::Y3),
    Mistake("advance", 1, "contact.wgsl", "sqrt(sqrt(tt))", "sqrt(tt)", Buffer::Y3),
    Mistake("advance", 1, "contact.wgsl", "min(per_velocity,", "max(per_velocity,", Buffer::Y3),
    Mistake("leap", 0, "contact.wgsl", "* reduced_mass / sqrt(tt)", "* reduced_mass / tt", Buffer::Y2),
    Mistake("advance", 2, "next_state.wgsl", "() == 2u", "() == 1u", Buffer::Y4),
    Mistake("finish", 3, "finished.wgsl", "step.dt / 6.0", "step.dt / 3.0", Buffer::Start),
    Mistake("finish_and_turn", 3, "finished.wgsl", "step.dt / 6.0", "step.dt / 3.0", Buffer::Start),
    Mistake("finish_and_turn", 3, "rotation.wgsl", "0.5 * rate", "rate", Buffer::Orientations),
    Mistake("leap", 0, "leap_state.wgsl", "step.dt * after.velocity", "step.dt * old_velocity.xyz", Buffer::Y2),
    Mistake("commit_leap", 0, "take_next.wgsl", "region < 3u", "region < 2u", Buffer::Start),
    Mistake("commit_and_turn", 0, "commit_and_turn.wgsl", "momentum.xyz * momentum.w", "momentum.xyz", Buffer::Orientations),
    Mistake("constrain", 0, "constrain.wgsl", "correction / step.dt", "correction * step.dt", Buffer::Start),
    Mistake("turn", 0, "turn.wgsl", "cross(spins + orbit, d)", "cross(spins - orbit, d)", Buffer::Start),
    Mistake("turn", 0, "turn.wgsl", "0.5 * step.dt * (change", "step.dt * (change", Buffer::Start),
    Mistake("turn", 0, "rotation.wgsl", "cross(a.xyz, b.xyz)", "cross(b.xyz, a.xyz)", Buffer::Orientations),
    Mistake("key_spheres", 0, "key_spheres.wgsl", "axes.y << 1u", "axes.y << 2u", Buffer::Y2),
    Mistake("count_digits", 1, "digits.wgsl", "digit * ((step", "digit + ((step", Buffer::Cells),
    Mistake("scatter_digits", 0, "scatter_digits.wgsl", "counts[at] += 1u", "counts[at] += 0u", Buffer::Y3),
    Mistake("scatter_digits", 7, "digits.wgsl", "* DIGIT_BITS", "* 3u", Buffer::Y2),
    Mistake("permute_spheres", 0, "permute_spheres.wgsl", "words[step.users_at + from_]", "from_", Buffer::Y4),
    Mistake("settle_spheres", 0, "settle_spheres.wgsl", "follow(at + 1u);", "", Buffer::Words),
    Mistake("settle_spheres", 0, "settle_spheres.wgsl", "= moved.y", "= moved.x", Buffer::Words),
    Mistake("apply_collisions", 0, "objects.wgsl", "select(end, NONE, end == SOME_RODS)", "NONE", Buffer::Y2),
    Mistake(
        "settle_spheres",
        0,
        "settle_spheres.wgsl",
        "step.slots_at + own.y] = i",
        "step.slots_at + i] = own.y",
        Buffer::Words,
    ),
    Mistake("measure_order", 0, "measure_order.wgsl", "32u - count", "31u - count", Buffer::Status),
    Mistake("end_step", 0, "close_step.wgsl", "atomicLoad(&max_overlap)", "atomicLoad(&contacts)", Buffer::Status),
    Mistake("run_steps", COLLISIONS, "run_steps.wgsl", "(k + order) % 2u", "(k + order + 1u) % 2u", Buffer::Status),
    Mistake("run_steps", COLLISIONS, "weights.wgsl", "sqrt(l.inverse_mass)", "l.inverse_mass", Buffer::Start),
    Mistake("run_steps", COLLISIONS, "four_states.wgsl", "(0u, region, i)] = row", "(1u, region, i)] = row", Buffer::Start),
    Mistake("run_steps", POSITIONS, "run_steps.wgsl", "evaluated = evaluation", "evaluated = evaluation / 2u", Buffer::Start),
    Mistake("run_steps", POSITIONS | LEAPS, "run_steps.wgsl", "next_row(2u, i)", "next_row(1u, i)", Buffer::Orientations),
    Mistake("run_steps", POSITIONS, "four_states.wgsl", "(2u, region", "(1u, region", Buffer::Start),
];

/// A run whose stage has another text in a file, if the file is part of it. It lives as long as the process, as stages do.
pub(crate) fn rewritten(run: Run, file: &str, rewrite: impl Fn(&str) -> String) -> Run {
    let mut parts: Vec<Part> = run.stage.parts.to_vec();
    if let Some(part) = parts.iter_mut().find(|part| part.file.ends_with(file)) {
        part.text = rewrite(part.text).leak();
    }
    let stage = Stage { parts: parts.leak(), ..*run.stage };
    Run { stage: Box::leak(Box::new(stage)), ..run }
}

/// The stage of a run with a mistake in it.
fn broken(run: Run, Mistake(_, _, file, right, wrong, _): &Mistake) -> Run {
    assert!(run.stage.parts.iter().any(|part| part.file.ends_with(file)), "{file}");
    rewritten(run, file, |text| {
        let mistaken = text.replacen(right, wrong, 1);
        assert_ne!(mistaken, text, "{file} has no '{right}'");
        mistaken
    })
}

#[test]
fn a_kernel_with_a_mistake_is_told() {
    let (rk4, euler) = (Integrator::Rk4, Integrator::SymplecticEuler);
    // The last two are without rods; the first trace that has the stage do something is the one that counts,
    // or the first with long movers, or the first with large spheres, or with those and without rods.
    let plans = [(0, rk4, true), (1, euler, true), (2, rk4, true), (3, rk4, false), (4, euler, false)];
    // Coulomb's cap is reached at a sliding velocity of 1, which some contacts exceed and some do not.
    let settings = Settings { coulomb_friction: 0.05, ..Settings::default() };
    let traces = plans.map(|(seed, integrator, rods)| trace(&Plan { settings, rods, ..plan(seed, integrator) }));
    let mut untold = Vec::new();
    for mistake in &MISTAKES {
        let Mistake(stage, pass, file, _, wrong, buffer) = mistake;
        let scenarios = traces.iter().flat_map(|trace| &trace.scenarios);
        let does = |Scenario { run, before }: &&Scenario| {
            let has_work = run.stage.threads != Threads::LongMovers || before.cells[3] > 0;
            run.stage.name == *stage && run.pass == *pass && run.applies(&before.step) && has_work
        };
        let scenarios: Vec<_> = scenarios.filter(does).collect();
        let is_told = |scenario: &Scenario| {
            // A device of its own: kernels are kept by name.
            let gpu = on_gpu(&open(), &scenario.before, broken(scenario.run, mistake));
            let told = differences(&scenario.run, &scenario.before, &gpu, MEASURED);
            told.iter().any(|difference| difference.buffer == *buffer)
        };
        let with_long_movers = scenarios.iter().find(|scenario| scenario.before.cells[3] > 0);
        let with_teams = scenarios.iter().find(|scenario| scenario.before.step.large > 0);
        let of_plain = scenarios.iter().find(|scenario| scenario.before.step.large > 0 && scenario.before.step.rods == 0);
        let first = scenarios.first().expect(stage);
        if ![Some(first), with_long_movers, with_teams, of_plain].into_iter().flatten().any(|scenario| is_told(scenario)) {
            untold.push(format!("{stage} {pass}, {file}: '{wrong}'"));
        }
    }
    assert!(untold.is_empty(), "{untold:#?}");
}

#[test]
fn there_is_a_mistake_for_every_stage() {
    for stage in rockfall::stage::ALL {
        assert!(MISTAKES.iter().any(|mistake| mistake.0 == stage.name), "{}", stage.name);
    }
}

/// Where there are too many objects for a key to hold the place of an id too, ids are looked up, and lists are the same.
#[test]
fn the_place_of_an_id_in_a_key_does_not_show() {
    let trace = trace(&plan(1, Integrator::Rk4));
    let is_meant = |scenario: &&Scenario| scenario.run.stage.name == "find_neighbours";
    let Scenario { run, before } = trace.scenarios.iter().find(is_meant).expect("a stage");
    let many = Mistake("", 0, "find_neighbours.wgsl", "override MANY: bool = false", "const MANY: bool = true", Buffer::Lists);
    let words = |world: &World| entries(world).iter().map(|entry| (entry.mover, entry.word)).collect::<Vec<_>>();
    let found = words(&on_gpu(&open(), before, broken(*run, &many)));
    assert!(found.len() > 1000, "{} entries", found.len());
    assert_eq!(found, words(&on_gpu(&open(), before, *run)));
}

/// Where there is no room for all contacts that are coupled with a workgroup's collisions, they are worked out part by part.
#[test]
fn the_room_for_coupled_contacts_does_not_show() {
    let trace = trace(&plan(0, Integrator::Rk4));
    let Scenario { run, before } =
        trace.scenarios.iter().find(|scenario| scenario.run.stage.name == "weigh_collisions").expect("a stage");
    let less = Mistake("", 0, "weigh_collisions.wgsl", "ROOM: u32 = 128u", "ROOM: u32 = AT_ONCE", Buffer::RowSums);
    let part_by_part = on_gpu(&open(), before, broken(*run, &less)).row_sums;
    let bits = |sums: &[f32]| sums.iter().map(|sum| sum.to_bits()).collect::<Vec<_>>();
    let at_once = on_gpu(&open(), before, *run).row_sums;
    assert!(at_once.iter().filter(|sum| sum.abs() > 1.5).count() > 50, "few collisions are coupled with others");
    assert_eq!(bits(&part_by_part), bits(&at_once));
}
