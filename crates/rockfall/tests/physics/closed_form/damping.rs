//! Linear and angular damping: v' = -C v and L' = -C L (docs/physics section 4.8).

use rockfall::model::world::World;
use rockfall::stability::Stiff;
use rockfall::{Backend, Capsule, Integrator, Options, Scene, Simulation, Sphere};

use crate::common::*;

/// Damping rates in 1/s.
const LINEAR: f32 = 0.75;
const ANGULAR: f32 = 1.25;
const STEPS: u64 = 128;
const VELOCITY: [f64; 3] = [3.0, -1.0, 2.0];
const MOMENTUM: [f64; 3] = [0.5, 0.25, -1.0];

fn damped() -> Scene {
    with(|settings| (settings.gravity, settings.linear_damping, settings.angular_damping) = (0.0, LINEAR, ANGULAR))
}

fn moving(position: [f32; 3], radius: f32) -> Sphere {
    Sphere::new(position, radius).velocity(VELOCITY.map(|v| v as f32)).angular_momentum(MOMENTUM.map(|l| l as f32))
}

/// exp(-C t) after all steps.
fn left(rate: f32) -> f64 {
    (-f64::from(rate) * STEPS as f64 * f64::from(DT)).exp()
}

/// v = v0 exp(-C t), x = x0 + v0 (1 - exp(-C t)) / C, L = L0 exp(-C t). RK4 leaves out (C dt)^5 / 120 a step, in all 4e-10; 128
/// steps round by some 1e-6.
fn sphere_slows_exponentially(backend: Backend) {
    let mut scene = damped();
    let [ball] = spheres(&mut scene, [moving([0.0; 3], 0.5)]);
    let mut simulation = simulation(scene, backend);
    simulation.run(STEPS, DT).expect("steps");
    let state = simulation.sphere(ball).expect("the sphere");
    near(state.velocity, VELOCITY.map(|v| v * left(LINEAR)), 3e-6, "velocity");
    near(state.position, VELOCITY.map(|v| v * (1.0 - left(LINEAR)) / f64::from(LINEAR)), 5e-6, "position");
    near(state.angular_momentum, MOMENTUM.map(|l| l * left(ANGULAR)), 2e-6, "angular momentum");
}

/// Symplectic Euler multiplies by 1 - C dt in every step.
fn symplectic_euler_slows_by_the_same_factor_every_step(backend: Backend) {
    let mut scene = damped();
    let [ball] = spheres(&mut scene, [moving([0.0; 3], 0.5)]);
    let mut simulation = euler(scene, backend);
    simulation.run(STEPS, DT).expect("steps");
    let state = simulation.sphere(ball).expect("the sphere");
    let after = |rate: f32| (1.0 - f64::from(rate) * f64::from(DT)).powi(STEPS as i32);
    near(state.velocity, VELOCITY.map(|v| v * after(LINEAR)), 3e-6, "velocity");
    near(state.angular_momentum, MOMENTUM.map(|l| l * after(ANGULAR)), 2e-6, "angular momentum");
}

/// With gravity G the velocity tends to G / C: v = (G / C) (1 - exp(-C t)). A change of less than half a unit in the last place of v,
/// 1.2e-7, is lost in a step: v stops up to 1.2e-7 / (C dt) = 2e-6 before its limit; rounding adds as much.
fn falling_sphere_tends_to_its_terminal_velocity(backend: Backend) {
    let mut scene = with(|settings| (settings.gravity, settings.linear_damping) = (10.0, 4.0));
    let [ball] = spheres(&mut scene, [Sphere::new([0.0; 3], 0.5)]);
    let mut simulation = simulation(scene, backend);
    for seconds in [0.25_f64, 0.5, 4.0] {
        let steps = (seconds / f64::from(DT)) as u64 - simulation.report().steps;
        simulation.run(steps, DT).expect("steps");
        let expected = -2.5 * (1.0 - (-4.0 * seconds).exp());
        close(simulation.sphere(ball).expect("the sphere").velocity.y, expected, 5e-6, "velocity");
    }
}

