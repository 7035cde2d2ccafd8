//! Muscles: springs whose rest length oscillates (docs/physics section 4.9).

use std::f64::consts::TAU;

use rockfall::{Backend, Checkpoint, Muscle, Simulation, Sphere, SphereId, Spring};

use crate::common::mixed::{Run, assert_bitwise_identical};
use crate::common::*;

/// Stiffness and rest length of the springs. With the masses 1 and 3, mu = 3/4 and w^2 = k / mu.
const K: f32 = 100.0;
const LENGTH: f32 = 1.0;
const MU: f64 = 0.75;

/// Masses 1 and 3 at rest, at the rest length of a spring that joins them.
fn pair(damping: f32, muscle: Option<Muscle>) -> (rockfall::Scene, [SphereId; 2]) {
    let mut scene = weightless();
    let ends = spheres(&mut scene, [Sphere::new([0.0; 3], 0.1), Sphere::new([LENGTH, 0.0, 0.0], 0.1).mass(3.0)]);
    let mut spring = Spring::new(ends[0], ends[1], K, LENGTH).damping(damping);
    spring.muscle = muscle;
    scene.add_spring(spring).expect("a valid spring");
    (scene, ends)
}

/// Distance of the pair and its rate of change.
fn length(simulation: &mut Simulation, ends: [SphereId; 2]) -> [f64; 2] {
    let [a, b] = ends.map(|end| simulation.sphere(end).expect("a sphere"));
    [f64::from(b.position.x - a.position.x), f64::from(b.velocity.x - a.velocity.x)]
}

/// d'' = -w^2 (d - l - l A sin Wt) with d = l and d' = 0 at first: d = l + l A w^2 / (w^2 - W^2) (sin Wt - W/w sin wt). RK4 with
/// 64 steps per period has an error of (w dt)^4/120 of the phase w t. A force at the wrong time within the step would have one of
/// w dt / 2.
fn a_driven_pair_follows_its_closed_form(backend: Backend) {
    let w = (f64::from(K) / MU).sqrt();
    let dt = (TAU / w / 64.0) as f32;
    for ratio in [0.5, 1.5] {
        let frequency = (ratio * w / TAU) as f32;
        let (scene, ends) = pair(0.0, Some(Muscle::new(0.1, frequency, 0.0)));
        let mut simulation = simulation(scene, backend);
        let driven = f64::from(frequency) * TAU;
        for steps in [20, 28] {
            simulation.run(steps, dt).expect("steps");
            let t = simulation.report().steps as f64 * f64::from(dt);
            let size = 0.1 * w * w / (w * w - driven * driven);
            let expected = 1.0 + size * ((driven * t).sin() - driven / w * (w * t).sin());
            close(length(&mut simulation, ends)[0], expected, 3e-6, "distance");
        }
    }
}

/// The steady amplitude of a damped pair is l A w^2 / sqrt((w^2 - W^2)^2 + C^2 W^2) with C = c / mu, since the muscle drives the
/// spring and not the damper. After 40 / C the start is forgotten to e^-20.
fn a_driven_pair_has_the_resonance_curve(backend: Backend) {
    // This takes thousands of steps.
    if backend == Backend::Gpu {
        return;
    }
    let (w, c) = ((f64::from(K) / MU).sqrt(), 3.0 / MU);
    for ratio in [0.25, 0.7, 0.98, 1.4, 3.0] {
        let frequency = (ratio * w / TAU) as f32;
        let (scene, ends) = pair(3.0, Some(Muscle::new(0.02, frequency, 0.2)));
        let mut simulation = simulation(scene, backend);
        let driven = f64::from(frequency) * TAU;
        let dt = (TAU / w.max(driven) / 100.0) as f32;
        simulation.run((40.0 / c / f64::from(dt)) as u64, dt).expect("steps");
        let mut largest: f64 = 0.0;
        for _ in 0..(TAU / driven / f64::from(dt)) as u32 + 1 {
            simulation.step(dt).expect("a step");
            let [d, v] = length(&mut simulation, ends);
            largest = largest.max((d - 1.0).hypot(v / driven));
        }
        let expected = 0.02 * w * w / ((w * w - driven * driven).powi(2) + (c * driven).powi(2)).sqrt();
        close(largest / expected, 1.0, 1e-3, "amplitude");
    }
}

/// The power of a muscle is dE/dl l' = -k (d - l) l'. Simpson's rule has a relative error of (w dt)^4 / 180.
fn the_work_of_a_muscle_equals_the_energy_gained(backend: Backend) {
    let (frequency, dt) = (1.7_f32, 1.0 / 128.0_f32);
    let (scene, ends) = pair(0.0, Some(Muscle::new(0.25, frequency, 0.125)));
    let spring = scene.spring_ids().next().expect("the spring");
    let mut simulation = simulation(scene, backend);
    let power = |simulation: &mut Simulation| {
        let turns = f64::from(frequency) * simulation.muscle_time() + 0.125;
        let rate = 0.25 * TAU * f64::from(frequency) * (TAU * turns).cos();
        let rest = simulation.rest_length(spring).expect("a rest length");
        close(rest, 1.0 + 0.25 * (TAU * turns).sin(), 1e-9, "rest length");
        -f64::from(K) * (length(simulation, ends)[0] - rest) * rate
    };
    let start = simulation.energy().expect("energies").total();
    let (mut before, mut work) = (power(&mut simulation), 0.0);
    for _ in 0..24 {
        simulation.step(dt).expect("a step");
        let middle = power(&mut simulation);
        simulation.step(dt).expect("a step");
        let after = power(&mut simulation);
        work += f64::from(dt) / 3.0 * (before + 4.0 * middle + after);
        before = after;
    }
    let gained = simulation.energy().expect("energies").total() - start;
    assert!(gained.abs() > 0.5, "{gained}");
    close(work, gained, 2e-4, "work");
}

