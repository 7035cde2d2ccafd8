//! Worlds side by side advance exactly as simulations of their own.

use rockfall::generate::{Kind, creature};
use rockfall::glam::Vec3;
use rockfall::{
    Backend, Cuboid, Error, Integrator, Muscle, Optimization, Options, Scene, Simulation, Sphere, SphereState, Spring, Tether,
    WorldPath, Worlds,
};

use crate::common::*;

const DT: f32 = 0.005;

/// Scenes of all kinds: creatures with muscles, bodies with rods and capsules, groups, other settings, an empty scene.
fn scenes() -> Vec<Scene> {
    let mut scenes: Vec<Scene> = (0..4).map(|seed| creature(12 + seed as u32, seed).expect("a creature")).collect();
    scenes.push(Kind::Mixed.generate(9, 3).expect("a scene"));
    scenes.push(Kind::Chain.generate(7, 1).expect("a scene"));
    scenes.push(Kind::Pile.generate(14, 2).expect("a scene"));
    let mut other = creature(8, 9).expect("a creature");
    other.settings.gravity = 3.0;
    other.settings.collisions = false;
    other.settings.friction = 0.0;
    let ids: Vec<_> = other.sphere_ids().collect();
    other.add_tether(Tether::new(ids[0], [0.0, 2.0, 0.0], 30.0)).expect("a tether");
    other.add_sphere(Sphere::new([0.0, 0.3, 0.0], 0.2).group(3).force([1.0, 0.0, 0.0])).expect("a sphere");
    scenes.push(other);
    let mut rough = creature(10, 4).expect("a creature");
    rough.settings.coulomb_friction = 0.5;
    scenes.push(rough);
    scenes.push(Scene::new());
    scenes
}

/// The final states of each scene in a simulation of its own.
fn alone(scenes: &[Scene], options: &Options, steps: u64) -> Vec<Vec<u32>> {
    let run = |scene: &Scene| {
        let mut simulation = Simulation::with_options(scene.clone(), options.clone()).expect("it opens");
        simulation.run(steps, DT).expect("steps");
        bits(&simulation.spheres().expect("states"))
    };
    scenes.iter().map(run).collect()
}

fn worlds(scenes: &[Scene], options: &Options) -> Worlds {
    Worlds::new(scenes.to_vec(), options.clone()).expect("worlds")
}

fn all_bits(worlds: &mut Worlds) -> Vec<Vec<u32>> {
    worlds.all_states().expect("states").iter().map(|states| bits(states)).collect()
}

/// Scenes for a backend. Software Vulkan compiles kernels of many kinds, so it gets fewer.
fn some_scenes(backend: Backend) -> Vec<Scene> {
    let mut scenes = scenes();
    if backend == Backend::Gpu {
        scenes = [0, 1, 7, 2].map(|place| scenes[place].clone()).to_vec();
    }
    scenes
}

/// Alone, in any place, in any batch, and in one call or several: the same bits.
fn a_world_advances_as_a_simulation_of_its_own(backend: Backend) {
    let scenes = some_scenes(backend);
    let steps = on(backend, 300, 24);
    let integrators =
        if backend == Backend::Cpu { Integrator::ALL.to_vec() } else { vec![Integrator::Rk4, Integrator::VelocityVerlet] };
    for integrator in integrators {
        let options = Options::new().backend(backend).integrator(integrator);
        let expected = alone(&scenes, &options, steps);
        let mut whole = worlds(&scenes, &options);
        whole.run(steps, DT).expect("steps");
        assert_eq!(all_bits(&mut whole), expected);
        for (world, scene) in scenes.iter().enumerate() {
            let counts = scene.counts();
            let is_small = counts.rods == 0 && counts.spheres > 0 && !scene.settings.collisions;
            let is_known = integrator != Integrator::VelocityVerlet;
            let on_device = backend == Backend::Gpu && is_known && is_small && scene.settings.coulomb_friction == 0.0;
            let path = if on_device { WorldPath::Device } else { WorldPath::Simulation };
            assert_eq!(whole.report(world, None).expect("a report").path, path, "scene {world}");
        }
        // Backwards, with one world twice, and in several calls.
        let mut order: Vec<usize> = (0..scenes.len()).rev().collect();
        order.insert(1, 0);
        let permuted: Vec<Scene> = order.iter().map(|place| scenes[*place].clone()).collect();
        let mut divided = worlds(&permuted, &options);
        for part in [1, steps / 3, steps - 1 - steps / 3] {
            divided.run(part, DT).expect("steps");
        }
        let found = all_bits(&mut divided);
        for (place, scene) in order.iter().enumerate() {
            assert_eq!(found[place], expected[*scene], "scene {scene} in place {place}");
        }
        // Without its neighbours.
        let mut few = worlds(&scenes[1..3], &options);
        few.run(steps, DT).expect("steps");
        assert_eq!(all_bits(&mut few), expected[1..3]);
    }
}

