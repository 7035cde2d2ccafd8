//! Contact forces along the normal, and the cases in which there are none.
//!
//! Forces are measured with one step of symplectic Euler from a given state: v' = v + dt F/m. Friction is switched off.

use std::f64::consts::TAU;

use rockfall::glam::Vec3;
use rockfall::{Backend, Scene, Sphere};

use crate::common::*;

/// Tolerance of forces up to 100. They are computed from velocities of the order of 1 that round by 1e-7, over dt = 1/64,
/// and from Cc = 1000 times an overlap that rounds by 6e-8, or by 5e-7 far from the origin.
const FORCE: f64 = 2e-3;

fn smooth() -> Scene {
    with(|settings| {
        settings.gravity = 0.0;
        settings.friction = 0.0;
    })
}

/// o = 0.01, u = 0.3 - (-0.1) = 0.4, m* = 1/(1 + 1/3) = 0.75: (1000 * 0.01 + 12.5 * 0.4) * 0.75 = 11.25 each way.
fn two_spheres_push_each_other_apart(backend: Backend) {
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

/// The velocity of a fixed sphere counts, its mass does not: u = 0.4, m* = 2, so the force on the other sphere is
/// (10 + 5) * 2 = 30. There is none on the fixed one.
fn the_surface_velocity_of_a_fixed_sphere_counts(backend: Backend) {
    let mut scene = smooth();
    spheres(
        &mut scene,
        [Sphere::new([0.0; 3], 0.5).velocity([0.4, 0.0, 0.0]).fixed(), Sphere::new([0.99, 0.0, 0.0], 0.5).mass(2.0)],
    );
    forces(&loads(scene, backend), [[0.0; 3], [30.0, 0.0, 0.0]], FORCE);
}

/// Against a static object m* is the mass of the sphere: o = 0.01, u = 0.4: (10 + 5) * 2 = 30.
fn boxes_and_polygons_push_a_sphere_with_the_same_force(backend: Backend) {
    for floor in [floor_box, floor_polygon] {
        let mut scene = smooth();
        floor(&mut scene);
        spheres(&mut scene, [Sphere::new([0.0, 0.49, 0.0], 0.5).mass(2.0).velocity([0.7, -0.4, 0.0])]);
        forces(&loads(scene, backend), [[0.0, 30.0, 0.0]], FORCE);
    }
}

/// At a = 0.25 with masses 1 and 3, 1/M = 7/12; with the ball's 1/2, m* = 12/13. o = 0.01. The contact point of the rod
/// moves upwards at 0.75 * 0.2 + 0.25 * 0.2 = 0.2, the ball downwards at 0.2: u = 0.4. The force is 15 * 12/13, and the
/// ends receive 3/4 and 1/4 of it.
fn the_contact_force_of_a_sphere_is_shared_by_the_ends_of_the_rod(backend: Backend) {
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

/// Rods at rest that cross at a = 0.25 and b = 0.5: 1/M = 19/32 and 7/12, as in the collision of the same rods, and
/// m* = 96/113. o = 0.01: 10 * 96/113, shared as (3/4, 1/4) and (1/2, 1/2).
fn the_contact_force_of_two_rods_is_shared_by_their_ends(backend: Backend) {
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

/// A rod at rest across the edge x = 5, y = 0 of the floor's box. Its axis is 0.09 outside the box (o = 0.01) or 0.04
/// inside it (o = 0.14); in both cases the rod is pushed out, not through the box. The force is Cc o m*, m* = 32/19 for
/// masses 1 and 2 at a = 0.25.
fn a_box_edge_pushes_a_rod_out(backend: Backend) {
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
            // The normal is computed from a distance of 0.04 between points that round by 1e-6 (the edge is 10 long):
            // 1e-6 / 0.04 * 200.
            6e-3,
        );
    }
}

/// The same at the vertex (5, 0, 5). The axis is 0.09 away from it along (1, 1, 1)/sqrt 3.
fn a_box_vertex_pushes_a_rod_out(backend: Backend) {
    let mut scene = smooth();
    floor_box(&mut scene);
    let along = Vec3::new(1.0, -1.0, 0.0).normalize();
    let point = Vec3::new(5.0, 0.0, 5.0) + 0.09 * Vec3::ONE.normalize();
    let ends = [Sphere::new(point - along, 0.05), Sphere::new(point + 3.0 * along, 0.05).mass(2.0)];
    rod(&mut scene, ends, 0.1);
    let f = 10.0 * 32.0 / 19.0 / 3.0_f64.sqrt();
    forces(&loads(scene, backend), [[0.75 * f; 3], [0.25 * f; 3]], FORCE);
}

/// A ball at rest on the floor sinks in until Cc o m* = m G: o = G / Cc, for any mass. It starts 1e-4 off. The damping
/// reduces that by exp(-Cd t / 2), which is exp(-12.5) in 2 s. Positions round by 3e-8.
fn a_ball_rests_with_an_overlap_of_gravity_over_contact_force(backend: Backend) {
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

/// Without damping, a pressed contact oscillates about its resting overlap with w = sqrt(Cc m* / m*) = sqrt Cc, for any
/// masses. Two balls of masses 1 and 3, pressed together by +-7.5, rest at 7.5 / (Cc m*) = 0.01. From 0.012 the overlap
/// goes to 0.008 in half a period and back in a whole one. With 40 steps per period, RK4 has a phase error of 3e-5,
/// which has no visible effect at a turning point.
fn an_undamped_contact_oscillates_with_its_period(backend: Backend) {
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
        // The error of the distance times w.
        close(b.velocity.x - a.velocity.x, 0.0, 6e-5, "velocity at the turning point");
    }
}

/// A contact that opens with u = -2 (o = 0.01): Cc o + Cd u = 10 - 25 = -15. It pulls only if contact_pull is on.
fn a_contact_pulls_only_with_contact_pull(backend: Backend) {
    for (pull, force) in [(false, 0.0), (true, 30.0)] {
        let mut scene = smooth();
        scene.settings.contact_pull = pull;
        floor_box(&mut scene);
        spheres(&mut scene, [Sphere::new([0.0, 0.49, 0.0], 0.5).mass(2.0).velocity([0.0, 2.0, 0.0])]);
        forces(&loads(scene, backend), [[0.0, -force, 0.0]], FORCE);
    }
}

/// Force on a ball of mass 1 above the floor in phase 4, without phase 3.
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

/// With collisions on, a pair with u above the threshold (0.5 here) and o < 2 u dt has no contact force, because phase
/// 3 has not handled its overlap yet. At u = 0.64, 2 u dt = 0.02. With collisions off, below the threshold, or with a
/// larger overlap, the force Cc o + Cd u acts.
fn new_overlaps_of_fast_pairs_have_no_contact_force(backend: Backend) {
    let force = |overlap, speed, collisions| force_in_phase_4(floor_box, overlap, speed, collisions, backend);
    close(force(0.0199, 0.64, true), 0.0, 0.0, "new overlap");
    close(force(0.0201, 0.64, true), 20.1 + 8.0, FORCE, "old overlap");
    close(force(0.0199, 0.64, false), 19.9 + 8.0, FORCE, "new overlap, with collisions off");
    close(force(0.004, 0.499, true), 4.0 + 12.5 * 0.499, FORCE, "new overlap, slow");
    close(force(0.004, 0.501, true), 0.0, 0.0, "new overlap, fast");
}

/// With collisions on, a pair that separates faster than the threshold (0.5) has no contact force (E22). A slower pair
/// has one, and with collisions off every pair has one. o = 0.05: Cc o - Cd * 0.501 = 43.7375,
/// 50 - 12.5 * 0.499 = 43.7625.
fn pairs_that_separate_fast_have_no_contact_force(backend: Backend) {
    for floor in [floor_polygon, floor_box] {
        let force = |speed: f32, collisions: bool| force_in_phase_4(floor, 0.05, -speed, collisions, backend);
        close(force(0.501, true), 0.0, 0.0, "fast");
        close(force(0.499, true), 43.7625, FORCE, "slow");
        close(force(0.501, false), 43.7375, FORCE, "fast, with collisions off");
    }
}

/// The forces of several contacts are computed independently and add up: a ball in a corner of floor and wall, o = 0.01
/// and 0.02.
fn forces_of_several_contacts_add_up(backend: Backend) {
    let mut scene = smooth();
    floor_polygon(&mut scene);
    let wall = rockfall::Cuboid::between([-6.0, -5.0, -5.0], [-1.0, 5.0, 5.0]);
    scene.add_box(wall).expect("a valid box");
    spheres(&mut scene, [Sphere::new([-0.52, 0.49, 0.0], 0.5).mass(2.0)]);
    forces(&loads(scene, backend), [[40.0, 20.0, 0.0]], FORCE);
}

both!(
    two_spheres_push_each_other_apart,
    the_surface_velocity_of_a_fixed_sphere_counts,
    boxes_and_polygons_push_a_sphere_with_the_same_force,
    the_contact_force_of_a_sphere_is_shared_by_the_ends_of_the_rod,
    the_contact_force_of_two_rods_is_shared_by_their_ends,
    a_box_edge_pushes_a_rod_out,
    a_box_vertex_pushes_a_rod_out,
    a_ball_rests_with_an_overlap_of_gravity_over_contact_force,
    an_undamped_contact_oscillates_with_its_period,
    a_contact_pulls_only_with_contact_pull,
    new_overlaps_of_fast_pairs_have_no_contact_force,
    pairs_that_separate_fast_have_no_contact_force,
    forces_of_several_contacts_add_up,
);
