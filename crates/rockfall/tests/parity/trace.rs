//! The worlds that the stages of a step begin with, with every decision of the step far from its switch.

use rockfall::model::layout::{
    CELL_BLOCK, CELLS_AT, FLAG_STAGES, PHASES_SHIFT, POSITIONS_FIRST, ROD_WORDS, SLICE, SWEEPS_FEW, SWEEPS_LISTED, SWEEPS_OFF,
    SWEEPS_ON, SYMPLECTIC_EULER,
};
use rockfall::model::world::World;
use rockfall::step::catalog::ALL;
use rockfall::step::schedule::{MEASURE_ORDER, Phase, Run, SORT_MEMORY, When};
use rockfall::{BroadPhase, Integrator, Settings};

use crate::cells;
use crate::clusters::{Clusters, clusters};
use crate::decisions::{self, Findings, Near};
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

/// A stage, or several that can be compared after the last one only, and the world that they begin with.
pub(crate) struct Scenario {
    pub(crate) runs: Vec<Run>,
    pub(crate) before: World,
}

impl Scenario {
    fn one(run: &Run, before: &World) -> Self {
        Self { runs: vec![*run], before: before.clone() }
    }

    /// Whether this is that stage alone.
    pub(crate) fn is(&self, stage: &str) -> bool {
        self.runs.len() == 1 && self.runs[0].stage.name == stage
    }

    /// Whether it has to do with how collisions are solved.
    pub(crate) fn solves_collisions(&self) -> bool {
        SOLVING.contains(&self.runs[0].stage.name) || self.is("run_steps")
    }

    pub(crate) fn name(&self) -> String {
        let [first, last] = [&self.runs[0], &self.runs[self.runs.len() - 1]];
        match self.runs.len() {
            1 => format!("{} pass {}", first.stage.name, first.pass),
            _ => format!("{} to {}, sweeps {}", first.stage.name, last.stage.name, self.before.step.sweeps),
        }
    }
}

/// Where the devices list collisions and sweep over them, the CPU does all of it in one stage.
const SOLVING: [&str; 11] = [
    "list_collisions",
    "weigh_networks",
    "weigh_collisions",
    "sweep_at_once",
    "sweep_collisions",
    "gather_impulses",
    "project_networks",
    "apply_collisions",
    "commit_collisions",
    "apply_friction_impulses",
    "commit_friction_impulses",
];

/// Stages in the groups that can be compared.
pub(crate) fn grouped(runs: &[Run]) -> Vec<Vec<Run>> {
    let is_solving = |run: &Run| SOLVING.contains(&run.stage.name);
    let groups = runs.chunk_by(|one, other| is_solving(one) && is_solving(other));
    groups.map(<[Run]>::to_vec).collect()
}

/// A world that sweeps over its collisions.
pub(crate) fn enable_sweeps(world: &mut World) {
    world.step.sweeps = SWEEPS_ON;
    world.step.collision_room = 8192;
}

/// One step of a random scene.
pub(crate) struct Trace {
    pub(crate) scenarios: Vec<Scenario>,
    /// What the step decided, and how often.
    pub(crate) findings: Findings,
    /// The world after the step.
    pub(crate) after: World,
}

/// What collisions there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Only {
    /// All kinds.
    All,
    /// Those that share no body.
    Lone,
    /// Those that one workgroup can sweep over: not on networks, not of large spheres.
    Few,
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
    /// Which of these.
    pub(crate) only: Only,
}

