//! A step that was rejected because a body left its AABB: the stages that build lists still do so, and `end_step` lets the next step
//! repeat it.

use rockfall::model::buffer::Buffer;
use rockfall::model::status::{
    Counters, NO_BODY, REBUILD_DONE, REBUILD_REQUESTED, REJECTED_BEFORE, REJECTED_ESCAPED, REJECTED_PAIRS, Status,
};
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run};
use rockfall::{BroadPhase, Integrator, Scene, Sphere};

use crate::broken::{Mistake, with_mistake};
use crate::decisions::entries;
use crate::device::{GPU, on_gpu};
use crate::trace::with_step_settings;

/// Spheres of which each touches the next, with lists of nothing.
fn row() -> World {
    let mut scene = Scene::new();
    for k in 0..70_u8 {
        scene.add_sphere(Sphere::new([f32::from(k) * 0.875, 0.0, 0.0], 0.5)).expect("a valid sphere");
    }
    let mut world = with_step_settings(World::build(&scene).expect("a world"));
    world.status.rejected = REJECTED_ESCAPED;
    world
}

/// The world after the stages that build lists, and the end of the step, on both backends.
fn after(before: &World, broad_phase: BroadPhase, mistake: Option<&Mistake>) -> [World; 2] {
    let lists = [Phase::UpdateAabbs, Phase::BroadPhase].into_iter();
    let lists = lists.flat_map(|phase| phase.stages(Integrator::Rk4, broad_phase));
    both(before, &lists.copied().chain(end()).collect::<Vec<_>>(), mistake)
}

fn end() -> impl Iterator<Item = Run> {
    let stages = Phase::UpdatePositions.stages(Integrator::Rk4, BroadPhase::Grid).iter();
    stages.filter(|run| run.stage.name == "end_step").copied()
}

/// The world after the runs, on the CPU and on the device, there with a mistake.
fn both(before: &World, runs: &[Run], mistake: Option<&Mistake>) -> [World; 2] {
    let mut cpu = before.clone();
    runs.iter().for_each(|run| run.on_cpu(&mut cpu));
    let on_device = mistake.map_or_else(|| runs.to_vec(), |mistake| with_mistake(runs, mistake, &mut None));
    [cpu, on_gpu(&GPU, before, &on_device)]
}

/// The words of all list entries. Where the lists are in memory is arbitrary.
fn words(world: &World) -> Vec<u32> {
    entries(world).iter().map(|entry| entry.word).collect()
}

/// The width of the AABB of the first sphere after a body was outside by this much, in units of 0.02 r.
fn width(escape: f32, change: fn(&mut World), mistake: Option<&Mistake>) -> [f32; 2] {
    let mut before = row();
    before.status.escape_ratio = escape.to_bits();
    change(&mut before);
    let stages = Phase::UpdateAabbs.stages(Integrator::Rk4, BroadPhase::BruteForce);
    both(&before, stages, mistake).map(|world| world.aabbs[0].max[0] - world.aabbs[0].min[0])
}

/// Docs of `update_aabbs`: 0.02 r (1.25 d + 1) more on each side, up to 0.2 r, where lists may be rebuilt in every step.
#[test]
fn aabbs_of_repeated_steps_are_larger() {
    let usual = |world: &mut World| world.status.rejected = 0;
    let radius = 0.5;
    for [cpu, gpu] in [(0.8, 0.04), (4.0, 0.12), (1e20, 0.2)].map(|(escape, more)| {
        let [with, without] = [width(escape, |_| (), None), width(escape, usual, None)];
        [0, 1].map(|backend| (with[backend] - without[backend]) / (2.0 * radius) - more)
    }) {
        assert!(cpu.abs() < 1e-5 && gpu.abs() < 1e-5, "{cpu} {gpu}");
    }
    // Elsewhere new lists suffice.
    let longer = |world: &mut World| world.step.lists.list_interval = 2.0;
    assert_eq!(width(4.0, longer, None), width(0.0, longer, None));
    let mistakes = [("* min(1.25", "* max(1.25"), ("step.list_interval == 1.0", "step.list_interval == 2.0")];
    for (right, wrong) in mistakes {
        let mistake = Mistake("update_aabbs", 0, "update_aabbs.wgsl", right, wrong, Buffer::Aabbs);
        let [cpu, gpu] = width(4.0, |_| (), Some(&mistake));
        assert!((cpu - gpu).abs() > 0.01, "'{wrong}' is accepted");
    }
}

#[test]
fn lists_are_built_for_bodies_outside_their_aabbs() {
    for broad_phase in [BroadPhase::Grid, BroadPhase::SortAndSkip, BroadPhase::BruteForce] {
        let [cpu, gpu] = after(&row(), broad_phase, None);
        assert_eq!(words(&cpu), words(&gpu), "{broad_phase:?}");
        for world in [cpu, gpu] {
            let status = &world.status;
            assert!(world.lists[..70].iter().all(|count| *count > 0), "{broad_phase:?}: {:?}", &world.lists[..70]);
            let found = (status.rejected, status.rebuild, status.builds, status.repeats, status.repeated, status.steps);
            assert_eq!(found, (0, 0, 1, 1, 1, 0), "{broad_phase:?}");
        }
        // A step that lacks room for its lists waits for the host, and so does one that is rejected for the second time.
        for (rejected, repeated) in [(REJECTED_ESCAPED | REJECTED_PAIRS, 0), (REJECTED_ESCAPED, 1)] {
            let mut waiting = row();
            (waiting.status.rejected, waiting.status.repeated) = (rejected, repeated);
            for world in after(&waiting, broad_phase, None) {
                let status = &world.status;
                let found = (status.rejected, status.rebuild, status.builds, status.repeats, status.repeated, status.steps);
                assert_eq!(found, (rejected | REJECTED_BEFORE, REBUILD_REQUESTED, 0, 0, repeated, 0), "{broad_phase:?}");
            }
        }
    }
}

