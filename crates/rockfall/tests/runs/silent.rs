//! Scenes that once gave wrong results without a message: slow motion, stiff grains, and collisions and capsules of symplectic
//! Euler.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, ContactAction, Cuboid, ForceInput, ForceLaw, ForceLoad, Integrator, Options, Precision, Scene, Simulation, Sphere,
    Spring, Tether,
};

const INTEGRATORS: [Integrator; 3] = [Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet];

fn scene(name: &str) -> Scene {
    let path = format!("{}/tests/runs/silent/{name}.txt", env!("CARGO_MANIFEST_DIR"));
    Scene::load(path).expect("a scene").scene
}

fn opened(scene: Scene, backend: Backend, integrator: Integrator) -> Simulation {
    let options = Options::new().backend(backend).integrator(integrator);
    Simulation::with_options(scene, options).expect("a simulation")
}

/// Software Vulkan takes fewer steps.
fn fewer(backend: Backend, steps: u64) -> u64 {
    crate::common::on(backend, steps, steps / 20)
}

/// Runs a scene without forces and asserts that every body moves by v t.
fn moves_freely(mut simulation: Simulation, steps: u64, dt: f32) {
    let before = simulation.spheres().expect("states").to_vec();
    simulation.run(steps, dt).expect("steps");
    let time = steps as f64 * f64::from(dt);
    for (after, before) in simulation.spheres().expect("states").iter().zip(before) {
        let moved = DVec3::from_array(after.centre()) - DVec3::from_array(before.centre());
        let expected = before.velocity.as_dvec3() * time;
        assert!(moved.distance(expected) < 1e-3 * expected.length(), "moved by {moved}, expected {expected}");
    }
}

/// A step of 20 nm, 0.6 units from the origin, and one of 40 nm, 5 units from it, are less than half the distance of neighbouring f32
/// numbers.
fn slow_bodies_move(backend: Backend) {
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        for precision in [Precision::Auto, Precision::Single] {
            let mut grain = scene("slow-grain");
            grain.settings.precision = precision;
            moves_freely(opened(grain, backend, integrator), fewer(backend, 100_000), 1e-6);
        }
    }
    for integrator in INTEGRATORS {
        moves_freely(opened(scene("slow-capsule"), backend, integrator), fewer(backend, 20_000), 1e-5);
    }
}

/// A wave in a chain of 60 steel beads keeps the energy of the first bead. With positions rounded to f32 it grew nineteenfold.
fn a_chain_of_steel_beads_keeps_its_energy(backend: Backend) {
    let mut simulation = opened(scene("steel-chain"), backend, Integrator::VelocityVerlet);
    let before = simulation.energy().expect("energies").total();
    for _ in 0..5 {
        simulation.run(fewer(backend, 1_300), 4e-7).expect("steps");
        let change = simulation.energy().expect("energies").total() / before - 1.0;
        assert!(change.abs() < 0.01, "{change}");
    }
}

/// The height of an elastic ball above a floor, and its energy, stay the same for ever.
fn an_elastic_ball_keeps_its_energy_with_symplectic_euler(backend: Backend) {
    let mut simulation = opened(scene("bouncing-ball"), backend, Integrator::SymplecticEuler);
    // Without the energy of the contact, while the ball is in the floor.
    let energy = |simulation: &mut Simulation| {
        let energy = simulation.energy().expect("energies");
        energy.kinetic + energy.potential
    };
    let before = energy(&mut simulation);
    for _ in 0..10 {
        simulation.run(fewer(backend, 2_000), 0.02).expect("steps");
        let change = energy(&mut simulation) / before - 1.0;
        assert!(change.abs() < 0.002, "{change}");
    }
    assert!(simulation.report().total_collisions > 10);
}

/// Four triangles of springs in an elastic cube. Energies from 27.7 rose to 4,576 in 5,000 steps of 20 ms.
fn springs_with_elastic_collisions_keep_their_energy(backend: Backend) {
    for (integrator, dt, bound) in [(Integrator::SymplecticEuler, 0.01, 0.3), (Integrator::SymplecticEuler, 0.02, 0.5)] {
        let mut simulation = opened(scene("spring-triangles"), backend, integrator);
        let before = simulation.energy().expect("energies").total();
        simulation.run(fewer(backend, 4_000), dt).expect("steps");
        let change = simulation.energy().expect("energies").total() / before - 1.0;
        assert!(change.abs() < bound, "{integrator}, {dt}: {change}");
    }
}

/// A ball that a force of 50 presses on a floor rests on it, as under gravity of 50.
fn a_pressed_ball_rests_on_its_floor(backend: Backend) {
    for integrator in INTEGRATORS {
        let mut simulation = opened(scene("pressed-ball"), backend, integrator);
        simulation.run(crate::common::on(backend, 1_000, 200), 0.02).expect("steps");
        let ball = &simulation.spheres().expect("states")[0];
        assert!(ball.position.y > 0.0 && ball.velocity.length() < 0.05, "{integrator}: {ball:?}");
    }
}

fn a_heavy_ball_rests_on_a_light_one(backend: Backend) {
    for integrator in INTEGRATORS {
        let mut simulation = opened(scene("heavy-on-light"), backend, integrator);
        simulation.run(crate::common::on(backend, 2_000, 400), 0.005).expect("steps");
        let balls = simulation.spheres().expect("states");
        let fastest = balls.iter().map(|ball| ball.velocity.length()).fold(0.0, f32::max);
        assert!(fastest < 0.02 && balls[1].position.y > 0.27, "{integrator}: {balls:?}");
    }
}

