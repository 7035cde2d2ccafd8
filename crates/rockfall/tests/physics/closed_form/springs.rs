//! Springs, tethers, external forces and impulses.

use std::f64::consts::TAU;

use rockfall::{Backend, Integrator, Options, Simulation, Sphere, SphereId, Spring, Tether};

use crate::common::*;

/// Masses 1 and 3 on a spring of k = 100, l = 1, stretched to 1.1 and released: mu = 3/4.
fn stretched(damping: f32, backend: Backend) -> (Simulation, [SphereId; 2]) {
    let mut scene = weightless();
    let ends = spheres(&mut scene, [Sphere::new([0.0; 3], 0.1), Sphere::new([1.1, 0.0, 0.0], 0.1).mass(3.0)]);
    let [a, b] = ends;
    let spring = Spring::new(a, b, 100.0, 1.0).damping(damping);
    scene.add_spring(spring).expect("a valid spring");
    (simulation(scene, backend), ends)
}

/// Length of the spring and its rate of change.
fn length(simulation: &mut Simulation, ends: [SphereId; 2]) -> (f64, f64) {
    let [a, b] = ends.map(|end| simulation.sphere(end).expect("a sphere"));
    let d = b.position.as_dvec3() - a.position.as_dvec3();
    let v = b.velocity.as_dvec3() - a.velocity.as_dvec3();
    (d.length(), v.dot(d) / d.length())
}

/// d = 1 + 0.1 cos wt with w = sqrt(k / mu): 0.9 after half a period, 1.1 after a whole one. With 64 steps per period
/// RK4 has a phase error of (w dt)^4/120 * 2 pi = 5e-6, and f32 one of about 64 * 6e-8.
fn a_spring_oscillates_with_its_period(backend: Backend) {
    let period = TAU / (100.0_f64 / 0.75).sqrt();
    let (mut simulation, ends) = stretched(0.0, backend);
    for expected in [0.9, 1.1] {
        simulation.run(32, (period / 64.0) as f32).expect("half a period");
        let (length, speed) = length(&mut simulation, ends);
        close(length, expected, 1e-5, "length");
        // The phase error times w * 0.1.
        close(speed, 0.0, 5e-5, "velocity at the turning point");
    }
    // The centre of mass stays at 3 * 1.1 / 4.
    let [a, b] = ends.map(|end| simulation.sphere(end).expect("a sphere").position.x);
    close((a + 3.0 * b) / 4.0, 0.825, 1e-6, "centre of mass");
}

/// With damping c = 3 the amplitude shrinks as exp(-g t), g = c / (2 mu) = 2, w_d = sqrt(w^2 - g^2). After a release at
/// rest, the turning points are at multiples of half the period 2 pi / w_d. The logarithmic decrement is g T.
fn a_damped_spring_has_the_expected_logarithmic_decrement(backend: Backend) {
    let (w, g) = ((100.0_f64 / 0.75).sqrt(), 2.0_f64);
    let period = TAU / (w * w - g * g).sqrt();
    let (mut simulation, ends) = stretched(3.0, backend);
    for half in [1.0, 2.0] {
        simulation.run(32, (period / 64.0) as f32).expect("half a period");
        let (length, speed) = length(&mut simulation, ends);
        let sign = if half == 1.0 { -1.0 } else { 1.0 };
        close(length, 1.0 + 0.1 * sign * (-g * half * period / 2.0).exp(), 1e-5, "length");
        close(speed, 0.0, 5e-5, "velocity at the turning point");
    }
}

