//! The amount of work in a step. It is counted, not timed, so the tests detect an increase on machines of any speed.
//!
//! Every bound is slightly above the value that was measured when it was written. When a change reduces the work of a
//! step, lower the bound. When a change must increase it, raise the bound and give the reason in the commit.

#[cfg(feature = "gpu")]
use rockfall::Profile;
use rockfall::exec::cpu;
use rockfall::generate::Benchmark;
use rockfall::model::layout::{LIST_COUNT_MASK, SLICE, words_of_rows};
use rockfall::model::status::Status;
use rockfall::model::world::World;
use rockfall::step::schedule::Phase;
use rockfall::{Backend, BroadPhase, Integrator, Options, Scene, Simulation, Sphere};

/// Enough bodies for the broad phase of large scenes.
const BODIES: u32 = 2500;
const STEPS: u64 = 40;
/// Number of steps after which piles have settled.
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

/// Checks the number of dispatches per step.
#[cfg(feature = "gpu")]
#[track_caller]
fn assert_dispatches_per_step(benchmark: Benchmark, integrator: Integrator, most: u64) {
    let profile = profile(benchmark, Backend::Gpu, integrator);
    assert_eq!(profile.steps, STEPS);
    let runs = profile.runs() / STEPS;
    let stages: Vec<_> = profile.stages.iter().map(|stage| (stage.name, stage.runs / STEPS)).collect();
    println!("{benchmark} {integrator}: {runs} dispatches per step");
    assert!(runs <= most, "{benchmark} {integrator}: {runs} dispatches per step, {stages:?}");
}

#[test]
#[cfg(feature = "gpu")]
fn a_step_has_few_dispatches() {
    // Few spheres without rods: 4 dispatches for collisions; 4 loads, 3 advance, finish, end_step. In some steps 1 for AABBs
    // and 6 for lists.
    assert_dispatches_per_step(Benchmark::Pile, Integrator::Rk4, 17);
    // loads and symplectic_euler in place of the four evaluations.
    assert_dispatches_per_step(Benchmark::Pile, Integrator::SymplecticEuler, 12);
    // loads, drift, loads and kick.
    assert_dispatches_per_step(Benchmark::Pile, Integrator::VelocityVerlet, 14);
    // With capsules and rods also weigh_collisions, rod_loads in each evaluation, and constrain before and after.
    assert_dispatches_per_step(Benchmark::Mixed, Integrator::Rk4, 27);
    // Two dispatches for the collisions of large spheres, two for every sweep in steps in which some collisions share
    // bodies, and two for the lists of large spheres when lists are rebuilt.
    assert_dispatches_per_step(Benchmark::Radii, Integrator::Rk4, 44);
}

