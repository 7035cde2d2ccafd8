//! Integration, orientation, and rods of fixed length.

use std::f64::consts::{FRAC_PI_2, TAU};

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, Capsule, Rod, Scene, Simulation, Sphere, SphereId};

use crate::common::*;

const G: [f32; 3] = [0.6, 0.0, -0.8];

fn falling() -> (Scene, SphereId) {
    let mut scene = with(|settings| {
        settings.gravity = 5.0;
        settings.gravity_direction = Vec3::from_array(G);
    });
    let [ball] = spheres(&mut scene, [Sphere::new([1.0, 2.0, 3.0], 0.5).velocity([1.0, 4.0, -2.0])]);
    (scene, ball)
}

/// RK4 is exact on a parabola except for rounding: x = x0 + v0 t + g t^2 / 2, v = v0 + g t.
fn rk4_is_exact_on_a_parabola(backend: Backend) {
    let (scene, ball) = falling();
    let mut simulation = simulation(scene, backend);
    simulation.run(32, DT).expect("1/2 s");
    let ball = simulation.sphere(ball).expect("the ball");
    near(ball.velocity, [2.5, 4.0, -4.0], 2e-6, "velocity");
    near(ball.position, [1.0 + 0.5 + 0.375, 4.0, 3.0 - 1.0 - 0.5], 5e-6, "position");
    close(simulation.report().time, 0.5, 0.0, "time");
}

/// Symplectic Euler gives v_n = v0 + n dt g, x_n = x0 + n dt v0 + dt^2 g n (n + 1) / 2. With n = 32 the term in g is
/// 33/32 of that of RK4.
fn symplectic_euler_follows_its_own_parabola(backend: Backend) {
    let (scene, ball) = falling();
    let mut simulation = euler(scene, backend);
    simulation.run(32, DT).expect("1/2 s");
    let ball = simulation.sphere(ball).expect("the ball");
    let longer = 33.0 / 32.0;
    near(ball.velocity, [2.5, 4.0, -4.0], 2e-6, "velocity");
    near(ball.position, [1.5 + 0.375 * longer, 4.0, 2.0 - 0.5 * longer], 5e-6, "position");
}

/// A spin of 2 rad/s about (2, 1, 2)/3 turns by 1 rad in 1/2 s, exactly with the exponential map, starting from the
/// initial orientation.
fn a_constant_spin_turns_the_orientation_by_spin_times_time(backend: Backend) {
    let axis = Vec3::new(2.0, 1.0, 2.0) / 3.0;
    let start = Quat::from_rotation_x(0.7);
    let ball = Sphere::new([0.0; 3], 0.5).mass(3.0).orientation(start);
    let mut scene = weightless();
    let [id] = spheres(&mut scene, [ball.angular_momentum(2.0 * ball.inertia() * axis)]);
    let mut simulation = simulation(scene, backend);
    simulation.run(32, DT).expect("1/2 s");
    let state = simulation.sphere(id).expect("the ball");
    let expected = Quat::from_axis_angle(axis, 1.0) * start;
    assert!(state.orientation.dot(expected).abs() > 1.0 - 1e-6, "{} and {expected}", state.orientation);
    for own in Vec3::AXES {
        near(state.rotation() * own, (expected * own).as_dvec3(), 5e-6, "an axis");
    }
    near(state.spin(), (2.0 * axis).as_dvec3(), 1e-6, "spin");
}

/// A pendulum of length 1 under G = 1 starts at 0.05 rad: T = 2 pi (1 + 0.05^2 / 16). It is at -0.05 rad after half a
/// period, and at 0.05 rad after a whole one. The phase error of SHAKE, (2 pi / 64)^2 / 24, has no visible effect at a
/// turning point.
fn a_pendulum_on_a_rod_has_the_expected_period(backend: Backend) {
    let mut scene = Scene::new();
    let (sin, cos) = 0.05_f32.sin_cos();
    let ends = [Sphere::new([0.0; 3], 0.1).fixed(), Sphere::new([sin, -cos, 0.0], 0.1).mass(2.0)];
    dumbbell(&mut scene, ends, 0.01);
    let mut simulation = simulation(scene, backend);
    let dt = TAU * (1.0 + 0.0025 / 16.0) / 64.0;
    for side in [-1.0, 1.0] {
        simulation.run(32, dt as f32).expect("half a period");
        let bob = simulation.spheres().expect("both ends")[1];
        let expected = [side * 0.05_f64.sin(), -0.05_f64.cos(), 0.0];
        near(bob.position, expected, 5e-5, "position of the bob");
        near(bob.velocity, [0.0; 3], 2e-4, "velocity at the turning point");
    }
}