/// The impulse that is reported before a step is the change of momentum in it. With symplectic Euler, 12.37 was reported and 14.15
/// applied.
fn reported_impulses_are_applied(backend: Backend) {
    const GRAVITY: f32 = 100.0;
    const STEP: f32 = 0.01;
    for integrator in INTEGRATORS {
        let mut scene = Scene::new();
        (scene.settings.gravity, scene.settings.restitution) = (GRAVITY, 0.5);
        scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0])).expect("a box");
        scene.add_sphere(Sphere::new([0.0, 0.21, 0.0], 0.1).mass(2.0)).expect("a ball");
        let mut simulation = opened(scene, backend, integrator);
        simulation.set_time_step(STEP).expect("a time step");
        let momentum = |simulation: &mut Simulation| simulation.energy().expect("energies").momentum.y;
        let impact = (0..10).find_map(|_| {
            let before = momentum(&mut simulation);
            let action = simulation.contacts().expect("contacts").first().map(|contact| contact.action);
            simulation.step(STEP).expect("a step");
            let applied = momentum(&mut simulation) - before + f64::from(2.0 * GRAVITY * STEP);
            match action {
                // On the box, so the ball gets the opposite.
                Some(ContactAction::Impulse(impulse)) => Some((f64::from(-impulse.y), applied)),
                _ => None,
            }
        });
        let (reported, applied) = impact.expect("an impact");
        assert!((reported / applied - 1.0).abs() < 1e-4, "{integrator}: {reported} reported, {applied} applied");
    }
}

/// A tether and a spring 20 km from the origin, where positions as f32 are 2 mm apart. The reported energy grew from 0.50 to 0.62.
fn energies_of_springs_have_the_low_parts_of_positions(backend: Backend) {
    for has_spring in [false, true] {
        let mut scene = Scene::new();
        (scene.settings.gravity, scene.settings.precision) = (0.0, Precision::Double);
        let anchor = [20_000.0, 0.0, 0.0];
        let ball = scene.add_sphere(Sphere::new(anchor, 0.1).centred_at([20_001.01, 0.0, 0.0]).mass(1.0)).expect("a ball");
        if has_spring {
            let fixed = scene.add_sphere(Sphere::new(anchor, 0.1).fixed()).expect("a fixed ball");
            scene.add_spring(Spring::new(fixed, ball, 1e4, 1.0)).expect("a spring");
        } else {
            scene.add_tether(Tether::new(ball, anchor, 1e4).length(1.0)).expect("a tether");
        }
        let mut simulation = opened(scene, backend, Integrator::VelocityVerlet);
        let before = simulation.energy().expect("energies").total();
        assert!((before - 0.5).abs() < 1e-4, "{before}");
        for _ in 0..50 {
            simulation.run(9, 7e-4).expect("steps");
            let energy = simulation.energy().expect("energies").total();
            assert!((energy - 0.5).abs() < 0.005, "{energy}");
        }
    }
}

/// Asserts that an energy stays within 4 %, which covers the half step between velocities and positions.
fn keeps(mut simulation: Simulation, steps: u64, dt: f32, energy: impl Fn(&mut Simulation) -> f64) {
    let before = energy(&mut simulation);
    for _ in 0..20 {
        simulation.run(steps / 20, dt).expect("steps");
        let change = energy(&mut simulation) / before - 1.0;
        assert!(change.abs() < 0.04, "{change}");
    }
}

/// Forces on the ends of a capsule. With symplectic Euler 27 % of the energy were left after 4,000 steps of 10 ms.
fn a_capsule_between_tethers_keeps_its_energy(backend: Backend) {
    for integrator in INTEGRATORS {
        let simulation = opened(scene("tethered-capsule"), backend, integrator);
        keeps(simulation, fewer(backend, 4_000), 0.01, |simulation| simulation.energy().expect("energies").total());
    }
}

/// A torque on the spins of the ends, with the potential -k x^2 / 2 per end.
fn a_capsule_that_is_turned_by_its_spins_keeps_its_energy(backend: Backend) {
    const K: f32 = 30.0;
    for integrator in INTEGRATORS {
        let law = ForceLaw::new("compass").parameter("k", K);
        // A build without the feature `wgsl` cannot read the text.
        let law = if cfg!(feature = "wgsl") {
            law.wgsl("torque = k * position.x * cross(position, vec3f(1.0, 0.0, 0.0));")
        } else {
            law.function(|body: &ForceInput<'_>| ForceLoad {
                force: Vec3::ZERO,
                torque: body.parameters[0] * body.position.x * body.position.cross(Vec3::X),
            })
        };
        let options = Options::new().backend(backend).integrator(integrator).force_law(law);
        let simulation = Simulation::with_options(scene("magnetic-capsule"), options).expect("a simulation");
        keeps(simulation, fewer(backend, 4_000), 0.01, |simulation| {
            let kinetic = simulation.energy().expect("energies").total();
            let squares = simulation.spheres().expect("states").into_iter().map(|end| 0.09 - f64::from(end.position.x).powi(2));
            kinetic + 0.5 * f64::from(K) * squares.sum::<f64>()
        });
    }
}

both_in_turn! {
    slow_bodies_move,
    a_chain_of_steel_beads_keeps_its_energy,
    an_elastic_ball_keeps_its_energy_with_symplectic_euler,
    springs_with_elastic_collisions_keep_their_energy,
    a_pressed_ball_rests_on_its_floor,
    a_heavy_ball_rests_on_a_light_one,
    reported_impulses_are_applied,
    energies_of_springs_have_the_low_parts_of_positions,
    a_capsule_between_tethers_keeps_its_energy,
    a_capsule_that_is_turned_by_its_spins_keeps_its_energy,
}