/// A world whose state stops being finite is stopped and reported. The others do not change.
fn a_world_that_is_not_finite_affects_no_other(backend: Backend) {
    let steps = on(backend, 100, 12);
    let count = on(backend, 60, 5);
    let mut scenes: Vec<Scene> = (0..count).map(|seed| creature(8, seed).expect("a creature")).collect();
    let options = Options::new().backend(backend);
    let expected = alone(&scenes, &options, steps);
    let poisoned = 3;
    let id = scenes[poisoned].sphere_ids().next().expect("a sphere");
    let at = scenes[poisoned].sphere(id).expect("a sphere").position;
    scenes[poisoned].add_tether(Tether::new(id, at + Vec3::X, 3e38)).expect("a tether");
    let mut worlds = worlds(&scenes, &options);
    worlds.run(steps, DT).expect("steps");
    let found = all_bits(&mut worlds);
    for world in (0..scenes.len()).filter(|world| *world != poisoned) {
        assert_eq!(found[world], expected[world], "world {world}");
        assert_eq!(worlds.report(world, None).expect("a report").stopped, None);
    }
    let report = worlds.report(poisoned, None).expect("a report");
    assert!(report.stopped.as_deref().is_some_and(|text| text.contains("stopped being finite in step")), "{report:?}");
    assert!(report.report.steps < steps);
    // It stays where it is until it is reset or replaced.
    let stopped = found[poisoned].clone();
    worlds.run(2, DT).expect("steps");
    assert_eq!(all_bits(&mut worlds)[poisoned], stopped);
    worlds.replace(poisoned, creature(8, 3).expect("a creature")).expect("a new world");
    worlds.run(steps, DT).expect("steps");
    assert_eq!(all_bits(&mut worlds)[poisoned], expected[poisoned]);
}

/// A world that is reset or replaced advances as a new one.
fn worlds_can_be_reset_and_replaced(backend: Backend) {
    let scenes: Vec<Scene> = (0..4).map(|seed| creature(8, seed).expect("a creature")).collect();
    let options = Options::new().backend(backend);
    let steps = on(backend, 80, 8);
    let expected = alone(&scenes, &options, steps);
    let twice = alone(&scenes, &options, 2 * steps);
    let mut worlds = worlds(&scenes, &options);
    worlds.run(steps, DT).expect("steps");
    worlds.set_rest_lengths(1, &vec![0.3; scenes[1].springs().len()]).expect("lengths");
    worlds.reset(&[1, 2]).expect("a reset");
    assert_eq!(worlds.report(1, None).expect("a report").report.steps, 0);
    worlds.replace(3, scenes[0].clone()).expect("a new world");
    worlds.run(steps, DT).expect("steps");
    let found = all_bits(&mut worlds);
    assert_eq!(found, [&twice[0], &expected[1], &expected[2], &expected[0]].map(Clone::clone));
}

/// All worlds can be replaced by others, in another number, by larger and by smaller ones. A bad scene changes nothing.
fn all_worlds_can_be_replaced(backend: Backend) {
    let scenes: Vec<Scene> = [8, 6, 9, 14].map(|spheres| creature(spheres, spheres.into()).expect("a creature")).to_vec();
    let options = Options::new().backend(backend);
    let steps = on(backend, 60, 6);
    let expected = alone(&scenes, &options, steps);
    let mut worlds = worlds(&scenes[..2], &options);
    for range in [1..4, 0..1, 0..0, 0..4] {
        worlds.run(2, DT).expect("steps");
        worlds.replace_all(scenes[range.clone()].to_vec()).expect("worlds");
        worlds.run(steps, DT).expect("steps");
        assert_eq!(all_bits(&mut worlds), expected[range]);
    }
    let mut bad = scenes[0].clone();
    bad.settings.gravity = f32::NAN;
    assert!(worlds.replace_all([scenes[1].clone(), bad]).is_err());
    assert_eq!(all_bits(&mut worlds), expected);
    for world in 0..worlds.len() {
        let path = if backend == Backend::Gpu { WorldPath::Device } else { WorldPath::Simulation };
        assert_eq!(worlds.report(world, None).expect("a report").path, path);
    }
}

