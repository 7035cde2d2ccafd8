//! Edges and corners of polygons (E28, docs/physics section 2.7).

use std::fmt::Write as _;

use rockfall::glam::Vec3;
use rockfall::{Backend, Integrator, Scene, Simulation, SphereState};

use super::scenes::{Random, in_gravity, kinetic, opened, scene, within};
use crate::common::on;

/// Runs a scene and returns the greatest kinetic energy plus potential energy above y = 0 after any part of the run.
fn greatest_energy(text: &str, backend: Backend, parts: u64, steps: u64, dt: f32) -> f64 {
    let scene = scene(text);
    let gravity = f64::from(scene.settings.gravity);
    let mut simulation = opened(scene, backend, Integrator::Rk4);
    let energy = |simulation: &mut Simulation| in_gravity(&simulation.spheres().expect("spheres"), gravity, 0.0);
    let mut greatest = energy(&mut simulation);
    for _ in 0..parts {
        simulation.run(steps, dt).expect("steps");
        greatest = greatest.max(energy(&mut simulation));
    }
    greatest
}

/// A frictionless ball at 0.2 on the top of a roof of two polygons. It rose to an energy of 0.82 of 0.52 when polygons had no edges.
fn e28_a_ball_that_leaves_a_ridge_gains_no_energy(backend: Backend) {
    let roof = "P -7.071068 -7.071068 -5 0 0 10 7.071068 7.071068 0\nP 0 0 -5 0 0 10 7.071068 -7.071068 0\n";
    let text = format!("set gravity 1\nset friction 0\nS 1 0 0.5 0 0.2 0 0 0 0 0 1 0.5 0\n{roof}");
    let most = greatest_energy(&text, backend, on(backend, 100, 20), 4, 0.01);
    assert!(most <= 0.5201, "energy {most}");
}

/// A ball comes from beside the edge of a polygon, with its centre 0.01 above the plane. It had 1.72 of its energy of 0.5.
fn e28_a_ball_that_meets_an_edge_gains_no_energy(backend: Backend) {
    for height in [0.01, 0.2, 0.4] {
        let text = format!("set gravity 0\nS 1 -1 {height} 0 1 0 0 0 0 0 1 0.5 0\nP 0 0 -5 0 0 10 10 0 0\n");
        let most = greatest_energy(&text, backend, on(backend, 100, 30), 3, 0.01);
        assert!(most <= 0.50005, "energy {most} at the height {height}");
    }
}

/// A ball at speed 1 meets a step of 0.3 units made of two polygons. It had 1.66 of its energy of 0.699.
fn e28_a_ball_that_meets_a_step_gains_no_energy(backend: Backend) {
    let step = "P -5 0 -5 0 0 10 5 0 0\nP 0 -0.3 -5 0 0 10 10 0 0\n";
    let text = format!("set gravity 1\nS 1 2 0.199 0 -1 0 0 0 0 0 1 0.5 0\n{step}");
    let most = greatest_energy(&text, backend, on(backend, 200, 40), 3, 0.01);
    assert!(most <= 0.6995, "energy {most}");
}

/// A law with history, for grains of 1 cm.
const GRAINS: &str = "set contact_law hertz-mindlin\nset gravity 9.81\n@material g density=2500 young=1e7 poisson=0.25\n\
                      @pair g g restitution=0.5 friction=0.3\n@use g\n";

/// The greatest speed of any sphere after any part of a run, with the fall below y = 0 taken off.
fn greatest_speed(scene: Scene, backend: Backend, parts: u64, steps: u64, dt: f32) -> f32 {
    let gravity = scene.settings.gravity;
    let mut simulation = opened(scene, backend, Integrator::VelocityVerlet);
    let mut greatest = 0.0_f32;
    for _ in 0..parts {
        simulation.run(steps, dt).expect("steps");
        let squared = |sphere: SphereState| sphere.velocity.length_squared() + 2.0 * gravity * sphere.position.y.min(0.0);
        let speeds = simulation.spheres().expect("spheres").into_iter().map(|sphere| squared(sphere).max(0.0).sqrt());
        greatest = speeds.fold(greatest, f32::max);
    }
    greatest
}

