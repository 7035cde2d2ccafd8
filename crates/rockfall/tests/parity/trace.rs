//! Traces of random steps: the world before every stage. No decision of the step is near the value at which it changes.

use rockfall::model::layout::{
    CELL_BLOCK, CELLS_AT, HISTORY_WORDS, LAW_THESIS, LINK_KEY, RESTORING, ROD_WORDS, SLICE, SWEEPS_FEW, SWEEPS_LISTED,
    SWEEPS_ON,
};
use rockfall::model::status::{REBUILD_REQUESTED, REJECTED_ESCAPED};
use rockfall::model::world::World;
use rockfall::step::schedule::{MEASURE_ORDER, Phase, Run, SORT_MEMORY};
use rockfall::{BroadPhase, ContactForceLaw, ContactInput, ContactLaw, ContactResponse, Integrator, Settings};

use crate::cells;
use crate::clusters::{Clusters, clusters};
use crate::decisions::{self, Ambiguous, Findings};
use crate::sweeps;

/// Time step of all traces, in s. It is short because deep overlaps cause large forces.
pub(crate) const DT: f32 = 0.004;
/// `Step::margin_scale` of all traces: AABBs so large that spheres stay inside under these forces, and that the pair lists also
/// contain pairs that do not overlap.
const MARGIN: f32 = 12.0;
/// A cluster that still has an ambiguous decision after this number of attempts has it by design, not by chance.
const MAX_ATTEMPTS: u64 = 200;

/// A stage, or a group of stages that can only be compared after the last one, with the world before it.
pub(crate) struct Scenario {
    pub(crate) runs: Vec<Run>,
    pub(crate) before: World,
}

impl Scenario {
    fn one(run: &Run, before: &World) -> Self {
        Self { runs: vec![*run], before: before.clone() }
    }

    /// Whether the scenario consists of the given stage alone.
    pub(crate) fn is(&self, stage: &str) -> bool {
        self.runs.len() == 1 && self.runs[0].stage.name == stage
    }

    /// Whether the scenario depends on how collisions are solved.
    pub(crate) fn solves_collisions(&self) -> bool {
        SOLVING.contains(&self.runs[0].stage.name)
    }

    pub(crate) fn name(&self) -> String {
        let [first, last] = [&self.runs[0], &self.runs[self.runs.len() - 1]];
        match self.runs.len() {
            1 => format!("{} pass {}", first.stage.name, first.pass),
            _ => format!("{} to {}, sweeps {}", first.stage.name, last.stage.name, self.before.step.constants.sweeps),
        }
    }
}

/// Stages that solve collisions. On the GPU each does a part of the work. The CPU computes all collisions in one of them.
const SOLVING: [&str; 11] = [
    "find_collisions",
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

/// Splits stages into groups that can be compared: all stages that solve collisions, or one other stage.
pub(crate) fn grouped(runs: &[Run]) -> Vec<Vec<Run>> {
    let is_solving = |run: &Run| SOLVING.contains(&run.stage.name);
    let groups = runs.chunk_by(|one, other| is_solving(one) && is_solving(other));
    groups.map(<[Run]>::to_vec).collect()
}

/// Makes a world sweep over its collisions.
pub(crate) fn enable_sweeps(world: &mut World) {
    world.step.constants.sweeps = SWEEPS_ON;
    world.step.layout.collision_room = 8192;
}

/// One step of a random scene.
pub(crate) struct Trace {
    pub(crate) scenarios: Vec<Scenario>,
    /// Cases that occurred in the step, and ambiguous decisions.
    pub(crate) findings: Findings,
    /// The world after the step.
    pub(crate) after: World,
}

/// Which collisions the clusters of a trace cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Only {
    /// All kinds.
    All,
    /// Collisions that share no body.
    Lone,
    /// Collisions that one workgroup can sweep over: without networks and large spheres.
    Few,
}

/// Parameters of a trace.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) seed: u64,
    pub(crate) clusters: usize,
    pub(crate) integrator: Integrator,
    pub(crate) broad_phase: BroadPhase,
    pub(crate) settings: Settings,
    /// Whether clusters may have rods and capsules.
    pub(crate) rods: bool,
    pub(crate) only: Only,
    /// Whether objects have materials.
    pub(crate) materials: bool,
}

