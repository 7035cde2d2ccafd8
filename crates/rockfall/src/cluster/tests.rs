//! The same bits for any number of processes.

mod flow;
mod periodic;

use std::thread;

use super::Cluster;
use super::ranks::Ranks as _;
use super::threads::Threads;
use crate::checkpoint::Checkpoint;
use crate::generate::Benchmark;
use crate::{
    Backend, ContactLaw, Cuboid, Error, Gauge, Integrator, Material, Motion, MotionTerm, Options, Pair, Polygon, Scene,
    Simulation, Sphere, Spring,
};

/// Pseudo-random numbers from 0 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }
}

fn options(integrator: Integrator) -> Options {
    options_on(Backend::Cpu, integrator)
}

fn options_on(backend: Backend, integrator: Integrator) -> Options {
    Options::new().backend(backend).integrator(integrator)
}

/// A scene without spheres, with a material that has friction and rolling friction.
fn sandbox(law: ContactLaw) -> (Scene, crate::MaterialId) {
    let mut scene = Scene::new();
    scene.settings.contact_law = law;
    scene.settings.collisions = false;
    scene.settings.gravity = 9.81;
    let sand = scene.add_material(Material::new("sand").density(2500.0).young(1e6).poisson(0.25)).unwrap();
    let pair = Pair::default().restitution(0.4).friction(0.5).rolling_friction(0.2);
    scene.set_pair(sand, sand, if law == ContactLaw::Linear { pair.stiffness(2e4) } else { pair }).unwrap();
    (scene, sand)
}

/// A column of grains on a floor, which collapses. The order of the grains has nothing to do with their places.
fn column(law: ContactLaw, radius: impl Fn(&mut Numbers) -> f32) -> Scene {
    let (mut scene, sand) = sandbox(law);
    scene.add_box(Cuboid::between([-9.0, -1.0, -9.0], [9.0, 0.0, 9.0]).material(sand)).unwrap();
    let mut numbers = Numbers(7);
    for k in 0..240_u32 {
        let k = (k * 77) % 240;
        let [x, y, z] = [k % 5, k / 30, k / 5 % 6].map(|n| n as f32);
        let radius = radius(&mut numbers);
        let place = [0.21 * x, 0.11 + 0.2 * y, 0.21 * z].map(|at| at + 0.01 * numbers.next());
        scene.add_sphere(Sphere::new(place, radius).mass(10.0 * radius).material(sand)).unwrap();
    }
    // A fixed sphere in the middle of the order of addition has effects on all processes.
    scene.add_sphere(Sphere::new([1.6, 0.2, 0.5], 0.3).fixed().material(sand)).unwrap();
    scene.add_sphere(Sphere::new([-0.4, 0.1, 0.5], 0.1).velocity([3.0, 0.0, 0.0]).material(sand)).unwrap();
    scene
}

/// The state after `steps` steps of one plain simulation.
fn alone(checkpoint: &Checkpoint, steps: u64, dt: f32) -> Checkpoint {
    let mut simulation = Simulation::resume(checkpoint.clone()).unwrap();
    simulation.run(steps, dt).unwrap();
    simulation.checkpoint().unwrap()
}

