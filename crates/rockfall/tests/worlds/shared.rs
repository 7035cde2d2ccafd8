//! Small worlds that share a workgroup advance as simulations of their own.

#![cfg(feature = "gpu")]

use rockfall::generate::{creature, creature_without_pairs};
use rockfall::{Backend, Integrator, Options, Scene, Simulation, Sleep, WorldPath, Worlds};

use crate::common::*;

const DT: f32 = 0.005;
const STEPS: u64 = 30;

/// Bits of the states, contacts, steps, and whether the world is stopped.
type Seen = (Vec<u32>, u32, u64, bool);

fn alone(scene: &Scene, options: &Options) -> Seen {
    let mut simulation = Simulation::with_options(scene.clone(), options.clone()).expect("it opens");
    let stopped = simulation.run(STEPS, DT).is_err();
    let report = simulation.report();
    (bits(&simulation.spheres().expect("states")), report.contacts, report.steps, stopped)
}

fn seen(worlds: &mut Worlds, world: usize) -> Seen {
    let states = bits(&worlds.states(world).expect("states"));
    let found = worlds.report(world, None).expect("a report");
    assert_eq!(found.path, WorldPath::Device);
    (states, found.report.contacts, found.report.steps, found.stopped.is_some())
}

/// A creature of which a body stops being finite in the first step.
fn torn(spheres: u32) -> Scene {
    let mut scene = creature(spheres, 9).expect("a creature");
    let id = scene.sphere_ids().next().expect("a sphere");
    scene.add_tether(rockfall::Tether::new(id, [9.0, 9.0, 0.0], 3e38)).expect("a tether");
    scene
}

fn without_muscles(scene: &Scene) -> Scene {
    let text = scene.to_text();
    let kept = text.lines().filter(|line| !line.starts_with("@muscle"));
    let text = kept.collect::<Vec<_>>().join("\n");
    Scene::parse(&text, std::path::Path::new("without muscles")).expect("a scene").scene
}

/// Worlds of up to so many spheres. Some of them are smaller, and one is torn.
fn scenes(most: u32) -> Vec<Scene> {
    let of = |spheres: u32, seed: u64| creature(spheres, seed).expect("a creature");
    let mut scenes: Vec<Scene> = (0..9).map(|seed| of(most - (seed % 3) as u32, seed)).collect();
    scenes[4] = torn(most - 1);
    // It has springs without muscles.
    scenes[5] = without_muscles(&scenes[5]);
    scenes
}

fn check(scenes: &[Scene], integrator: Integrator) {
    let options = Options::new().backend(Backend::Gpu).integrator(integrator);
    let mut worlds = Worlds::new(scenes.to_vec(), options.clone()).expect("worlds");
    worlds.share_workgroups(true);
    for steps in [11, STEPS - 11] {
        worlds.run(steps, DT).expect("steps");
    }
    for (world, scene) in scenes.iter().enumerate() {
        assert_eq!(seen(&mut worlds, world), alone(scene, &options), "world {world} of {}, {integrator}", scenes.len());
    }
}

/// Eight and two in 32 threads, three in 64, and a workgroup each. The last workgroup has empty places.
#[test]
fn worlds_that_share_a_workgroup_advance_as_simulations() {
    let _turn = turn();
    let _device = rockfall::gpu::SharedDevice::new();
    for most in [3, 12, 20, 28] {
        check(&scenes(most), Integrator::Rk4);
    }
    check(&scenes(20), Integrator::SymplecticEuler);
    let apart: Vec<Scene> = (0..4).map(|seed| creature_without_pairs(18, seed).expect("a creature")).collect();
    check(&apart, Integrator::Rk4);
}

/// A world that takes the place of another one in a workgroup leaves its neighbours as they are.
#[test]
fn a_world_is_replaced_in_a_shared_workgroup() {
    let _turn = turn();
    let _device = rockfall::gpu::SharedDevice::new();
    let options = Options::new().backend(Backend::Gpu);
    let mut scenes = scenes(20);
    let mut worlds = Worlds::new(scenes.clone(), options.clone()).expect("worlds");
    worlds.share_workgroups(true);
    worlds.run(STEPS, DT).expect("steps");
    let before: Vec<Seen> = (0..scenes.len()).map(|world| seen(&mut worlds, world)).collect();
    scenes[1] = creature(7, 77).expect("a creature");
    worlds.replace(1, scenes[1].clone()).expect("a world");
    for world in [0, 2, 3, 4] {
        assert_eq!(seen(&mut worlds, world), before[world], "world {world}");
    }
    worlds.run(STEPS, DT).expect("steps");
    assert_eq!(seen(&mut worlds, 1), alone(&scenes[1], &options));
}

/// A world that sleeps stands still, while others in its workgroup go on.
#[test]
fn a_sleeping_world_leaves_its_neighbours_awake() {
    let _turn = turn();
    let _device = rockfall::gpu::SharedDevice::new();
    let mut resting = creature(1, 0).expect("a creature");
    resting.settings.gravity = 0.0;
    let scenes = [creature(4, 1).expect("a creature"), resting, creature(4, 2).expect("a creature")];
    let run = |shared: bool| {
        let options = Options::new().backend(Backend::Gpu);
        let mut worlds = Worlds::new(scenes.to_vec(), options).expect("worlds");
        worlds.share_workgroups(shared);
        worlds.set_sleep(Sleep::new().speed(0.01).steps(5).skip(true)).expect("a valid criterion");
        for _ in 0..3 {
            worlds.run(10, DT).expect("steps");
        }
        (0..scenes.len()).map(|world| seen(&mut worlds, world)).collect::<Vec<_>>()
    };
    let shared = run(true);
    assert_eq!(shared, run(false));
    assert_eq!([shared[0].2, shared[1].2, shared[2].2], [30, 5, 30]);
}
