//! Faults of the thesis's collision and contact model that this model corrects. Every test has its own scene, and its
//! expected values are derived by hand.
//!
//! This file tests the errata E19 to E30 of `docs/physics`, together with `faults/surfaces.rs` (E27), `faults/edges.rs` (E28),
//! `faults/chains.rs` (E29) and `faults/frames.rs` (E30). Each test's name begins with the number of its erratum. The other files in `faults/` test corrections that are not errata.

use rockfall::{Backend, Cuboid, Integrator, Scene, Simulation, Sphere, SphereState};

use crate::common::{on, spheres, weightless, with};
use scenes::{Random, after, angular, in_gravity, kinetic, open, opened, scene, within};

mod chains;
mod edges;
mod forces;
mod frames;
mod lengths;
mod networks;
pub(crate) mod scenes;
mod surfaces;

/// Settings for a smooth elastic collision without gravity.
const ELASTIC: &str = "set gravity 0\nset restitution 1\nset friction 0\nset contact_damping 0\n";

/// One end of a level capsule falls on a face that ends below it, e = 1, without friction. A rigid body keeps its kinetic energy,
/// 1. It kept 0.38 of it when the end had the inverse mass of a single sphere (E20).
fn e20_a_level_capsule_rebounds_as_a_rigid_body(backend: Backend) {
    for dt in [0.02, 0.01, 0.005, 0.002] {
        let scene = "C -0.25 0.52 0  0.25 0.52 0  0 -1 0  2 0.5\nP -0.5 0 -1  0 0 2  0.25 0 0\n";
        let mut simulation = open(&format!("{scene}{ELASTIC}"), backend);
        within(kinetic(&after(&mut simulation, (0.2 / dt) as u64, dt)), 1.0, 1e-3, "kinetic energy");
        assert!(simulation.report().total_collisions > 0, "the capsule must hit the floor");
    }
}

/// Oblique elastic drops on one end keep the kinetic energy of a rigid body, 1.
fn e20_an_oblique_capsule_keeps_its_energy(backend: Backend) {
    for degrees in [15.0_f32, 30.0, 45.0, 60.0, 75.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let low = 0.32;
        let scene = format!("C 0 {low} 0  {} {} 0  0 -1 0  2 0.3\nP -50 0 -50  0 0 100  100 0 0\n", 0.8 * cos, low + 0.8 * sin);
        let spheres = after(&mut open(&format!("{scene}{ELASTIC}"), backend), 10, 0.005);
        assert!(spheres.iter().any(|sphere| sphere.velocity.y > -0.9), "the capsule must hit the floor");
        within(kinetic(&spheres), 1.0, 1e-3, "kinetic energy");
    }
}

/// Two smooth elastic balls collide obliquely with a closing speed of 10. Their angular momentum is that of their
/// initial straight paths: -0.35 * 5 * 2.
fn e21_an_oblique_pair_keeps_its_angular_momentum(backend: Backend) {
    let pair = "S 1 -1.28 0.35 0  5 0 0  0 0 0 1 0.5\nS 2 1.28 -0.35 0  -5 0 0  0 0 0 1 0.5\n";
    let spheres = after(&mut open(&format!("{pair}{ELASTIC}"), backend), 30, 0.02);
    assert!(spheres[0].velocity.x < 4.9, "the balls must collide");
    within(angular(&spheres).z, -3.5, 1e-5, "angular momentum");
    within(kinetic(&spheres), 25.0, 1e-5, "kinetic energy");
}