/// Traces a plan. Clusters with an ambiguous decision are drawn again until none is left.
pub(crate) fn trace(plan: &Plan) -> Trace {
    let mut attempts = vec![0; plan.clusters];
    loop {
        let drawn = clusters(plan, &attempts);
        let trace = run(&drawn, plan);
        if trace.findings.ambiguous.is_empty() {
            assert_eq!(trace.after.status.rejected, 0, "the step is rejected, the AABBs are too small for the forces");
            return trace;
        }
        let mut again: Vec<usize> = trace.findings.ambiguous.iter().map(|decision| drawn.cluster_of[decision.object]).collect();
        again.sort_unstable();
        again.dedup();
        for cluster in again {
            attempts[cluster] += 1;
            let mut ambiguous = trace.findings.ambiguous.iter();
            let why = ambiguous.find(|decision| drawn.cluster_of[decision.object] == cluster).map(|decision| decision.what);
            assert!(attempts[cluster] < MAX_ATTEMPTS, "cluster {cluster} stays ambiguous: {why:?}");
        }
    }
}

/// A contact law of the program that depends on all that a law may know: that of Hertz and Mindlin with damping, but with parameters
/// in place of some of its constants.
fn contact_law() -> ContactForceLaw {
    let wgsl = "let a = sqrt(radius * overlap);\n\
                let normal = 2.0 * young * a * scale;\n\
                normal_force = 2.0 / 3.0 * normal * overlap + g * sqrt(normal * mass) * speed;\n\
                tangential_stiffness = 8.0 * shear * a;\n\
                tangential_damping = g * sqrt(tangential_stiffness * mass);";
    let function = |contact: &ContactInput<'_>| {
        let &[g, scale] = contact.parameters else { unreachable!("two parameters") };
        let a = (contact.radius * contact.overlap).sqrt();
        let (normal, tangential) = (2.0 * contact.young * a * scale, 8.0 * contact.shear * a);
        ContactResponse {
            normal_force: 2.0 / 3.0 * normal * contact.overlap + g * (normal * contact.mass).sqrt() * contact.speed,
            tangential_stiffness: tangential,
            tangential_damping: g * (tangential * contact.mass).sqrt(),
        }
    };
    ContactForceLaw::new("trial").parameter("g", 0.3).parameter("scale", 1.25).wgsl(wgsl).function(function)
}

fn give_contact_law(world: &mut World, drawn: &Clusters) {
    if drawn.scene.settings.contact_law == ContactLaw::User {
        let mut law = contact_law();
        if let [first, second, ..] = drawn.scene.materials() {
            law = law.pair_parameter([&first.name, &second.name], "scale", 0.75);
        }
        world.set_laws(&drawn.scene, &[], Some(&law)).unwrap();
    }
}

/// Builds the world of a scene, with room for its lists.
fn build(drawn: &Clusters, plan: &Plan) -> World {
    let mut world = World::build(&drawn.scene).unwrap();
    give_contact_law(&mut world, drawn);
    // One block of cells, the number for so few objects, or two: the stages of a grid of several blocks are different.
    world.set_cells(CELL_BLOCK * (1 + plan.seed % 2) as u32);
    world.set_integrator(plan.integrator);
    // Not 0, so that rates that a stage fails to write are noticed.
    world.rates.fill(3.0);
    with_step_settings(world)
}

pub(crate) fn with_step_settings(mut world: World) -> World {
    world.step.constants.dt = DT;
    // The attraction of JKR cohesion moves small spheres further.
    world.step.lists.margin_scale = if world.step.layout.neck > 0.0 { 2.0 * MARGIN } else { MARGIN };
    world.step.lists.lead = 0.5;
    enable_sweeps(&mut world);
    world.set_pair_rows(world.movers().div_ceil(SLICE) * 64);
    // Not 0, so that a word that a stage fails to write is noticed.
    world.cells[CELLS_AT as usize..].fill(3);
    for wrench in &mut world.wrenches {
        *wrench = glam::Vec4::splat(1e3);
    }
    world
}