/// A rejected step with new lists. Every word that its end may change has a value of its own.
fn rejected(collided: u32) -> World {
    let mut world = row();
    let status = &mut world.status;
    for (block, counters) in status.counters.iter_mut().enumerate() {
        let block = block as u32;
        *counters = Counters { contacts: 100 + block, max_overlap: 200 + block, collisions: 300 + block, ..*counters };
    }
    *status = Status {
        rebuild: REBUILD_DONE,
        escape_ratio: 1.5_f32.to_bits(),
        collided,
        steps: 5,
        collides: 1,
        lengths_due: 1,
        forces_due: 1,
        last_contacts: 6,
        last_collisions: 7,
        total_collisions_low: 8,
        bad_body: 9,
        bad_count: 10,
        total_bad: 11,
        builds: 12,
        listed: 13,
        clustered: 1,
        clustered_steps: 14,
        many_steps: 15,
        history_table: 1,
        repeats: 16,
        repeat_escape: 17,
        ..*status
    };
    world
}

/// What the end of the step leaves, from the specification of the status.
fn expected(collided: u32) -> Status {
    let before = rejected(collided).status;
    let is_done = u32::from(collided != 0);
    Status {
        counters: before.counters.map(|counters| Counters { collisions: is_done * counters.collisions, ..Counters::default() }),
        rejected: 0,
        rebuild: 0,
        escape_ratio: 0,
        collided: is_done,
        collides: is_done,
        clustered: is_done,
        listed: 0,
        bad_body: NO_BODY,
        bad_count: 0,
        builds: 13,
        repeats: 17,
        repeated: 1,
        repeat_escape: 1.5_f32.to_bits(),
        ..before
    }
}

#[test]
fn the_end_of_a_rejected_step_lets_the_next_one_repeat_it() {
    let end: Vec<Run> = end().collect();
    for collided in 0..3 {
        for world in both(&rejected(collided), &end, None) {
            assert_eq!(world.status, expected(collided));
        }
    }
    // Without new lists, after a first attempt, and for another reason, the host repeats the step.
    let changes: [fn(&mut Status); 4] = [
        |status| status.rebuild = REBUILD_DONE | REBUILD_REQUESTED,
        |status| status.rebuild = 0,
        |status| status.repeated = 1,
        |status| status.rejected |= REJECTED_PAIRS,
    ];
    for change in changes {
        let mut before = rejected(2);
        change(&mut before.status);
        for world in both(&before, &end, None) {
            assert_eq!(world.status, Status { rejected: before.status.rejected | REJECTED_BEFORE, ..before.status });
        }
    }
}

/// Mistakes in the end of a rejected step.
static MISTAKES: [(&str, &str); 12] = [
    ("status.builds += 1u", "status.builds += 0u"),
    ("status.repeats += 1u", "status.repeats += 0u"),
    ("status.repeated = 1u", "status.repeated = 0u"),
    ("= atomicExchange(&status.escape_ratio, 0u)", "= atomicLoad(&status.escape_ratio)"),
    ("atomicStore(&status.rebuild, 0u)", "atomicOr(&status.rebuild, 0u)"),
    ("atomicStore(&status.listed, 0u)", "atomicOr(&status.listed, 0u)"),
    ("atomicStore(&status.collided, 1u)", "atomicOr(&status.collided, 1u)"),
    ("atomicStore(&status.rejected, 0u)", "atomicOr(&status.rejected, 0u)"),
    ("atomicStore(&status.counters[block].contacts, 0u)", "atomicOr(&status.counters[block].contacts, 0u)"),
    ("atomicStore(&status.counters[block].max_overlap, 0u)", "atomicOr(&status.counters[block].max_overlap, 0u)"),
    ("if atomicLoad(&status.collided) == 0u", "if true"),
    ("(local < COUNTER_BLOCKS) & repeats_step", "(local == 0u) & repeats_step"),
];

/// After a step that was repeated, the next one may be repeated, too.
#[test]
fn a_completed_step_is_no_repetition() {
    let end: Vec<Run> = end().collect();
    let mut before = row();
    (before.status.rejected, before.status.repeated, before.status.repeats) = (0, 1, 3);
    for world in both(&before, &end, None) {
        assert_eq!((world.status.steps, world.status.repeated, world.status.repeats), (1, 0, 3));
    }
    let mistake = Mistake("end_step", 0, "close_step.wgsl", "status.repeated = 0u", "status.repeated = 1u", Buffer::Status);
    let [_, gpu] = both(&before, &end, Some(&mistake));
    assert_eq!(gpu.status.repeated, 1, "the mistake has no effect");
}

#[test]
fn mistakes_in_the_end_of_a_rejected_step_are_rejected() {
    let end: Vec<Run> = end().collect();
    for (right, wrong) in MISTAKES {
        let mistake = Mistake("end_step", 0, "close_step.wgsl", right, wrong, Buffer::Status);
        let [_, gpu] = both(&rejected(2), &end, Some(&mistake));
        assert_ne!(gpu.status, expected(2), "'{wrong}' is accepted");
    }
    let mistake = Mistake(
        "count_pairs",
        0,
        "due.wgsl",
        "has_only_escaped(status.rejected)",
        "(status.rejected == REJECTED_PAIRS)",
        Buffer::Status,
    );
    let [_, gpu] = after(&row(), BroadPhase::BruteForce, Some(&mistake));
    assert!(gpu.lists[..70].contains(&0), "'{}' is accepted", mistake.4);
}
