//! Changes to a scene between steps: settings, objects, states, phases.

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, Capsule, Counts, Cuboid, Error, Polygon, Rod, Scene, Simulation, Sphere, SphereState, Spring, Tether};

use crate::common::*;

/// Gravity changes between steps: v = 1 * 1/4 downwards, then 4 * 1/4 along x.
fn settings_change_between_steps(backend: Backend) {
    let mut scene = Scene::new();
    let [ball] = spheres(&mut scene, [Sphere::new([0.0; 3], 0.5)]);
    let mut simulation = simulation(scene, backend);
    simulation.run(16, DT).expect("1/4 s");
    let mut settings = *simulation.settings();
    settings.gravity = 4.0;
    settings.gravity_direction = Vec3::X;
    simulation.set_settings(settings).expect("valid settings");
    simulation.run(16, DT).expect("1/4 s");
    let state = simulation.sphere(ball).expect("the ball");
    near(state.velocity, [1.0, -0.25, 0.0], 1e-6, "velocity");
    settings.gravity = f32::NAN;
    assert!(matches!(simulation.set_settings(settings), Err(Error::Invalid { .. })));
    assert_eq!(simulation.settings().gravity, 4.0, "a rejected change must change nothing");
}

/// A ball that hits the floor at 2 leaves at e * 2 with the current value of e: 0.5, then 1.
fn restitution_changes_between_steps(backend: Backend) {
    let mut scene = weightless();
    floor_box(&mut scene);
    let [ball] = spheres(&mut scene, [Sphere::new([0.0, 0.49, 0.0], 0.5)]);
    let mut simulation = simulation(scene, backend);
    for restitution in [0.5, 1.0] {
        let mut settings = *simulation.settings();
        settings.restitution = restitution;
        simulation.set_settings(settings).expect("valid settings");
        simulation.set_position(ball, [0.0, 0.49, 0.0]).expect("a sphere");
        simulation.set_velocity(ball, [0.0, -2.0, 0.0]).expect("a sphere");
        simulation.handle_collisions().expect("phase 3");
        let speed = simulation.sphere(ball).expect("the ball").velocity.y;
        close(speed, 2.0 * f64::from(restitution), F32, "velocity");
    }
}

/// A scene with every kind of object, and with collisions and contacts.
fn crowded() -> Scene {
    let mut scene = Scene::new();
    floor_box(&mut scene);
    let wall = Polygon::new([-1.0, -1.0, -5.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]);
    scene.add_polygon(wall).expect("a valid polygon");
    let [a, b, c, d] = spheres(
        &mut scene,
        [
            Sphere::new([-0.5, 0.48, 0.0], 0.5).velocity([-2.0, -1.0, 0.3]),
            Sphere::new([0.45, 0.5, 0.0], 0.5).velocity([-1.0, 0.0, 0.0]).angular_momentum([0.0, 0.1, 0.2]),
            Sphere::new([0.3, 1.4, -0.6], 0.2),
            Sphere::new([0.2, 1.3, 0.9], 0.2).mass(2.0),
        ],
    );
    scene.add_rod(Rod::new(c, d, 0.1).length(1.5)).expect("a valid rod");
    scene.add_spring(Spring::new(a, c, 20.0, 1.0).damping(0.5)).expect("a valid spring");
    scene.add_tether(Tether::new(b, [1.0, 1.0, 1.0], 5.0)).expect("a valid tether");
    let capsule = Capsule::new([1.3, 0.3, 0.0], [1.3, 1.2, 0.3], 0.3).velocity([-1.0, -1.0, 0.0]);
    scene.add_capsule(capsule).expect("a valid capsule");
    scene
}

fn states(simulation: &mut Simulation) -> Vec<SphereState> {
    simulation.spheres().expect("spheres are read back")
}

