//! The faults that the mended collision and contact model removes, with scenes of their own and expectations from paper.
//! Here are those of the errata E19 to E26, whose numbers begin the names; those that are no erratum are in `faults/`.

use rockfall::{Backend, Cuboid, Integrator, Scene, Simulation, Sphere, SphereState};

mod common;

use common::{spheres, weightless, with};
use scenes::{Random, after, angular, in_gravity, kinetic, open, opened, scene, within};

/// Tests of functions of a backend, on each.
macro_rules! on_backends {
    ($($name:ident),* $(,)?) => {
        mod cpu {
            $(
                #[test]
                fn $name() {
                    super::$name(rockfall::Backend::Cpu);
                }
            )*
        }

        #[cfg(feature = "gpu")]
        mod gpu {
            $(
                #[test]
                fn $name() {
                    super::$name(rockfall::Backend::Gpu);
                }
            )*
        }
    };
}

#[path = "faults/forces.rs"]
mod forces;
#[path = "faults/lengths.rs"]
mod lengths;
#[path = "faults/scenes.rs"]
mod scenes;

/// What a smooth elastic collision without gravity needs.
const ELASTIC: &str = "set gravity 0\nset restitution 1\nset friction 0\nset contact_damping 0\n";

/// D2. One end of a level capsule comes down on a face, e = 1, smooth. A rigid body keeps its kinetic energy, 1. With the end's inverse mass
/// taken as that of a sphere by itself (E20) it kept 0.38.
fn e20_capsule_gives_way_as_a_rigid_body(backend: Backend) {
    for dt in [0.02, 0.01, 0.005, 0.002] {
        let scene = "C -0.25 0.52 0  0.25 0.52 0  0 -1 0  2 0.5\nP -0.5 0 -1  0 0 2  0.375 0 0\n";
        let mut simulation = open(&format!("{scene}{ELASTIC}"), backend);
        within(kinetic(&after(&mut simulation, (0.2 / dt) as u64, dt)), 1.0, 1e-3, "kinetic energy");
        assert!(simulation.report().total_collisions > 0, "it has to come down");
    }
}

/// D2. Oblique elastic drops on either end: the kinetic energy of a rigid body, 1.
fn e20_oblique_capsule_keeps_its_energy(backend: Backend) {
    for degrees in [15.0_f32, 30.0, 45.0, 60.0, 75.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let low = 0.32;
        let scene = format!("C 0 {low} 0  {} {} 0  0 -1 0  2 0.3\nP -50 0 -50  0 0 100  100 0 0\n", 0.8 * cos, low + 0.8 * sin);
        let spheres = after(&mut open(&format!("{scene}{ELASTIC}"), backend), 10, 0.005);
        assert!(spheres.iter().any(|sphere| sphere.velocity.y > -0.9), "it has to come down");
        within(kinetic(&spheres), 1.0, 1e-3, "kinetic energy");
    }
}

/// D5. Two smooth elastic balls meet obliquely at 10. Their angular momentum is that of the line they fly along: -0.35 * 5 * 2.
fn e21_oblique_pair_keeps_its_angular_momentum(backend: Backend) {
    let pair = "S 1 -1.28 0.35 0  5 0 0  0 0 0 1 0.5\nS 2 1.28 -0.35 0  -5 0 0  0 0 0 1 0.5\n";
    let spheres = after(&mut open(&format!("{pair}{ELASTIC}"), backend), 30, 0.02);
    assert!(spheres[0].velocity.x < 4.9, "they have to meet");
    within(angular(&spheres).z, -3.5, 1e-5, "angular momentum");
    within(kinetic(&spheres), 25.0, 1e-5, "kinetic energy");
}

/// D5. The same of 200 random pairs, on software Vulkan, which opens each in a second, of 30: 9 % were lost on average.
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
        // Pairs that graze may meet and part within a step.
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

/// D5. Three smooth elastic balls on springs, which nothing drives, for 200 s: angular momentum -1.2. It came to -15.9.
fn e21_spring_triangle_keeps_its_angular_momentum(backend: Backend) {
    let mut simulation = open(&format!("{TRIANGLE}{ELASTIC}"), backend);
    within(angular(&after(&mut simulation, 10_000, 0.02)).z, -1.2, 0.01, "angular momentum");
    assert!(simulation.report().total_collisions > 500);
}