/// Rest lengths, forces and states that are set for a world act as in a simulation.
fn a_world_is_controlled_as_a_simulation(backend: Backend) {
    let integrators = if backend == Backend::Cpu { Integrator::ALL.to_vec() } else { vec![Integrator::Rk4] };
    for integrator in integrators {
        is_controlled_as_a_simulation(Options::new().backend(backend).integrator(integrator));
    }
}

fn is_controlled_as_a_simulation(options: Options) {
    let scene = creature(8, 5).expect("a creature");
    let mut worlds = worlds(&[creature(9, 1).expect("a creature"), scene.clone()], &options);
    let mut simulation = Simulation::with_options(scene, options).expect("it opens");
    let springs: Vec<_> = simulation.scene().spring_ids().collect();
    let spheres: Vec<_> = simulation.scene().sphere_ids().collect();
    for round in 0..3_u8 {
        let lengths: Vec<f32> = springs
            .iter()
            .map(|id| {
                let length = simulation.scene().spring(*id).expect("a spring").length;
                length * (1.0 + 0.05 * f32::from(round))
            })
            .collect();
        let forces: Vec<Vec3> = (0..spheres.len()).map(|place| Vec3::new(place as f32, f32::from(round), 0.0)).collect();
        worlds.set_rest_lengths(1, &lengths).expect("lengths");
        springs.iter().zip(&lengths).for_each(|(id, length)| {
            simulation.update_spring(*id, |spring| spring.length = *length).expect("a spring");
        });
        // In the last round lengths change alone, which takes another way.
        if round < 2 {
            worlds.set_forces(1, &forces).expect("forces");
            spheres.iter().zip(&forces).for_each(|(id, force)| simulation.set_force(*id, *force).expect("a force"));
        }
        worlds.run(5, DT).expect("steps");
        simulation.run(5, DT).expect("steps");
        assert_eq!(bits(&worlds.states(1).expect("states")), bits(&simulation.spheres().expect("states")));
    }
    // The same for all worlds at once: the first world has other springs and spheres.
    let counts = worlds.scene(0).expect("a scene").counts();
    let lengths: Vec<f32> = springs.iter().map(|id| simulation.scene().spring(*id).expect("a spring").length * 0.9).collect();
    let forces = vec![Vec3::Z; spheres.len()];
    worlds.set_all_forces(&[vec![Vec3::X; counts.spheres], forces.clone()].concat()).expect("forces");
    worlds.run(5, DT).expect("steps");
    spheres.iter().zip(&forces).for_each(|(id, force)| simulation.set_force(*id, *force).expect("a force"));
    simulation.run(5, DT).expect("steps");
    worlds.set_all_rest_lengths(&[vec![0.5; counts.springs], lengths.clone()].concat()).expect("lengths");
    assert_eq!(worlds.scene(0).expect("a scene").springs()[0].length, 0.5);
    for (id, length) in springs.iter().zip(&lengths) {
        simulation.update_spring(*id, |spring| spring.length = *length).expect("a spring");
    }
    worlds.run(5, DT).expect("steps");
    simulation.run(5, DT).expect("steps");
    assert_eq!(bits(&worlds.states(1).expect("states")), bits(&simulation.spheres().expect("states")));
    let states = worlds.states(1).expect("states");
    let back: Vec<SphereState> = states
        .iter()
        .map(|state| {
            let mut state = *state;
            state.position += Vec3::Y;
            state.position_low = Vec3::ZERO;
            state
        })
        .collect();
    worlds.set_states(1, &back).expect("states");
    spheres.iter().zip(&back).for_each(|(id, state)| simulation.set_position(*id, state.position).expect("a position"));
    worlds.run(5, DT).expect("steps");
    simulation.run(5, DT).expect("steps");
    assert_eq!(bits(&worlds.states(1).expect("states")), bits(&simulation.spheres().expect("states")));
}