/// The same for 200 random pairs, or for 30 on the GPU backend, because software Vulkan needs a second to open each.
/// With the thesis's rule the mean error was 9 %.
fn e21_random_pairs_keep_their_angular_momentum(backend: Backend) {
    let mut random = Random::new(7);
    let wanted = if backend == Backend::Gpu { 30 } else { 200 };
    let (mut hits, mut sum) = (0, 0.0);
    while hits < wanted {
        let offset = random.between(-0.9, 0.9) as f32;
        let speed = random.between(3.0, 10.0) as f32;
        let masses = [random.between(0.5, 2.0), random.between(0.5, 2.0)].map(|mass| mass as f32);
        let mut scene = weightless();
        (scene.settings.restitution, scene.settings.friction, scene.settings.contact_damping) = (1.0, 0.0, 0.0);
        let ball = |side: f32, mass: f32| {
            Sphere::new([side * 1.3, side * 0.5 * offset, 0.0], 0.5).mass(mass).velocity([-side * speed / 2.0, 0.0, 0.0])
        };
        spheres(&mut scene, [ball(-1.0, masses[0]), ball(1.0, masses[1])]);
        let mut simulation = opened(scene, backend, Integrator::Rk4);
        let before = simulation.spheres().expect("spheres");
        let steps = (2.0 / (speed * 0.02)).ceil() as u64;
        let spheres = after(&mut simulation, steps, 0.02);
        // Grazing pairs may meet and separate within one step.
        if simulation.report().total_collisions == 0 {
            continue;
        }
        hits += 1;
        let (was, is) = (angular(&before).z, angular(&spheres).z);
        sum += (is - was).abs() / was.abs().max(0.1);
    }
    let mean = sum / f64::from(wanted);
    assert!(mean < 1e-5, "mean error {mean}");
}

const TRIANGLE: &str = "S 1 -0.6 0 0  0 -1 0  0 0 0 1 0.5\nS 2 0.6 0 0  0 1 0  0 0 0 1 0.5\nS 3 0 1.2 0  2 0 0  0 0 0 1 0.5\n\
                        K 1 2 5 0.5 0\nK 1 3 5 0.5 0\nK 2 3 5 0.5 0\n";

/// Three smooth elastic balls on springs, without external forces, for 200 s: the angular momentum is -1.2. With the
/// thesis's rule it drifted to -15.9.
fn e21_a_spring_triangle_keeps_its_angular_momentum(backend: Backend) {
    let mut simulation = open(&format!("{TRIANGLE}{ELASTIC}"), backend);
    within(angular(&after(&mut simulation, 10_000, 0.02)).z, -1.2, 0.01, "angular momentum");
    assert!(simulation.report().total_collisions > 500);
}

/// The energy of the same triangle, 3 + 5/2 (0.7^2 + 2 (sqrt(1.8) - 0.5)^2) = 7.77, after 10,000 steps. The test takes
/// the median of the last hundred states, because part of the energy is stored in the contact while two balls overlap.
/// At 20 ms the energy rose to 58.6, and to 34.8 when the rebound did not allow for the springs. The remaining loss
/// occurs where three balls meet, a few times in 100 s.
fn e21_a_spring_triangle_keeps_its_energy(backend: Backend) {
    for (dt, tolerance) in [(0.02, 0.03), (0.005, 0.01)] {
        let mut simulation = open(&format!("{TRIANGLE}{ELASTIC}"), backend);
        after(&mut simulation, 9_900, dt);
        let mut energies: Vec<f64> = (0..100).map(|_| energy_of_triangle(&after(&mut simulation, 1, dt))).collect();
        energies.sort_by(f64::total_cmp);
        within(energies[50], 7.767, tolerance, "energy");
    }
}

fn energy_of_triangle(spheres: &[SphereState]) -> f64 {
    let stretched = |[a, b]: [usize; 2]| f64::from(spheres[a].position.distance(spheres[b].position)) - 0.5;
    kinetic(spheres) + [[0, 1], [0, 2], [1, 2]].map(|ends| 2.5 * stretched(ends).powi(2)).into_iter().sum::<f64>()
}

/// An elastic ball bounces on a floor, G = 10: its energy stays at 10 * 1.5. With the thesis's rule it rose to 246 in
/// 400 s.
fn e21_an_elastic_ball_keeps_its_height(backend: Backend) {
    let ball = "S 1 0 1.5 0  0 0 0  0 0 0 1 0.5\nP -50 0 -50  0 0 100  100 0 0\nset gravity 10\nset restitution 1\n";
    let spheres = after(&mut open(ball, backend), 20_000, 0.02);
    within(in_gravity(&spheres, 10.0, 0.0), 15.0, 0.01, "energy");
}