/// D5. The energy of the same, 3 + 5/2 (0.7^2 + 2 (sqrt(1.8) - 0.5)^2) = 7.77, for 10,000 steps: the median of the last hundred, for while two
/// balls overlap some of it is in their contact. At 20 ms it came to 58.6, and to 34.8 where the rebound did not allow for the springs. What it
/// loses now it loses where three balls meet, a few times in 100 s.
fn e21_spring_triangle_keeps_its_energy(backend: Backend) {
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

/// D5. An elastic ball on a floor, G = 10: E = 10 * 1.5 for ever. It rose to 246 in 400 s.
fn e21_elastic_ball_keeps_its_height(backend: Backend) {
    let ball = "S 1 0 1.5 0  0 0 0  0 0 0 1 0.5\nP -50 0 -50  0 0 100  100 0 0\nset gravity 10\nset restitution 1\n";
    let spheres = after(&mut open(ball, backend), 20_000, 0.02);
    within(in_gravity(&spheres, 10.0, 0.0), 15.0, 0.01, "energy");
}

/// M2. The n-th bounce of a ball reaches e^2n of the height of the fall, at a time step of 1/64.
fn e21_bounces_reach_their_heights(backend: Backend) {
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

/// D11. A ball of radius 0.1 at G = 9.81 and dt = 0.02: gravity alone gives it more than the threshold of 0.1 in a step. It bounced for ever.
fn e19_small_ball_comes_to_rest(backend: Backend) {
    let ball = "S 1 0 0.3 0  0 0 0  0 0 0 1 0.1\nP -50 0 -50  0 0 100  100 0 0\nset gravity 9.81\n";
    at_rest(&mut opened(scene(ball), backend, Integrator::Rk4), 0.1, 9.81, 0.02);
}

/// M6. The same for radii, gravities and steps, on a polygon and on a box. The overlap at rest is G / Cc: it has to be less than the radius.
fn e19_balls_of_any_size_come_to_rest(backend: Backend) {
    let cases =
        [(0.01, 1.0, 0.02), (0.1, 10.0, 0.005), (0.5, 1.0, 0.0005), (1.0, 100.0, 0.02), (10.0, 9.81, 0.01), (1.0, 0.1, 0.02)];
    for (radius, gravity, dt) in cases {
        for floor in ["P -50 0 -50  0 0 100  100 0 0", "B -50 -1 -50  100 0 0  0 1 0  0 0 100"] {
            let ball = format!("S 1 0 {} 0  0 0 0  0 0 0 1 {radius}\n{floor}\nset gravity {gravity}\n", 1.2 * radius);
            for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
                at_rest(&mut opened(scene(&ball), backend, integrator), radius, gravity, dt);
            }
        }
    }
}

/// After a while it rests on the floor, and nothing collides any more.
fn at_rest(simulation: &mut Simulation, radius: f32, gravity: f32, dt: f32) {
    let steps = ((20.0 + 20.0 * (radius / gravity).sqrt()) / dt) as u64;
    simulation.run(steps, dt).expect("steps");
    let collisions = simulation.report().total_collisions;
    let sphere = after(simulation, 200, dt)[0];
    assert_eq!(simulation.report().total_collisions, collisions, "radius {radius}, G {gravity}, dt {dt}: it collides");
    assert!(
        sphere.velocity.length() < 1e-3 * (gravity * radius).sqrt(),
        "radius {radius}, G {gravity}, dt {dt}: {}",
        sphere.velocity
    );
    let overlap = radius - sphere.position.y;
    let expected = gravity / 1000.0;
    assert!((overlap - expected).abs() < 0.02 * expected + 1e-6 * radius, "radius {radius}, G {gravity}: overlap {overlap}");
}

/// A scene with a groove of two boxes and a ball that falls into it at 5.
fn groove(degrees: f32) -> Scene {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mut text = format!("S 1 0 {} 0  0 -5 0  0 0 0 1 0.5\n", 0.5 / cos + 0.5);
    for side in [-1.0, 1.0] {
        let (out, down) = ([side * 10.0 * cos, 10.0 * sin], [side * 3.0 * sin, -3.0 * cos]);
        text += &format!("B 0 0 -5  {} {} 0  {} {} 0  0 0 10\n", out[0], out[1], down[0], down[1]);
    }
    scene(&(text + ELASTIC))
}

/// D4. An elastic ball falls into a symmetric groove: it leaves as fast as it came, K = 12.5. The contact force of the wall that it left by an
/// impulse added to it: 21.6.
fn e22_ball_leaves_a_groove_at_its_speed(backend: Backend) {
    for (degrees, least, most) in [(15.0, 0.99, 1.01), (30.0, 0.99, 1.01), (44.0, 0.99, 1.01), (60.0, 0.95, 1.01)] {
        let spheres = after(&mut opened(groove(degrees), backend, Integrator::Rk4), 100, 0.005);
        let kept = kinetic(&spheres) / 12.5;
        assert!(spheres[0].velocity.y > 1.0, "{degrees} degrees: it has to leave");
        assert!((least..most).contains(&kept), "{degrees} degrees: {kept} of the kinetic energy");
    }
}

/// A rod laid flat across a box, e = 1: both edges hit it at once, and it leaves as fast as it came, K = 1.
fn e22_rod_leaves_a_box_at_its_speed(backend: Backend) {
    let text = "S 1 -1 0.25 0 0 -1 0 0 0 0 1 0.05\nS 2 1 0.25 0 0 -1 0 0 0 0 1 0.05\nR 1 2 0.2 2\nB -0.5 -1 -1 1 0 0 0 1 0 0 0 2\n\
                set gravity 0\nset restitution 1\nset friction 0\nset contact_damping 0\n";
    for dt in [0.02, 0.005] {
        let mut simulation: Simulation = open(text, backend);
        let spheres = after(&mut simulation, (0.3 / dt) as u64, dt);
        assert!(spheres[0].velocity.y > 0.5, "it has to leave: {}", spheres[0].velocity);
        within(kinetic(&spheres), 1.0, 0.01, "kinetic energy");
    }
}

/// A floor, and smooth elastic collisions without gravity.
const ON_A_FLOOR: &str =
    "P -50 0 -50  0 0 100  100 0 0\nset gravity 0\nset restitution 1\nset friction 0\nset contact_damping 0\n";

/// The kinetic energy after a frame has come down on the floor.
fn rebound(frame: &str, backend: Backend, dt: f32) -> f64 {
    let mut simulation = open(&format!("{frame}{ON_A_FLOOR}"), backend);
    let spheres = after(&mut simulation, (0.1 / dt) as u64, dt);
    assert!(simulation.report().total_collisions > 0, "it has to come down");
    kinetic(&spheres)
}

/// D3. A tetrahedron of fixed-length rods comes down on a vertex: K = 2. The collision took the vertex for a sphere by itself: 0.025.
fn e23_tetrahedron_rebounds(backend: Backend) {
    let frame = "S 1 0.000000 0.115000 0.000000 0 -1 0 0 0 0 1 0.1\nS 2 0.577350 0.931497 0.000000 0 -1 0 0 0 0 1 0.1\n\
                 S 3 -0.288675 0.931497 0.500000 0 -1 0 0 0 0 1 0.1\nS 4 -0.288675 0.931497 -0.500000 0 -1 0 0 0 0 1 0.1\n\
                 R 1 2 0.02 1\nR 1 3 0.02 1\nR 2 3 0.02 1\nR 1 4 0.02 1\nR 2 4 0.02 1\nR 3 4 0.02 1\n";
    for dt in [0.02, 0.005, 0.001] {
        within(rebound(frame, backend, dt), 2.0, 0.01, "kinetic energy");
    }
}

/// D3. A triangle on a vertex, tilted: K = 3/2.
fn e23_triangle_rebounds(backend: Backend) {
    let frame = "S 1 0 0.115 0 0 -1 0 0 0 0 1 0.1\nS 2 0.8 0.715 0 0 -1 0 0 0 0 1 0.1\nS 3 -0.352 0.951 0 0 -1 0 0 0 0 1 0.1\n\
                 R 1 2 0.02 1\nR 1 3 0.02 0.907263\nR 2 3 0.02 1.175925\n";
    for dt in [0.02, 0.005, 0.001] {
        within(rebound(frame, backend, dt), 1.5, 0.01, "kinetic energy");
    }
}

/// D3. An upright chain of five: the floor meets all of its mass, K = 5/2.
fn e23_upright_chain_rebounds(backend: Backend) {
    let spheres: String = (0..5).map(|n| format!("S {n} 0 {} 0 0 -1 0 0 0 0 1 0.1\n", 0.115 + 0.5 * n as f32)).collect();
    let rods: String = (1..5).map(|n| format!("R {} {n} 0.02 0.5\n", n - 1)).collect();
    for dt in [0.02, 0.005, 0.001] {
        within(rebound(&(spheres.clone() + &rods), backend, dt), 2.5, 0.01, "kinetic energy");
    }
}

/// 27 elastic balls of radius 0.3 in a cube of side 3, each as fast as 2 along every axis at most.
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

/// D12. The kinetic energy of a gas stays within 3 % for 8 s; of impulses that are scaled once and not swept 19 % went.
fn e24_gas_keeps_its_energy(backend: Backend) {
    let mut simulation = opened(gas(), backend, Integrator::Rk4);
    let before = kinetic(&simulation.spheres().expect("spheres"));
    let kept = kinetic(&after(&mut simulation, 400, 0.02)) / before;
    assert!(simulation.report().total_collisions > 200, "{}", simulation.report().total_collisions);
    assert!((0.97..1.03).contains(&kept), "{kept} of the kinetic energy");
}

/// An elastic cradle: of five balls that touch, the blow of one goes through, and the sum of momenta stays. Where rounding has two balls
/// overlap by 1e-7, the collision of the one is not lone and not moved back to its time: 3 % of the energy stays with the ball before.
fn e24_blow_goes_through_a_row(backend: Backend) {
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
    assert!((0.95..1.001).contains(&kept), "{kept} of the kinetic energy");
}

/// D7. `friction` five times the contact force, which the square-root law alone turned into a runaway, is stable.
fn e25_strong_friction_is_stable(backend: Backend) {
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
    assert!(left < 0.5, "kinetic energy a ball {left}");
}

/// D10. A rod to a fixed sphere with a surface velocity, and a ball that rests against the rod's other end: it stays. The rod's end took the
/// surface velocity, and the ball left at 8.75.
fn e26_rod_ignores_the_surface_of_a_fixed_end(backend: Backend) {
    let text = "S 1 0 0 0  0 5 0  0 0 0 1 0.1 1\nS 2 0 1 0  0 0 0  0 0 0 1 0.1\nR 1 2 0.05 1\nS 3 0 1.19 0  0 0 0  0 0 0 1 0.1\nset gravity 0\n";
    let spheres = after(&mut open(text, backend), 50, 0.02);
    // The overlap of 0.01 pushes it off softly: at most sqrt(Cc) o = 0.32.
    assert!(spheres[2].velocity.length() < 0.35, "{}", spheres[2].velocity);
    assert!(spheres[1].velocity.length() < 1e-3, "{}", spheres[1].velocity);
}

/// E26. A ball that lies on a rod between two rollers, fixed spheres whose surfaces move along the rod and across it: it is not carried along.
fn e26_rod_between_rollers_carries_nothing(backend: Backend) {
    let text = "S 1 -1 0 0  3 0 2  0.1 0 0 1 0.1 1\nS 2 1 0 0  3 0 2  0.1 0 0 1 0.1 1\nR 1 2 0.1 2\n\
                S 3 0 0.299 0 0 0 0 0 0 0 1 0.2\n";
    let ball = after(&mut open(text, backend), 20, 0.01)[2];
    assert!(ball.velocity.length() < 1e-4 && ball.angular_momentum.length() < 1e-5, "{ball:?}");
}

on_backends! {
    e19_balls_of_any_size_come_to_rest,
    e19_small_ball_comes_to_rest,
    e20_capsule_gives_way_as_a_rigid_body,
    e20_oblique_capsule_keeps_its_energy,
    e21_bounces_reach_their_heights,
    e21_elastic_ball_keeps_its_height,
    e21_oblique_pair_keeps_its_angular_momentum,
    e21_random_pairs_keep_their_angular_momentum,
    e21_spring_triangle_keeps_its_angular_momentum,
    e21_spring_triangle_keeps_its_energy,
    e22_ball_leaves_a_groove_at_its_speed,
    e22_rod_leaves_a_box_at_its_speed,
    e23_tetrahedron_rebounds,
    e23_triangle_rebounds,
    e23_upright_chain_rebounds,
    e24_blow_goes_through_a_row,
    e24_gas_keeps_its_energy,
    e25_strong_friction_is_stable,
    e26_rod_between_rollers_carries_nothing,
    e26_rod_ignores_the_surface_of_a_fixed_end,
}
