//! Worlds in which everything rests sleep. They are reported, and stand still on request.

use rockfall::generate::creature;
use rockfall::glam::Vec3;
use rockfall::{Backend, Integrator, Options, Scene, Simulation, Sleep, Sphere, Spring, Tether, Worlds};

use crate::common::*;

const DT: f32 = 0.005;
/// A world sleeps after so many steps.
const CALM: u32 = 12;
const SPEED: f32 = 0.05;

fn ground() -> Scene {
    let mut scene = creature(1, 0).expect("a creature");
    let id = scene.sphere_ids().next().expect("a sphere");
    scene.remove_sphere(id).expect("a sphere");
    scene
}

/// A ball that sinks into the ground until it carries it.
fn ball() -> Scene {
    let mut scene = ground();
    scene.add_sphere(Sphere::new([0.0, 0.1, 0.0], 0.1)).expect("a sphere");
    scene
}

/// A ball that spins in place, away from the ground.
fn spinning() -> Scene {
    let mut scene = weightless();
    scene.settings.collisions = false;
    scene.add_sphere(Sphere::new([0.0, 5.0, 0.0], 0.1).angular_momentum([0.0, 0.01, 0.0])).expect("a sphere");
    scene
}

/// A ball on a spring, which rests for less than [`CALM`] steps at the ends of its way.
fn swinging() -> Scene {
    let mut scene = weightless();
    scene.settings.collisions = false;
    let id = scene.add_sphere(Sphere::new([0.5, 5.0, 0.0], 0.1)).expect("a sphere");
    scene.add_tether(Tether::new(id, [0.0, 5.0, 0.0], 4.0)).expect("a tether");
    scene
}

fn scenes() -> Vec<Scene> {
    vec![ball(), spinning(), swinging(), creature(4, 1).expect("a creature")]
}

fn worlds(scenes: &[Scene], backend: Backend, skip: bool) -> Worlds {
    let options = Options::new().backend(backend).integrator(Integrator::SymplecticEuler);
    let mut worlds = Worlds::new(scenes.to_vec(), options).expect("worlds");
    worlds.set_sleep(Sleep::new().speed(SPEED).steps(CALM).skip(skip)).expect("a valid criterion");
    worlds
}

/// Steps and whether it sleeps, of each world.
fn reports(worlds: &mut Worlds) -> Vec<(u64, bool)> {
    let count = worlds.len();
    let report = |world: usize| {
        let report = worlds.report(world, None).expect("a report");
        (report.report.steps, report.sleeping)
    };
    (0..count).map(report).collect()
}

/// The step after which the ball of a scene sleeps, found by looking at every state.
fn falls_asleep_at(scene: &Scene, backend: Backend) -> u64 {
    let options = Options::new().backend(backend).integrator(Integrator::SymplecticEuler);
    let mut simulation = Simulation::with_options(scene.clone(), options).expect("it opens");
    let mut calm = 0;
    while calm < CALM {
        simulation.run(1, DT).expect("a step");
        let state = simulation.spheres().expect("states")[0];
        calm = if state.velocity.length() <= SPEED { calm + 1 } else { 0 };
        assert!(simulation.report().steps < 500, "it never rests");
    }
    simulation.report().steps
}

/// It sleeps from the same step on however steps are divided, and stands still if it is asked to.
fn a_world_at_rest_sleeps(backend: Backend) {
    let scenes = scenes();
    let asleep = falls_asleep_at(&scenes[0], backend);
    assert!(asleep > u64::from(CALM) + 5, "it moves at first, {asleep}");
    let total = asleep + 40;
    for skip in [false, true] {
        for portions in [vec![total], vec![asleep - 1, 1, 40], vec![3, asleep - 3 - 7, 9, 38]] {
            let mut worlds = worlds(&scenes, backend, skip);
            let mut done = 0;
            for portion in portions {
                worlds.run(portion, DT).expect("steps");
                done += portion;
                let ball = (if skip { done.min(asleep) } else { done }, done >= asleep);
                assert_eq!(reports(&mut worlds), [ball, (done, false), (done, false), (done, false)], "{skip}");
            }
        }
    }
}