/// The n-th bounce of a ball reaches e^(2n) of the drop height, at a time step of 1/64.
fn e21_bounces_reach_their_expected_heights(backend: Backend) {
    let ball = "S 1 0 2.5 0  0 0 0  0 0 0 1 0.5\nP -50 0 -50  0 0 100  100 0 0\nset gravity 10\n";
    let mut simulation = open(ball, backend);
    let mut bounces = 0;
    while bounces < 5 {
        let before = simulation.report().total_collisions;
        let spheres = after(&mut simulation, 1, 1.0 / 64.0);
        if simulation.report().total_collisions == before {
            continue;
        }
        bounces += 1;
        let height = in_gravity(&spheres, 10.0, 0.5) / 10.0;
        within(height, 2.0 * 0.75_f64.powi(2 * bounces), 0.01, "height of a bounce");
    }
}

/// A ball of radius 0.1 at G = 9.81 and dt = 0.02: in one step, gravity alone adds more than the thesis's threshold
/// velocity of 0.1. With that threshold the ball never came to rest.
fn e19_a_small_ball_comes_to_rest(backend: Backend) {
    let ball = "S 1 0 0.3 0  0 0 0  0 0 0 1 0.1\nP -50 0 -50  0 0 100  100 0 0\nset gravity 9.81\n";
    assert_comes_to_rest(&mut opened(scene(ball), backend, Integrator::Rk4), 0.1, 9.81, 0.02);
}

/// The same for other radii, gravities and time steps, on a polygon and on a box. The overlap at rest is G / Cc; it
/// must be less than the radius.
fn e19_balls_of_any_size_come_to_rest(backend: Backend) {
    let cases =
        [(0.01, 1.0, 0.02), (0.1, 10.0, 0.005), (0.5, 1.0, 0.0005), (1.0, 100.0, 0.02), (10.0, 9.81, 0.01), (1.0, 0.1, 0.02)];
    for (radius, gravity, dt) in cases {
        for floor in ["P -50 0 -50  0 0 100  100 0 0", "B -50 -1 -50  100 0 0  0 1 0  0 0 100"] {
            let ball = format!("S 1 0 {} 0  0 0 0  0 0 0 1 {radius}\n{floor}\nset gravity {gravity}\n", 1.2 * radius);
            for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
                assert_comes_to_rest(&mut opened(scene(&ball), backend, integrator), radius, gravity, dt);
            }
        }
    }
}

/// Asserts that the ball comes to rest on the floor with the expected overlap, without further collisions.
fn assert_comes_to_rest(simulation: &mut Simulation, radius: f32, gravity: f32, dt: f32) {
    let steps = ((20.0 + 20.0 * (radius / gravity).sqrt()) / dt) as u64;
    simulation.run(steps, dt).expect("steps");
    let collisions = simulation.report().total_collisions;
    let sphere = after(simulation, 200, dt)[0];
    assert_eq!(
        simulation.report().total_collisions,
        collisions,
        "radius {radius}, G {gravity}, dt {dt}: the ball still collides"
    );
    assert!(
        sphere.velocity.length() < 1e-3 * (gravity * radius).sqrt(),
        "radius {radius}, G {gravity}, dt {dt}: {}",
        sphere.velocity
    );
    let overlap = radius - sphere.position.y;
    let expected = gravity / 1000.0;
    assert!((overlap - expected).abs() < 0.02 * expected + 1e-6 * radius, "radius {radius}, G {gravity}: overlap {overlap}");
}

/// A groove between two boxes, and a ball that falls into it at a speed of 5.
fn groove(degrees: f32) -> Scene {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mut text = format!("S 1 0 {} 0  0 -5 0  0 0 0 1 0.5\n", 0.5 / cos + 0.5);
    for side in [-1.0, 1.0] {
        let (out, down) = ([side * 10.0 * cos, 10.0 * sin], [side * 3.0 * sin, -3.0 * cos]);
        text += &format!("B 0 0 -5  {} {} 0  {} {} 0  0 0 10\n", out[0], out[1], down[0], down[1]);
    }
    scene(&(text + ELASTIC))
}

/// An elastic ball that falls into a symmetric groove leaves it at its initial speed, K = 12.5. In the thesis's model,
/// a wall that the ball was already leaving after an impulse still applied its contact force: K rose to 21.6.
fn e22_a_ball_leaves_a_groove_at_its_initial_speed(backend: Backend) {
    for (degrees, least, most) in [(15.0, 0.99, 1.01), (30.0, 0.99, 1.01), (44.0, 0.99, 1.01), (60.0, 0.95, 1.01)] {
        let spheres = after(&mut opened(groove(degrees), backend, Integrator::Rk4), 100, 0.005);
        let kept = kinetic(&spheres) / 12.5;
        assert!(spheres[0].velocity.y > 1.0, "{degrees} degrees: the ball must leave the groove");
        assert!((least..most).contains(&kept), "{degrees} degrees: kept {kept} of the kinetic energy");
    }
}

