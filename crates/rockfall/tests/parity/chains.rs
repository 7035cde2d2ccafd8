//! Chains of several blocks of springs: `loads` and `end_step` for movers that own more contacts than a block holds, with and
//! without room in the pool.

use rockfall::exec::gpu::GpuWorld;
use rockfall::glam::Vec3;
use rockfall::model::buffer::Buffer;
use rockfall::model::layout::{HISTORY_BLOCK, HISTORY_WORDS, LINK_KEY, NO_KEY};
use rockfall::model::status::{REJECTED_BEFORE, REJECTED_HISTORY};
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run};
use rockfall::{BroadPhase, ContactLaw, Cuboid, Integrator, Material, Pair, Scene, Sphere};

use crate::broken::{Mistake, with_mistake};
use crate::compare::{MEASURED, differences, listed};
use crate::device::{GPU, on_gpu};
use crate::keys;
use crate::trace::with_step_settings;
use crate::verdicts::Verdicts;

/// Balls on 1, 2, ... 14 strips.
const BALLS: u8 = 14;
/// Blocks of the pool that their chains take.
const BLOCKS: u32 = 3 + 3 * 2 + 3 * 3 + 4;

/// The stages, by name.
fn runs(names: &[&str]) -> Vec<Run> {
    let stages = Phase::UpdatePositions.stages(Integrator::SymplecticEuler, BroadPhase::BruteForce).iter();
    stages.filter(|run| names.contains(&run.stage.name)).copied().collect()
}

/// The balls after two steps of force evaluations, so that both tables have chains. Where a chain ends, the records of the table
/// that is written next are not empty.
fn before(pool: u32) -> World {
    let mut scene = Scene::new();
    scene.settings.contact_law = ContactLaw::Linear;
    scene.settings.collisions = false;
    let soft = Material::new("soft").density(1.0).young(1e5).poisson(0.25);
    let soft = scene.add_material(soft).expect("a valid material");
    scene.set_pair(soft, soft, Pair::default().restitution(0.5).friction(0.5).stiffness(1e3)).expect("a valid pair");
    for k in 0..BALLS {
        let place = [f32::from(k) * 1.5, 0.48 + 0.001 * f32::from(k), 0.1];
        let velocity = [0.3, -0.1, 0.2 + 0.01 * f32::from(k)];
        scene.add_sphere(Sphere::new(place, 0.5).density(1.0).material(soft).velocity(velocity)).expect("a valid sphere");
    }
    for k in 0..BALLS {
        // A ball touches the strips that begin before it. Each strip is in another direction: of strips in one plane, only one would
        // count.
        let (sin, cos) = (0.15 * (f32::from(k) - 6.5)).sin_cos();
        let (down, across) = (Vec3::new(0.0, -cos, sin), Vec3::new(0.0, sin, cos));
        let begin = f32::from(k) * 1.5 - 0.75;
        let corner = Vec3::new(begin, 0.48, 0.1) + 0.48 * down + 0.1 * across;
        let strip = Cuboid::new(corner, (40.0 - begin) * Vec3::X, 0.2 * down, -0.2 * across);
        scene.add_box(strip.material(soft)).expect("a valid box");
    }
    let mut world = with_step_settings(World::build(&scene).expect("a world"));
    world.set_history_pool(BLOCKS);
    let lists = [Phase::UpdateAabbs, Phase::BroadPhase].into_iter();
    let lists = lists.flat_map(|phase| phase.stages(Integrator::SymplecticEuler, BroadPhase::BruteForce));
    lists.for_each(|run| run.on_cpu(&mut world));
    for _ in 0..2 {
        runs(&["loads", "end_step"]).iter().for_each(|run| run.on_cpu(&mut world));
        assert_eq!((world.status.rejected, world.status.history_blocks), (0, 0));
    }
    assert_eq!(world.status.history_table, 0);
    if pool < BLOCKS {
        // Without springs before the step, which would not fit.
        world.histories.fill(NO_KEY);
    }
    world.set_history_pool(pool);
    let table = world.histories.len() / 2;
    world.histories[table..].fill(7);
    // A contact of the ball with a full block is new. The ball after it has a contact with the same key.
    world.histories[((3 * HISTORY_BLOCK + 1) * HISTORY_WORDS - 1) as usize] = 1 << 20;
    world
}

/// The differences between the backends after these stages, or with a mistake in one of them.
fn found(before: &World, names: &[&str], mistake: Option<&Mistake>) -> Vec<Buffer> {
    let runs = runs(names);
    let on_device = mistake.map_or_else(|| runs.clone(), |mistake| with_mistake(&runs, mistake, &mut None));
    let all = differences(&runs, before, &on_gpu(&GPU, before, &on_device), MEASURED);
    assert!(mistake.is_some() || all.is_empty(), "{names:?}: {}", listed(&all));
    all.iter().map(|difference| difference.buffer).collect()
}