/// By default sleeping worlds advance as simulations of their own, bit for bit.
fn sleeping_worlds_advance_by_default(backend: Backend) {
    let scenes = [ball(), swinging()];
    let steps = 200;
    let mut worlds = worlds(&scenes, backend, false);
    worlds.run(steps, DT).expect("steps");
    assert_eq!(reports(&mut worlds), [(steps, true), (steps, false)]);
    for (world, scene) in scenes.iter().enumerate() {
        let options = worlds.options().clone();
        let mut simulation = Simulation::with_options(scene.clone(), options).expect("it opens");
        simulation.run(steps, DT).expect("steps");
        assert_eq!(bits(&worlds.states(world).expect("states")), bits(&simulation.spheres().expect("states")));
    }
    let default = Worlds::new([ball()], Options::new().backend(Backend::Cpu)).expect("worlds").sleep();
    assert_eq!((default.speed, default.steps, default.skip), (0.01, 100, false));
}

/// A ball that a tether tears away. It stops in the first step, so it is at rest at the end of this step.
fn torn() -> Scene {
    let mut scene = weightless();
    scene.settings.collisions = false;
    let id = scene.add_sphere(Sphere::new([0.0, 5.0, 0.0], 0.1)).expect("a sphere");
    scene.add_tether(Tether::new(id, [9.0, 9.0, 0.0], 3e38)).expect("a tether");
    scene
}

/// A world that would fall asleep in the step in which a body stops being finite is stopped and reported.
fn a_world_that_is_not_finite_does_not_sleep(backend: Backend) {
    let mut worlds = worlds(&[torn(), ball()], backend, true);
    worlds.set_sleep(Sleep::new().speed(SPEED).steps(1).skip(true)).expect("a valid criterion");
    worlds.run(5, DT).expect("steps");
    let report = worlds.report(0, None).expect("a report");
    assert!(report.stopped.is_some() && !report.sleeping, "{report:?}");
    assert!(worlds.report(1, None).expect("a report").stopped.is_none());
}

/// Two balls on a spring at its rest length.
fn balanced() -> Scene {
    let mut scene = weightless();
    scene.settings.collisions = false;
    let [a, b] = [0.0, 1.0].map(|x| scene.add_sphere(Sphere::new([x, 5.0, 0.0], 0.1)).expect("a sphere"));
    scene.add_spring(Spring::new(a, b, 50.0, 1.0)).expect("a spring");
    scene
}

/// Without springs there are no lengths to write, and the worlds wake up all the same.
fn no_rest_lengths_wake_worlds_up(backend: Backend) {
    let mut scene = balanced();
    let id = scene.spring_ids().next().expect("a spring");
    scene.remove_spring(id).expect("a spring");
    let mut worlds = worlds(&[scene.clone(), scene], backend, true);
    worlds.run(30, DT).expect("steps");
    worlds.set_all_rest_lengths(&[]).expect("no lengths");
    worlds.run(5, DT).expect("steps");
    assert_eq!(reports(&mut worlds), [(u64::from(CALM) + 5, false); 2]);
}

/// New rest lengths alone wake a world up, whether its state was read back in between or not.
fn new_rest_lengths_wake_a_world_up(backend: Backend) {
    for (is_read, is_alone) in [(false, false), (true, false), (false, true), (true, true)] {
        let mut worlds = worlds(&[balanced(), balanced()], backend, true);
        worlds.run(30, DT).expect("steps");
        if is_read {
            let slept = (u64::from(CALM), true);
            assert_eq!(reports(&mut worlds), [slept, slept]);
        }
        if is_alone {
            worlds.set_rest_lengths(1, &[1.5]).expect("a length");
        } else {
            worlds.set_all_rest_lengths(&[1.0, 1.5]).expect("lengths");
        }
        let sleeping: Vec<bool> = reports(&mut worlds).iter().map(|report| report.1).collect();
        assert_eq!(sleeping, [is_alone, false]);
        worlds.run(5, DT).expect("steps");
        let steps = u64::from(CALM) + if is_alone { 0 } else { 5 };
        assert_eq!(reports(&mut worlds), [(steps, is_alone), (u64::from(CALM) + 5, false)], "{is_read} {is_alone}");
        let options = Options::new().backend(backend).integrator(Integrator::SymplecticEuler);
        let mut simulation = Simulation::with_options(balanced(), options).expect("it opens");
        let id = simulation.scene().spring_ids().next().expect("a spring");
        simulation.update_spring(id, |spring| spring.length = 1.5).expect("a spring");
        simulation.run(5, DT).expect("steps");
        assert_eq!(bits(&worlds.states(1).expect("states")), bits(&simulation.spheres().expect("states")));
    }
}

