//! Contact forces along the normal, and when there are none.
//!
//! Forces are read off one step of symplectic Euler from a given state: v' = v + dt F/m. Friction is switched off.

use std::f64::consts::TAU;

use rockfall::glam::Vec3;
use rockfall::{Backend, Scene, Sphere};

use crate::common::*;

/// Forces of up to 100, from velocities of the order of 1 that round by 1e-7, over dt = 1/64; and Cc = 1000 times an
/// overlap that rounds by 6e-8, or by 5e-7 far from the origin.
const FORCE: f64 = 2e-3;

fn smooth() -> Scene {
    with(|settings| {
        settings.gravity = 0.0;
        settings.friction = 0.0;
    })
}

/// o = 0.01, u = 0.3 - (-0.1) = 0.4, m* = 1/(1 + 1/3) = 0.75: (1000 * 0.01 + 12.5 * 0.4) * 0.75 = 11.25 each way.
fn sphere_on_sphere(backend: Backend) {
    let mut scene = smooth();
    spheres(
        &mut scene,
        [
            Sphere::new([0.0; 3], 0.5).velocity([0.3, 0.0, 0.0]),
            Sphere::new([0.99, 0.0, 0.0], 0.5).mass(3.0).velocity([-0.1, 0.0, 0.0]),
        ],
    );
    forces(&loads(scene, backend), [[-11.25, 0.0, 0.0], [11.25, 0.0, 0.0]], FORCE);
}

/// A fixed sphere's velocity counts, its mass does not: u = 0.4, m* = 2: (10 + 5) * 2 = 30 on the other alone.
fn sphere_on_fixed_sphere(backend: Backend) {
    let mut scene = smooth();
    spheres(
        &mut scene,
        [Sphere::new([0.0; 3], 0.5).velocity([0.4, 0.0, 0.0]).fixed(), Sphere::new([0.99, 0.0, 0.0], 0.5).mass(2.0)],
    );
    forces(&loads(scene, backend), [[0.0; 3], [30.0, 0.0, 0.0]], FORCE);
}

/// Against what is static m* is the sphere's mass: o = 0.01, u = 0.4: (10 + 5) * 2 = 30.
fn sphere_on_box_and_polygon(backend: Backend) {
    for floor in [floor_box, floor_polygon] {
        let mut scene = smooth();
        floor(&mut scene);
        spheres(&mut scene, [Sphere::new([0.0, 0.49, 0.0], 0.5).mass(2.0).velocity([0.7, -0.4, 0.0])]);
        forces(&loads(scene, backend), [[0.0, 30.0, 0.0]], FORCE);
    }
}

/// At a = 0.25 of masses 1 and 3 1/M = 7/12; with the ball's 1/2 m* = 12/13. o = 0.01, the rod's point moves at
/// 0.75 * 0.2 + 0.25 * 0.2 = 0.2 up, the ball at 0.2 down: u = 0.4, 15 * 12/13 between them, shared as 3/4 and 1/4.
fn sphere_on_rod(backend: Backend) {
    let mut scene = smooth();
    let ends = [
        Sphere::new([0.0; 3], 0.2).velocity([0.0, 0.2, 0.0]),
        Sphere::new([4.0, 0.0, 0.0], 0.2).mass(3.0).velocity([0.0, 0.2, 0.0]),
    ];
    rod(&mut scene, ends, 0.1);
    spheres(&mut scene, [Sphere::new([1.0, 0.59, 0.0], 0.5).mass(2.0).velocity([0.0, -0.2, 0.0])]);
    let f = 15.0 * 12.0 / 13.0;
    forces(&loads(scene, backend), [[0.0, -0.75 * f, 0.0], [0.0, -0.25 * f, 0.0], [0.0, f, 0.0]], FORCE);
}

/// Rods crossing at a = 0.25 and b = 0.5: 1/M = 19/32 and 7/12 as in the collision of the same rods, m* = 96/113; o =
/// 0.01, at rest: 10 * 96/113, shared as (3/4, 1/4) and (1/2, 1/2).
fn rod_on_rod(backend: Backend) {
    let mut scene = smooth();
    let a = [Sphere::new([-1.0, 0.0, 0.0], 0.05), Sphere::new([3.0, 0.0, 0.0], 0.05).mass(2.0)];
    let b = [Sphere::new([0.0, 0.19, -1.0], 0.05).mass(3.0), Sphere::new([0.0, 0.19, 1.0], 0.05).mass(0.5)];
    rod(&mut scene, a, 0.1);
    rod(&mut scene, b, 0.1);
    let f = 960.0 / 113.0;
    forces(
        &loads(scene, backend),
        [[0.0, -0.75 * f, 0.0], [0.0, -0.25 * f, 0.0], [0.0, 0.5 * f, 0.0], [0.0, 0.5 * f, 0.0]],
        FORCE,
    );
}

