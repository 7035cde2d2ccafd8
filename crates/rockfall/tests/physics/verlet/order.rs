//! The error falls with the square of the time step.

use rockfall::glam::DVec3;
use rockfall::{Backend, Integrator, Rod, Scene, Sphere, SphereId, Tether};

use super::{simulation, state, verlet};
use crate::common::with;

/// A sphere on an elliptic orbit about a point. Its spring is longer than its rest length all the time, and is not linear.
fn orbit() -> (Scene, SphereId) {
    let mut scene = with(|settings| (settings.gravity, settings.collisions) = (0.0, false));
    let body = Sphere::new([1.5, 0.0, 0.0], 0.1).mass(1.0).velocity([0.0, 1.2, 0.4]);
    let id = scene.add_sphere(body).expect("a valid sphere");
    scene.add_tether(Tether::new(id, [0.0; 3], 9.0).length(1.0)).expect("a valid tether");
    (scene, id)
}

/// A pendulum of length 1: a rod of fixed length from a fixed sphere, released at 60 degrees.
fn pendulum() -> (Scene, SphereId) {
    let mut scene = with(|settings| (settings.gravity, settings.collisions) = (9.81, false));
    let pivot = scene.add_sphere(Sphere::new([0.0; 3], 0.05).fixed()).expect("a valid sphere");
    let angle = std::f32::consts::FRAC_PI_3;
    let place = [angle.sin(), -angle.cos(), 0.0];
    let bob = scene.add_sphere(Sphere::new(place, 0.05).mass(2.0)).expect("a valid sphere");
    scene.add_rod(Rod::new(pivot, bob, 0.02).length(1.0)).expect("a valid rod");
    (scene, bob)
}

fn after(scene: &(Scene, SphereId), integrator: Integrator, steps: u32, time: f64) -> DVec3 {
    let mut simulation = simulation(scene.0.clone(), Backend::Cpu, integrator);
    simulation.run(steps.into(), (time / f64::from(steps)) as f32).expect("steps");
    state(&mut simulation, scene.1)[0]
}

/// The order between successive time steps, each half of the one before.
fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

#[test]
fn an_orbit_on_a_spring_converges_with_order_two() {
    let (orbit, time) = (orbit(), 3.0);
    let reference = after(&orbit, Integrator::Rk4, 3000, time);
    let errors = [50, 100, 200].map(|steps| after(&orbit, Integrator::VelocityVerlet, steps, time).distance(reference));
    let orders = orders(&errors);
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.15), "{errors:?}: {orders:?}");
    let first = after(&orbit, Integrator::SymplecticEuler, 200, time).distance(reference);
    assert!(first > 5.0 * errors[2], "symplectic Euler {first}, velocity Verlet {}", errors[2]);
}

/// The pendulum equation theta'' = -G sin(theta), by RK4 in f64 with 20,000 steps.
fn pendulum_angle(time: f64) -> f64 {
    let (mut theta, mut rate) = (std::f64::consts::FRAC_PI_3, 0.0);
    let h = time / 20_000.0;
    let slope = |theta: f64, rate: f64| (rate, -9.81 * theta.sin());
    for _ in 0..20_000 {
        let (a1, b1) = slope(theta, rate);
        let (a2, b2) = slope(theta + 0.5 * h * a1, rate + 0.5 * h * b1);
        let (a3, b3) = slope(theta + 0.5 * h * a2, rate + 0.5 * h * b2);
        let (a4, b4) = slope(theta + h * a3, rate + h * b3);
        theta += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        rate += h / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4);
    }
    theta
}

#[test]
fn a_pendulum_converges_with_order_two() {
    let (pendulum, time) = (pendulum(), 1.7);
    let exact = pendulum_angle(time);
    let errors = [20, 40, 80].map(|steps| {
        let place = after(&pendulum, Integrator::VelocityVerlet, steps, time);
        assert!((place.length() - 1.0).abs() < 1e-5, "the rod keeps its length: {}", place.length());
        (place.x.atan2(-place.y) - exact).abs()
    });
    let orders = orders(&errors);
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.25), "{errors:?}: {orders:?}");
}

/// RATTLE with velocity Verlet is symplectic: the energy of a pendulum does not drift.
#[test]
fn the_energy_of_a_pendulum_does_not_drift() {
    let (scene, id) = pendulum();
    let mut simulation = verlet(scene, Backend::Cpu);
    let energy = |[x, v]: [DVec3; 2]| v.length_squared() + 2.0 * 9.81 * (x.y + 1.0);
    let first = energy(state(&mut simulation, id));
    let mut worst = 0.0_f64;
    for _ in 0..2000 {
        simulation.run(10, 0.01).expect("steps");
        worst = worst.max((energy(state(&mut simulation, id)) / first - 1.0).abs());
    }
    assert!(worst < 5e-3, "{worst}");
}