/// A rod that lies flat falls on a box, e = 1. Two edges of the box hit it at the same time. It leaves at its initial
/// speed, K = 1.
fn e22_a_rod_leaves_a_box_at_its_initial_speed(backend: Backend) {
    let text = "S 1 -1 0.25 0 0 -1 0 0 0 0 1 0.05\nS 2 1 0.25 0 0 -1 0 0 0 0 1 0.05\nR 1 2 0.2 2\nB -0.5 -1 -1 1 0 0 0 1 0 0 0 2\n\
                set gravity 0\nset restitution 1\nset friction 0\nset contact_damping 0\n";
    for dt in [0.02, 0.005] {
        let mut simulation: Simulation = open(text, backend);
        let spheres = after(&mut simulation, (0.3 / dt) as u64, dt);
        assert!(spheres[0].velocity.y > 0.5, "the rod must leave the box: {}", spheres[0].velocity);
        within(kinetic(&spheres), 1.0, 0.01, "kinetic energy");
    }
}

/// A floor, and settings for smooth elastic collisions without gravity.
const ON_A_FLOOR: &str =
    "P -50 0 -50  0 0 100  100 0 0\nset gravity 0\nset restitution 1\nset friction 0\nset contact_damping 0\n";

/// Drops a network on the floor. Returns its kinetic energy after the collision.
fn rebound(network: &str, backend: Backend, dt: f32) -> f64 {
    let mut simulation = open(&format!("{network}{ON_A_FLOOR}"), backend);
    let spheres = after(&mut simulation, (0.1 / dt) as u64, dt);
    assert!(simulation.report().total_collisions > 0, "the network must hit the floor");
    kinetic(&spheres)
}

/// Drops a frame on the floor: with continuous collisions as a network, and without them as a rigid body, whose contact takes its time.
fn assert_frame_rebounds(frame: &str, backend: Backend, energy: f64) {
    for dt in [0.02, 0.005, 0.001] {
        within(rebound(&format!("{frame}set continuous_collisions on\n"), backend, dt), energy, 0.01, "kinetic energy");
    }
    let mut simulation = open(&format!("{frame}{ON_A_FLOOR}"), backend);
    let spheres = after(&mut simulation, on(backend, 400, 80), on(backend, 0.001, 0.005));
    let up = spheres.iter().map(|sphere| sphere.velocity.y).sum::<f32>();
    assert!(up > 0.0 && simulation.contacts().expect("contacts").is_empty(), "the frame must leave the floor");
    within(kinetic(&spheres), energy, 0.01, "kinetic energy of a body");
}

/// A tetrahedron of rods of fixed length lands on a vertex: K = 2. It kept 0.025 when the collision treated the vertex
/// as a single sphere.
fn e23_a_tetrahedron_rebounds_with_its_energy(backend: Backend) {
    let frame = "S 1 0.000000 0.115000 0.000000 0 -1 0 0 0 0 1 0.1\nS 2 0.577350 0.931497 0.000000 0 -1 0 0 0 0 1 0.1\n\
                 S 3 -0.288675 0.931497 0.500000 0 -1 0 0 0 0 1 0.1\nS 4 -0.288675 0.931497 -0.500000 0 -1 0 0 0 0 1 0.1\n\
                 R 1 2 0.02 1\nR 1 3 0.02 1\nR 2 3 0.02 1\nR 1 4 0.02 1\nR 2 4 0.02 1\nR 3 4 0.02 1\n";
    assert_frame_rebounds(frame, backend, 2.0);
}

/// A tilted triangle lands on a vertex: K = 3/2.
fn e23_a_triangle_rebounds_with_its_energy(backend: Backend) {
    let frame = "S 1 0 0.115 0 0 -1 0 0 0 0 1 0.1\nS 2 0.8 0.715 0 0 -1 0 0 0 0 1 0.1\nS 3 -0.352 0.951 0 0 -1 0 0 0 0 1 0.1\n\
                 R 1 2 0.02 1\nR 1 3 0.02 0.907263\nR 2 3 0.02 1.175925\n";
    assert_frame_rebounds(frame, backend, 1.5);
}

