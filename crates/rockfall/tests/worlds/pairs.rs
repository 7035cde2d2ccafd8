//! Worlds whose spheres touch only the ground advance as simulations of their own, also where a world with pairs joins them.

use rockfall::generate::{creature, creature_without_pairs};
use rockfall::glam::Vec3;
use rockfall::{Backend, Integrator, Options, Scene, Simulation, Sphere, WorldPath, Worlds};

use crate::common::*;

const DT: f32 = 0.005;

fn alone(scene: &Scene, options: &Options, steps: u64) -> (Vec<u32>, u32) {
    let mut simulation = Simulation::with_options(scene.clone(), options.clone()).expect("it opens");
    simulation.run(steps, DT).expect("steps");
    (bits(&simulation.spheres().expect("states")), simulation.report().contacts)
}

fn in_worlds(worlds: &mut Worlds, world: usize) -> (Vec<u32>, u32) {
    (bits(&worlds.states(world).expect("states")), worlds.report(world, None).expect("a report").report.contacts)
}

fn worlds_without_pairs_advance_as_simulations(backend: Backend) {
    let mut scenes: Vec<Scene> = [20, 9].map(|spheres| creature_without_pairs(spheres, 7).expect("a creature")).to_vec();
    let steps = on(backend, 200, 24);
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let options = Options::new().backend(backend).integrator(integrator);
        let mut worlds = Worlds::new(scenes.clone(), options.clone()).expect("worlds");
        worlds.run(steps, DT).expect("steps");
        for (world, scene) in scenes.iter().enumerate() {
            let expected = alone(scene, &options, steps);
            assert!(expected.1 > 0, "a creature on the ground touches it");
            assert_eq!(in_worlds(&mut worlds, world), expected);
        }
        // A world with pairs takes the place of one without.
        let mut touching = creature(18, 3).expect("a creature");
        for x in [0.0, 0.3] {
            touching.add_sphere(Sphere::new([x, 3.0, 0.0], 0.2)).expect("a sphere");
        }
        worlds.replace(1, touching.clone()).expect("a world");
        worlds.run(steps, DT).expect("steps");
        let path = if backend == Backend::Gpu { WorldPath::Device } else { WorldPath::Simulation };
        assert_eq!(worlds.report(1, None).expect("a report").path, path);
        assert_eq!(in_worlds(&mut worlds, 1), alone(&touching, &options, steps));
        assert_eq!(in_worlds(&mut worlds, 0), alone(&scenes[0], &options, 2 * steps));
        // Without it, the code for pairs is gone again.
        scenes.reverse();
        worlds.replace_all(scenes.clone()).expect("worlds");
        worlds.run(steps, DT).expect("steps");
        assert_eq!(in_worlds(&mut worlds, 0), alone(&scenes[0], &options, steps));
    }
}

both_in_turn!(worlds_without_pairs_advance_as_simulations);

/// Spheres that overlap at the start push each other only with pairs.
#[test]
fn spheres_of_a_creature_without_pairs_do_not_touch() {
    let contacts = |scene: Scene| {
        let ids: Vec<_> = scene.sphere_ids().collect();
        let above = scene.sphere(ids[0]).expect("a sphere").position + 5.0 * Vec3::Y;
        let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens");
        ids[..2].iter().for_each(|id| simulation.set_position(*id, above).expect("a position"));
        simulation.run(1, DT).expect("a step");
        simulation.report().contacts
    };
    let [with, without] = [creature, creature_without_pairs].map(|generate| contacts(generate(4, 1).expect("a creature")));
    assert_eq!((with, without), (1, 0));
    let error = creature_without_pairs(70_000, 0).expect_err("too many groups");
    assert!(error.to_string().contains("at most 65536 spheres"), "{error}");
}