/// A rod at rest across the edge x = 5, y = 0 of the floor's box, its axis 0.09 outside (o = 0.01, pushed out) or 0.04
/// inside it (o = 0.14, pushed out, not through): Cc o m*, m* = 32/19 for masses 1 and 2 at a = 0.25.
fn rod_on_box_edge(backend: Backend) {
    for (distance, overlap) in [(0.09, 0.01), (-0.04, 0.14)] {
        let mut scene = smooth();
        floor_box(&mut scene);
        let root = 0.5_f32.sqrt();
        let along = Vec3::new(root, -root, 0.0);
        let point = Vec3::new(5.0, 0.0, 0.3) + distance * Vec3::new(root, root, 0.0);
        let ends = [Sphere::new(point - along, 0.05), Sphere::new(point + 3.0 * along, 0.05).mass(2.0)];
        rod(&mut scene, ends, 0.1);
        let f = 1000.0 * overlap * 32.0 / 19.0 / 2.0_f64.sqrt();
        forces(
            &loads(scene, backend),
            [[0.75 * f, 0.75 * f, 0.0], [0.25 * f, 0.25 * f, 0.0]],
            // The normal is made of a distance of 0.04 between points that round by 1e-6 (the edge is 10 long): 1e-6 /
            // 0.04 * 200.
            6e-3,
        );
    }
}

/// The same at the vertex (5, 0, 5), from which the axis is 0.09 away along (1, 1, 1)/sqrt 3.
fn rod_on_box_vertex(backend: Backend) {
    let mut scene = smooth();
    floor_box(&mut scene);
    let along = Vec3::new(1.0, -1.0, 0.0).normalize();
    let point = Vec3::new(5.0, 0.0, 5.0) + 0.09 * Vec3::ONE.normalize();
    let ends = [Sphere::new(point - along, 0.05), Sphere::new(point + 3.0 * along, 0.05).mass(2.0)];
    rod(&mut scene, ends, 0.1);
    let f = 10.0 * 32.0 / 19.0 / 3.0_f64.sqrt();
    forces(&loads(scene, backend), [[0.75 * f; 3], [0.25 * f; 3]], FORCE);
}

/// A ball at rest on the floor sinks in until Cc o m* = m G: o = G / Cc, whatever the mass. It starts 1e-4 off; the damping
/// takes exp(-Cd t / 2) of that away, exp(-12.5) in 2 s. Positions round by 3e-8.
fn resting_overlap(backend: Backend) {
    for (floor, gravity) in [(floor_box as fn(&mut Scene), 1.0), (floor_polygon, 10.0)] {
        let mut scene = with(|settings| settings.gravity = gravity);
        floor(&mut scene);
        let rest = gravity / 1000.0;
        let [ball] = spheres(&mut scene, [Sphere::new([0.1, 0.4999 - rest, 0.2], 0.5).mass(3.0)]);
        let mut simulation = simulation(scene, backend);
        simulation.run(on(backend, 128, 64), DT).expect("steps");
        let height = simulation.sphere(ball).expect("the ball").position.y;
        close(height, 0.5 - f64::from(rest), 1e-6, "height at rest");
        let report = simulation.report();
        assert_eq!(report.contacts, 1);
        close(report.max_overlap, rest.into(), 1e-6, "reported overlap");
    }
}

/// Undamped, a pressed contact oscillates about its resting overlap with w = sqrt(Cc m* / m*) = sqrt Cc, whatever the masses:
/// two balls of mass 1 and 3, pressed by +-7.5, rest at 7.5 / (Cc m*) = 0.01. From 0.012 they go to 0.008 in half a period and
/// back in a whole one. RK4 at 40 steps a period is off by 3e-5 of the phase, which does not show at a turning point.
fn contact_oscillates(backend: Backend) {
    let mut scene = smooth();
    scene.settings.contact_damping = 0.0;
    let [a, b] = spheres(
        &mut scene,
        [
            Sphere::new([0.0; 3], 0.5).force([7.5, 0.0, 0.0]),
            Sphere::new([0.988, 0.0, 0.0], 0.5).mass(3.0).force([-7.5, 0.0, 0.0]),
        ],
    );
    let mut simulation = simulation(scene, backend);
    let period = TAU / 1000.0_f64.sqrt();
    for overlap in [0.008, 0.012] {
        simulation.run(20, (period / 40.0) as f32).expect("half a period");
        let [a, b] = [a, b].map(|id| simulation.sphere(id).expect("a ball"));
        close(a.position.distance(b.position), 1.0 - overlap, 2e-6, "distance");
        // w times the error of the distance.
        close(b.velocity.x - a.velocity.x, 0.0, 6e-5, "velocity at the turning point");
    }
}