/// An upright chain of five spheres lands on its lowest one and rebounds with its whole mass, K = 5/2.
fn e23_an_upright_chain_rebounds_with_its_energy(backend: Backend) {
    let spheres: String = (0..5).map(|n| format!("S {n} 0 {} 0 0 -1 0 0 0 0 1 0.1\n", 0.115 + 0.5 * n as f32)).collect();
    let rods: String = (1..5).map(|n| format!("R {} {n} 0.02 0.5\n", n - 1)).collect();
    for dt in [0.02, 0.005, 0.001] {
        within(rebound(&(spheres.clone() + &rods), backend, dt), 2.5, 0.01, "kinetic energy");
    }
}

/// 27 elastic balls of radius 0.3 in a cube of side 3. Every component of their velocities is at most 2.
fn gas() -> Scene {
    let mut scene = with(|settings| {
        (settings.gravity, settings.restitution, settings.friction, settings.contact_damping) = (0.0, 1.0, 0.0, 0.0);
    });
    for axis in 0..3 {
        for side in [-2.5, 1.5] {
            let (mut low, mut high) = ([-2.5_f32; 3], [2.5_f32; 3]);
            (low[axis], high[axis]) = (side, side + 1.0);
            scene.add_box(Cuboid::between(low, high)).expect("a wall");
        }
    }
    let mut random = Random::new(3);
    for place in 0..27 {
        let at = [place % 3, place / 3 % 3, place / 9].map(|k| k as f32 - 1.0);
        let velocity: [f32; 3] = std::array::from_fn(|_| random.between(-2.0, 2.0) as f32);
        scene.add_sphere(Sphere::new(at, 0.3).velocity(velocity)).expect("a ball");
    }
    scene
}

/// The kinetic energy of a gas stays within 3 % for 8 s. With one scaled pass over the collisions in place of repeated
/// sweeps, it lost 19 %.
fn e24_an_elastic_gas_keeps_its_energy(backend: Backend) {
    let mut simulation = opened(gas(), backend, Integrator::Rk4);
    let before = kinetic(&simulation.spheres().expect("spheres"));
    let kept = kinetic(&after(&mut simulation, 400, 0.02)) / before;
    assert!(simulation.report().total_collisions > 200, "{}", simulation.report().total_collisions);
    assert!((0.97..1.03).contains(&kept), "kept {kept} of the kinetic energy");
}

/// An elastic Newton's cradle of five balls that touch: the impulse of the first passes through the row, and the total
/// momentum stays constant. Where rounding makes two balls overlap by 1e-7, their collision is not a lone one, so it is
/// not moved back to its time of contact: 3 % of the energy stays with the second-last ball.
fn e24_an_impulse_passes_through_a_row_of_balls(backend: Backend) {
    let mut scene = with(|settings| {
        (settings.gravity, settings.restitution, settings.friction, settings.contact_damping) = (0.0, 1.0, 0.0, 0.0);
    });
    for place in 0..5 {
        let x = if place == 0 { -0.05 } else { place as f32 };
        let speed = if place == 0 { 2.0 } else { 0.0 };
        scene.add_sphere(Sphere::new([x, 0.0, 0.0], 0.5).velocity([speed, 0.0, 0.0])).expect("a ball");
    }
    let spheres = after(&mut opened(scene, backend, Integrator::Rk4), 60, 0.01);
    let momentum: f32 = spheres.iter().map(|sphere| sphere.velocity.x).sum();
    assert!((momentum - 2.0).abs() < 1e-5, "{momentum}");
    let kept = kinetic(&spheres) / 2.0;
    assert!((0.95..1.001).contains(&kept), "kept {kept} of the kinetic energy");
}

/// A `friction` of five times `contact_force` is stable. With the square-root law alone the energy grew without bound.
fn e25_a_pile_with_strong_friction_is_stable(backend: Backend) {
    let spheres: String = (0..27)
        .map(|n| {
            format!(
                "S {n} {} {} {} 0 0 0 0 0 0 1 0.3\n",
                0.61 * (n % 3) as f32,
                0.3 + 0.61 * (n / 9) as f32,
                0.63 * (n / 3 % 3) as f32
            )
        })
        .collect();
    let text = format!("{spheres}B -5 -1 -5 10 0 0 0 1 0 0 0 10\nset gravity 10\nset friction 5000\n");
    let left = kinetic(&after(&mut open(&text, backend), 1_000, 0.02)) / 27.0;
    assert!(left < 0.5, "kinetic energy per ball {left}");
}

