//! Small scenes without rods run whole steps in one dispatch, while profiles run the stages one by one. Both give
//! bitwise identical steps.

#![cfg(feature = "gpu")]

mod common;

use std::cell::Cell;

use common::mixed::{Run, assert_bitwise_identical};
use common::{floor_box, spheres, weightless, with};
use rockfall::generate::Benchmark;
use rockfall::glam::Vec3;
use rockfall::{
    Backend, BroadPhase, Error, Integrator, Muscle, Options, Polygon, Scene, Simulation, Sphere, SphereId, Spring, Tether,
};

/// Spheres that fall on each other, on a box and on a polygon, some with springs, tethers and forces. There are more of
/// them than a workgroup of software Vulkan has threads, and not a multiple of that number.
fn crowd(balls: usize) -> Scene {
    let mut scene = with(|settings| settings.gravity = 10.0);
    floor_box(&mut scene);
    scene.add_polygon(Polygon::new([-2.0, 0.0, -2.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0])).expect("a valid polygon");
    let ball = |ball: usize| {
        let place = Vec3::new((ball % 6) as f32 * 0.5, (ball / 36) as f32 * 0.48 + 0.25, (ball / 6 % 6) as f32 * 0.5);
        let jitter = 0.05 * Vec3::new((ball as f32).sin(), 0.0, (ball as f32 * 1.7).cos());
        let mut sphere = Sphere::new(place + jitter - Vec3::new(1.5, 0.0, 1.5), 0.24 + 0.03 * (ball as f32 * 0.9).sin());
        sphere.fixed = ball == 40;
        sphere.mass(1.0 + (ball % 3) as f32).velocity([0.0, -2.0, 0.3])
    };
    let ids: Vec<SphereId> = (0..balls).map(|place| scene.add_sphere(ball(place)).expect("a valid sphere")).collect();
    for pair in ids.chunks_exact(2).step_by(9) {
        scene.add_spring(Spring::new(pair[0], pair[1], 200.0, 0.5).damping(1.0)).expect("a valid spring");
        scene.add_tether(Tether::new(pair[1], [0.0, 3.0, 0.0], 5.0)).expect("a valid tether");
    }
    scene
}

/// The same side by side on the floor, so that no two collisions share a body: `run_steps` does not solve such
/// collisions.
fn side_by_side(balls: usize) -> Scene {
    let mut scene = with(|settings| settings.gravity = 10.0);
    scene.add_box(rockfall::Cuboid::between([-20.0, -1.0, -20.0], [20.0, 0.0, 20.0])).expect("a valid box");
    let ball = |ball: usize| {
        let place = Vec3::new((ball % 18) as f32 - 9.0, 0.22 + 0.01 * (ball % 7) as f32, (ball / 18) as f32 - 9.0);
        let mut sphere = Sphere::new(place, 0.2 + 0.03 * (ball as f32 * 0.9).sin());
        sphere.fixed = ball == 40;
        sphere.mass(1.0 + (ball % 3) as f32).velocity([0.02, -2.0, 0.01])
    };
    let ids: Vec<SphereId> = (0..balls).map(|place| scene.add_sphere(ball(place)).expect("a valid sphere")).collect();
    for pair in ids.chunks_exact(2).step_by(9) {
        scene.add_spring(Spring::new(pair[0], pair[1], 20.0, 1.0).damping(1.0)).expect("a valid spring");
        // Vertical, because otherwise it would pull the balls together.
        let above = Vec3::new(0.0, 3.0, 0.0) + scene.sphere(pair[1]).expect("a ball").position;
        scene.add_tether(Tether::new(pair[1], above, 0.5)).expect("a valid tether");
    }
    scene
}

fn simulation(scene: Scene, options: Options) -> Simulation {
    Simulation::with_options(scene, options.backend(Backend::Gpu).join_steps(true)).expect("the simulation opens")
}

fn dispatches(simulation: &Simulation) -> u64 {
    simulation.gpu_view().expect("the GPU backend").dispatches()
}