/// Calling the four phases one by one gives a bitwise identical state and counts as one step.
fn the_four_phases_in_order_equal_one_step(backend: Backend) {
    let [mut whole, mut parts] = [(); 2].map(|()| simulation(crowded(), backend));
    for steps in 1..=5 {
        whole.step(0.01).expect("a step");
        parts.set_time_step(0.01).expect("a valid time step");
        parts.update_aabbs().expect("phase 1");
        parts.broad_phase().expect("phase 2");
        parts.handle_collisions().expect("phase 3");
        parts.update_positions(0.01).expect("phase 4");
        assert_eq!(states(&mut whole), states(&mut parts), "after {steps} steps");
        // Only a whole step chooses how often lists are rebuilt, and so how often a step is repeated.
        let counted = |simulation: &Simulation| {
            let mut report = simulation.report();
            (report.list_builds, report.replays) = (0, 0);
            report
        };
        assert_eq!(counted(&parts), counted(&whole));
    }
    assert!(whole.report().total_collisions > 1 && whole.report().contacts > 1, "{:?}", whole.report());
}

/// The first two phases may be skipped: results do not depend on how the lists were made, bit for bit.
fn reusing_lists_does_not_change_the_result(backend: Backend) {
    let [mut whole, mut parts] = [(); 2].map(|()| simulation(crowded(), backend));
    for _ in 0..4 {
        whole.step(0.01).expect("a step");
        parts.set_time_step(0.01).expect("a valid time step");
        parts.handle_collisions().expect("phase 3");
        parts.update_positions(0.01).expect("phase 4");
    }
    assert_eq!(states(&mut whole), states(&mut parts));
}

/// With collisions off, only the contact force acts on a ball that falls on the floor at 2. In a step of 1/64 s from
/// o = 0.01 it loses at most dt (Cc o + Cd u), about 0.55, and no collision is counted. Phase 3 called on its own does
/// not handle collisions either; it only applies friction impulses.
fn with_collisions_off_phase_3_changes_no_normal_velocity(backend: Backend) {
    let mut scene = weightless();
    scene.settings.collisions = false;
    floor_box(&mut scene);
    let [ball] = spheres(&mut scene, [Sphere::new([0.0, 0.49, 0.0], 0.5).velocity([0.0, -2.0, 0.0])]);
    let mut simulation = euler(scene, backend);
    simulation.step(DT).expect("a step");
    // With symplectic Euler the result is exactly -2 + dt (10 + 25).
    let speed = simulation.sphere(ball).expect("the ball").velocity.y;
    close(speed, -2.0 + 35.0 / 64.0, F32, "velocity");
    assert_eq!(simulation.report().total_collisions, 0);
    simulation.handle_collisions().expect("phase 3");
    let after = simulation.sphere(ball).expect("the ball").velocity.y;
    close(after, speed.into(), 0.0, "velocity after phase 3");
}

/// An invalid time step is an error and changes nothing.
fn invalid_time_steps_are_rejected(backend: Backend) {
    let mut simulation = simulation(crowded(), backend);
    for dt in [0.0, -0.01, f32::NAN, f32::INFINITY] {
        assert!(matches!(simulation.step(dt), Err(Error::Invalid { field: "dt", .. })), "{dt}");
    }
    assert_eq!(simulation.report().steps, 0);
}