/// A rod connects a ball to a fixed sphere that has a surface velocity. Another ball rests against the free end of the
/// rod and stays there. When the rod took over the surface velocity of its fixed end, the ball left at 8.75.
fn e26_a_rod_ignores_the_surface_velocity_of_a_fixed_end(backend: Backend) {
    let text = "S 1 0 0 0  0 5 0  0 0 0 1 0.1 1\nS 2 0 1 0  0 0 0  0 0 0 1 0.1\nR 1 2 0.05 1\nS 3 0 1.19 0  0 0 0  0 0 0 1 0.1\nset gravity 0\n";
    let spheres = after(&mut open(text, backend), 50, 0.02);
    // The overlap of 0.01 pushes the ball away slowly: at most at sqrt(Cc) o = 0.32.
    assert!(spheres[2].velocity.length() < 0.35, "{}", spheres[2].velocity);
    assert!(spheres[1].velocity.length() < 1e-3, "{}", spheres[1].velocity);
}

/// A ball lies on a rod between two rollers. The rollers are fixed spheres whose surfaces move along the rod and across
/// it. The rod does not carry the ball along.
fn e26_a_rod_between_rollers_does_not_move_a_ball(backend: Backend) {
    let text = "S 1 -1 0 0  3 0 2  0.1 0 0 1 0.1 1\nS 2 1 0 0  3 0 2  0.1 0 0 1 0.1 1\nR 1 2 0.1 2\n\
                S 3 0 0.299 0 0 0 0 0 0 0 1 0.2\n";
    let ball = after(&mut open(text, backend), 20, 0.01)[2];
    assert!(ball.velocity.length() < 1e-4 && ball.angular_momentum.length() < 1e-5, "{ball:?}");
}

/// A hit of two coplanar boxes that overlap is damped once. The ball arrives at 1, e = 0.5.
fn e27_overlapping_boxes_damp_once(backend: Backend) {
    let text = "set contact_law hertz-mindlin\nset gravity 0\n@material g density=2500 young=1e8 poisson=0.25\n\
                @pair g g restitution=0.5 friction=0.3\n@use g\nB -1 -1 -1 2 0 0 0 1 0 0 0 2\nB -0.5 -0.5 -1 2 0 0 0 0.5 0 0 0 2\n\
                S 7 0 0.0102 0 0 -1 0 0 0 0 - 0.01\n";
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let mut simulation = opened(scene(text), backend, integrator);
        simulation.run(300, 1e-5).expect("steps");
        let velocity = simulation.spheres().expect("spheres")[0].velocity;
        assert!((velocity.y - 0.5).abs() < 0.01, "{integrator}: {velocity}");
    }
}

both! {
    e19_balls_of_any_size_come_to_rest,
    e19_a_small_ball_comes_to_rest,
    e20_a_level_capsule_rebounds_as_a_rigid_body,
    e20_an_oblique_capsule_keeps_its_energy,
    e21_bounces_reach_their_expected_heights,
    e21_an_elastic_ball_keeps_its_height,
    e21_an_oblique_pair_keeps_its_angular_momentum,
    e21_random_pairs_keep_their_angular_momentum,
    e21_a_spring_triangle_keeps_its_angular_momentum,
    e21_a_spring_triangle_keeps_its_energy,
    e22_a_ball_leaves_a_groove_at_its_initial_speed,
    e22_a_rod_leaves_a_box_at_its_initial_speed,
    e23_a_tetrahedron_rebounds_with_its_energy,
    e23_a_triangle_rebounds_with_its_energy,
    e23_an_upright_chain_rebounds_with_its_energy,
    e24_an_impulse_passes_through_a_row_of_balls,
    e24_an_elastic_gas_keeps_its_energy,
    e25_a_pile_with_strong_friction_is_stable,
    e26_a_rod_between_rollers_does_not_move_a_ball,
    e26_a_rod_ignores_the_surface_velocity_of_a_fixed_end,
    e27_overlapping_boxes_damp_once,
}
