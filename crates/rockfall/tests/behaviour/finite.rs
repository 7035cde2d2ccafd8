//! A body that stops being finite is told, with its index, step and stage; the others stay as they are.

use rockfall::error::BadStage;
use rockfall::{Backend, BroadPhase, Error, Options, Rod, Scene, Simulation, Sphere, SphereId, Tether, TetherId};

use crate::common::*;

/// Three falling spheres; the middle one hangs on a tether, harmless at first.
fn tethered(keep_going: bool, backend: Backend) -> (Simulation, [SphereId; 3], TetherId) {
    let mut scene = Scene::new();
    let ids = spheres(&mut scene, [0.0, 4.0, 8.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.5).velocity([1.0, 2.0, 3.0])));
    let tether = Tether::new(ids[1], [4.0, 50.0, 0.0], 0.0);
    let tether = scene.add_tether(tether).expect("a valid tether");
    let options = Options::new().backend(backend).keep_going(keep_going);
    let simulation = Simulation::with_options(scene, options).expect("the simulation opens");
    (simulation, ids, tether)
}

/// 3e38 * 50 is more than f32 holds.
fn make_it_burst(simulation: &mut Simulation, tether: TetherId) {
    simulation.update_tether(tether, |tether| tether.stiffness = 3e38).expect("a valid tether");
}

/// The first and the last sphere fly on: x0 + v t - t^2/2, after 8 steps of 1/64 s.
fn others_fly_on(simulation: &mut Simulation, ids: [SphereId; 3], t: f64) {
    for (id, x) in [(ids[0], 0.0), (ids[2], 8.0)] {
        let state = simulation.sphere(id).expect("a sphere");
        near(state.position, [x + t, 2.0 * t - 0.5 * t * t, 3.0 * t], 5e-6, "position of another");
        near(state.velocity, [1.0, 2.0 - t, 3.0], 2e-6, "velocity of another");
    }
}

/// Sphere 1, in the third step, in its first force evaluation. It stays where it was, at rest.
fn body_that_bursts_is_told(backend: Backend) {
    let (mut simulation, ids, tether) = tethered(false, backend);
    simulation.run(2, DT).expect("two harmless steps");
    let before = simulation.sphere(ids[1]).expect("the middle one");
    make_it_burst(&mut simulation, tether);
    let error = simulation.run(5, DT).expect_err("the middle one bursts");
    let Error::NonFinite { sphere, step, stage } = error else {
        panic!("another error: {error}");
    };
    assert_eq!((sphere, step), (1, 3));
    assert!(matches!(stage, BadStage::Forces1), "{stage:?}");
    assert_eq!(simulation.report().steps, 3, "the steps after it are not done");
    assert!(simulation.report().non_finite > 0);
    let after = simulation.sphere(ids[1]).expect("the middle one");
    near(after.position, before.position.as_dvec3(), 0.0, "it stays where it was");
    near(after.velocity, [0.0; 3], 0.0, "it is at rest");
    others_fly_on(&mut simulation, ids, 3.0 / 64.0);
    // The cause is taken away: it goes on.
    simulation.remove_tether(tether).expect("a tether");
    simulation.run(5, DT).expect("it can go on");
    others_fly_on(&mut simulation, ids, 8.0 / 64.0);
}

fn told_to_go_on_it_goes_on(backend: Backend) {
    let (mut simulation, ids, tether) = tethered(true, backend);
    make_it_burst(&mut simulation, tether);
    let report = simulation.run(8, DT).expect("no error");
    assert_eq!(report.steps, 8);
    assert!(report.non_finite >= 8, "told at least once a step: {}", report.non_finite);
    let stopped = simulation.sphere(ids[1]).expect("the middle one");
    near(stopped.position, [4.0, 0.0, 0.0], 0.0, "it stays where it was");
    near(stopped.velocity, [0.0; 3], 0.0, "it is at rest");
    others_fly_on(&mut simulation, ids, 8.0 / 64.0);
}