/// Gives the contacts of a world springs as a step before may have left them: longer than those of one step, and with overlaps that
/// have grown or shrunk since.
fn add_springs(world: &mut World, plan: &Plan) {
    let mut early = world.clone();
    // One evaluation of the present state advances the springs.
    early.set_integrator(Integrator::Rk4);
    if early.step.layout.neck > 0.0 {
        // Some pairs that are apart have touched before, so that necks connect them. Others have not.
        let spheres = early.step.layout.spheres as usize;
        early.states[0][..spheres].iter_mut().step_by(2).for_each(|place| place.w *= 1.02);
    }
    let lists = [Phase::UpdateAabbs, Phase::BroadPhase].into_iter();
    for run in lists.flat_map(|phase| phase.stages(plan.integrator, plan.broad_phase)) {
        run.on_cpu(&mut early);
    }
    let laws = ["rod_loads", "loads", "end_step"];
    let stages = Phase::UpdatePositions.stages(Integrator::SymplecticEuler, plan.broad_phase).iter();
    stages.filter(|run| laws.contains(&run.stage.name)).for_each(|run| run.on_cpu(&mut early));
    assert_eq!(early.status.rejected, 0, "the pool has no room for all springs");
    for (number, record) in early.histories.chunks_exact_mut(HISTORY_WORDS as usize).enumerate() {
        if record[HISTORY_WORDS as usize - 1] & LINK_KEY == 0 {
            let factors = [[3.0; 3], [0.5; 3]][number % 2];
            for (word, factor) in record.iter_mut().zip(factors) {
                *word = (f32::from_bits(*word) * factor).to_bits();
            }
            // As if the contact had turned since, so that the spring is not in the tangent plane.
            record[..3].rotate_left(1);
            // Moments are left alone or are far too large, so that some springs yield.
            for word in &mut record[4..7] {
                *word = (f32::from_bits(*word) * [1.0, 0.5, 40.0][number % 3]).to_bits();
            }
            record[4..7].rotate_left(number % 2);
            // A negative overlap marks a body that passes a polygon.
            if f32::from_bits(record[3]) > 0.0 {
                record[3] = (f32::from_bits(record[3]) * [0.8, 1.25][number % 2]).to_bits();
            }
        }
    }
    world.histories = early.histories;
    world.status.history_table = early.status.history_table;
}

fn run(drawn: &Clusters, plan: &Plan) -> Trace {
    let mut world = build(drawn, plan);
    if world.step.layout.law != LAW_THESIS {
        world.set_history_pool(256);
        add_springs(&mut world, plan);
    }
    let mut scenarios = Vec::new();
    let mut findings = Findings::default();
    let settings = &drawn.scene.settings;
    let has_impulses = settings.collisions || settings.coulomb_friction > 0.0 || settings.collision_friction > 0.0;
    let phases = Phase::STEP.iter().filter(|phase| has_impulses || **phase != Phase::HandleCollisions);
    let start = world.states[0].clone();
    let runs: Vec<Run> = phases.flat_map(|phase| phase.stages(plan.integrator, plan.broad_phase)).copied().collect();
    for group in grouped(&runs) {
        let solves = group[0].stage.name == "find_collisions";
        if solves {
            let mut marked = world.clone();
            group[0].on_cpu(&mut marked);
            let shared = decisions::collisions(&marked, &mut findings).shared;
            if plan.only == Only::Lone {
                findings.ambiguous.extend(shared.into_iter().map(|object| Ambiguous { what: "a shared body", object }));
            }
            scenarios.extend(collision_scenarios(&world, &group, plan));
        }
        for run in &group {
            if run.stage.name == "constrain" {
                reverse_some_rods(&mut world);
            }
            if run.applies(&world.step) {
                decide(&world, run, &mut findings);
            }
            // Other stages of a group cannot be compared alone. With networks, neither can `commit_collisions`: the GPU commits
            // all spheres of a network, the CPU only those that collide.
            let is_comparable = match run.stage.name {
                "commit_collisions" => world.step.layout.networks == 0,
                "find_collisions" | "commit_friction_impulses" => true,
                _ => group.len() == 1,
            };
            if is_comparable {
                scenarios.push(Scenario::one(run, &world));
                scenarios.extend(scenario_without_forces(&world, run, plan));
            }
            run.on_cpu(&mut world);
            // A sphere that leaves its AABB makes its cluster ambiguous. The others go on.
            world.status.rejected &= !REJECTED_ESCAPED;
            if run.stage.name == "constrain" {
                // Swap back. An axis that turns by 180 degrees has no unique shortest rotation, so `turn` could not be
                // compared.
                reverse_some_rods(&mut world);
            }
        }
        if solves {
            // The integration continues from the state before the collisions. Pairs that rebound have an overlap of nearly 0,
            // and its relative error by rounding would be large.
            world.states[0].clone_from(&start);
        }
    }
    decisions::escapes(&world, 0, &mut findings);
    scenarios.extend(memory_order_scenarios(drawn));
    Trace { scenarios, findings, after: world }
}