/// Draws clusters again until no decision of the step is near its switch.
pub(crate) fn trace(plan: &Plan) -> Trace {
    let mut attempts = vec![0; plan.clusters];
    loop {
        let drawn = clusters(plan, &attempts);
        let trace = run(&drawn, plan);
        if trace.findings.near.is_empty() {
            assert_eq!(trace.after.status.rejected, 0, "the margins are too narrow for the forces");
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
    enable_sweeps(&mut world);
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
    let settings = &drawn.scene.settings;
    let has_impulses = settings.collisions || settings.coulomb_friction > 0.0 || settings.collision_friction > 0.0;
    let phases = Phase::STEP.iter().filter(|phase| has_impulses || **phase != Phase::HandleCollisions);
    let start = world.states[0].clone();
    let runs: Vec<Run> = phases.flat_map(|phase| phase.stages(plan.integrator, plan.broad_phase)).copied().collect();
    for group in grouped(&runs) {
        if group[0].stage.name == "list_collisions" {
            let shared = decisions::collisions(&world, &mut findings).shared;
            if plan.only == Only::Lone {
                findings.near.extend(shared.into_iter().map(|object| Near { what: "a shared body", object }));
            }
            scenarios.extend(solving(&world, &group, plan));
        }
        for run in &group {
            if run.stage.name == "constrain" {
                turn_some(&mut world);
            }
            scenarios.extend(joined(&world, run, plan));
            if run.applies(&world.step) {
                decide(&world, run, &mut findings);
            }
            // The others have nothing to say without each other; of networks the GPU commits all spheres, the CPU those that collide.
            let is_whole = match run.stage.name {
                "commit_collisions" => world.step.networks == 0,
                "commit_friction_impulses" => true,
                _ => group.len() == 1,
            };
            if is_whole {
                scenarios.push(Scenario::one(run, &world));
            }
            run.on_cpu(&mut world);
            if run.stage.name == "constrain" {
                // Axes that turn half around have no shortest rotation.
                turn_some(&mut world);
            }
        }
        if group[0].stage.name == "list_collisions" {
            // What rebounds has an overlap of nearly 0, of which a few units in the last place are much. So the integration goes
            // on from the state before the collisions.
            world.states[0].clone_from(&start);
        }
    }
    decisions::escapes(&world, 0, &mut findings);
    scenarios.extend(sorting(drawn));
    Trace { scenarios, findings, after: world }
}

/// The stages that solve collisions, with sweeps and, where no collisions share a body, without; with friction impulses, where there
/// are any, and before them.
fn solving(world: &World, group: &[Run], plan: &Plan) -> Vec<Scenario> {
    let mut ways = vec![SWEEPS_ON];
    if plan.only == Only::Few {
        ways.push(SWEEPS_FEW);
    }
    if plan.only == Only::Lone {
        ways.push(SWEEPS_LISTED);
        // Without lists nobody knows the impulses that friction goes by.
        ways.extend((!plan.rods && world.step.collision_friction <= 0.0).then_some(SWEEPS_OFF));
    }
    let last = group.iter().position(|run| run.stage.name == "commit_collisions").expect("the stage");
    let mut ends = vec![last + 1];
    ends.extend(world.step.has_friction_impulses().then_some(group.len()));
    let all = ways.into_iter().flat_map(|sweeps| ends.iter().map(move |end| (sweeps, *end)));
    all.map(|(sweeps, end)| {
        let mut before = world.clone();
        before.step.sweeps = sweeps;
        Scenario { runs: group[..end].to_vec(), before }
    })
    .collect()
}

/// The dispatch that stands for a phase of a small scene, where this run is the first of it.
fn joined(world: &World, first: &Run, plan: &Plan) -> Option<Scenario> {
    let pass = match (first.stage.name, first.pass) {
        // It solves no collisions that share a body, and makes no friction impulses.
        ("find_collisions", 0) if plan.only == Only::Lone && !world.step.has_friction_impulses() => COLLISIONS,
        ("advance", 0) => POSITIONS,
        ("symplectic_euler", 0) => POSITIONS | SYMPLECTIC_EULER,
        _ => return None,
    };
    let stage = ALL.into_iter().find(|stage| stage.name == "run_steps").expect("the stage of small scenes");
    let run = Run { stage, pass, when: When::NoRods, every: 1, planned: false };
    run.applies(&world.step).then(|| {
        // There are no large spheres where it is used.
        let mut before = world.clone();
        before.step.large = 0;
        before.step.sweeps = SWEEPS_OFF;
        Scenario::one(&run, &before)
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
        scenarios.push(Scenario::one(run, &world));
        run.on_cpu(&mut world);
    }
    scenarios
}

/// Swaps where the ends of every ninth rod were before the step: as if it had turned half around within it.
fn turn_some(world: &mut World) {
    for rod in (0..world.step.rods).step_by(9) {
        let at = (world.step.rods_at + rod * ROD_WORDS) as usize;
        let [one, two] = [world.topology[at], world.topology[at + 1]].map(|end| end as usize);
        world.states[2].swap(one, two);
    }
}

/// The decisions that a stage is about to make.
fn decide(world: &World, run: &Run, findings: &mut Findings) {
    let state = run.pass as usize;
    match run.stage.name {
        "build_grid" | "count_cells" => cells::decide(world, findings),
        "find_collisions" => decisions::escapes(world, 0, findings),
        "apply_friction_impulses" => decisions::friction_impulses(world, findings),
        "advance" | "finish" | "finish_and_turn" | "symplectic_euler" => {
            decisions::escapes(world, state, findings);
            decisions::forces(world, state, findings);
        }
        "restore_lengths" => sweeps::restore(world, findings),
        "constrain" => sweeps::constrain(world, findings),
        _ => {}
    }
}
