//! Every optimization can be left out, and no result depends on it.

#![cfg(feature = "gpu")]

use crate::common::mixed::{Run, assert_bitwise_identical};
use rockfall::generate::Benchmark;
use rockfall::model::step::Step;
use rockfall::{Backend, BroadPhase, Integrator, Optimization, Options, Scene, Simulation, Sphere};

const STEPS: u64 = 40;
const DT: f32 = 0.02;

/// Small spheres and some large ones that fall into a pile.
fn radii() -> Scene {
    Benchmark::Radii.generate(700, 3).expect("a scene")
}

/// Equal spheres that fall into a pile. Many collide at the same time.
fn pile() -> Scene {
    Benchmark::Pile.generate(700, 3).expect("a scene")
}

/// Equal spheres in contact, so that lists last for many steps.
fn lattice() -> Scene {
    Benchmark::Lattice.generate(500, 3).expect("a scene")
}

fn options() -> Options {
    Options::new().backend(Backend::Gpu).broad_phase(BroadPhase::Grid).integrator(Integrator::Rk4)
}

fn run(scene: Scene, options: Options) -> Simulation {
    let _device = rockfall::gpu::SharedDevice::new();
    let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
    simulation.run(STEPS, DT).expect("steps");
    simulation
}

/// Runs a scene with and without an optimization, asserts that the results are bitwise identical, and returns what
/// `effect` measures in each.
fn with_and_without<T>(
    optimization: Optimization,
    scene: fn() -> Scene,
    options: &Options,
    effect: impl Fn(&Simulation) -> T,
) -> [T; 2] {
    let runs = [options.clone(), options.clone().without(optimization)].map(|options| {
        let mut simulation = run(scene(), options);
        (effect(&simulation), Run::of(&mut simulation))
    });
    assert_bitwise_identical(&runs[0].1, &runs[1].1);
    assert!(runs[0].1.report.contacts > 0 || runs[0].1.report.total_collisions > 0, "{:?}", runs[0].1.report);
    runs.map(|(effect, _)| effect)
}

fn dispatches(simulation: &Simulation) -> u64 {
    simulation.gpu_view().expect("the GPU backend").dispatches()
}

fn step(simulation: &Simulation) -> Step {
    *simulation.gpu_view().expect("the GPU backend").step()
}

#[test]
fn a_list_interval_saves_dispatches() {
    let [with, without] = with_and_without(Optimization::ListInterval, lattice, &options(), dispatches);
    assert!(with < without, "{with} and {without} dispatches");
}

#[test]
fn aabbs_may_be_placed_without_lead() {
    let lead = with_and_without(Optimization::Lead, pile, &options(), |simulation| step(simulation).lists.lead);
    assert_eq!(lead, [0.5, 0.0]);
}

/// Only the time of a run shows whether portions overlap.
#[test]
fn portions_may_run_one_by_one() {
    with_and_without(Optimization::Portions, pile, &options(), |_| ());
}

/// Fast spheres hit a pile that is too large for the portions of small scenes. Steps are rejected, because spheres leave their
/// AABBs.
#[test]
fn portions_may_have_any_length() {
    let runs = [(1, 1), (4, 2), (16, 2), (32, 4)].map(|(steps, depth)| {
        let mut scene = Benchmark::Pile.generate(1100, 3).expect("a scene");
        for k in 0..5u8 {
            let centre = [f32::from(k), 25.0 + 12.0 * f32::from(k), 0.0];
            scene.add_sphere(Sphere::new(centre, 1.0).mass(200.0).velocity([0.0, -60.0, 0.0])).expect("a sphere");
        }
        let mut simulation = Simulation::with_options(scene, options()).expect("the simulation opens");
        simulation.set_portions(steps, depth);
        simulation.run(STEPS, DT).expect("steps");
        assert!(simulation.report().replays > 0, "no step was rejected");
        Run::of(&mut simulation)
    });
    for run in &runs[1..] {
        assert_bitwise_identical(&runs[0], run);
    }
}

#[test]
fn memory_may_stay_in_insertion_order() {
    let in_order =
        |simulation: &Simulation| (0..simulation.scene().counts().spheres).all(|sphere| simulation.slot(sphere) == sphere);
    assert_eq!(with_and_without(Optimization::SpatialOrder, pile, &options(), in_order), [false, true]);
}

#[test]
fn large_spheres_may_have_one_thread() {
    let large = |simulation: &Simulation| step(simulation).layout.large > 0;
    assert_eq!(with_and_without(Optimization::LargeSpheres, radii, &options(), large), [true, false]);
}

#[test]
fn lists_of_long_movers_may_be_built_by_one_thread() {
    let long = |simulation: &Simulation| step(simulation).layout.long_at > 0;
    assert_eq!(with_and_without(Optimization::LongMovers, radii, &options(), long), [true, false]);
}

#[test]
fn sweeps_may_take_a_dispatch_each() {
    let [with, without] = with_and_without(Optimization::SweepsAtOnce, pile, &options(), dispatches);
    assert!(with < without, "{with} and {without} dispatches");
}

#[test]
fn names_of_optimizations_are_read() {
    for optimization in Optimization::ALL {
        assert_eq!(optimization.to_string().parse::<Optimization>().expect("a name"), optimization);
    }
    let error = "lists".parse::<Optimization>().expect_err("not a name").to_string();
    assert!(error.contains("sweeps-at-once") && error.contains("joined-steps"), "{error}");
}