/// Another time step, and a world that grows too large for a workgroup, change nothing but the path.
fn time_steps_and_sizes_may_change(backend: Backend) {
    let scene = creature(20, 6).expect("a creature");
    let options = Options::new().backend(backend);
    let mut worlds = worlds(&[scene.clone(), creature(8, 1).expect("a creature")], &options);
    let mut simulation = Simulation::with_options(scene.clone(), options).expect("it opens");
    let forces = vec![Vec3::new(0.5, 1.0, 0.0); scene.spheres().len()];
    for (steps, dt) in [(7, DT), (5, 0.004), (6, DT)] {
        worlds.run(steps, dt).expect("steps");
        simulation.run(steps, dt).expect("steps");
        let [one, other] = [worlds.report(0, None).expect("a report").report, simulation.report()];
        assert_eq!(
            (one.steps, one.time, one.contacts, one.max_overlap),
            (other.steps, other.time, other.contacts, other.max_overlap)
        );
        if dt == 0.004 {
            worlds.set_forces(0, &forces).expect("forces");
            let ids: Vec<_> = simulation.scene().sphere_ids().collect();
            ids.iter().zip(&forces).for_each(|(id, force)| simulation.set_force(*id, *force).expect("a force"));
        }
    }
    assert_eq!(bits(&worlds.states(0).expect("states")), bits(&simulation.spheres().expect("states")));
    let snapshot = worlds.snapshot(0).expect("a scene");
    assert_eq!(snapshot.springs()[3].muscle, simulation.snapshot().expect("a scene").springs()[3].muscle);
}

/// Rest lengths that are set again and again, with and without reading states, act as in simulations, also in worlds that are added,
/// reset or stand still.
fn rest_lengths_can_be_set_at_any_time(backend: Backend) {
    let scenes =
        [creature(8, 1).expect("a creature"), creature(6, 2).expect("a creature"), creature(9, 3).expect("a creature")];
    let options = Options::new().backend(backend);
    let mut worlds = worlds(&scenes, &options);
    let mut simulations: Vec<_> =
        scenes.iter().map(|scene| Simulation::with_options(scene.clone(), options.clone()).expect("it opens")).collect();
    let lengths_of =
        |scene: &Scene, factor: f32| scene.springs().iter().map(|spring| spring.length * factor).collect::<Vec<_>>();
    for round in 0..5_u8 {
        let factor = 1.0 + 0.04 * f32::from(round);
        if round == 3 {
            worlds.reset(&[1]).expect("a world");
            simulations[1] = Simulation::with_options(scenes[1].clone(), options.clone()).expect("it opens");
        }
        let lengths: Vec<f32> = scenes.iter().flat_map(|scene| lengths_of(scene, factor)).collect();
        worlds.set_all_rest_lengths(&lengths).expect("lengths");
        // Once more for a single world, before the device has got the first ones.
        worlds.set_rest_lengths(2, &lengths_of(&scenes[2], factor + 0.1)).expect("lengths");
        for (place, (simulation, scene)) in simulations.iter_mut().zip(&scenes).enumerate() {
            let factor = if place == 2 { factor + 0.1 } else { factor };
            let ids: Vec<_> = simulation.scene().spring_ids().collect();
            for (id, length) in ids.into_iter().zip(lengths_of(scene, factor)) {
                simulation.update_spring(id, |spring| spring.length = length).expect("a spring");
            }
            simulation.run(4, DT).expect("steps");
        }
        worlds.run(4, DT).expect("steps");
        // A sample does not bring the states to the host.
        if round % 2 == 0 {
            for (world, simulation) in simulations.iter_mut().enumerate() {
                let sampled = worlds.sample(|sample| sample.states(world)).expect("states");
                assert_eq!(bits(&sampled), bits(&simulation.spheres().expect("states")), "round {round}, world {world}");
            }
        }
    }
    for (world, simulation) in simulations.iter_mut().enumerate() {
        assert_eq!(bits(&worlds.states(world).expect("states")), bits(&simulation.spheres().expect("states")), "world {world}");
        assert_eq!(worlds.scene(world).expect("a scene").springs()[0].length, simulation.scene().springs()[0].length);
    }
}

both_in_turn!(
    time_steps_and_sizes_may_change,
    a_world_advances_as_a_simulation_of_its_own,
    a_world_that_is_not_finite_affects_no_other,
    worlds_can_be_reset_and_replaced,
    all_worlds_can_be_replaced,
    a_world_is_controlled_as_a_simulation,
    rest_lengths_can_be_set_at_any_time,
);