#[test]
#[cfg(feature = "gpu")]
fn a_profile_counts_every_executed_step() {
    let profile = profile(Benchmark::Pile, Backend::Gpu, Integrator::Rk4);
    for stage in &profile.stages {
        // Lists are rebuilt at least in every eighth step, and once more when they no longer fit.
        let fits = match stage.phase {
            Phase::UpdateAabbs | Phase::BroadPhase => (STEPS / 8..STEPS + STEPS / 4).contains(&stage.runs),
            // These run only in steps with collisions that share bodies.
            _ if ["weigh_collisions", "sweep_at_once"].contains(&stage.name) => stage.runs <= STEPS + STEPS / 4,
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
    let loads = profile.stages.iter().find(|stage| stage.name == "loads").unwrap();
    assert_eq!((loads.phase, loads.runs), (Phase::UpdatePositions, 4 * STEPS));
}

#[test]
fn a_profile_counts_rejected_steps_separately() {
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
fn the_device_uses_as_much_memory_as_the_host() {
    let [cpu, gpu] =
        [Backend::Cpu, Backend::Gpu].map(|backend| simulation(Benchmark::Settled, backend, Integrator::Rk4).device_memory());
    // The status and the uniform blocks are not arrays. An empty array has 128 bytes.
    let other_bytes = size_of::<Status>() as u64 + 1472;
    assert!((cpu..cpu + other_bytes).contains(&gpu), "{cpu} and {gpu} bytes");
}

/// Bounds on a scene after [`FALL`] steps.
struct Bounds {
    /// Bytes of all buffers, per sphere.
    memory: u64,
    /// List entries per mover.
    entries: f64,
    /// Words of list entries per mover, with the padding of slices.
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
    let words = each(words_of_rows(world.status.pair_rows_needed));
    let summary = format!("{benchmark}: {memory} bytes per sphere; {entries:.2} entries in {words:.2} words per mover");
    println!("{summary}");
    assert!(memory <= most.memory && entries <= most.entries && words <= most.words, "{summary}");
}

/// The present state with newly built lists.
fn listed(simulation: &mut Simulation, build: fn(&Scene) -> rockfall::Result<World>) -> World {
    let mut world = build(simulation.sync().unwrap()).unwrap();
    world.step.constants.dt = DT;
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

// At the start: three states of 64 bytes and one of 48, an AABB of 32, an orientation of 16, a tag and a count of 4 each, about 17 of
// the grid, an extent of 16, two memory slots of 4 each, a load of 32, and 24 list entries of 4 (16 in large scenes) make 468. Where
// a longer lookahead makes lists longer, the lookahead is shortened before the lists use more memory.

#[test]
fn a_lattice_stays_within_its_memory() {
    // Six neighbours touch, and others at the rim are close. Elastic collisions are no longer lost, so the lattice
    // spreads slightly.
    check_size(Benchmark::Lattice, &Bounds { memory: 472, entries: 6.5, words: 9.0 });
}

#[test]
fn a_pile_stays_within_its_memory() {
    check_size(Benchmark::Pile, &Bounds { memory: 472, entries: 4.9, words: 8.4 });
}

#[test]
fn a_settled_pile_stays_within_its_memory() {
    check_size(Benchmark::Settled, &Bounds { memory: 472, entries: 10.2, words: 11.6 });
}

#[test]
fn rods_and_capsules_among_spheres_stay_within_their_memory() {
    // Row sums of collisions have as much capacity as list entries: 128 bytes per sphere, because there are four movers
    // per three spheres.
    check_size(Benchmark::Mixed, &Bounds { memory: 696, entries: 2.5, words: 5.2 });
}

/// Pair tests of the grid and words of list entries, both per sphere, after a number of steps.
fn work_of(benchmark: Benchmark, spheres: u32, steps: u64) -> [f64; 2] {
    let scene = benchmark.generate(spheres, 5).unwrap();
    let options = Options::new().backend(Backend::Cpu).broad_phase(BroadPhase::Grid);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    simulation.run(steps, DT).unwrap();
    let world = listed(&mut simulation, World::build_in_space);
    [cpu::pair_tests(&world), words_of_rows(world.status.pair_rows_needed)].map(|sum| sum as f64 / f64::from(spheres))
}

/// Large spheres are spread over a lattice of small ones. No thread visits more than some hundred objects. Slices of
/// the pair lists are wide only where large spheres are next to each other.
#[test]
fn a_few_large_spheres_do_not_slow_down_many_small_ones() {
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
    let (visited, words) = (cpu::longest_search(&world), words_of_rows(world.status.pair_rows_needed));
    let summary =
        format!("at most {visited} objects per thread, lists of up to {longest}, {words} words for {entries} entries");
    println!("{summary}");
    assert!(longest > 100 && visited <= 125 && words as f64 <= 1.2 * entries as f64, "{summary}");
}

/// The AABB of a body that flies off fast is a thousand times as large as the others. It must not visit all other
/// objects, because on a device a single thread would do so.
#[test]
fn a_body_that_flies_off_does_not_slow_down_the_others() {
    let mut scene = Scene::new();
    for k in 0..8_000 {
        scene.add_sphere(Sphere::new([k % 20, k / 20 % 20, k / 400].map(|x| 0.1 * x as f32), 0.049)).unwrap();
    }
    scene.add_sphere(Sphere::new([0.0, 1e6, 0.0], 0.049).velocity([0.0, 1e4, 0.0])).unwrap();
    let options = Options::new().backend(Backend::Cpu).broad_phase(BroadPhase::Grid);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    let world = listed(&mut simulation, World::build_in_space);
    let visited = cpu::longest_search(&world);
    println!("at most {visited} objects per thread");
    assert!(visited <= 125, "{visited} objects");
}

/// Ten times as many spheres, with as much work per sphere. Spheres inside have more neighbours than those on the
/// surface, and a small crowd has a larger share of surface.
#[track_caller]
fn assert_bounded_growth(benchmark: Benchmark, steps: u64, most: [f64; 2], growth: f64) {
    let [small, large] = [1_000, 10_000].map(|spheres| work_of(benchmark, spheres, steps));
    let summary = format!("{benchmark}: {small:.1?} and {large:.1?} pair tests and words of entries per sphere");
    println!("{summary}");
    let is_bounded = |place: usize| large[place] <= most[place] && large[place] <= growth * small[place];
    assert!(is_bounded(0) && is_bounded(1), "{summary}");
}

#[test]
fn work_per_sphere_does_not_grow_in_a_lattice() {
    assert_bounded_growth(Benchmark::Lattice, 0, [185.0, 6.2], 1.3);
}

#[test]
fn work_per_sphere_does_not_grow_in_a_pile() {
    assert_bounded_growth(Benchmark::Pile, 60, [63.0, 3.0], 1.3);
}

#[test]
fn work_per_sphere_does_not_grow_with_different_radii() {
    assert_bounded_growth(Benchmark::Radii, 0, [58.0, 2.6], 1.3);
}