/// Grains of several sizes fall on the top of a roof and on the rims of two sloping walls. From the height of 0.08 they reach a speed
/// of 1.3. Some left at 17.
fn e28_grains_that_fall_on_rims_are_not_thrown(backend: Backend) {
    let mut text = GRAINS.to_owned();
    text += "P 0 0 -0.03 0 0 0.06 0.03 -0.03 0\nP -0.03 -0.03 -0.03 0 0 0.06 0.03 0.03 0\n";
    text += "P 0.05 0 -0.03 0 0 0.06 0.03 0.05 0\nP -0.05 0 -0.03 -0.03 0.05 0 0 0 0.06\n";
    let mut random = Random::new(28);
    let (columns, rows) = on(backend, (24, 6), (12, 2));
    for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
        let (x, z) = (-0.09 + 0.18 * column as f64 / columns as f64, -0.02 + 0.04 * row as f64 / rows as f64);
        let [dx, dy, r] = [random.between(0.0, 0.002), random.between(0.0, 0.01), random.between(0.0015, 0.003)];
        let _ = writeln!(text, "S {} {} {} {z} 0 0 0 0 0 0 - {r}", column * rows + row + 1, x + dx, 0.06 + dy);
    }
    let fastest = greatest_speed(scene(&text), backend, on(backend, 150, 25), on(backend, 50, 40), on(backend, 2e-5, 1e-4));
    assert!(fastest < 2.5, "speed {fastest}");
}

/// A ball falls through a polygon from behind, with a law with history. It left at 55 units/s.
fn e28_a_ball_that_comes_through_a_polygon_is_not_thrown(backend: Backend) {
    let stiff = GRAINS.replace("young=1e7", "young=1e8");
    for (speed, y) in [(0.0_f32, 0.0102), (-1.0, 0.011), (-3.0, 0.02)] {
        let text = format!("{stiff}P -1 0 -1 2 0 0 0 0 2\nS 7 0 {y} 0 0 {speed} 0 0 0 0 - 0.01\n");
        let fastest = greatest_speed(scene(&text), backend, on(backend, 40, 12), 50, on(backend, 5e-5, 1e-4));
        // The speed of a free fall to y = 0, and little more.
        let free = (speed * speed + 2.0 * 9.81 * y).sqrt();
        assert!(fastest < free + 0.01, "speed {fastest}, free fall {free}");
        let mut simulation = opened(scene(&text), backend, Integrator::VelocityVerlet);
        let dt = on(backend, 5e-5, 1e-4);
        // The centre is 5 mm below the polygon.
        let time = (speed + (speed * speed + 2.0 * 9.81 * (y + 0.005)).sqrt()) / 9.81;
        simulation.run((time / dt) as u64, dt).expect("steps");
        assert_eq!(simulation.contacts().expect("contacts").len(), 1);
        assert!(simulation.energy().expect("energies").contact.abs() < 1e-12);
    }
}

/// A ball rests on a polygon that it touches from the front, whatever the size of the first step is.
fn e28_a_ball_that_lands_on_a_polygon_is_held(backend: Backend) {
    for speed in [0.0, -0.5, -2.0] {
        let text = format!("{GRAINS}P -1 0 -1 0 0 2 2 0 0\nS 7 0 0.0105 0 0 {speed} 0 0 0 0 - 0.01\n");
        let mut simulation = opened(scene(&text), backend, Integrator::VelocityVerlet);
        simulation.run(on(backend, 20_000, 1_500), on(backend, 2e-5, 5e-5)).expect("steps");
        let y = simulation.spheres().expect("spheres")[0].position.y;
        assert!(y > 0.0095, "the ball is at {y}");
    }
}

