//! The worlds that the stages of a step begin with, with every decision of the step far from its switch.

use rockfall::layout::{CELL_BLOCK, CELLS_AT, FLAG_STAGES, LEAPS, PHASES_SHIFT, POSITIONS_FIRST, ROD_WORDS, SLICE};
use rockfall::stage::{ALL, MEASURE_ORDER, Phase, Run, SORT_MEMORY, When};
use rockfall::world::World;
use rockfall::{BroadPhase, Integrator, Settings};

use crate::cells;
use crate::clusters::{Clusters, clusters};
use crate::decisions::{self, Findings};
use crate::sweeps;

/// Time step of all traces, in s: forces of deep overlaps are large.
pub(crate) const DT: f32 = 0.004;
/// AABBs that hold what these forces do, and pairs that do not overlap besides.
const MARGIN: f32 = 12.0;
/// A cluster that still has a decision too close to call is wrong by design, not by chance.
const MAX_ATTEMPTS: u64 = 200;

/// The pass of `run_steps` that does the collisions of a step.
pub(crate) const COLLISIONS: u32 = 1 << PHASES_SHIFT;
/// The one that does the rest of it.
pub(crate) const POSITIONS: u32 = 1 << PHASES_SHIFT | POSITIONS_FIRST;

/// A stage, and the world that it begins with.
pub(crate) struct Scenario {
    pub(crate) run: Run,
    pub(crate) before: World,
}

/// One step of a random scene.
pub(crate) struct Trace {
    pub(crate) scenarios: Vec<Scenario>,
    /// What the step decided, and how often.
    pub(crate) findings: Findings,
    /// The world after the step.
    pub(crate) after: World,
}

/// What makes a trace.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) seed: u64,
    pub(crate) clusters: usize,
    pub(crate) integrator: Integrator,
    pub(crate) broad_phase: BroadPhase,
    pub(crate) settings: Settings,
    /// With rods and capsules among the clusters.
    pub(crate) rods: bool,
}

/// Draws clusters again until no decision of the step is near its switch.
pub(crate) fn trace(plan: &Plan) -> Trace {
    let mut attempts = vec![0; plan.clusters];
    loop {
        let drawn = clusters(plan, &attempts);
        let trace = run(&drawn, plan);
        if trace.findings.near.is_empty() {
            assert_eq!(trace.after.status.void, 0, "the margins are too narrow for the forces");
            return trace;
        }
        let mut again: Vec<usize> = trace.findings.near.iter().map(|near| drawn.cluster_of[near.object]).collect();
        again.sort_unstable();
        again.dedup();
        for cluster in again {
            attempts[cluster] += 1;
            let mut near = trace.findings.near.iter();
            let why = near.find(|near| drawn.cluster_of[near.object] == cluster).map(|near| near.what);
            assert!(attempts[cluster] < MAX_ATTEMPTS, "cluster {cluster}: {why:?}");
        }
    }
}

/// A world of the scene, roomy enough for its lists.
fn built(drawn: &Clusters, plan: &Plan) -> World {
    let mut world = World::build(&drawn.scene).unwrap();
    // The grid of one block of cells, which so few objects get, and the grid of more.
    world.set_cells(CELL_BLOCK * (1 + plan.seed % 2) as u32);
    sized(world)
}

fn sized(mut world: World) -> World {
    world.step.dt = DT;
    world.step.margin_scale = MARGIN;
    world.step.lead = 0.5;
    // As in a large scene.
    world.step.planned = 1;
    world.set_pair_rows(world.movers().div_ceil(SLICE) * 64);
    // Not 0, so that a word that a stage leaves out shows.
    world.cells[CELLS_AT as usize..].fill(3);
    // As if a step of RK4 had been done in which some accelerated.
    world.step.flags |= if world.step.large > 0 { FLAG_STAGES } else { 0 };
    let spheres = world.step.spheres as usize;
    for sphere in 0..spheres {
        let change = glam::Vec4::new(0.1, -0.2, 0.3, 0.0) * (sphere % 5) as f32;
        world.states[2][spheres + sphere] = world.states[0][spheres + sphere];
        world.states[3][spheres + sphere] = world.states[0][spheres + sphere] + change;
    }
    for wrench in &mut world.wrenches {
        *wrench = glam::Vec4::splat(1e3);
    }
    world
}

