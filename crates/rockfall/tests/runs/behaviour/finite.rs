//! A body that becomes non-finite is reported with its insertion index, step and stage. The other bodies are not
//! affected.

use rockfall::error::BadStage;
use rockfall::{Backend, BroadPhase, Error, Options, Rod, Scene, Simulation, Sphere, SphereId, Tether, TetherId};

use crate::common::*;

/// Three falling spheres. The middle one has a tether, which exerts no force at first.
fn tethered(keep_going: bool, backend: Backend) -> (Simulation, [SphereId; 3], TetherId) {
    let mut scene = Scene::new();
    let ids = spheres(&mut scene, [0.0, 4.0, 8.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.5).velocity([1.0, 2.0, 3.0])));
    let tether = Tether::new(ids[1], [4.0, 50.0, 0.0], 0.0);
    let tether = scene.add_tether(tether).expect("a valid tether");
    let options = Options::new().backend(backend).keep_going(keep_going);
    let simulation = Simulation::with_options(scene, options).expect("the simulation opens");
    (simulation, ids, tether)
}

/// Makes the middle sphere non-finite: 3e38 * 50 exceeds the range of f32.
fn make_non_finite(simulation: &mut Simulation, tether: TetherId) {
    simulation.update_tether(tether, |tether| tether.stiffness = 3e38).expect("a valid tether");
}

/// Asserts that the first and the last sphere follow x0 + v t - t^2/2.
fn assert_others_unaffected(simulation: &mut Simulation, ids: [SphereId; 3], t: f64) {
    for (id, x) in [(ids[0], 0.0), (ids[2], 8.0)] {
        let state = simulation.sphere(id).expect("a sphere");
        near(state.position, [x + t, 2.0 * t - 0.5 * t * t, 3.0 * t], 5e-6, "position of an unaffected sphere");
        near(state.velocity, [1.0, 2.0 - t, 3.0], 2e-6, "velocity of an unaffected sphere");
    }
}

/// Sphere 1 becomes non-finite in the first force evaluation of the third step. It keeps its position, at rest.
fn a_body_that_becomes_non_finite_is_reported(backend: Backend) {
    let (mut simulation, ids, tether) = tethered(false, backend);
    simulation.run(2, DT).expect("two steps without an error");
    let before = simulation.sphere(ids[1]).expect("the middle one");
    make_non_finite(&mut simulation, tether);
    let error = simulation.run(5, DT).expect_err("the middle sphere must become non-finite");
    let Error::NonFinite { sphere, step, stage } = error else {
        panic!("another error: {error}");
    };
    assert_eq!((sphere, step), (1, 3));
    assert!(matches!(stage, BadStage::Forces1), "{stage:?}");
    assert_eq!(simulation.report().steps, 3, "the remaining steps must not run");
    assert!(simulation.report().non_finite > 0);
    let after = simulation.sphere(ids[1]).expect("the middle one");
    near(after.position, before.position.as_dvec3(), 0.0, "position of the non-finite sphere");
    near(after.velocity, [0.0; 3], 0.0, "velocity of the non-finite sphere");
    assert_others_unaffected(&mut simulation, ids, 3.0 / 64.0);
    // Without the cause, the run continues.
    simulation.remove_tether(tether).expect("a tether");
    simulation.run(5, DT).expect("the run must continue");
    assert_others_unaffected(&mut simulation, ids, 8.0 / 64.0);
}

fn with_keep_going_a_run_continues(backend: Backend) {
    let (mut simulation, ids, tether) = tethered(true, backend);
    make_non_finite(&mut simulation, tether);
    let report = simulation.run(8, DT).expect("no error");
    assert_eq!(report.steps, 8);
    assert!(report.non_finite >= 8, "must be reported at least once per step: {}", report.non_finite);
    let stopped = simulation.sphere(ids[1]).expect("the middle one");
    near(stopped.position, [4.0, 0.0, 0.0], 0.0, "position of the non-finite sphere");
    near(stopped.velocity, [0.0; 3], 0.0, "velocity of the non-finite sphere");
    assert_others_unaffected(&mut simulation, ids, 8.0 / 64.0);
}