/// A rod of length 1 between spheres at a distance of 1.2, of masses 1 and 3. The first step moves them along the rod
/// by 0.15 and 0.05 and does not change their velocities. If one end is fixed, the other end moves the whole distance.
fn the_first_step_restores_lengths_in_positions_only(backend: Backend) {
    for (fixed, moved) in [(false, [0.15, -0.05]), (true, [0.0, -0.2])] {
        let mut scene = weightless();
        let mut first = Sphere::new([0.0; 3], 0.1);
        first.fixed = fixed;
        let [one, two] = spheres(&mut scene, [first, Sphere::new([0.0, 1.2, 0.0], 0.1).mass(3.0)]);
        scene.add_rod(Rod::new(one, two, 0.05).length(1.0)).expect("a valid rod");
        let mut simulation = simulation(scene, backend);
        simulation.step(DT).expect("a step");
        let ends = simulation.spheres().expect("both ends");
        near(ends[0].position, [0.0, moved[0], 0.0], 1e-6, "end 1");
        near(ends[1].position, [0.0, 1.2 + moved[1], 0.0], 1e-6, "end 2");
        velocities(&ends, [[0.0; 3]; 2]);
    }
}

/// Restoring a length changes positions only, also when the rod turns. The ends of a rod of length 1 start at a
/// distance of 1.2 and pass each other at 0.5. They keep that relative velocity when the distance is restored, because
/// only the velocity perpendicular to the axis remains. SHAKE keeps the angular momentum and would accelerate them to
/// 0.6.
fn restoring_a_length_leaves_the_velocities(backend: Backend) {
    let mut scene = weightless();
    let [one, two] = spheres(
        &mut scene,
        [Sphere::new([0.0; 3], 0.1), Sphere::new([0.0, 1.2, 0.0], 0.1).mass(3.0).velocity([0.5, 0.0, 0.0])],
    );
    scene.add_rod(Rod::new(one, two, 0.05).length(1.0)).expect("a valid rod");
    let mut simulation = simulation(scene, backend);
    simulation.step(DT).expect("a step");
    let ends = simulation.spheres().expect("both ends");
    close(ends[0].position.distance(ends[1].position), 1.0, 1e-6, "length");
    // RATTLE removes the component along the axis that the turn by 0.5 dt leaves, 3e-5 of it. By E18 the inertia of the
    // ends themselves, 2/5 * 4 * 0.01, turns with mu d^2 = 3/4.
    let speed = ends[0].velocity.distance(ends[1].velocity);
    close(speed, 0.5 / (1.0 + 0.016 / 0.75), 1e-4, "relative velocity");
}

/// A force along a rod moves both ends: with masses 1 and 3 and a force of 8 on one of them, both accelerate at 2.
fn a_force_along_a_rod_accelerates_both_ends(backend: Backend) {
    let mut scene = weightless();
    let ends = [Sphere::new([0.0; 3], 0.1), Sphere::new([1.0, 0.0, 0.0], 0.1).mass(3.0).force([8.0, 0.0, 0.0])];
    dumbbell(&mut scene, ends, 0.05);
    let mut simulation = simulation(scene, backend);
    simulation.run(32, DT).expect("1/2 s");
    let ends = simulation.spheres().expect("both ends");
    velocities(&ends, [[1.0, 0.0, 0.0]; 2]);
    near(ends[0].position, [0.25, 0.0, 0.0], 1e-5, "end 1");
    near(ends[1].position, [1.25, 0.0, 0.0], 1e-5, "end 2");
}