/// Objects are added and removed between steps. Removing a sphere removes its rods, capsules, springs and tethers. The
/// other objects keep their order, state and handles. Handles of removed objects are errors.
fn removing_a_sphere_removes_what_is_attached_to_it(backend: Backend) {
    let mut simulation = simulation(weightless(), backend);
    let balls: Vec<_> = (0..4)
        .map(|x| {
            let ball = Sphere::new([3.0 * x as f32, 0.0, 0.0], 0.5).velocity([0.0, x as f32, 0.0]);
            simulation.add_sphere(ball).expect("a valid sphere")
        })
        .collect();
    simulation.step(0.5).expect("a step");
    let rods = [(0, 1), (2, 3)].map(|(a, b)| simulation.add_rod(Rod::new(balls[a], balls[b], 0.1)).expect("a valid rod"));
    let springs = [(1, 2), (0, 3)].map(|(a, b)| {
        let spring = Spring::new(balls[a], balls[b], 0.0, 1.0);
        simulation.add_spring(spring).expect("a valid spring")
    });
    let tether = simulation.add_tether(Tether::new(balls[1], [0.0; 3], 0.0)).expect("a valid tether");
    let capsule = Capsule::new([0.0, 0.0, 9.0], [1.0, 0.0, 9.0], 0.2);
    let capsule = simulation.add_capsule(capsule).expect("a valid capsule");
    simulation.step(0.5).expect("a step");

    simulation.remove_sphere(balls[1]).expect("a sphere");
    let mut counts = Counts::default();
    (counts.spheres, counts.rods, counts.capsules, counts.springs) = (5, 2, 1, 1);
    assert_eq!(simulation.scene().counts(), counts);
    assert!(matches!(simulation.sphere(balls[1]), Err(Error::StaleHandle { kind: "sphere" })));
    assert!(matches!(simulation.remove_rod(rods[0]), Err(Error::StaleHandle { kind: "rod" })));
    assert!(matches!(simulation.remove_spring(springs[0]), Err(Error::StaleHandle { kind: "spring" })));
    assert!(matches!(simulation.remove_tether(tether), Err(Error::StaleHandle { kind: "tether" })));
    assert!(matches!(simulation.set_velocity(balls[1], [0.0; 3]), Err(Error::StaleHandle { .. })));
    assert!(matches!(simulation.set_force(balls[1], [0.0; 3]), Err(Error::StaleHandle { .. })));
    let stale = Spring::new(balls[0], balls[1], 1.0, 1.0);
    assert!(matches!(simulation.add_spring(stale), Err(Error::StaleHandle { .. })));

    simulation.step(0.5).expect("a step");
    // The others have moved for 1.5 s and kept their order.
    for (index, x) in [(0, 0.0), (1, 2.0), (2, 3.0)] {
        let place = states(&mut simulation)[index].position;
        near(place, [3.0 * x, 1.5 * x, 0.0], 1e-6, "position");
        near(simulation.sphere(balls[x as usize]).expect("a sphere").position, place.as_dvec3(), 0.0, "by handle");
    }
    let rod = *simulation.scene().rod(rods[1]).expect("the other rod");
    assert_eq!((rod.end1, rod.end2), (balls[2], balls[3]));

    simulation.remove_capsule(capsule).expect("a capsule");
    assert!(matches!(simulation.remove_capsule(capsule), Err(Error::StaleHandle { kind: "capsule" })));
    assert_eq!(simulation.scene().counts().spheres, 3);
    assert_eq!(simulation.scene().counts().rods, 1);
    assert_eq!(states(&mut simulation).len(), 3);

    // Many at once, or none.
    let some = [balls[3], balls[1]];
    assert!(matches!(simulation.remove_spheres(&some), Err(Error::StaleHandle { kind: "sphere" })));
    assert_eq!(states(&mut simulation).len(), 3);
    simulation.remove_spheres(&[balls[3], balls[0], balls[3]]).expect("spheres");
    assert_eq!((states(&mut simulation).len(), simulation.scene().counts().rods), (1, 0));
}

/// An added object takes part at once, and a removed object no longer does: a floor is added under a falling ball and
/// removed again.
fn an_added_floor_collides_until_it_is_removed(backend: Backend) {
    let mut scene = weightless();
    let [ball] = spheres(&mut scene, [Sphere::new([0.0; 3], 0.5)]);
    let mut simulation = simulation(scene, backend);
    let speed_after_phase_3 = |simulation: &mut Simulation| {
        simulation.set_position(ball, [0.0, 0.49, 0.0]).expect("a sphere");
        simulation.set_velocity(ball, [0.0, -2.0, 0.0]).expect("a sphere");
        simulation.handle_collisions().expect("phase 3");
        simulation.sphere(ball).expect("the ball").velocity.y
    };
    close(speed_after_phase_3(&mut simulation), -2.0, 0.0, "no floor");
    let floor = Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]);
    let floor = simulation.add_box(floor).expect("a valid box");
    close(speed_after_phase_3(&mut simulation), 1.5, F32, "a floor");
    simulation.remove_box(floor).expect("a box");
    close(speed_after_phase_3(&mut simulation), -2.0, 0.0, "the floor is gone");
}