/// A contact that opens at u = -2 (o = 0.01): Cc o + Cd u = 10 - 25 = -15. It does not pull, unless contact_pull is on.
fn contact_pulls_only_when_told_to(backend: Backend) {
    for (pull, force) in [(false, 0.0), (true, 30.0)] {
        let mut scene = smooth();
        scene.settings.contact_pull = pull;
        floor_box(&mut scene);
        spheres(&mut scene, [Sphere::new([0.0, 0.49, 0.0], 0.5).mass(2.0).velocity([0.0, 2.0, 0.0])]);
        forces(&loads(scene, backend), [[0.0, -force, 0.0]], FORCE);
    }
}

/// The force on a ball of mass 1 over the floor, in phase 4 alone, phase 3 being left out.
fn force_in_phase_4(floor: fn(&mut Scene), overlap: f32, speed: f32, collisions: bool, backend: Backend) -> f64 {
    let mut scene = smooth();
    scene.settings.collisions = collisions;
    floor(&mut scene);
    let ball = Sphere::new([0.0, 0.5 - overlap, 0.0], 0.5).velocity([0.0, -speed, 0.0]);
    let [id] = spheres(&mut scene, [ball]);
    let mut simulation = euler(scene, backend);
    simulation.update_positions(DT).expect("phase 4");
    let after = simulation.sphere(id).expect("the ball");
    loads_between(&[ball], &[after])[0].force.y
}

/// While collisions are on, a pair with u above the threshold (0.5 here) and o < 2 u dt makes no contact force: phase 3
/// has yet to see it. At u = 0.64, 2 u dt = 0.02. With collisions off, below the threshold or deeper, Cc o + Cd u acts.
fn fresh_overlaps_are_left_to_phase_3(backend: Backend) {
    let force = |overlap, speed, collisions| force_in_phase_4(floor_box, overlap, speed, collisions, backend);
    close(force(0.0199, 0.64, true), 0.0, 0.0, "fresh");
    close(force(0.0201, 0.64, true), 20.1 + 8.0, FORCE, "old");
    close(force(0.0199, 0.64, false), 19.9 + 8.0, FORCE, "fresh, with collisions off");
    close(force(0.004, 0.499, true), 4.0 + 12.5 * 0.499, FORCE, "fresh, but slow");
    close(force(0.004, 0.501, true), 0.0, 0.0, "fresh and fast");
}

/// While collisions are on, a pair that separates faster than the threshold (0.5) makes no contact force (E22); a slower one does, and every
/// one with collisions off. o = 0.05: Cc o - Cd * 0.501 = 43.7375, 50 - 12.5 * 0.499 = 43.7625.
fn what_separates_fast_makes_no_force(backend: Backend) {
    for floor in [floor_polygon, floor_box] {
        let force = |speed: f32, collisions: bool| force_in_phase_4(floor, 0.05, -speed, collisions, backend);
        close(force(0.501, true), 0.0, 0.0, "fast");
        close(force(0.499, true), 43.7625, FORCE, "slow");
        close(force(0.501, false), 43.7375, FORCE, "fast, with collisions off");
    }
}

/// Forces of several contacts add up, each for itself: a ball in a corner of floor and wall, o = 0.01 and 0.02.
fn forces_of_several_contacts_add_up(backend: Backend) {
    let mut scene = smooth();
    floor_polygon(&mut scene);
    let wall = rockfall::Cuboid::between([-6.0, -5.0, -5.0], [-1.0, 5.0, 5.0]);
    scene.add_box(wall).expect("a valid box");
    spheres(&mut scene, [Sphere::new([-0.52, 0.49, 0.0], 0.5).mass(2.0)]);
    forces(&loads(scene, backend), [[40.0, 20.0, 0.0]], FORCE);
}

both!(
    sphere_on_sphere,
    sphere_on_fixed_sphere,
    sphere_on_box_and_polygon,
    sphere_on_rod,
    rod_on_rod,
    rod_on_box_edge,
    rod_on_box_vertex,
    resting_overlap,
    contact_oscillates,
    contact_pulls_only_when_told_to,
    fresh_overlaps_are_left_to_phase_3,
    what_separates_fast_makes_no_force,
    forces_of_several_contacts_add_up,
);