/// Two spheres approach each other at 6e38. Phase 3 finds that their impulse exceeds the range of f32. A third sphere
/// is not affected.
fn a_collision_that_becomes_non_finite_is_reported(backend: Backend) {
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
    let error = simulation.step(DT).expect_err("the collision must become non-finite");
    let Error::NonFinite { sphere, step, stage } = error else {
        panic!("another error: {error}");
    };
    assert_eq!((sphere, step), (1, 1));
    assert!(matches!(stage, BadStage::Collisions), "{stage:?}");
    let state = simulation.sphere(ids[0]).expect("the third one");
    near(state.position, [50.0 + 1.0 / 64.0, 0.0, 0.0], 1e-5, "position of the third sphere");
}

/// When several bodies become non-finite in one stage, the one that was added first is reported, wherever it is stored.
/// The grid stores it last.
fn the_first_of_several_non_finite_bodies_is_reported(backend: Backend) {
    for broad_phase in [BroadPhase::BruteForce, BroadPhase::Grid] {
        let mut scene = Scene::new();
        let ids = spheres(&mut scene, [8.0, 4.0, 0.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.5)));
        for id in ids {
            scene.add_tether(Tether::new(id, [0.0, 50.0, 0.0], 3e38)).expect("a valid tether");
        }
        let options = Options::new().backend(backend).broad_phase(broad_phase);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        let error = simulation.step(DT).expect_err("all spheres must become non-finite");
        assert!(matches!(error, Error::NonFinite { sphere: 0, step: 1, .. }), "{broad_phase}: {error}");
    }
}

/// Corrections of rods of fixed length that exceed the range of f32: ends whose relative velocity exceeds it, and an
/// end that would be moved out of it. The ends keep finite states, and other bodies are not affected.
fn rods_whose_corrections_overflow_keep_finite_states(backend: Backend) {
    let parting = [Sphere::new([20.0, 0.0, 0.0], 0.5).velocity([-3e38, 0.0, 0.0]), Sphere::new([22.0, 0.0, 0.0], 0.5)];
    let parting = [parting[0], parting[1].velocity([3e38, 0.0, 0.0])];
    // Where both ends coincide, the rod has no direction, and (0, 1, 0) is used.
    let far = [Sphere::new([0.0, 3e38, 0.0], 0.5); 2];
    for (ends, length) in [(parting, 2.0), (far, 3e38)] {
        let mut scene = weightless();
        let [alone] = spheres(&mut scene, [Sphere::new([0.0; 3], 0.5).velocity([1.0, 0.0, 0.0])]);
        let [one, two] = spheres(&mut scene, ends);
        scene.add_rod(Rod::new(one, two, 0.1).length(length)).expect("a valid rod");
        let mut simulation = simulation(scene, backend);
        for step in 1_u8..4 {
            // An end may be reported as non-finite.
            if let Err(error) = simulation.step(DT) {
                assert!(matches!(error, Error::NonFinite { .. }), "length {length:e}, step {step}: {error}");
            }
            for (index, state) in simulation.spheres().expect("states").iter().enumerate() {
                let finite = state.position.is_finite() && state.velocity.is_finite() && state.angular_momentum.is_finite();
                assert!(finite, "length {length:e}, step {step}, sphere {index}: {state:?}");
            }
            let state = simulation.sphere(alone).expect("a sphere");
            near(state.position, [f64::from(step) / 64.0, 0.0, 0.0], 1e-7, "position of an unaffected sphere");
            near(state.velocity, [1.0, 0.0, 0.0], 0.0, "velocity of an unaffected sphere");
        }
    }
}

both!(
    rods_whose_corrections_overflow_keep_finite_states,
    a_body_that_becomes_non_finite_is_reported,
    with_keep_going_a_run_continues,
    a_collision_that_becomes_non_finite_is_reported,
    the_first_of_several_non_finite_bodies_is_reported
);