/// Runs steps of 10 ms, joined in few dispatches or stage by stage. Returns the number of dispatches.
fn run(simulation: &mut Simulation, steps: u64, joined: bool) -> u64 {
    let before = dispatches(simulation);
    if joined {
        simulation.run(steps, 0.01).expect("steps");
    } else {
        simulation.profile(steps, 0.01).expect("steps, timed");
    }
    dispatches(simulation) - before
}

/// Does the same with a scene in both modes and asserts that the results are identical.
#[track_caller]
fn run_both_modes(scene: &Scene, options: &Options, act: impl Fn(&mut Simulation, bool)) -> [Run; 2] {
    let runs = [true, false].map(|joined| {
        let mut simulation = simulation(scene.clone(), options.clone());
        act(&mut simulation, joined);
        Run::of(&mut simulation)
    });
    let counts = |run: &Run| (run.report.steps, run.report.collisions, run.report.non_finite);
    assert_eq!(counts(&runs[0]), counts(&runs[1]));
    assert_bitwise_identical(&runs[0], &runs[1]);
    runs
}

/// The time of muscles goes on within a dispatch.
#[test]
fn muscles_in_one_dispatch_equal_those_of_the_stages() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let mut scene = side_by_side(60);
        let springs: Vec<_> = scene.spring_ids().collect();
        for (id, number) in springs.into_iter().zip(0_u8..) {
            let muscle = Muscle::new(0.1, 3.0, 0.3 * f32::from(number));
            scene.update_spring(id, |spring| spring.muscle = (number != 1).then_some(muscle)).expect("a valid muscle");
        }
        let options = Options::new().integrator(integrator);
        let [joined, _] = run_both_modes(&scene, &options, |simulation, joined| {
            run(simulation, 20, joined);
            run(simulation, 12, joined);
        });
        let mut still = scene.clone();
        let springs: Vec<_> = still.spring_ids().collect();
        springs.into_iter().for_each(|id| still.update_spring(id, |spring| spring.muscle = None).expect("a valid spring"));
        let mut simulation = simulation(still, options);
        run(&mut simulation, 32, true);
        let moved = Run::of(&mut simulation).spheres[0].position.distance(joined.spheres[0].position);
        assert!(moved > 1e-3, "muscles move spheres by {moved}");
    }
}

#[test]
fn steps_in_one_dispatch_equal_those_of_the_stages() {
    for broad_phase in [BroadPhase::BruteForce, BroadPhase::Grid] {
        for (collisions, integrator) in [(true, Integrator::Rk4), (false, Integrator::Rk4), (true, Integrator::SymplecticEuler)]
        {
            let mut scene = side_by_side(300);
            scene.settings.collisions = collisions;
            let options = Options::new().broad_phase(broad_phase).integrator(integrator);
            let dispatches = [Cell::new(0), Cell::new(0)];
            let [joined, _] = run_both_modes(&scene, &options, |simulation, joined| {
                // Until the lists fit.
                run(simulation, 8, joined);
                dispatches[usize::from(joined)].set(run(simulation, 32, joined));
            });
            // Lists take up to four dispatches, and the joined stages replace five to eight.
            let [apart, together] = dispatches.map(Cell::into_inner);
            assert!(together > 0 && 5 * apart > 8 * together, "{apart} dispatches and {together}");
            assert_eq!(joined.report.total_collisions > 300, collisions, "{:?}", joined.report);
        }
    }
}

/// Collisions that share bodies are computed by the stages, until there have been none for a while.
#[test]
fn the_stages_compute_clusters() {
    let mut scene = side_by_side(60);
    // Only these three in a row collide at the same time, in the air.
    for (x, speed) in [(0.0, 1.0), (0.41, 0.0), (0.82, -1.0)] {
        scene.add_sphere(Sphere::new([x, 30.0, 0.0], 0.2).velocity([speed, 0.0, 0.0])).expect("a valid sphere");
    }
    let dispatches = Cell::new([0; 2]);
    let [joined, _] = run_both_modes(&scene, &Options::new().broad_phase(BroadPhase::Grid), |simulation, joined| {
        let first = run(simulation, 20, joined);
        // 128 steps without clusters.
        run(simulation, 160, joined);
        let later = run(simulation, 20, joined);
        if joined {
            dispatches.set([first, later]);
        }
    });
    let [first, later] = dispatches.get();
    assert!(first > 2 * later, "{first} dispatches and {later}");
    assert!(joined.report.total_collisions > 60 && joined.report.replays > 0, "{:?}", joined.report);
}