#[test]
fn backends_agree_on_chains_of_blocks() {
    let world = before(BLOCKS);
    found(&world, &["loads"], None);
    found(&world, &["loads", "end_step"], None);
    let mut after = world.clone();
    runs(&["loads"]).iter().for_each(|run| run.on_cpu(&mut after));
    assert_eq!((after.status.history_blocks, after.status.rejected), (BLOCKS, 0));
}

/// Without room for the last block, the step is rejected, and the status has the number of blocks that are needed. A step that is
/// rejected for another reason returns its blocks, too.
#[test]
fn backends_agree_on_a_full_pool() {
    let short = before(BLOCKS - 1);
    let names = ["loads", "end_step"];
    let mut cpu = short.clone();
    runs(&names).iter().for_each(|run| run.on_cpu(&mut cpu));
    for status in [cpu.status, on_gpu(&GPU, &short, &runs(&names)).status] {
        let found = (status.rejected, status.history_blocks, status.history_needed);
        assert_eq!(found, (REJECTED_HISTORY | REJECTED_BEFORE, 0, BLOCKS));
    }
    let mut escaped = before(BLOCKS);
    escaped.aabbs.iter_mut().for_each(|aabb| aabb.max[0] -= 1.0);
    let names = ["loads", "symplectic_euler", "end_step"];
    let mut cpu = escaped.clone();
    runs(&names).iter().for_each(|run| run.on_cpu(&mut cpu));
    for status in [cpu.status, on_gpu(&GPU, &escaped, &runs(&names)).status] {
        let found = (status.has_only_escaped(), status.history_blocks, status.history_needed);
        assert_eq!(found, (true, 0, 0));
    }
}

/// Kernels follow links without bounds checks, so a link that does not lead to a free block of the pool is refused.
#[test]
fn invalid_links_are_refused() {
    let world = before(BLOCKS);
    let end = world.histories.chunks_exact(HISTORY_WORDS as usize).position(|record| record[7] == NO_KEY).expect("an end");
    let used = world.histories.iter().find(|word| **word & LINK_KEY != 0 && **word != NO_KEY).expect("a link");
    // Outside the table, a block of a mover, and a block that belongs to another chain.
    for link in [LINK_KEY | world.step.history_table_blocks(), LINK_KEY | 2, *used] {
        let mut wrong = world.clone();
        wrong.histories[end * HISTORY_WORDS as usize + 7] = link;
        let refused = GpuWorld::new(&GPU, &wrong).map(drop).expect_err("refused").to_string();
        assert!(refused.contains("a link of the springs"), "{refused}");
    }
    assert!(GpuWorld::new(&GPU, &world).is_ok());
}

/// Mistakes that only chains reveal.
static MISTAKES: [Mistake; 9] = [
    Mistake("loads", 0, "history.wgsl", "(last & LINK_KEY) != 0u", "false", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "HISTORY_BLOCK * (last & ~LINK_KEY)", "HISTORY_BLOCK", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "if (record + 1u) % HISTORY_BLOCK == 0u {", "if false {", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "histories[new_] = histories[old]", "histories[new_] = vec4u(0u)", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "= vec4u(LINK_KEY | block)", "= vec4u(NO_KEY)", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "if !is_full(chain) &", "if is_full(chain) &", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "block + 1u;", "block;", Buffer::Histories),
    Mistake("loads", 0, "history.wgsl", "atomicAdd(&status.history_blocks, 1u)", "0u", Buffer::Histories),
    Mistake(
        "end_step",
        0,
        "close_step.wgsl",
        "atomicExchange(&status.history_blocks, 0u)",
        "atomicLoad(&status.history_blocks)",
        Buffer::Status,
    ),
];

#[test]
fn mistakes_in_chains_are_rejected() {
    let world = before(BLOCKS);
    let stages = ["loads", "end_step"];
    let runs = runs(&stages);
    let input = keys::of_input(keys::code(include_str!("chains.rs")), &runs, &world, MEASURED);
    let verdicts = Verdicts::of("chains");
    let is_rejected = |mistake: &&Mistake| {
        let key = |_: &()| keys::of_kernels(input, &with_mistake(&runs, mistake, &mut None), &world, mistake);
        let rejects = |_: &()| found(&world, &stages, Some(mistake)).contains(&mistake.5);
        verdicts.rejects(&mistake.name(), std::iter::once(()), key, rejects)
    };
    let accepted: Vec<String> = MISTAKES.iter().filter(|mistake| !is_rejected(mistake)).map(Mistake::name).collect();
    verdicts.finish();
    assert!(accepted.is_empty(), "accepted: {accepted:#?}");
}