/// Two spheres that close at 6e38: their impulse is beyond f32, which phase 3 finds; a third one stays as it is.
fn collision_that_bursts_is_told(backend: Backend) {
    let mut scene = weightless();
    let ids = spheres(
        &mut scene,
        [
            Sphere::new([50.0, 0.0, 0.0], 0.5).velocity([1.0, 0.0, 0.0]),
            Sphere::new([0.0; 3], 0.5).velocity([3e38, 0.0, 0.0]),
            Sphere::new([0.9, 0.0, 0.0], 0.5).velocity([-3e38, 0.0, 0.0]),
        ],
    );
    let mut simulation = simulation(scene, backend);
    let error = simulation.step(DT).expect_err("the collision bursts");
    let Error::NonFinite { sphere, step, stage } = error else {
        panic!("another error: {error}");
    };
    assert_eq!((sphere, step), (1, 1));
    assert!(matches!(stage, BadStage::Collisions), "{stage:?}");
    let state = simulation.sphere(ids[0]).expect("the third one");
    near(state.position, [50.0 + 1.0 / 64.0, 0.0, 0.0], 1e-5, "it flies on");
}

/// Of several that burst in one stage the one that was added first is told, wherever in memory it stands: the grid puts it
/// last.
fn first_of_several_is_told(backend: Backend) {
    for broad_phase in [BroadPhase::BruteForce, BroadPhase::Grid] {
        let mut scene = Scene::new();
        let ids = spheres(&mut scene, [8.0, 4.0, 0.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.5)));
        for id in ids {
            scene.add_tether(Tether::new(id, [0.0, 50.0, 0.0], 3e38)).expect("a valid tether");
        }
        let options = Options::new().backend(backend).broad_phase(broad_phase);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        let error = simulation.step(DT).expect_err("all burst");
        assert!(matches!(error, Error::NonFinite { sphere: 0, step: 1, .. }), "{broad_phase}: {error}");
    }
}

/// Rods of fixed length whose corrections are beyond f32: ends that part faster than it can tell, and an end that would be moved
/// out of it. They keep what they have, and nobody else knows of it.
fn rods_whose_corrections_burst_are_contained(backend: Backend) {
    let parting = [Sphere::new([20.0, 0.0, 0.0], 0.5).velocity([-3e38, 0.0, 0.0]), Sphere::new([22.0, 0.0, 0.0], 0.5)];
    let parting = [parting[0], parting[1].velocity([3e38, 0.0, 0.0])];
    // In one place the rod has no direction, and takes that of y.
    let far = [Sphere::new([0.0, 3e38, 0.0], 0.5); 2];
    for (ends, length) in [(parting, 2.0), (far, 3e38)] {
        let mut scene = weightless();
        let [alone] = spheres(&mut scene, [Sphere::new([0.0; 3], 0.5).velocity([1.0, 0.0, 0.0])]);
        let [one, two] = spheres(&mut scene, ends);
        scene.add_rod(Rod::new(one, two, 0.1).length(length)).expect("a valid rod");
        let mut simulation = simulation(scene, backend);
        for step in 1_u8..4 {
            // An end may be told to have stopped.
            let _ = simulation.step(DT);
            for (index, state) in simulation.spheres().expect("states").iter().enumerate() {
                let finite = state.position.is_finite() && state.velocity.is_finite() && state.angular_momentum.is_finite();
                assert!(finite, "length {length:e}, step {step}, sphere {index}: {state:?}");
            }
            let state = simulation.sphere(alone).expect("a sphere");
            near(state.position, [f64::from(step) / 64.0, 0.0, 0.0], 1e-7, "position of another");
            near(state.velocity, [1.0, 0.0, 0.0], 0.0, "velocity of another");
        }
    }
}

both!(
    rods_whose_corrections_burst_are_contained,
    body_that_bursts_is_told,
    told_to_go_on_it_goes_on,
    collision_that_bursts_is_told,
    first_of_several_is_told
);
