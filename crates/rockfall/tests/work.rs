//! How much a step does, counted and not timed, so that a machine of any speed sees when it becomes more.
//!
//! Every expectation is an upper bound on what was measured when it was written. Where a change makes a step do less, lower
//! it; where one must do more, raise it and say why in the commit.

use rockfall::layout::{SLICE, Status};
use rockfall::scene::generate::Benchmark;
use rockfall::stage::Phase;
use rockfall::world::World;
use rockfall::{Backend, Integrator, Options, Profile, Simulation, cpu};

/// Enough for the broad phase of large scenes.
const BODIES: u32 = 3000;
const STEPS: u64 = 40;
const DT: f32 = 0.02;

fn simulation(benchmark: Benchmark, backend: Backend, integrator: Integrator) -> Simulation {
    let scene = benchmark.generate(BODIES, 5).unwrap();
    let options = Options::new().backend(backend).integrator(integrator);
    Simulation::with_options(scene, options).unwrap()
}

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
    // Spheres alone: 1 for AABBs, 9 for lists, 5 for collisions; 3 advance, finish, turn, end_step.
    check_dispatches(Benchmark::Pile, Integrator::Rk4, 21);
    // leap and commit_leap for the four evaluations.
    check_dispatches(Benchmark::Pile, Integrator::SymplecticEuler, 19);
    // With capsules and rods besides: rod_forces in each evaluation, restore_lengths, constrain.
    check_dispatches(Benchmark::Mixed, Integrator::Rk4, 27);
}

#[test]
#[cfg(feature = "gpu")]
fn every_step_of_a_profile_is_a_step_that_was_done() {
    let profile = profile(Benchmark::Pile, Backend::Gpu, Integrator::Rk4);
    for stage in &profile.stages {
        assert_eq!(stage.runs % STEPS, 0, "{stage:?}");
        assert!(stage.seconds > 0.0, "{stage:?}");
    }
    assert!(
        profile.stage_seconds() + profile.void_seconds <= profile.seconds,
        "{profile:?}"
    );
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
    assert!(profile.void_seconds > 0.0);
    assert_eq!(profile.steps, STEPS);
    assert!(
        profile.stages.iter().all(|stage| stage.runs % STEPS == 0),
        "{:?}",
        profile.stages
    );
}

/// Bytes of all buffers after some steps, per sphere.
#[track_caller]
fn check_memory(benchmark: Benchmark, backend: Backend, most: u64) {
    let mut simulation = simulation(benchmark, backend, Integrator::Rk4);
    simulation.run(STEPS, DT).unwrap();
    let spheres = simulation.scene().counts().spheres as u64;
    let bytes = simulation.device_memory() / spheres;
    let buffers = simulation.buffer_sizes();
    println!("{benchmark} on {backend}: {bytes} bytes a sphere");
    assert!(bytes <= most, "{benchmark} on {backend}: {bytes} bytes a sphere, {buffers:?}");
}

#[test]
fn memory_of_a_sphere() {
    // Four states of 48 bytes, an AABB of 32, an orientation of 16, a tag and a count of 4, and 16 list entries of 4 with
    // a weight of 4 each come to 376.
    check_memory(Benchmark::Pile, Backend::Cpu, 4000);
    check_memory(Benchmark::Settled, Backend::Cpu, 4000);
    #[cfg(feature = "gpu")]
    check_memory(Benchmark::Pile, Backend::Gpu, 4000);
}

/// List entries a mover, and how many of them meet at all.
#[track_caller]
fn check_entries(benchmark: Benchmark, most: f64) {
    let mut simulation = simulation(benchmark, Backend::Cpu, Integrator::Rk4);
    simulation.run(STEPS, DT).unwrap();
    let mut world = World::build(simulation.sync().unwrap()).unwrap();
    world.step.dt = DT;
    for phase in [Phase::UpdateAabbs, Phase::BroadPhase] {
        let stages = phase.stages(Integrator::Rk4, simulation.broad_phase_method());
        cpu::run(&mut world, stages);
        while world.status.void != 0 {
            world.set_pair_capacity(world.status.pairs_needed.next_multiple_of(SLICE));
            world.status = Status::default();
            cpu::run(&mut world, stages);
        }
    }
    let movers = world.movers();
    let entries: u64 = world.lists[..movers as usize].iter().map(|count| u64::from(*count)).sum();
    let each = entries as f64 / f64::from(movers);
    println!("{benchmark}: {each} entries a mover");
    assert!(each <= most, "{benchmark}: {each} entries a mover");
    // The padding of slices comes on top.
    let padded = f64::from(world.status.pairs_needed) / f64::from(movers);
    println!("{benchmark}: {padded} words of entries a mover");
    assert!(padded <= 3.0 * most, "{benchmark}: {padded} words of entries a mover");
}

#[test]
fn list_entries_of_a_mover() {
    // Six neighbours; the AABBs of two spheres that do not touch overlap at the edges of the lattice only.
    check_entries(Benchmark::Lattice, 70.0);
    check_entries(Benchmark::Pile, 70.0);
    check_entries(Benchmark::Settled, 70.0);
    check_entries(Benchmark::Mixed, 70.0);
}