/// By default a GPU joins steps. A software device does not, because one workgroup is one thread there.
#[test]
fn by_default_only_hardware_joins_steps() {
    let plain = Options::new().backend(Backend::Gpu);
    let options = [plain.clone(), plain.clone().join_steps(true), plain.join_steps(false)];
    let mut software = false;
    let [default, joined, apart] = options.map(|options| {
        let mut simulation = Simulation::with_options(side_by_side(300), options).expect("the simulation opens");
        software = simulation.gpu_view().expect("the GPU backend").gpu().is_software();
        run(&mut simulation, 8, true);
        run(&mut simulation, 32, true)
    });
    // When a body that leaves its AABB is detected depends on the order of checks, and so does how often lists are
    // rebuilt.
    let is_joined = |dispatches| 8 * dispatches < 5 * apart;
    assert!(is_joined(joined), "{joined} dispatches and {apart}");
    assert_eq!(is_joined(default), !software, "{default} dispatches, {joined} joined, {apart} not");
}

/// Many spheres at once, of which some have several collisions and most have none, so the threads reach the barriers by
/// different paths.
#[test]
fn threads_with_different_amounts_of_work_stay_in_step() {
    for broad_phase in [BroadPhase::BruteForce, BroadPhase::Grid] {
        let scene = Benchmark::Thesis.generate(1_000, 0).expect("a scene");
        let [joined, _] = run_both_modes(&scene, &Options::new().broad_phase(broad_phase), |simulation, joined| {
            run(simulation, 40, joined);
        });
        assert!(joined.report.total_collisions > 300, "{:?}", joined.report);
    }
}

/// A step is rejected when lists do not fit or when a ball leaves its AABB. The later steps of the dispatch are then
/// skipped.
#[test]
fn rejected_steps_are_repeated() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let options = Options::new().integrator(integrator).pair_capacity(1);
        let [joined, apart] = run_both_modes(&crowd(300), &options, |simulation, joined| {
            run(simulation, 20, joined);
        });
        assert!(joined.report.replays > 0 && apart.report.replays > 0);
    }

    // Arrives after 6 s, when lists are rebuilt in every eighth step.
    let mut scene = weightless();
    for k in 0..60 {
        let place = Vec3::new((k % 4) as f32, (k / 16) as f32, (k / 4 % 4) as f32);
        scene.add_sphere(Sphere::new(place, 0.499)).expect("a valid sphere");
    }
    scene.add_sphere(Sphere::new([-47.4, 1.1, 0.9], 0.5).mass(5.0).velocity([8.0, 0.0, 0.0])).expect("a valid sphere");
    let [joined, apart] = run_both_modes(&scene, &Options::new().broad_phase(BroadPhase::Grid), |simulation, joined| {
        run(simulation, 400, joined);
        let dispatches = run(simulation, 32, joined);
        // Seven dispatches for lists, one for the eight steps between two rebuilds, and one that starts the portion.
        assert_eq!(dispatches <= 33, joined, "{dispatches} in 32 steps");
        run(simulation, 184, joined);
    });
    for run in [joined, apart] {
        assert!(run.report.replays > 0 && run.report.total_collisions > 10, "{:?}", run.report);
    }
}

/// The acceleration exceeds the range of f32. The ball is stopped and reported, and later steps run only with
/// `keep_going`.
#[test]
fn non_finite_bodies_are_reported_as_by_the_stages() {
    let scene = |force: f32| {
        let mut scene = crowd(40);
        scene.add_sphere(Sphere::new([0.0, 9.0, 0.0], 0.2).mass(1e-3).force([force, 0.0, 0.0])).expect("a valid sphere");
        scene
    };
    let [joined, _] = run_both_modes(&scene(3e38), &Options::new().keep_going(true), |simulation, joined| {
        run(simulation, 10, joined);
    });
    assert!(joined.report.non_finite > 0, "{:?}", joined.report);
    let reports = [true, false].map(|joined| {
        let mut simulation = simulation(scene(3e38), Options::new());
        let error = if joined { simulation.run(10, 0.01).map(|_| ()) } else { simulation.profile(10, 0.01).map(|_| ()) };
        let Err(Error::NonFinite { sphere, step, stage }) = error else { panic!("{error:?}") };
        (sphere, step, stage, simulation.report().steps, simulation.spheres().expect("spheres are read back"))
    });
    assert_eq!((reports[0].0, reports[0].3), (40, reports[0].1));
    assert_eq!(reports[0], reports[1]);
}