/// On the CPU, small scenes have one function for the phase of positions. It computes the same as the stages, also where bodies are
/// fixed, coincide, collide or stop being finite.
#[test]
fn positions_in_one_function_equal_those_of_the_stages() {
    let mut scenes = scenes();
    let mut odd = creature(8, 2).expect("a creature");
    let ids: Vec<_> = odd.sphere_ids().collect();
    let at = odd.sphere(ids[1]).expect("a sphere").position;
    let twin = odd.add_sphere(Sphere::new(at, 0.1).velocity([1.0, 0.0, 0.0])).expect("a sphere");
    let fixed = odd.add_sphere(Sphere::new(at + Vec3::Y, 0.3).fixed().velocity([0.0, 0.0, 2.0])).expect("a sphere");
    odd.add_spring(Spring::new(ids[1], twin, 100.0, 0.2)).expect("a spring");
    odd.add_spring(Spring::new(fixed, twin, 50.0, 0.1).damping(1.0)).expect("a spring");
    odd.add_tether(Tether::new(twin, at, 10.0)).expect("a tether");
    odd.settings.linear_damping = 0.3;
    scenes.push(odd.clone());
    odd.add_tether(Tether::new(ids[3], at, 1e38)).expect("a tether");
    scenes.push(odd);
    scenes.push(Kind::Pile.generate(127, 1).expect("a scene"));
    let options = Options::new().backend(Backend::Cpu);
    for (number, scene) in scenes.iter().enumerate() {
        let [joined, apart] = [true, false].map(|join| {
            let options =
                if join { options.clone() } else { options.clone().without(Optimization::JoinedSteps) }.keep_going(true);
            let mut simulation = Simulation::with_options(scene.clone(), options).expect("it opens");
            simulation.run(200, DT).expect("steps");
            let report = simulation.report();
            (bits(&simulation.spheres().expect("states")), report)
        });
        assert!(joined == apart, "scene {number}: {:?} {:?}", joined.1, apart.1);
    }
}

#[test]
fn wrong_numbers_and_worlds_are_errors() {
    let mut worlds = worlds(&[creature(8, 0).expect("a creature")], &Options::new().backend(Backend::Cpu));
    let message = |answer: Result<(), Error>| answer.expect_err("an error").to_string();
    assert_eq!(message(worlds.reset(&[0, 1])), "world: 1 of 1 is not allowed, expected a number below that of worlds");
    let springs = worlds.scene(0).expect("a scene").springs().len();
    assert_eq!(
        message(worlds.set_rest_lengths(0, &[1.0])),
        format!("rest lengths: 1 for {springs} is not allowed, expected one length per spring of the world")
    );
    let bad = [vec![1.0; springs - 1], vec![-1.0]].concat();
    assert!(message(worlds.set_rest_lengths(0, &bad)).starts_with("spring.length: -1 is not allowed"));
    assert!(message(worlds.set_forces(0, &[Vec3::NAN; 8])).starts_with("force: "));
    assert!(message(worlds.set_forces(0, &[Vec3::ZERO; 7])).starts_with("forces: 7 for 8 is not allowed"));
    let all = message(worlds.set_all_rest_lengths(&[1.0; 3]));
    assert_eq!(all, format!("rest lengths: 3 for {springs} is not allowed, expected one length per spring of all worlds"));
    assert!(message(worlds.set_all_forces(&[Vec3::NAN; 8])).starts_with("force: "));
    assert!(message(worlds.run(1, 0.0)).starts_with("dt: 0 is not allowed"));
    let mut states = worlds.states(0).expect("states");
    states[2].velocity.x = f32::INFINITY;
    assert!(message(worlds.set_states(0, &states)).starts_with("state.velocity"));
    let mut refused = creature(8, 0).expect("a creature");
    refused.settings.gravity = f32::NAN;
    assert!(worlds.replace(0, refused).is_err());
    // Nothing has changed.
    worlds.run(3, DT).expect("steps");
    let expected = alone(&[creature(8, 0).expect("a creature")], &Options::new().backend(Backend::Cpu), 3);
    assert_eq!(all_bits(&mut worlds), expected);
}

#[test]
fn reports_name_the_first_sphere_out_of_bounds() {
    let mut scene = weightless();
    spheres(&mut scene, [Sphere::new([0.0; 3], 0.1), Sphere::new([5.0, 0.0, 0.0], 0.1).velocity([100.0, 0.0, 0.0])]);
    let mut worlds = worlds(&[scene], &Options::new().backend(Backend::Cpu));
    let bounds = Some([Vec3::splat(-6.0), Vec3::splat(6.0)]);
    let report = worlds.report(0, bounds).expect("a report");
    assert_eq!((report.escaped, report.path, report.report.steps), (None, WorldPath::Simulation, 0));
    worlds.run(10, DT).expect("steps");
    let report = worlds.report(0, bounds).expect("a report");
    assert_eq!((report.escaped, report.report.steps), (Some(1), 10));
    assert_eq!(worlds.report(0, None).expect("a report").escaped, None);
}