/// States, forces and resets wake a world up. What it did before makes no difference.
fn controls_wake_a_world_up(backend: Backend) {
    let mut worlds = worlds(&[ball(), ball(), ball()], backend, true);
    worlds.run(200, DT).expect("steps");
    let asleep = reports(&mut worlds)[0].0;
    assert_eq!(reports(&mut worlds), [(asleep, true); 3]);
    let before = worlds.states(1).expect("states");
    worlds.set_forces(0, &[Vec3::new(3.0, 0.0, 0.0)]).expect("forces");
    worlds.set_states(1, &before).expect("states");
    assert_eq!(reports(&mut worlds), [(asleep, false), (asleep, false), (asleep, true)]);
    worlds.run(5, DT).expect("steps");
    assert_eq!(reports(&mut worlds), [(asleep + 5, false), (asleep + 5, false), (asleep, true)]);
    assert!(worlds.states(0).expect("states")[0].velocity.x > 0.05);
    // The third still stands where the second stood.
    assert_eq!(bits(&worlds.states(2).expect("states")), bits(&before));
    worlds.reset(&[2]).expect("a reset");
    assert_eq!(reports(&mut worlds)[2], (0, false));
    worlds.run(200, DT).expect("steps");
    // The force drags the first over the ground.
    assert_eq!(reports(&mut worlds)[1..], [(asleep + u64::from(CALM), true), (asleep, true)]);
    worlds.replace(2, ball()).expect("a world");
    assert_eq!(reports(&mut worlds)[2], (0, false));
}

fn files_keep_what_sleeps(backend: Backend) {
    let name = format!("worlds-sleep-{backend}-{}.ckpt", std::process::id());
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let asleep = falls_asleep_at(&ball(), backend);
    let mut whole = worlds(&[ball(), swinging()], backend, true);
    whole.run(asleep - 4, DT).expect("steps");
    whole.save_checkpoint(&path).expect("a file");
    let mut resumed = Worlds::resume(&path, None).expect("worlds");
    assert_eq!(resumed.sleep(), whole.sleep());
    for both in [&mut whole, &mut resumed] {
        both.run(30, DT).expect("steps");
        assert_eq!(reports(both), [(asleep, true), (asleep + 26, false)]);
    }
    assert_eq!(bits(&resumed.states(0).expect("states")), bits(&whole.states(0).expect("states")));
}

both_in_turn!(
    a_world_at_rest_sleeps,
    sleeping_worlds_advance_by_default,
    a_world_that_is_not_finite_does_not_sleep,
    controls_wake_a_world_up,
    new_rest_lengths_wake_a_world_up,
    no_rest_lengths_wake_worlds_up,
    files_keep_what_sleeps,
);

/// Muscles move sooner or later, however slow everything is now.
#[test]
fn worlds_with_muscles_never_sleep() {
    let mut worlds = worlds(&[creature(4, 1).expect("a creature"), spinning(), Scene::new()], Backend::Cpu, true);
    worlds.set_sleep(Sleep::new().speed(1e3).steps(5).skip(true)).expect("a valid criterion");
    worlds.run(40, DT).expect("steps");
    assert_eq!(reports(&mut worlds), [(40, false), (5, true), (40, false)]);
}

#[test]
fn wrong_criteria_are_errors() {
    let mut worlds = worlds(&[ball()], Backend::Cpu, false);
    for (sleep, field) in [
        (Sleep::new().speed(-1.0), "sleep.speed"),
        (Sleep::new().speed(f32::NAN), "sleep.speed"),
        (Sleep::new().steps(0), "sleep.steps"),
    ] {
        let error = worlds.set_sleep(sleep).expect_err("it is wrong").to_string();
        assert!(error.contains(field), "{error}");
    }
    assert_eq!(worlds.sleep().steps, CALM);
}
