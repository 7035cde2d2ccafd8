//! How much a step does, counted and not timed, so that a machine of any speed sees when it becomes more.
//!
//! Every expectation is an upper bound on what was measured when it was written. Where a change makes a step do less, lower
//! it; where one must do more, raise it and say why in the commit.

#[cfg(feature = "gpu")]
use rockfall::Profile;
use rockfall::exec::cpu;
use rockfall::generate::Benchmark;
use rockfall::model::layout::{LIST_COUNT_MASK, SLICE, words_of};
use rockfall::model::status::Status;
use rockfall::model::world::World;
use rockfall::step::schedule::Phase;
use rockfall::{Backend, BroadPhase, Integrator, Options, Scene, Simulation, Sphere};

/// Enough for the broad phase of large scenes.
const BODIES: u32 = 2500;
const STEPS: u64 = 40;
/// Steps after which piles have fallen into a heap.
const FALL: u64 = 120;
const DT: f32 = 0.02;

fn simulation(benchmark: Benchmark, backend: Backend, integrator: Integrator) -> Simulation {
    let scene = benchmark.generate(BODIES, 5).unwrap();
    let options = Options::new().backend(backend).integrator(integrator);
    Simulation::with_options(scene, options).unwrap()
}

#[cfg(feature = "gpu")]
fn profile(benchmark: Benchmark, backend: Backend, integrator: Integrator) -> Profile {
    simulation(benchmark, backend, integrator).profile(STEPS, DT).unwrap()
}

/// Dispatches a step.
#[cfg(feature = "gpu")]
#[track_caller]
fn check_dispatches(benchmark: Benchmark, integrator: Integrator, most: u64) {
    let profile = profile(benchmark, Backend::Gpu, integrator);
    assert_eq!(profile.steps, STEPS);
    let runs = profile.runs() / STEPS;
    let stages: Vec<_> = profile.stages.iter().map(|stage| (stage.name, stage.runs / STEPS)).collect();
    println!("{benchmark} {integrator}: {runs} dispatches a step");
    assert!(runs <= most, "{benchmark} {integrator}: {runs} dispatches a step, {stages:?}");
}

#[test]
#[cfg(feature = "gpu")]
fn dispatches_of_a_step() {
    // Spheres alone, few: 3 for collisions; 3 advance, finish_and_turn, end_step. In some steps 1 for AABBs and 2 for lists.
    check_dispatches(Benchmark::Pile, Integrator::Rk4, 10);
    // symplectic_euler and commit_and_turn for the four evaluations.
    check_dispatches(Benchmark::Pile, Integrator::SymplecticEuler, 8);
    // With capsules and rods besides: weigh_collisions, rod_forces in each evaluation, restore_lengths, constrain; twice as many
    // objects as bodies, too many for a grid that is built in one dispatch.
    check_dispatches(Benchmark::Mixed, Integrator::Rk4, 23);
    // Two for the collisions of large spheres, two for every sweep in steps in which some share bodies, and, where lists are made, two
    // for theirs.
    check_dispatches(Benchmark::Radii, Integrator::Rk4, 44);
}

/// Dispatches of so many plain steps of a small scene without rods, after some others.
#[cfg(feature = "gpu")]
fn joined_dispatches(benchmark: Benchmark, before: u64, steps: u64) -> u64 {
    let scene = benchmark.generate(1_000, 5).unwrap();
    let options = Options::new().backend(Backend::Gpu).broad_phase(BroadPhase::Grid).join_steps(true);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    simulation.run(before, DT).unwrap();
    let count = |simulation: &Simulation| simulation.gpu_view().unwrap().dispatches();
    let first = count(&simulation);
    simulation.run(steps, DT).unwrap();
    println!("{benchmark}: {} dispatches in {steps} steps", count(&simulation) - first);
    count(&simulation) - first
}

#[test]
#[cfg(feature = "gpu")]
fn dispatches_of_the_steps_of_a_small_scene() {
    // Three that make lists, and one for all else; one more begins a batch, of which the first is one step that makes lists twice.
    assert!(joined_dispatches(Benchmark::Pile, 0, 32) <= 4 * 32 + 1 + 4);
    // The same in every eighth step.
    assert!(joined_dispatches(Benchmark::Lattice, 320, 32) <= 4 * 4 + 1);
}