/// Springs, tethers and rods change: forces of 10 * (2 - 1), then 20 * (2 - 1.5), each measured in one step from rest.
fn changed_springs_tethers_and_rods_act_in_the_next_step(backend: Backend) {
    let mut scene = weightless();
    let places = [[0.0; 3], [2.0, 0.0, 0.0]];
    let [a, b] = spheres(&mut scene, places.map(|place| Sphere::new(place, 0.1)));
    let spring = scene.add_spring(Spring::new(a, b, 10.0, 1.0)).expect("a valid spring");
    let tether = scene.add_tether(Tether::new(a, [0.0; 3], 4.0)).expect("a valid tether");
    let rod = scene.add_rod(Rod::new(a, b, 0.05)).expect("a valid rod");
    let mut simulation = euler(scene, backend);
    let force_on_a = |simulation: &mut Simulation| {
        for (id, place) in [a, b].into_iter().zip(places) {
            simulation.set_position(id, place).expect("a sphere");
            simulation.set_velocity(id, [0.0; 3]).expect("a sphere");
        }
        let before = simulation.sync().expect("the scene").spheres().to_vec();
        simulation.step(DT).expect("a step");
        loads_between(&before, &states(simulation))[0].force
    };
    near(force_on_a(&mut simulation), [10.0, 0.0, 0.0], 1e-4, "at first");
    let change = |spring: &mut Spring| (spring.stiffness, spring.length) = (20.0, 1.5);
    simulation.update_spring(spring, change).expect("a valid spring");
    simulation.update_tether(tether, |tether| tether.point = Vec3::Y).expect("a valid tether");
    near(force_on_a(&mut simulation), [10.0, 4.0, 0.0], 1e-4, "changed");
    let refused = simulation.update_spring(spring, |spring| spring.stiffness = -1.0);
    assert!(matches!(refused, Err(Error::Invalid { .. })));
    // In the next step, a rod of length 1 moves both ends inwards by half a unit.
    simulation.remove_spring(spring).expect("a spring");
    simulation.remove_tether(tether).expect("a tether");
    simulation.update_rod(rod, |rod| rod.length = Some(1.0)).expect("a valid rod");
    near(force_on_a(&mut simulation), [0.0; 3], 1e-4, "without a spring");
    near(states(&mut simulation)[0].position, [0.5, 0.0, 0.0], 1e-5, "end 1");
    near(states(&mut simulation)[1].position, [1.5, 0.0, 0.0], 1e-5, "end 2");
}

/// A state reads back as it was set, before and after a step.
fn a_state_reads_back_as_it_was_set(backend: Backend) {
    let mut scene = weightless();
    let [ball] = spheres(&mut scene, [Sphere::new([0.0; 3], 0.5).mass(2.0)]);
    let mut simulation = simulation(scene, backend);
    simulation.step(DT).expect("a step");
    let turn = Quat::from_rotation_y(0.5);
    simulation.set_position(ball, [1.0, 2.0, 3.0]).expect("a sphere");
    simulation.set_velocity(ball, [4.0, 5.0, 6.0]).expect("a sphere");
    simulation.set_angular_momentum(ball, [0.0, 0.4, 0.0]).expect("a sphere");
    simulation.set_orientation(ball, turn).expect("a unit quaternion");
    let state = simulation.sphere(ball).expect("the ball");
    assert_eq!(state.position, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(state.velocity, Vec3::new(4.0, 5.0, 6.0));
    assert_eq!(state.angular_momentum, Vec3::new(0.0, 0.4, 0.0));
    assert_eq!(state.orientation, turn);
    assert_eq!((state.mass, state.radius, state.fixed), (2.0, 0.5, false));
    simulation.step(0.25).expect("a step");
    let state = simulation.sphere(ball).expect("the ball");
    near(state.position, [2.0, 3.25, 4.5], 1e-6, "position");
    // w = 0.4 / (2/5 * 2 * 0.25) = 2 rad/s, for 1/4 s.
    near(state.rotation() * Vec3::X, [1.0_f64.cos(), 0.0, -1.0_f64.sin()], 1e-6, "orientation");
    assert!(matches!(simulation.set_position(ball, [f32::NAN; 3]), Err(Error::Invalid { .. })));
    assert!(matches!(simulation.set_orientation(ball, Quat::from_xyzw(1.0, 1.0, 0.0, 0.0)), Err(Error::Invalid { .. })));
}

both!(
    settings_change_between_steps,
    restitution_changes_between_steps,
    the_four_phases_in_order_equal_one_step,
    reusing_lists_does_not_change_the_result,
    with_collisions_off_phase_3_changes_no_normal_velocity,
    invalid_time_steps_are_rejected,
    removing_a_sphere_removes_what_is_attached_to_it,
    an_added_floor_collides_until_it_is_removed,
    changed_springs_tethers_and_rods_act_in_the_next_step,
    a_state_reads_back_as_it_was_set,
);
