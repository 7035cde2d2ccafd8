//! One sphere on a spring of rest length 0: x'' = -omega² x - C x'.

use rockfall::{Backend, Integrator, Scene, Simulation, Sphere, SphereId, Tether};

use super::{simulation, state, verlet};
use crate::common::{on, with};

/// A sphere of mass 1 at x = 1, tied to the origin. Without a collision phase, so every step evaluates the forces once.
fn oscillator(omega: f32, damping: f32) -> (Scene, SphereId) {
    let mut scene = with(|settings| (settings.gravity, settings.collisions) = (0.0, false));
    let id = scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.1).mass(1.0)).expect("a valid sphere");
    scene.add_tether(Tether::new(id, [0.0; 3], omega * omega).damping(damping)).expect("a valid tether");
    (scene, id)
}

fn energy(simulation: &mut Simulation, id: SphereId, omega: f64) -> f64 {
    let [x, v] = state(simulation, id);
    0.5 * (v.length_squared() + (omega * x.length()).powi(2))
}

/// In exact arithmetic v²/2 + omega² x²/2 (1 - (omega dt)²/4) is constant, so the energy stays between 1 - (omega dt)²/4 and 1
/// times the first one for ever. RK4 loses nearly all of it.
#[test]
fn the_energy_of_an_oscillator_stays_within_its_band_for_1e5_periods() {
    // With one body, waking other threads takes longer than a step.
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread").install(energy_over_1e5_periods);
}

fn energy_over_1e5_periods() {
    const STEPS_PER_PERIOD: u64 = 12;
    let dt = 1.0 / 64.0;
    let omega = std::f64::consts::TAU / (STEPS_PER_PERIOD as f64 * dt);
    let band = (omega * dt).powi(2) / 4.0;
    let (scene, id) = oscillator(omega as f32, 0.0);
    let mut simulation = verlet(scene, Backend::Cpu);
    let first = energy(&mut simulation, id, omega);
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for _ in 0..100 {
        // Not a multiple of a period, so that all phases are met.
        simulation.run(1000 * STEPS_PER_PERIOD - 1, dt as f32).expect("steps");
        for _ in 0..STEPS_PER_PERIOD + 1 {
            simulation.run(1, dt as f32).expect("a step");
            let now = energy(&mut simulation, id, omega) / first;
            (least, most) = (least.min(now), most.max(now));
        }
    }
    println!("energy from {least} to {most}, band {band}");
    assert!(simulation.report().steps >= 100_000 * STEPS_PER_PERIOD);
    // Rounding to f32 adds a random walk: 2e-3 in 1.2 million steps.
    assert!(least > 1.0 - band - 5e-3 && most < 1.0 + 5e-3, "energy from {least} to {most}, band {band}");
    assert!(most - least > 0.5 * band, "energy from {least} to {most}, band {band}");
}

/// The bound that `check` reports for a spring: omega dt = 2 with linear forces.
fn the_stability_bound_is_two_over_omega(backend: Backend) {
    let omega = 8.0;
    let steps = on(backend, 2000, 200);
    for (factor, is_stable) in [(0.99, true), (1.01, false)] {
        let dt = factor * 2.0 / omega;
        let (scene, id) = oscillator(omega, 0.0);
        let warnings = scene.stability(dt, Integrator::VelocityVerlet);
        let unstable = warnings.iter().any(|warning| warning.effect == rockfall::stability::Effect::Unstable);
        assert_eq!(unstable, !is_stable, "{dt}: {warnings:?}");
        let mut simulation = verlet(scene, backend);
        let _ = simulation.run(steps, dt);
        let [x, _] = state(&mut simulation, id);
        assert_eq!(x.length() < 20.0, is_stable, "dt = {dt}: x = {x}");
    }
}

/// Steps forward, reversed velocities, the same steps again: back to the start, but for rounding.
fn time_can_be_reversed(backend: Backend) {
    let (scene, id) = oscillator(3.0, 0.0);
    let mut simulation = verlet(scene, backend);
    simulation.set_velocity(id, [0.2, 0.5, -0.3]).expect("a velocity");
    let before = state(&mut simulation, id);
    let (steps, dt) = (on(backend, 500, 60), 0.02);
    simulation.run(steps, dt).expect("steps");
    let [x, v] = state(&mut simulation, id);
    assert!(x.distance(before[0]) > 0.1);
    simulation.set_velocity(id, -v.as_vec3()).expect("a velocity");
    simulation.run(steps, dt).expect("steps");
    let [x, v] = state(&mut simulation, id);
    let error = x.distance(before[0]) + v.distance(-before[1]);
    assert!(error < 2e-5, "{error}");
}

/// x = e^(-C t / 2) (cos w t + C / (2 w) sin w t), w² = omega² - C²/4. The damping uses the velocity of half a step earlier, so the
/// error is of first order, about C dt / 2 of the amplitude per radian.
fn a_damped_oscillator_follows_the_closed_form(backend: Backend) {
    let (omega, damping) = (4.0_f64, 0.8_f64);
    let w = (omega * omega - 0.25 * damping * damping).sqrt();
    let exact = |t: f64| (-0.5 * damping * t).exp() * ((w * t).cos() + 0.5 * damping / w * (w * t).sin());
    let mut errors = Vec::new();
    for steps in on(backend, [160_u32, 320], [80, 160]) {
        let dt = 2.0 / f64::from(steps);
        let (scene, id) = oscillator(omega as f32, damping as f32);
        let mut simulation = verlet(scene, backend);
        let mut worst = 0.0_f64;
        for part in 1..=8 {
            simulation.run((steps / 8).into(), dt as f32).expect("steps");
            let [x, _] = state(&mut simulation, id);
            worst = worst.max((x.x - exact(0.25 * f64::from(part))).abs());
        }
        assert!(worst < damping * dt, "dt = {dt}: {worst}");
        errors.push(worst);
    }
    let ratio = errors[0] / errors[1];
    assert!((1.7..4.2).contains(&ratio), "{errors:?}");
}

/// Positions and velocities in the middle of the steps are the states of symplectic Euler.
fn positions_are_those_of_symplectic_euler(backend: Backend) {
    let (omega, damping, dt) = (4.0_f32, 0.5_f32, 1.0 / 64.0);
    let (scene, id) = oscillator(omega, damping);
    let (mut leap, mut verlet) = (simulation(scene.clone(), backend, Integrator::SymplecticEuler), verlet(scene, backend));
    // Half a kick back: the first kick of symplectic Euler then ends in the middle of the first step.
    leap.set_velocity(id, [0.5 * dt * omega * omega, 0.0, 0.0]).expect("a velocity");
    leap.step(1e-12).expect("a step that changes nothing");
    let first = state(&mut leap, id)[1].x;
    assert!((first - f64::from(0.5 * dt * omega * omega)).abs() < 1e-6);
    // The damping of the first kick of symplectic Euler acts on that velocity.
    let factor = 1.0 - dt * damping;
    leap.set_velocity(id, [0.5 * dt * omega * omega / factor, 0.0, 0.0]).expect("a velocity");
    for step in 0..on(backend, 400, 60) {
        leap.step(dt).expect("a step");
        verlet.step(dt).expect("a step");
        let [one, other] = [&mut leap, &mut verlet].map(|simulation| state(simulation, id)[0]);
        assert!(one.distance(other) < 2e-5, "step {step}: {one} and {other}");
    }
}

both!(
    the_stability_bound_is_two_over_omega,
    time_can_be_reversed,
    a_damped_oscillator_follows_the_closed_form,
    positions_are_those_of_symplectic_euler,
);