#[test]
#[cfg(feature = "gpu")]
fn every_step_of_a_profile_is_a_step_that_was_done() {
    let profile = profile(Benchmark::Pile, Backend::Gpu, Integrator::Rk4);
    for stage in &profile.stages {
        // Lists are made in every eighth step at least; those that do not fit any more are made once besides.
        let fits = match stage.phase {
            Phase::UpdateAabbs | Phase::BroadPhase => (STEPS / 8..STEPS + STEPS / 4).contains(&stage.runs),
            // These stand in steps with collisions that share bodies alone.
            _ if ["list_collisions", "weigh_collisions", "sweep_at_once"].contains(&stage.name) => {
                stage.runs <= STEPS + STEPS / 4
            }
            _ => stage.runs >= STEPS && stage.runs % STEPS < STEPS / 4,
        };
        assert!(fits, "{stage:?}");
        assert!(stage.seconds > 0.0, "{stage:?}");
    }
    assert!(profile.stage_seconds() + profile.rejected_seconds <= profile.seconds, "{profile:?}");
}

#[test]
fn profiling_changes_nothing() {
    let mut plain = simulation(Benchmark::Mixed, Backend::Cpu, Integrator::Rk4);
    let mut profiled = simulation(Benchmark::Mixed, Backend::Cpu, Integrator::Rk4);
    plain.run(STEPS, DT).unwrap();
    let profile = profiled.profile(STEPS, DT).unwrap();
    assert_eq!(plain.report(), profiled.report());
    assert_eq!(plain.spheres().unwrap(), profiled.spheres().unwrap());
    assert_eq!(profile.steps, STEPS);
    let advance = profile.stages.iter().find(|stage| stage.name == "advance").unwrap();
    assert_eq!((advance.phase, advance.runs), (Phase::UpdatePositions, 3 * STEPS));
}

#[test]
fn void_steps_are_kept_apart() {
    let scene = Benchmark::Lattice.generate(BODIES, 0).unwrap();
    let options = Options::new().backend(Backend::Cpu).pair_capacity(SLICE);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    let profile = simulation.profile(STEPS, DT).unwrap();
    assert!(simulation.report().replays > 0);
    assert!(profile.rejected_seconds > 0.0);
    assert_eq!(profile.steps, STEPS);
    assert!(profile.stages.iter().all(|stage| stage.runs % STEPS < STEPS / 4), "{:?}", profile.stages);
}

#[test]
#[cfg(feature = "gpu")]
fn the_device_holds_what_the_host_would() {
    let [cpu, gpu] =
        [Backend::Cpu, Backend::Gpu].map(|backend| simulation(Benchmark::Settled, backend, Integrator::Rk4).device_memory());
    // The status and the uniform blocks are no arrays; what is empty has 128 bytes.
    let besides = size_of::<Status>() as u64 + 1024;
    assert!((cpu..cpu + besides).contains(&gpu), "{cpu} and {gpu} bytes");
}

/// Bounds on a scene after [`FALL`] steps.
struct Bounds {
    /// Bytes of all buffers, per sphere.
    memory: u64,
    /// List entries a mover.
    entries: f64,
    /// Words of list entries a mover, with the padding of slices.
    words: f64,
}

#[track_caller]
fn check_size(benchmark: Benchmark, most: &Bounds) {
    let mut simulation = simulation(benchmark, Backend::Cpu, Integrator::Rk4);
    simulation.run(FALL, DT).unwrap();
    let memory = simulation.device_memory() / simulation.scene().counts().spheres as u64;
    let world = listed(&mut simulation, World::build);
    let movers = world.movers();
    let each = |sum: u64| sum as f64 / f64::from(movers);
    let entries = each(world.lists[..movers as usize].iter().map(|count| u64::from(*count & LIST_COUNT_MASK)).sum());
    let words = each(words_of(world.status.pair_rows_needed));
    let told = format!("{benchmark}: {memory} bytes a sphere; {entries:.2} entries and {words:.2} words of them a mover");
    println!("{told}");
    assert!(memory <= most.memory && entries <= most.entries && words <= most.words, "{told}");
}

/// The present state with the lists of a fresh world.
fn listed(simulation: &mut Simulation, build: fn(&Scene) -> rockfall::Result<World>) -> World {
    let mut world = build(simulation.sync().unwrap()).unwrap();
    world.step.dt = DT;
    for phase in [Phase::UpdateAabbs, Phase::BroadPhase] {
        let stages = phase.stages(Integrator::Rk4, simulation.broad_phase_method());
        cpu::run(&mut world, stages);
        while world.status.rejected != 0 {
            world.set_pair_rows(world.status.pair_rows_needed);
            world.status = Status::default();
            cpu::run(&mut world, stages);
        }
    }
    world
}

// At the start: four states of 48 bytes, an AABB of 32, an orientation of 16, a tag and a count of 4 each, about 13 of the
// grid, an extent of 16, its two places in the order of memory of 4 each, and 24 list entries of 4 (16 in large scenes) make 384. Where
// lists get longer by looking ahead, they are made for fewer steps before they take more memory.

#[test]
fn size_of_a_lattice() {
    // Six neighbours touch; a rim of others is close. Elastic collisions are no longer lost: it spreads a little more.
    check_size(Benchmark::Lattice, &Bounds { memory: 388, entries: 6.5, words: 9.0 });
}