/// The states that the processes gather after `steps` steps, and how often spheres were divided.
fn shared(checkpoint: &Checkpoint, size: usize, steps: u64, dt: f32) -> Vec<(Checkpoint, u64)> {
    let run = |ranks: Threads| {
        #[cfg(feature = "gpu")]
        let _shared = crate::exec::gpu::SharedDevice::new();
        let mut simulation = Simulation::resume(checkpoint.clone()).unwrap();
        let mut cluster = Cluster::new(&mut simulation, ranks).unwrap();
        // Where a caller divides steps into calls does not matter.
        cluster.run(steps / 3, dt).unwrap();
        cluster.run(steps - steps / 3, dt).unwrap();
        let report = cluster.report().unwrap();
        let state = cluster.gather().unwrap().clone();
        assert_eq!(report, state.report);
        // The state fits into a simulation again, in the order that it would have there.
        simulation.restore(&state).unwrap();
        (simulation.checkpoint().unwrap(), cluster.divisions())
    };
    thread::scope(|scope| {
        let threads: Vec<_> = Threads::of(size).into_iter().map(|ranks| scope.spawn(|| run(ranks))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

/// Checks that two states have the same bits.
fn assert_same(one: &Checkpoint, other: &Checkpoint, what: &str) {
    let bits = |state: &Checkpoint| -> Vec<Vec<u32>> {
        let spheres = state.scene.spheres().iter();
        spheres
            .map(|s| {
                let vectors = [s.position, s.position_low, s.velocity, s.angular_momentum];
                let numbers = vectors.iter().flat_map(|v| v.to_array()).chain(s.orientation.to_array());
                numbers.map(f32::to_bits).collect()
            })
            .collect()
    };
    let (first, second) = (bits(one), bits(other));
    let differing: Vec<usize> = (0..first.len()).filter(|k| first[*k] != second[*k]).collect();
    assert!(differing.is_empty(), "{what}: {} spheres differ, the first is {:?}", differing.len(), differing.first());
    assert!(one.springs == other.springs, "{what}: springs");
    assert_eq!(one.rates, other.rates, "{what}: rates");
    assert_eq!(one.residues, other.residues, "{what}: residues");
    assert_eq!(one.scene.shear(), other.scene.shear(), "{what}");
    let counts = |state: &Checkpoint| {
        let report = state.report;
        (report.steps, report.time.to_bits(), report.contacts, report.max_overlap.to_bits())
    };
    assert_eq!(counts(one), counts(other), "{what}");
}

/// Checks that 1 to 4 processes get the bits of one plain simulation. Returns how often 4 processes divided the spheres.
fn check(scene: Scene, integrator: Integrator, steps: u64, dt: f32) -> (Checkpoint, u64) {
    check_on(Backend::Cpu, &[1, 2, 3, 4], scene, integrator, steps, dt)
}

/// Checks that these numbers of processes get the bits of one plain simulation on a backend. Returns the state, and how often the last
/// number of processes divided the spheres.
fn check_on(backend: Backend, sizes: &[usize], scene: Scene, integrator: Integrator, steps: u64, dt: f32) -> (Checkpoint, u64) {
    let start = Simulation::with_options(scene, options_on(backend, integrator)).unwrap().checkpoint().unwrap();
    let expected = alone(&start, steps, dt);
    let mut divisions = 0;
    for size in sizes.iter().copied() {
        for (rank, (state, divided)) in shared(&start, size, steps, dt).into_iter().enumerate() {
            assert_same(&state, &expected, &format!("process {rank} of {size}"));
            divisions = divided;
        }
    }
    (expected, divisions)
}

#[test]
fn a_column_collapses_to_the_same_bits() {
    for integrator in [Integrator::VelocityVerlet, Integrator::SymplecticEuler] {
        let (state, divisions) = check(column(ContactLaw::HertzMindlin, |_| 0.1), integrator, 800, 0.00045);
        assert!(divisions > 2, "{divisions}");
        assert!(state.springs.len() > 200, "{}", state.springs.len());
    }
}

#[test]
fn sizes_of_one_to_five_cross_faces_to_the_same_bits() {
    let radius = |numbers: &mut Numbers| if numbers.next() < 0.1 { 0.2 } else { 0.04 + 0.04 * numbers.next() };
    let (state, divisions) = check(column(ContactLaw::Linear, radius), Integrator::VelocityVerlet, 600, 0.0005);
    assert!(divisions > 2 && state.springs.len() > 20, "{divisions}, {}", state.springs.len());
}

/// A floor that oscillates, a bar that turns among the grains, a belt and a roller.
fn machine() -> Scene {
    let mut scene = column(ContactLaw::HertzMindlin, |_| 0.1);
    let floor = scene.box_ids().next().unwrap();
    let sand = scene.boxes()[0].material.unwrap();
    let shake = Motion::new("shake", MotionTerm::oscillation([0.0, 0.05, 0.02], 3.0));
    let shake = scene.add_motion(shake).unwrap();
    scene.set_motion(floor, Some(shake)).unwrap();
    let turn = scene.add_motion(Motion::new("turn", MotionTerm::turn(4.0, [0.0, 1.0, 0.0], [1.0, 0.0, 0.5]))).unwrap();
    let bar = scene.add_box(Cuboid::between([0.9, 0.3, -0.3], [1.1, 0.5, 1.3]).material(sand)).unwrap();
    scene.set_motion(bar, Some(turn)).unwrap();
    let belt = scene.add_box(Cuboid::between([-0.9, -0.2, -9.0], [-0.3, 0.05, 9.0]).material(sand)).unwrap();
    scene.set_surface_velocity(belt, [-1.0, 0.0, 0.3]).unwrap();
    let roller = Sphere::new([0.5, 0.1, 1.4], 0.2).fixed().material(sand);
    let inertia = roller.inertia();
    scene.add_sphere(roller.angular_momentum([8.0 * inertia, 0.0, 0.0])).unwrap();
    scene
}

#[test]
fn grains_among_moving_walls_have_the_same_bits() {
    for integrator in [Integrator::VelocityVerlet, Integrator::SymplecticEuler] {
        let (state, divisions) = check(machine(), integrator, 600, 0.0005);
        assert!(divisions > 3 && state.springs.len() > 100, "{divisions}, {}", state.springs.len());
    }
}

/// A gas with the law of the thesis in a box. Spheres fly from slab to slab, and pass edges and corners.
fn gas() -> Scene {
    let mut scene = Scene::new();
    scene.settings.collisions = false;
    scene.settings.gravity = 0.0;
    for (low, high) in [([-1.0, -1.0, -1.0], [5.0, 0.0, 4.0]), ([-1.0, 3.0, -1.0], [5.0, 4.0, 4.0])] {
        scene.add_box(Cuboid::between(low, high)).unwrap();
    }
    for x in [-1.0, 4.0] {
        scene.add_box(Cuboid::between([x, -1.0, -1.0], [x + 1.0, 4.0, 4.0])).unwrap();
    }
    for z in [-1.0, 3.0] {
        scene.add_box(Cuboid::between([-1.0, -1.0, z], [5.0, 4.0, z + 1.0])).unwrap();
    }
    let mut numbers = Numbers(3);
    for k in 0..200_u32 {
        let place = [k % 8, k / 8 % 5, k / 40].map(|n| 0.3 + 0.45 * n as f32);
        let velocity = [0; 3].map(|_| 4.0 * (numbers.next() - 0.5));
        scene.add_sphere(Sphere::new(place, 0.12 + 0.12 * numbers.next()).velocity(velocity)).unwrap();
    }
    scene
}

#[test]
fn a_gas_moves_to_the_same_bits() {
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let (state, divisions) = check(gas(), integrator, 500, 0.002);
        assert!(divisions > 5 && state.report.contacts > 10, "{divisions}, {:?}", state.report);
    }
}

/// The same on a GPU.
#[cfg(feature = "gpu")]
#[test]
fn processes_on_a_gpu_have_the_same_bits() {
    let _shared = crate::exec::gpu::SharedDevice::new();
    let (state, divisions) = check_on(Backend::Gpu, &[1, 3], machine(), Integrator::VelocityVerlet, 90, 0.00049);
    assert!(divisions > 0 && state.springs.len() > 100, "{divisions}, {}", state.springs.len());
    let (state, divisions) = check_on(Backend::Gpu, &[2], gas(), Integrator::SymplecticEuler, 60, 0.002);
    assert!(divisions > 1 && state.report.contacts > 10, "{divisions}, {:?}", state.report);
}

/// Three spheres cannot be shared by four processes, and on a triangle they meet at one place.
#[test]
fn a_process_may_have_no_spheres() {
    let (mut scene, sand) = sandbox(ContactLaw::HertzMindlin);
    let corners = [[-5.0, 0.0, -5.0], [5.0, 0.0, -5.0], [0.0, 0.0, 9.0]];
    scene.add_polygon(Polygon::triangle(corners[0], corners[1], corners[2]).material(sand)).unwrap();
    for (x, velocity) in [(-1.0, 2.0), (0.0, 0.0), (1.0, -2.0)] {
        let sphere = Sphere::new([x, 0.2, 0.1 * x], 0.2).velocity([velocity, 0.0, 0.0]).material(sand);
        scene.add_sphere(sphere).unwrap();
    }
    let (state, _) = check(scene, Integrator::VelocityVerlet, 900, 0.001);
    assert!(!state.springs.is_empty());
}

#[test]
fn a_checkpoint_goes_on_with_another_number_of_processes() {
    let scene = column(ContactLaw::HertzMindlin, |_| 0.1);
    let start = Simulation::with_options(scene, options(Integrator::VelocityVerlet)).unwrap().checkpoint().unwrap();
    let middle = shared(&start, 3, 200, 0.00045).remove(1).0;
    // A checkpoint is the same file, whoever writes it.
    for size in [1, 2, 4] {
        let other = shared(&start, size, 200, 0.00045).remove(0).0;
        assert!(middle.to_bytes() == other.to_bytes(), "{size} processes");
    }
    let middle = Checkpoint::from_bytes(&middle.to_bytes(), "middle").unwrap();
    let expected = alone(&start, 400, 0.00045);
    for size in [1, 2, 4] {
        let end = shared(&middle, size, 200, 0.00045).remove(0).0;
        let named = Checkpoint::from_bytes(&end.to_bytes(), "end").unwrap();
        let wanted = Checkpoint::from_bytes(&expected.to_bytes(), "expected").unwrap();
        // Handles differ after a file, so both come from files.
        assert_eq!(named.scene.to_text(), wanted.scene.to_text());
        assert_eq!(spring_bits(&named), spring_bits(&wanted));
    }
}

/// Loads on walls and flows through planes follow from the state and from what was in front of the planes at the start.
#[test]
fn gauges_measure_the_same() {
    for (mut scene, wall) in [(machine(), Some("shake")), (periodic::chute(2.0), None)] {
        scene.add_gauge(Gauge::plane("flow", [1.0, 0.0, 0.0], [1.0, -0.1, 0.0])).unwrap();
        wall.into_iter().for_each(|wall| scene.add_gauge(Gauge::wall("load", wall)).unwrap());
        let measured = |state: &Checkpoint| Simulation::resume(state.clone()).unwrap().gauges().unwrap();
        let start = Simulation::with_options(scene, options(Integrator::VelocityVerlet)).unwrap().checkpoint().unwrap();
        let expected = measured(&alone(&start, 300, 0.0005));
        assert_ne!(expected, measured(&start));
        let middle = shared(&start, 2, 100, 0.0005).remove(1).0;
        assert_eq!(measured(&shared(&middle, 3, 200, 0.0005).remove(0).0), expected);
    }
}

fn spring_bits(state: &Checkpoint) -> Vec<([Option<u32>; 2], [u32; 7])> {
    let number = |id| state.scene.number_of(id);
    let springs = state.springs.iter().map(|spring| {
        let [x, y, z] = spring.shift.to_array();
        let [u, v, w] = spring.moment.to_array();
        ([number(spring.a), number(spring.b)], [x, y, z, spring.overlap, u, v, w].map(f32::to_bits))
    });
    springs.collect()
}

#[test]
fn what_cannot_be_shared_is_refused_by_name() {
    let refused = |scene: Scene, options: Options| {
        let mut simulation = Simulation::with_options(scene, options.backend(Backend::Cpu)).unwrap();
        match Cluster::new(&mut simulation, Threads::of(1).remove(0)) {
            Err(Error::Invalid { field: "MPI", value, .. }) => value,
            other => panic!("{other:?}"),
        }
    };
    let euler = || options(Integrator::SymplecticEuler);
    let rods = Benchmark::Mixed.generate(60, 1).unwrap();
    assert!(["a scene with rods", "a scene with capsules"].contains(&refused(rods, euler()).as_str()));
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([0.0; 3], 1.0)).unwrap();
    assert!(refused(scene.clone(), euler()).starts_with("a scene with impulses of collisions"));
    scene.settings.contact_law = ContactLaw::Rigid;
    assert_eq!(refused(scene.clone(), euler()), "the contact law rigid");
    scene.settings.contact_law = ContactLaw::Thesis;
    scene.settings.collisions = false;
    assert_eq!(refused(scene.clone(), options(Integrator::Rk4)), "the integrator rk4");
    let ends = [1.0, 2.0].map(|x| scene.add_sphere(Sphere::new([x, 0.0, 0.0], 0.1)).unwrap());
    scene.add_spring(Spring::new(ends[0], ends[1], 1.0, 1.0)).unwrap();
    assert_eq!(refused(scene, euler()), "a scene with springs");
}

/// All processes learn of the failure of one of them.
#[test]
fn a_failure_has_the_same_message_on_all_processes() {
    let (mut scene, sand) = sandbox(ContactLaw::HertzMindlin);
    for k in 0..8_u8 {
        let speed = if k == 5 { 3e38 } else { 0.0 };
        let sphere = Sphere::new([f32::from(k), 0.0, 0.0], 0.1).material(sand).velocity([0.0, speed, 0.0]);
        scene.add_sphere(sphere).unwrap();
    }
    let start = Simulation::with_options(scene, options(Integrator::SymplecticEuler)).unwrap().checkpoint().unwrap();
    let run = |ranks: Threads| {
        let rank = ranks.rank();
        let mut cluster = Cluster::new(&mut Simulation::resume(start.clone()).unwrap(), ranks).unwrap();
        let error = cluster.run(10, 100.0).unwrap_err();
        assert!(matches!(error, Error::Cluster(_)), "process {rank}: {error:?}");
        error.to_string()
    };
    let messages: Vec<String> = thread::scope(|scope| {
        let threads: Vec<_> = Threads::of(3).into_iter().map(|ranks| scope.spawn(|| run(ranks))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert!(messages.iter().all(|message| *message == messages[0]), "{messages:?}");
    assert!(messages[0].contains("sphere number 5"), "{messages:?}");
}

#[test]
fn processes_with_different_scenes_are_refused() {
    let (mut scene, sand) = sandbox(ContactLaw::HertzMindlin);
    scene.add_sphere(Sphere::new([0.0; 3], 0.1).material(sand)).unwrap();
    let run = |ranks: Threads, mut scene: Scene| {
        scene.settings.gravity += ranks.rank() as f32;
        let mut simulation = Simulation::with_options(scene, options(Integrator::SymplecticEuler)).unwrap();
        Cluster::new(&mut simulation, ranks).unwrap().run(1, 0.001).unwrap_err().to_string()
    };
    let scene = &scene;
    thread::scope(|scope| {
        let threads: Vec<_> = Threads::of(2).into_iter().map(|ranks| scope.spawn(move || run(ranks, scene.clone()))).collect();
        for thread in threads {
            assert!(thread.join().unwrap().starts_with("the processes have different scenes"));
        }
    });
}