/// Symplectic Euler evaluates the force at the start of a step. From d = l at rest, u1 = dt w^2 (l(0) - l), d1 = l + dt u1,
/// u2 = u1 + dt w^2 (l(dt) - d1).
fn symplectic_euler_takes_the_rest_length_at_the_start_of_a_step(backend: Backend) {
    let (dt, frequency, w2) = (1.0 / 32.0_f32, 3.0_f32, f64::from(K) / MU);
    let (scene, ends) = pair(0.0, Some(Muscle::new(0.2, frequency, 0.3)));
    let mut simulation = euler(scene, backend);
    let rest = |t: f64| 1.0 + 0.2 * (TAU * (f64::from(frequency) * t + f64::from(0.3_f32))).sin();
    let (mut d, mut u, step) = (1.0, 0.0, f64::from(dt));
    for n in 0..5 {
        simulation.step(dt).expect("a step");
        u += step * w2 * (rest(f64::from(n) * step) - d);
        d += step * u;
        let [distance, speed] = length(&mut simulation, ends);
        close(distance, d, 2e-6, "distance");
        close(speed, u, 2e-5, "rate");
    }
}

/// Phases depend on the number of steps alone, so calls of any size and resumed runs give bitwise identical results, also with
/// several time steps.
fn muscles_do_not_depend_on_how_steps_are_divided(backend: Backend) {
    let start = || simulation(pair(1.0, Some(Muscle::new(0.3, 3.7, 0.1))).0, backend);
    let parts = [(24, 0.01_f32), (9, 0.013), (13, 0.01)];
    let mut whole = start();
    for (steps, dt) in parts {
        whole.run(steps, dt).expect("steps");
    }
    let mut divided = start();
    for (steps, dt) in parts {
        divided.run(steps / 2, dt).expect("steps");
        let bytes = divided.checkpoint().expect("a checkpoint").to_bytes();
        divided = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("a checkpoint")).expect("it resumes");
        for _ in steps / 2..steps {
            divided.step(dt).expect("a step");
        }
    }
    assert_eq!(whole.muscle_time().to_bits(), divided.muscle_time().to_bits());
    assert_bitwise_identical(&Run::of(&mut whole), &Run::of(&mut divided));
    // A restored simulation goes back in time.
    let checkpoint = whole.checkpoint().expect("a checkpoint");
    let [first, second] = [(); 2].map(|()| {
        whole.restore(&checkpoint).expect("it goes back");
        whole.run(10, 0.02).expect("steps");
        Run::of(&mut whole)
    });
    assert_bitwise_identical(&first, &second);
}

/// A spring that gets a muscle during a run moves as if it had had one of amplitude 0.
fn a_muscle_may_be_added_and_removed_during_a_run(backend: Backend) {
    let muscle = Muscle::new(0.4, 2.0, 0.0);
    let none = Muscle::new(0.0, 2.0, 0.0);
    let [early, late] = [Some(none), None].map(|first| {
        let mut simulation = simulation(pair(0.5, first).0, backend);
        let spring = simulation.scene().spring_ids().next().expect("the spring");
        for (steps, wanted) in [(6, first), (9, Some(muscle)), (5, first), (4, Some(muscle))] {
            simulation.update_spring(spring, |spring| spring.muscle = wanted).expect("a valid muscle");
            simulation.run(steps, DT).expect("steps");
        }
        Run::of(&mut simulation)
    });
    assert!((early.spheres[0].velocity.length()) > 0.5, "{:?}", early.spheres);
    assert_bitwise_identical(&early, &late);
}

/// A snapshot goes on where the simulation is, up to the rounding of its phase to f32.
fn a_snapshot_goes_on_with_the_present_phase(backend: Backend) {
    let (scene, ends) = pair(1.0, Some(Muscle::new(0.3, 3.7, 0.1)));
    let mut whole = simulation(scene, backend);
    whole.run(13, 0.011).expect("steps");
    let mut other = simulation(whole.snapshot().expect("a scene"), backend);
    assert_eq!(other.report().time, 0.0);
    for simulation in [&mut whole, &mut other] {
        simulation.run(11, 0.011).expect("steps");
    }
    let [one, two] = [&mut whole, &mut other].map(|simulation| length(simulation, ends));
    close(one[0], two[0], 2e-6, "distance");
    close(one[1], two[1], 2e-5, "rate");
}

both!(
    a_driven_pair_follows_its_closed_form,
    a_driven_pair_has_the_resonance_curve,
    the_work_of_a_muscle_equals_the_energy_gained,
    symplectic_euler_takes_the_rest_length_at_the_start_of_a_step,
    muscles_do_not_depend_on_how_steps_are_divided,
    a_muscle_may_be_added_and_removed_during_a_run,
    a_snapshot_goes_on_with_the_present_phase,
);