/// A mass of 2 on a tether of k = 50, l = 0: w = 5. It is released at the height of the tether's point and oscillates
/// about its rest position at m G / k = 0.4 below (G = 10): y = -0.4 (1 - cos wt), and independently x = 0.3 cos wt.
fn a_mass_on_a_tether_oscillates_about_its_rest_position(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    let [ball] = spheres(&mut scene, [Sphere::new([0.3, 0.0, 0.0], 0.1).mass(2.0)]);
    scene.add_tether(Tether::new(ball, [0.0; 3], 50.0)).expect("a valid tether");
    let mut simulation = simulation(scene, backend);
    for expected in [[-0.3, -0.8, 0.0], [0.3, 0.0, 0.0]] {
        simulation.run(32, (TAU / 5.0 / 64.0) as f32).expect("half a period");
        let ball = simulation.sphere(ball).expect("the ball");
        near(ball.position, expected, 1e-5, "position");
        near(ball.velocity, [0.0; 3], 1e-4, "velocity at the turning point");
    }
}

/// d = (3, 4, 0): n = (0.6, 0.8, 0), |d| - l = 5 - 4. The sphere moves towards the point at (1, 2, 0).n = 2.2:
/// F = (10 * 1 - 2 * 2.2) n = 5.6 n. A compressed tether with l = 7 pushes: 10 * (5 - 7) - 2 * 2.2 = -24.4.
fn a_tether_force_includes_rest_length_and_damping(backend: Backend) {
    for (length, force) in [(4.0, 5.6), (7.0, -24.4)] {
        let mut scene = weightless();
        let [ball] = spheres(&mut scene, [Sphere::new([1.0, 1.0, 1.0], 0.1).velocity([1.0, 2.0, 0.0])]);
        let tether = Tether::new(ball, [4.0, 5.0, 1.0], 10.0).length(length).damping(2.0);
        scene.add_tether(tether).expect("a valid tether");
        forces(&loads(scene, backend), [[0.6 * force, 0.8 * force, 0.0]], 1e-4);
    }
}

/// The velocity of a fixed sphere counts in a spring's damping, c (vB - vA).n = 2 * (3 - 1) = 4. The fixed sphere
/// itself does not move.
fn the_damping_of_a_spring_includes_the_velocity_of_a_fixed_sphere(backend: Backend) {
    let mut scene = weightless();
    let [a, b] = spheres(
        &mut scene,
        [
            Sphere::new([0.0; 3], 0.1).velocity([1.0, 0.0, 0.0]),
            Sphere::new([2.0, 0.0, 0.0], 0.1).velocity([3.0, 0.0, 0.0]).fixed(),
        ],
    );
    scene.add_spring(Spring::new(a, b, 5.0, 2.0).damping(2.0)).expect("a valid spring");
    forces(&loads(scene, backend), [[4.0, 0.0, 0.0], [0.0; 3]], 1e-4);
}

/// The forces of two springs and a tether on one sphere add up: 10 * (2 - 1) along x, 20 * (3 - 1) along y, 5 * 1 along
/// -z.
fn the_spring_forces_on_one_sphere_add_up(backend: Backend) {
    let mut scene = weightless();
    let [a, b, c] = spheres(&mut scene, [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]].map(|place| Sphere::new(place, 0.1)));
    scene.add_spring(Spring::new(a, b, 10.0, 1.0)).expect("a valid spring");
    scene.add_spring(Spring::new(c, a, 20.0, 1.0)).expect("a valid spring");
    scene.add_tether(Tether::new(a, [0.0, 0.0, -1.0], 5.0)).expect("a valid tether");
    let found = loads(scene, backend);
    forces(&found, [[10.0, 40.0, -5.0], [-10.0, 0.0, 0.0], [0.0, -40.0, 0.0]], 1e-4);
}