fn run(drawn: &Clusters, plan: &Plan) -> Trace {
    let mut world = built(drawn, plan);
    let mut scenarios = Vec::new();
    let mut findings = Findings::default();
    let phases = Phase::STEP.iter().filter(|phase| drawn.scene.settings.collisions || **phase != Phase::HandleCollisions);
    let start = world.states[0].clone();
    for run in phases.flat_map(|phase| phase.stages(plan.integrator, plan.broad_phase)) {
        if run.stage.name == "constrain" {
            turn_some(&mut world);
        }
        scenarios.extend(joined(&world, run));
        decide(&world, run, &mut findings);
        scenarios.push(Scenario { run: *run, before: world.clone() });
        run.on_cpu(&mut world);
        if run.stage.name == "constrain" {
            // Axes that turn half around have no shortest rotation.
            turn_some(&mut world);
        }
        if run.stage.name == "commit_collisions" {
            // A pair whose overlap was just removed touches, to the last bit: whether it still overlaps is for rounding
            // to say. So the integration goes on from the state before the collisions.
            world.states[0].clone_from(&start);
        }
    }
    decisions::escapes(&world, 0, &mut findings);
    scenarios.extend(sorting(drawn));
    Trace { scenarios, findings, after: world }
}

/// The dispatch that stands for a phase of a small scene, where this run is the first of it.
fn joined(world: &World, first: &Run) -> Option<Scenario> {
    let pass = match (first.stage.name, first.pass) {
        ("find_collisions", 0) => COLLISIONS,
        ("advance", 0) => POSITIONS,
        ("leap", 0) => POSITIONS | LEAPS,
        _ => return None,
    };
    let stage = ALL.into_iter().find(|stage| stage.name == "run_steps").expect("the stage of small scenes");
    let run = Run { stage, pass, when: When::NoRods, every: 1, planned: false };
    run.applies(&world.step).then(|| {
        // There are no large spheres where it is used.
        let mut before = world.clone();
        before.step.large = 0;
        before.row_sums.clear();
        Scenario { run, before }
    })
}

/// Putting memory in order, from the order of x.
fn sorting(drawn: &Clusters) -> Vec<Scenario> {
    let mut world = sized(World::build_along_x(&drawn.scene).unwrap());
    let phases = [Phase::UpdateAabbs, Phase::BroadPhase];
    for run in phases.iter().flat_map(|phase| phase.stages(Integrator::Rk4, BroadPhase::BruteForce)) {
        run.on_cpu(&mut world);
    }
    let mut scenarios = Vec::new();
    for run in MEASURE_ORDER.iter().chain(SORT_MEMORY) {
        scenarios.push(Scenario { run: *run, before: world.clone() });
        run.on_cpu(&mut world);
    }
    scenarios
}

/// Swaps where the ends of every ninth rod were before the step: as if it had turned half around within it.
fn turn_some(world: &mut World) {
    for rod in (0..world.step.rods).step_by(9) {
        let at = (world.step.rods_at + rod * ROD_WORDS) as usize;
        let [one, two] = [world.words[at], world.words[at + 1]].map(|end| end as usize);
        world.states[2].swap(one, two);
    }
}

/// The decisions that a stage is about to make.
fn decide(world: &World, run: &Run, findings: &mut Findings) {
    let state = run.pass as usize;
    match run.stage.name {
        "build_grid" | "count_cells" => cells::decide(world, findings),
        "find_collisions" => {
            decisions::escapes(world, 0, findings);
            decisions::collisions(world, findings);
        }
        "advance" | "finish" | "finish_and_turn" | "leap" => {
            decisions::escapes(world, state, findings);
            decisions::forces(world, state, findings);
        }
        "restore_lengths" => sweeps::restore(world, findings),
        "constrain" => sweeps::constrain(world, findings),
        _ => {}
    }
}
