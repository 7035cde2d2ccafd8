//! Worlds with moving walls advance as simulations of their own.

use rockfall::generate::creature;
use rockfall::{Backend, Cuboid, Motion, MotionTerm, Options, Scene, Simulation, Sleep, Sphere, WorldPath, Worlds};

use crate::common::*;

const DT: f32 = 0.005;

/// A ball and a grain on a plate that follows a motion. Without it, a workgroup would run this world.
fn plate(term: MotionTerm) -> Scene {
    let mut scene = Scene::new();
    scene.settings.collisions = false;
    scene.settings.gravity = 9.81;
    let motion = scene.add_motion(Motion::new("plate", term)).expect("a motion");
    scene.add_box(Cuboid::between([-2.0, -0.2, -2.0], [2.0, 0.0, 2.0]).motion(motion)).expect("a box");
    scene.add_sphere(Sphere::new([0.3, 0.5, 0.0], 0.5).velocity([0.1, 0.0, 0.0])).expect("a sphere");
    scene.add_sphere(Sphere::new([-0.9, 0.3, 0.2], 0.25)).expect("a sphere");
    scene
}

/// Three plates that move in different ways, and a world without walls.
fn scenes() -> Vec<Scene> {
    let shaken = |frequency| MotionTerm::oscillation([0.0, 0.05, 0.0], frequency);
    let turned = MotionTerm::turn(2.0, [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]).during(0.05, 0.2);
    let mut scenes = [shaken(3.0), shaken(7.0), turned].map(plate).to_vec();
    scenes.push(creature(8, 1).expect("a creature"));
    scenes
}

fn alone(scene: &Scene, backend: Backend, steps: u64) -> Vec<u32> {
    let mut simulation = Simulation::with_options(scene.clone(), Options::new().backend(backend)).expect("it opens");
    simulation.run(steps, DT).expect("steps");
    bits_of(&mut simulation)
}

fn all_bits(worlds: &mut Worlds) -> Vec<Vec<u32>> {
    worlds.all_states().expect("states").iter().map(|states| bits(states)).collect()
}

fn plates_move_in_worlds(backend: Backend) {
    let scenes = scenes();
    let expected =
        |steps: [u64; 4]| -> Vec<_> { scenes.iter().zip(steps).map(|(scene, steps)| alone(scene, backend, steps)).collect() };
    let mut worlds = Worlds::new(scenes.clone(), Options::new().backend(backend)).expect("worlds");
    for (world, path) in
        [(0, WorldPath::Simulation), (3, if backend == Backend::Gpu { WorldPath::Device } else { WorldPath::Simulation })]
    {
        assert_eq!(worlds.report(world, None).expect("a report").path, path, "world {world}");
    }
    for part in [7, 13] {
        worlds.run(part, DT).expect("steps");
    }
    assert_eq!(all_bits(&mut worlds), expected([20; 4]));
    // A copy of all worlds, and a simulation that goes on from one of them.
    let mut copy = Worlds::from_bytes(&worlds.to_bytes().expect("bytes"), "copy", None).expect("worlds");
    let mut one = Simulation::resume(worlds.checkpoint(2).expect("a state")).expect("it goes on");
    one.run(20, DT).expect("steps");
    for both in [&mut worlds, &mut copy] {
        both.run(20, DT).expect("steps");
        both.reset(&[1]).expect("a reset");
        both.run(15, DT).expect("steps");
    }
    assert_eq!(bits_of(&mut one), alone(&scenes[2], backend, 40));
    let end = expected([55, 15, 55, 55]);
    assert_eq!(all_bits(&mut worlds), end);
    assert_eq!(all_bits(&mut copy), end);
    // A world that replaces another begins at time 0.
    worlds.replace(3, scenes[0].clone()).expect("a world");
    worlds.run(15, DT).expect("steps");
    assert_eq!(all_bits(&mut worlds)[3], alone(&scenes[0], backend, 15));
}

/// A wall that reaches a ball at rest later.
#[test]
fn a_world_does_not_sleep_while_a_wall_may_come() {
    let mut still = Scene::new();
    still.settings.gravity = 0.0;
    still.add_sphere(Sphere::new([0.0; 3], 0.5)).expect("a sphere");
    let mut pushed = still.clone();
    let motion = pushed.add_motion(Motion::new("wall", MotionTerm::translation([1.0, 0.0, 0.0]))).expect("a motion");
    pushed.add_box(Cuboid::between([-2.0, -1.0, -1.0], [-1.0, 1.0, 1.0]).motion(motion)).expect("a box");
    let mut worlds = Worlds::new([pushed, still], Options::new().backend(Backend::Cpu)).expect("worlds");
    worlds.set_sleep(Sleep::new().steps(5).skip(true)).expect("a setting");
    worlds.run(200, DT).expect("steps");
    let reports = [0, 1].map(|world| worlds.report(world, None).expect("a report"));
    assert_eq!(reports.clone().map(|report| (report.report.steps, report.sleeping)), [(200, false), (5, true)]);
    assert!(worlds.states(0).expect("states")[0].position.x > 0.3, "the wall has pushed the ball");
}

/// Two balls that touch through the faces of a periodic box.
fn periodic_worlds_are_simulations(backend: Backend) {
    let mut scene = Scene::new();
    scene.settings.collisions = false;
    scene.settings.gravity = 0.0;
    scene.set_periodic(0, Some([-2.0, 2.0])).expect("a period");
    for x in [-1.6, 1.6] {
        scene.add_sphere(Sphere::new([x, 0.0, 0.0], 0.5)).expect("a sphere");
    }
    let mut worlds = Worlds::new([scene.clone()], Options::new().backend(backend)).expect("worlds");
    assert_eq!(worlds.report(0, None).expect("a report").path, WorldPath::Simulation);
    worlds.run(20, DT).expect("steps");
    assert_eq!(all_bits(&mut worlds), [alone(&scene, backend, 20)]);
    assert!(worlds.states(0).expect("states")[0].velocity.x > 0.0, "they push each other");
}

both_in_turn!(plates_move_in_worlds, periodic_worlds_are_simulations);