/// A creature has muscles and stands on the ground, and its motion depends on its muscles.
#[test]
fn muscles_move_creatures() {
    let scene = creature(20, 1).expect("a creature");
    assert_eq!((scene.counts().spheres, scene.counts().springs), (20, 60));
    let mut still = scene.clone();
    let ids: Vec<_> = still.spring_ids().collect();
    ids.into_iter().for_each(|id| still.update_spring(id, |spring: &mut Spring| spring.muscle = None).expect("a spring"));
    assert!(scene.springs().iter().all(|spring| spring.muscle.is_some_and(|muscle| muscle != Muscle::new(0.0, 0.0, 0.0))));
    assert!(scene.concerns(DT, Integrator::Rk4).is_empty(), "{:?}", scene.concerns(DT, Integrator::Rk4));
    let mut worlds = worlds(&[scene, still], &Options::new().backend(Backend::Cpu));
    worlds.run(400, DT).expect("steps");
    let kinetic = |states: Vec<SphereState>| -> f32 { states.iter().map(|state| state.velocity.length_squared()).sum() };
    let [moved, rests] = [0, 1].map(|world| kinetic(worlds.states(world).expect("states")));
    assert!(moved > 0.5 && rests < 0.1 * moved, "{moved} {rests}");
}

/// A body as large as genomes may be fits into a workgroup, with as many boxes as are promised. One more box does not.
#[test]
#[cfg(feature = "gpu")]
fn a_body_of_the_greatest_size_fits_into_a_workgroup() {
    let _turn = turn();
    let body = |boxes: u8| {
        let mut scene = weightless();
        scene.settings.collisions = false;
        // Each in contact with a box of its own.
        let place = |k: usize| Sphere::new([k as f32 + 0.5, 0.05, 0.5], 0.1);
        let ids: Vec<_> = (0..Worlds::BODY_SPHERES).map(|k| scene.add_sphere(place(k)).expect("a sphere")).collect();
        let pairs = (0..ids.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
        for (a, b) in pairs.take(Worlds::BODY_MUSCLES) {
            let spring = Spring::new(ids[a], ids[b], 100.0, 1.0).muscle(Muscle::new(0.1, 1.0, 0.0));
            scene.add_spring(spring).expect("a spring");
        }
        for k in 0..boxes {
            let low = Vec3::new(f32::from(k), -1.0, 0.0);
            scene.add_box(Cuboid::between(low, low + Vec3::ONE)).expect("a box");
        }
        scene
    };
    // Worlds with as much of everything as documented.
    let mut full = body(32);
    // The last two spheres are in contact with each other and with the last box.
    let place = |k: usize| Sphere::new([if k == 10 { 31.35 } else { k as f32 + 20.5 }, 0.05, 0.5], 0.1).force([0.0, 1.0, 0.0]);
    let more: Vec<_> = (0..12).map(|k| full.add_sphere(place(k)).expect("a sphere")).collect();
    for k in 0..64 {
        let spring = Spring::new(more[k % 11], more[11], 100.0, 1.0).muscle(Muscle::new(0.1, 1.0, 0.0));
        full.add_spring(spring).expect("a spring");
    }
    for _ in 0..16 {
        full.add_tether(Tether::new(more[0], [0.0, 1.0, 0.0], 3.0)).expect("a tether");
    }
    let scenes = [body(44), body(45), full];
    let options = Options::new().backend(Backend::Gpu);
    let mut worlds = worlds(&scenes, &options);
    let paths = [0, 1, 2].map(|world| worlds.report(world, None).expect("a report").path);
    assert_eq!(paths, [WorldPath::Device, WorldPath::Simulation, WorldPath::Device]);
    const { assert!(Worlds::BODY_MUSCLES == 64) };
    worlds.run(10, DT).expect("steps");
    for world in [0, 2] {
        let mut alone = Simulation::with_options(scenes[world].clone(), options.clone()).expect("the simulation opens");
        alone.run(10, DT).expect("steps");
        assert_eq!(bits(&worlds.states(world).expect("states")), bits(&alone.spheres().expect("states")));
        let contacts = worlds.report(world, None).expect("a report").report.contacts;
        assert!(contacts > 10 && contacts == alone.report().contacts, "{contacts}");
    }
}