/// Scenarios of the stages that solve collisions: one for each sweep mode that the collisions allow. If there are friction
/// impulses, each mode has two scenarios: one ends before the friction impulses and one after them.
fn collision_scenarios(world: &World, group: &[Run], plan: &Plan) -> Vec<Scenario> {
    let mut modes = vec![SWEEPS_ON];
    if plan.only == Only::Few {
        modes.push(SWEEPS_FEW);
    }
    if plan.only == Only::Lone {
        modes.push(SWEEPS_LISTED);
    }
    let last = group.iter().position(|run| run.stage.name == "commit_collisions").expect("the stage");
    let mut ends = vec![last + 1];
    ends.extend(world.step.traits().friction_impulses.then_some(group.len()));
    let all = modes.into_iter().flat_map(|sweeps| ends.iter().map(move |end| (sweeps, *end)));
    all.map(|(sweeps, end)| {
        let mut before = world.clone();
        before.step.constants.sweeps = sweeps;
        Scenario { runs: group[..end].to_vec(), before }
    })
    .collect()
}

/// Scenario of a stage of velocity Verlet that needs the rates at the start of the step, if those of the step before are known.
fn scenario_without_forces(world: &World, run: &Run, plan: &Plan) -> Option<Scenario> {
    let evaluates = ["rod_loads", "loads", "drift"].contains(&run.stage.name) && run.pass == 0;
    let is_concerned = evaluates && plan.integrator == Integrator::VelocityVerlet && run.applies(&world.step);
    is_concerned.then(|| {
        let mut before = world.clone();
        before.status.forces_due = 0;
        // Each number is another, so that a rate at a wrong place is noticed.
        before.rates.iter_mut().enumerate().for_each(|(place, rate)| *rate = 3.0 + (place % 7) as f32);
        Scenario::one(run, &before)
    })
}

/// Scenarios of the stages that measure and sort the order of spheres in memory. The spheres begin in the order of x.
fn memory_order_scenarios(drawn: &Clusters) -> Vec<Scenario> {
    let mut world = World::build_along_x(&drawn.scene).unwrap();
    give_contact_law(&mut world, drawn);
    let mut world = with_step_settings(world);
    let phases = [Phase::UpdateAabbs, Phase::BroadPhase];
    for run in phases.iter().flat_map(|phase| phase.stages(Integrator::Rk4, BroadPhase::BruteForce)) {
        run.on_cpu(&mut world);
    }
    let mut scenarios = Vec::new();
    // As `Simulation` does before it sorts memory: the sums of digits are those of the grid, which is built on request.
    world.status.rebuild = REBUILD_REQUESTED;
    for run in MEASURE_ORDER.iter().chain(SORT_MEMORY) {
        scenarios.push(Scenario::one(run, &world));
        run.on_cpu(&mut world);
    }
    scenarios
}

/// Swaps the old positions of the ends of every ninth rod, as if the rod had turned by 180 degrees within the step.
fn reverse_some_rods(world: &mut World) {
    for rod in (0..world.step.layout.rods).step_by(9) {
        let at = (world.step.layout.rods_at + rod * ROD_WORDS) as usize;
        let [one, two] = [world.topology[at], world.topology[at + 1]].map(|end| end as usize);
        world.states[2].swap(one, two);
    }
}

/// Records the decisions that a stage makes from this world.
fn decide(world: &World, run: &Run, findings: &mut Findings) {
    let state = run.pass as usize;
    match run.stage.name {
        "count_cells" => cells::decide(world, findings),
        "find_collisions" => decisions::escapes(world, 0, findings),
        "apply_friction_impulses" => decisions::friction_impulses(world, findings),
        "loads" => {
            decisions::escapes(world, state, findings);
            decisions::forces(world, state, findings);
        }
        "constrain" if run.pass == RESTORING => sweeps::restore(world, findings),
        "constrain" => sweeps::constrain(world, findings),
        _ => {}
    }
}