/// Edits between steps, and steps and phases one by one.
#[test]
fn edits_and_single_phases_reach_joined_steps() {
    let act = |simulation: &mut Simulation, joined: bool| {
        let ids: Vec<SphereId> = simulation.scene().sphere_ids().collect();
        run(simulation, 5, joined);
        for id in ids.iter().step_by(7) {
            simulation.apply_impulse(*id, [0.3, 1.0, -0.2]).expect("a sphere");
            simulation.set_force(*id, [0.0, 20.0, 1.0]).expect("a sphere");
        }
        run(simulation, 5, joined);
        for (number, id) in (0_u8..).zip(ids.iter().rev().step_by(9)) {
            simulation.remove_sphere(*id).expect("a sphere");
            simulation.add_sphere(Sphere::new([0.13 * f32::from(number) - 1.0, 6.0, 0.3], 0.2)).expect("a valid sphere");
        }
        simulation.update_aabbs().expect("AABBs");
        simulation.broad_phase().expect("lists");
        simulation.handle_collisions().expect("collisions");
        simulation.update_positions(0.01).expect("positions");
        for _ in 0..3 {
            run(simulation, 1, joined);
        }
    };
    let [joined, _] = run_both_modes(&crowd(150), &Options::new().broad_phase(BroadPhase::Grid), act);
    assert!(joined.report.total_collisions > 100, "{:?}", joined.report);
}

/// The stages run one by one when there are too many spheres, a long list or a rod.
#[test]
fn larger_scenes_and_those_with_rods_run_the_stages() {
    let mut scene = weightless();
    let balls = |from: u16, to: u16| (from..to).map(|k| Sphere::new([f32::from(k % 64), f32::from(k / 64), 0.0], 0.4));
    spheres_of(&mut scene, balls(0, 512));
    let mut simulation = simulation(scene, Options::new().broad_phase(BroadPhase::Grid));
    // Seven for lists, which are also built before the first step, one for collisions and one for positions.
    assert_eq!(run(&mut simulation, 2, true), 7 + 2 * 9);
    let last = simulation.add_sphere(Sphere::new([0.0, 0.0, 9.0], 0.4)).expect("a valid sphere");
    assert!(run(&mut simulation, 2, true) > 7 + 2 * 9, "513 spheres");
    simulation.remove_sphere(last).expect("the last sphere");
    assert!(run(&mut simulation, 2, true) <= 7 + 2 * 9, "512 spheres again");

    let mut scene = crowd(100);
    scene.add_sphere(Sphere::new([0.0, 30.0, 0.0], 20.0)).expect("a valid sphere");
    let mut simulation = self::simulation(scene, Options::new().broad_phase(BroadPhase::Grid));
    assert!(run(&mut simulation, 2, true) > 7 + 2 * 9, "a long list");

    let mut scene = weightless();
    let ends = spheres(&mut scene, [Sphere::new([0.0; 3], 0.2), Sphere::new([1.0, 0.0, 0.0], 0.2)]);
    scene.add_rod(rockfall::Rod::new(ends[0], ends[1], 0.1)).expect("a valid rod");
    scene.settings.collisions = false;
    let mut simulation = self::simulation(scene, Options::new().integrator(Integrator::Rk4));
    assert!(run(&mut simulation, 2, true) > 2 * 8, "a rod");
}

fn spheres_of(scene: &mut Scene, balls: impl Iterator<Item = Sphere>) {
    for ball in balls {
        scene.add_sphere(ball).expect("a valid sphere");
    }
}