/// A chain of ten rods on a fixed sphere is released from a horizontal position (G = 1). Every length stays within 1 %
/// after every step, with both time steps. (At G = 10 and 20 ms the free end turns by more than a radian per step, and
/// the sweeps cannot follow that.)
fn a_swinging_chain_keeps_its_lengths(backend: Backend) {
    for (dt, steps) in [(0.02, on(backend, 1000, 48)), (0.005, on(backend, 1000, 32))] {
        let mut scene = Scene::new();
        let mut links: Vec<SphereId> = Vec::new();
        for link in 0..11 {
            let mut sphere = Sphere::new([0.5 * link as f32, 0.0, 0.0], 0.05);
            sphere.fixed = link == 0;
            links.extend(spheres(&mut scene, [sphere]));
        }
        for pair in links.windows(2) {
            scene.add_rod(Rod::new(pair[0], pair[1], 0.02).length(0.5)).expect("a valid rod");
        }
        let mut simulation = simulation(scene, backend);
        let mut lowest: f32 = 0.0;
        for _ in 0..steps {
            simulation.step(dt).expect("a step");
            let chain = simulation.spheres().expect("the chain");
            let places: Vec<Vec3> = chain.iter().map(|link| link.position).collect();
            for pair in places.windows(2) {
                close(pair[0].distance(pair[1]), 0.5, 0.005, "length of a link");
            }
            lowest = lowest.min(places[10].y);
        }
        assert!(lowest < on(backend, -1.5, -0.01), "the chain must swing: {lowest}");
    }
}

/// A free capsule of length 1, for a rotation at 10 rad/s about z.
fn spinning_capsule() -> Scene {
    let mut scene = weightless();
    let capsule = Capsule::new([-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], 0.2).mass(2.0);
    scene.add_capsule(capsule).expect("a valid capsule");
    scene
}

fn set_rotation(simulation: &mut Simulation) {
    let ends: Vec<SphereId> = simulation.scene().sphere_ids().collect();
    // v = w x r at 10 rad/s. The spin of each sphere is w too: I w = 2/5 * 0.04 * 10.
    for (end, side) in ends.into_iter().zip([-1.0, 1.0]) {
        simulation.set_velocity(end, [0.0, 5.0 * side, 0.25]).expect("a sphere");
        simulation.set_angular_momentum(end, [0.0, 0.0, 0.16]).expect("a sphere");
    }
}

/// At dt = 20 ms the capsule keeps its angular momentum, 2 * (1 * 0.5 * 5 + 0.16) = 5.32, within 0.1 % over 1,000
/// steps. It also keeps its momentum and its length.
fn a_free_capsule_keeps_its_angular_momentum(backend: Backend) {
    let mut simulation = simulation(spinning_capsule(), backend);
    set_rotation(&mut simulation);
    for _ in 0..10 {
        simulation.run(on(backend, 100, 8), 0.02).expect("steps");
        let energy = simulation.energy().expect("energies");
        // The angular momentum about the centre of mass, which moves along z, equals that about the origin.
        near(energy.angular_momentum, [0.0, 0.0, 5.32], 0.00532, "angular momentum");
        near(energy.momentum, [0.0, 0.0, 0.5], 1e-4, "momentum");
        let ends = simulation.spheres().expect("both ends");
        close(ends[0].position.distance(ends[1].position), 1.0, 1e-5, "length");
    }
}

/// SHAKE moves the ends by w dt perpendicular to the axis and brings them back along the old axis. So a step turns the
/// capsule by asin(w dt). The quarter turn in pi/20 s therefore differs by a relative error of (w dt)^2/6.
fn a_free_capsule_turns_by_the_angle_of_shake_in_every_step(backend: Backend) {
    let mut simulation = simulation(spinning_capsule(), backend);
    set_rotation(&mut simulation);
    let step = FRAC_PI_2 / 32.0;
    simulation.run(32, (step / 10.0) as f32).expect("a quarter turn");
    let ends = simulation.spheres().expect("both ends");
    let axis = (ends[1].position - ends[0].position).as_dvec3();
    let (sin, cos) = (32.0 * step.asin()).sin_cos();
    near(axis, [cos, sin, 0.0], 2e-5, "axis after a quarter turn");
}

both!(
    rk4_is_exact_on_a_parabola,
    symplectic_euler_follows_its_own_parabola,
    a_constant_spin_turns_the_orientation_by_spin_times_time,
    a_pendulum_on_a_rod_has_the_expected_period,
    the_first_step_restores_lengths_in_positions_only,
    restoring_a_length_leaves_the_velocities,
    a_force_along_a_rod_accelerates_both_ends,
    a_swinging_chain_keeps_its_lengths,
    a_free_capsule_keeps_its_angular_momentum,
    a_free_capsule_turns_by_the_angle_of_shake_in_every_step,
);