/// The energy of the contact of a ball with a polygon is continuous wherever the centre is in front of the plane, and the contact
/// begins with no overlap.
#[test]
fn e28_the_overlap_is_continuous_at_edges_and_corners() {
    let text = "set gravity 0\nset collisions off\nP 0 0 0  0.2 0 1  1 0 -0.3\nS 1 0 1 0  0 0 0  0 0 0  1 0.4\n";
    let mut simulation = opened(scene(text), Backend::Cpu, Integrator::Rk4);
    let id = simulation.scene().sphere_ids().next().expect("a sphere");
    let mut random = Random::new(3);
    let mut overlap = |at: Vec3| {
        simulation.set_position(id, at).expect("a position");
        simulation.contacts().expect("contacts").first().map_or(0.0, |contact| contact.overlap)
    };
    let normal = Vec3::new(0.2, 0.0, 1.0).cross(Vec3::new(1.0, 0.0, -0.3)).normalize();
    assert!(normal.y > 0.99, "the polygon faces up: {normal}");
    let (mut touched, mut beside) = (0, 0);
    for _ in 0..400 {
        let mut place = |low: f64, high: f64| random.between(low, high) as f32;
        let (from, to) = (
            Vec3::new(place(-0.6, 1.6), place(0.001, 0.6), place(-0.6, 1.3)),
            Vec3::new(place(-0.6, 1.6), place(0.001, 0.6), place(-0.6, 1.3)),
        );
        let pieces = 200;
        let step = from.distance(to) / pieces as f32;
        let mut before = overlap(from);
        for piece in 1..=pieces {
            let at = from.lerp(to, piece as f32 / pieces as f32);
            let now = overlap(at);
            assert!((now - before).abs() <= 1.01 * step + 1e-6, "from {before} to {now} within {step} at {at}");
            touched += u32::from(now > 0.0);
            beside += u32::from(now > 0.0 && (at.x < 0.0 || at.z < -0.3));
            before = now;
        }
    }
    assert!(touched > 10_000 && beside > 1_000, "{touched} contacts, {beside} of them beside the face");
}

/// Smooth elastic balls that hit edges and corners at random keep their kinetic energy.
fn e28_hits_of_edges_keep_the_energy(backend: Backend) {
    let mut random = Random::new(281);
    let mut hits = 0;
    for number in 0..on(backend, 300, 8) {
        let (x, z) = (random.between(-0.3, 1.3), random.between(-0.3, 1.3));
        let v = [random.between(-3.0, 3.0), random.between(-4.0, -1.0), random.between(-3.0, 3.0)];
        let dt = random.between(0.002, 0.01);
        // The ball is at its place after a time of flight of 0.3.
        let at = [x - 0.3 * v[0], 0.35 - 0.3 * v[1], z - 0.3 * v[2]];
        let text = format!(
            "set gravity 0\nset restitution 1\nset friction 0\nset contact_damping 0\nP 0 0 0  0 0 1  1 0 0\n\
             S 1 {} {} {}  {} {} {}  0 0 0  1 0.4\n",
            at[0], at[1], at[2], v[0], v[1], v[2]
        );
        let mut simulation = opened(scene(&text), backend, Integrator::Rk4);
        let before = kinetic(&simulation.spheres().expect("spheres"));
        simulation.run((0.8 / dt) as u64, dt as f32).expect("steps");
        let after = kinetic(&simulation.spheres().expect("spheres"));
        hits += simulation.report().total_collisions;
        within(after, before, 0.01, &format!("kinetic energy of hit {number}"));
    }
    assert!(hits > on(backend, 150, 3), "{hits} hits");
}

both! {
    e28_a_ball_that_comes_through_a_polygon_is_not_thrown,
    e28_a_ball_that_lands_on_a_polygon_is_held,
    e28_a_ball_that_leaves_a_ridge_gains_no_energy,
    e28_a_ball_that_meets_a_step_gains_no_energy,
    e28_a_ball_that_meets_an_edge_gains_no_energy,
    e28_grains_that_fall_on_rims_are_not_thrown,
    e28_hits_of_edges_keep_the_energy,
}