#[test]
fn size_of_a_pile() {
    check_size(Benchmark::Pile, &Bounds { memory: 388, entries: 4.9, words: 8.4 });
}

#[test]
fn size_of_what_has_settled() {
    check_size(Benchmark::Settled, &Bounds { memory: 388, entries: 10.2, words: 11.6 });
}

#[test]
fn size_of_rods_and_capsules_among_spheres() {
    // Row sums of collisions have as much room as list entries: 128 bytes a sphere, for there are four movers to three spheres.
    check_size(Benchmark::Mixed, &Bounds { memory: 624, entries: 2.5, words: 5.2 });
}

/// Pair tests of the grid and words of list entries, both per sphere, of so many spheres after some steps.
fn work_of(benchmark: Benchmark, spheres: u32, steps: u64) -> [f64; 2] {
    let scene = benchmark.generate(spheres, 5).unwrap();
    let options = Options::new().backend(Backend::Cpu).broad_phase(BroadPhase::Grid);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    simulation.run(steps, DT).unwrap();
    let world = listed(&mut simulation, World::build_in_space);
    [cpu::pair_tests(&world), words_of(world.status.pair_rows_needed)].map(|sum| sum as f64 / f64::from(spheres))
}

/// Large spheres all over a lattice of small ones: no thread looks at more than some hundred objects, and slices of the pair lists
/// are wide where large spheres stand side by side, and nowhere else.
#[test]
fn few_large_spheres_do_not_hold_up_many_small_ones() {
    let mut scene = Scene::new();
    for k in 0..20_000 {
        let place = [k % 27, k / 27 % 27, k / 729].map(|x| 0.1 * x as f32);
        scene.add_sphere(Sphere::new(place, 0.049)).unwrap();
        if k % 700 == 0 {
            scene.add_sphere(Sphere::new(place, 0.3)).unwrap();
        }
    }
    let options = Options::new().backend(Backend::Cpu).broad_phase(BroadPhase::Grid);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    let world = listed(&mut simulation, World::build_in_space);
    let counts = || world.lists[..world.movers() as usize].iter().map(|count| u64::from(*count & LIST_COUNT_MASK));
    let (longest, entries) = (counts().max().unwrap(), counts().sum::<u64>());
    let (looked_at, words) = (cpu::longest_search(&world), words_of(world.status.pair_rows_needed));
    let told = format!("{looked_at} objects at most, lists of up to {longest}, {words} words for {entries} entries");
    println!("{told}");
    assert!(longest > 100 && looked_at <= 125 && words as f64 <= 1.2 * entries as f64, "{told}");
}

/// What flies off, so fast that its AABB is a thousand times as large as the others, has nobody to look at but itself: for a device it
/// is one thread that looks.
#[test]
fn a_body_that_flies_off_does_not_hold_up_the_others() {
    let mut scene = Scene::new();
    for k in 0..8_000 {
        scene.add_sphere(Sphere::new([k % 20, k / 20 % 20, k / 400].map(|x| 0.1 * x as f32), 0.049)).unwrap();
    }
    scene.add_sphere(Sphere::new([0.0, 1e6, 0.0], 0.049).velocity([0.0, 1e4, 0.0])).unwrap();
    let options = Options::new().backend(Backend::Cpu).broad_phase(BroadPhase::Grid);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    let world = listed(&mut simulation, World::build_in_space);
    let looked_at = cpu::longest_search(&world);
    println!("{looked_at} objects at most");
    assert!(looked_at <= 125, "{looked_at} objects");
}

/// Ten times the spheres, each with as much to do: those inside have more neighbours than those on the surface, of which a
/// small crowd has more.
#[track_caller]
fn check_growth(benchmark: Benchmark, steps: u64, most: [f64; 2], growth: f64) {
    let [small, large] = [1_000, 10_000].map(|spheres| work_of(benchmark, spheres, steps));
    let told = format!("{benchmark}: {small:.1?} and {large:.1?} pair tests and words of entries a sphere");
    println!("{told}");
    let is_bounded = |place: usize| large[place] <= most[place] && large[place] <= growth * small[place];
    assert!(is_bounded(0) && is_bounded(1), "{told}");
}

#[test]
fn work_a_sphere_does_not_grow_in_a_lattice() {
    check_growth(Benchmark::Lattice, 0, [185.0, 6.2], 1.3);
}

#[test]
fn work_a_sphere_does_not_grow_in_a_pile() {
    check_growth(Benchmark::Pile, 60, [63.0, 3.0], 1.3);
}

#[test]
fn work_a_sphere_does_not_grow_where_radii_differ() {
    check_growth(Benchmark::Radii, 0, [58.0, 2.6], 1.3);
}