/// On a GPU a workgroup sums the forces on a large sphere: it slows like all others.
fn large_sphere_slows_like_small_ones(backend: Backend) {
    let mut scene = damped();
    let small = (0..64_u8).map(|k| moving([f32::from(k % 8), f32::from(k / 8), 0.0], 0.1));
    for sphere in small.chain([moving([0.0, 0.0, 100.0], 20.0).mass(3.0)]) {
        scene.add_sphere(sphere).expect("a valid sphere");
    }
    assert_eq!(World::build_in_space(&scene).expect("a world").step.layout.large, 1);
    let mut simulation = simulation(scene, backend);
    simulation.run(STEPS, DT).expect("steps");
    for state in simulation.spheres().expect("states") {
        near(state.velocity, VELOCITY.map(|v| v * left(LINEAR)), 3e-6, "velocity");
        near(state.angular_momentum, MOMENTUM.map(|l| l * left(ANGULAR)), 2e-6, "angular momentum");
    }
}

/// Rods and capsules move by the spheres at their ends. Both bodies here are rigid: ends of mass 1 at a distance of 1 from the middle,
/// of inertia I = 0.4 * 0.25^2 = 0.025 each. The middle slows at the rate Cv. Of the angular momentum per end, 1 + I times the angular
/// velocity, the ends' motion loses at the rate Cv and their spin at the rate CL: in all at (Cv + I CL) / (1 + I).
fn rod_and_capsule_slow_by_their_ends(backend: Backend) {
    let ends = [[-1.0, 1.0], [1.0, -1.0]].map(|[x, v]: [f32; 2]| {
        Sphere::new([x, 0.0, 0.0], 0.25).velocity([0.0, 2.0 + v, 0.0]).angular_momentum([0.0, 0.0, -0.025])
    });
    let mut scene = damped();
    dumbbell(&mut scene, ends, 0.2);
    let mut rod = simulation(scene, backend);
    let mut scene = damped();
    let capsule = scene.add_capsule(Capsule::new([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.25).mass(2.0)).expect("a valid capsule");
    let parts = *scene.capsule(capsule).expect("the capsule");
    let mut capsule = simulation(scene, backend);
    for (end, moving) in [parts.end1, parts.end2].into_iter().zip(ends) {
        capsule.set_velocity(end, moving.velocity).expect("a sphere");
        capsule.set_angular_momentum(end, moving.angular_momentum).expect("a sphere");
    }
    for simulation in [&mut rod, &mut capsule] {
        let turning = |simulation: &mut Simulation| {
            let [one, two] = simulation.spheres().expect("states")[..] else { panic!("two spheres") };
            let middle = (one.velocity + two.velocity) * 0.5;
            let half = (two.position - one.position) * 0.5;
            (middle, half.cross(two.velocity - middle).z / half.length_squared())
        };
        let (_, before) = turning(simulation);
        simulation.run(STEPS, DT).expect("steps");
        let (middle, after) = turning(simulation);
        near(middle, [0.0, 2.0 * left(LINEAR), 0.0], 1e-5, "velocity of the middle");
        close(after / before, left((LINEAR + 0.025 * ANGULAR) / 1.025), 1e-4, "rotation");
    }
}

/// A damped velocity is multiplied by 1 - z (symplectic Euler) or 1 - z + z^2/2 - z^3/6 + z^4/24 (RK4) in every step, z = C dt: it grows
/// above z = 2 and z = 2.785. `Scene::stability` warns just above.
fn damping_is_stable_up_to_the_time_step_that_is_stated(backend: Backend) {
    for (integrator, bound) in [(Integrator::Rk4, 2.78), (Integrator::SymplecticEuler, 2.0)] {
        for (share, is_stable) in [(0.97, true), (1.03, false)] {
            let mut scene = damped();
            scene.settings.angular_damping = 0.0;
            let [ball] = spheres(&mut scene, [moving([0.0; 3], 0.5)]);
            let dt = (share * bound / f64::from(LINEAR)) as f32;
            let warnings = scene.stability(dt, integrator);
            assert_eq!(warnings.iter().any(|warning| warning.what == Stiff::LinearDamping), !is_stable, "{integrator} {share}");
            let options = Options::new().backend(backend).integrator(integrator);
            let mut simulation = Simulation::with_options(scene, options).expect("a simulation");
            simulation.run(60, dt).expect("steps");
            let speed = f64::from(simulation.sphere(ball).expect("the sphere").velocity.length());
            let before = VELOCITY.iter().map(|v| v * v).sum::<f64>().sqrt();
            assert_eq!(speed < before, is_stable, "{integrator} {share}: {speed}");
        }
    }
}

both!(
    damping_is_stable_up_to_the_time_step_that_is_stated,
    sphere_slows_exponentially,
    symplectic_euler_slows_by_the_same_factor_every_step,
    falling_sphere_tends_to_its_terminal_velocity,
    large_sphere_slows_like_small_ones,
    rod_and_capsule_slow_by_their_ends,
);