/// A force of (4, 0, 0) on a mass of 2 that falls at G = 2: x = t^2, y = -t^2. Then the force changes to (0, 4, 0),
/// which balances gravity.
fn an_external_force_acts_until_it_is_changed(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 2.0);
    let [ball, bystander] =
        spheres(&mut scene, [Sphere::new([0.0; 3], 0.1).mass(2.0).force([4.0, 0.0, 0.0]), Sphere::new([9.0, 0.0, 0.0], 0.1)]);
    let mut simulation = simulation(scene, backend);
    simulation.run(16, DT).expect("1/4 s");
    let state = simulation.sphere(ball).expect("the ball");
    near(state.position, [0.0625, -0.0625, 0.0], 1e-6, "position after 1/4 s");
    near(state.velocity, [0.5, -0.5, 0.0], 1e-6, "velocity after 1/4 s");
    simulation.set_force(ball, [0.0, 4.0, 0.0]).expect("a sphere");
    simulation.run(16, DT).expect("1/4 s");
    let state = simulation.sphere(ball).expect("the ball");
    near(state.position, [0.1875, -0.1875, 0.0], 1e-6, "position after 1/2 s");
    near(state.velocity, [0.5, -0.5, 0.0], 1e-6, "velocity after 1/2 s");
    let state = simulation.sphere(bystander).expect("the other");
    near(state.position, [9.0, -0.25, 0.0], 1e-6, "a sphere without a force falls by t^2");
}

/// An impulse changes v by J/m, at once and only once. A fixed sphere does not change.
fn an_impulse_changes_the_velocity_once(backend: Backend) {
    let mut scene = weightless();
    let [ball, fixed] = spheres(
        &mut scene,
        [Sphere::new([0.0; 3], 0.1).mass(4.0).velocity([1.0, 0.0, 0.0]), Sphere::new([9.0, 0.0, 0.0], 0.1).fixed()],
    );
    let mut simulation = simulation(scene, backend);
    for id in [ball, ball, fixed] {
        simulation.apply_impulse(id, [0.0, 2.0, 0.0]).expect("a sphere");
    }
    near(simulation.sphere(ball).expect("the ball").velocity, [1.0, 1.0, 0.0], 1e-6, "before the step");
    simulation.run(8, DT).expect("8 steps");
    let state = simulation.sphere(ball).expect("the ball");
    near(state.velocity, [1.0, 1.0, 0.0], 1e-6, "velocity");
    near(state.position, [0.125, 0.125, 0.0], 1e-6, "position");
    let state = simulation.sphere(fixed).expect("the fixed sphere");
    near(state.velocity, [0.0; 3], 0.0, "velocity of the fixed sphere");
    near(state.position, [9.0, 0.0, 0.0], 0.0, "position of the fixed sphere");
}

/// Symplectic Euler on x'' = -w^2 x advances x by a map with trace 2 - (w dt)^2, so x_n = A cos(n a + p), 2 cos
/// a = 2 - (w dt)^2. From x = 0.1 at rest, v1 = -w^2 dt x0 and x1 = x0 (1 - (w dt)^2): x_n = x0 cos((n + 1/2)
/// a) / cos(a/2).
fn a_spring_under_symplectic_euler_follows_its_difference_equation(backend: Backend) {
    let mut scene = weightless();
    let [ball] = spheres(&mut scene, [Sphere::new([0.1, 0.0, 0.0], 0.1).mass(2.0)]);
    scene.add_tether(Tether::new(ball, [0.0; 3], 50.0)).expect("a valid tether");
    let options = Options::new().backend(backend).integrator(Integrator::SymplecticEuler);
    let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
    let (dt, wdt) = (1.0_f32 / 16.0, 5.0_f64 / 16.0);
    let a = (1.0 - 0.5 * wdt * wdt).acos();
    for n in [1.0_f64, 20.0, 40.0] {
        let done = simulation.report().steps;
        simulation.run(n as u64 - done, dt).expect("steps");
        let x = simulation.sphere(ball).expect("the ball").position.x;
        close(x, 0.1 * ((n + 0.5) * a).cos() / (0.5 * a).cos(), 1e-6, "position");
    }
}

both!(
    a_spring_oscillates_with_its_period,
    a_damped_spring_has_the_expected_logarithmic_decrement,
    a_mass_on_a_tether_oscillates_about_its_rest_position,
    a_tether_force_includes_rest_length_and_damping,
    the_damping_of_a_spring_includes_the_velocity_of_a_fixed_sphere,
    the_spring_forces_on_one_sphere_add_up,
    an_external_force_acts_until_it_is_changed,
    an_impulse_changes_the_velocity_once,
    a_spring_under_symplectic_euler_follows_its_difference_equation,
);
