//! Capsules as rigid bodies.

use rockfall::glam::Vec3;
use rockfall::{Backend, Capsule, Scene, Sphere, SphereState};

use crate::common::*;

/// Returns a capsule before and after phase 3. It has mass 2, falls at 2 with o = 0.01 and lies in the plane z = 0.
fn drop_capsule(end2: [f32; 3], backend: Backend, floor: fn(&mut Scene)) -> (Vec<Sphere>, Vec<SphereState>) {
    let mut scene = weightless();
    floor(&mut scene);
    let capsule = Capsule::new([0.0, 0.49, 0.0], end2, 0.5).mass(2.0).velocity([0.0, -2.0, 0.0]);
    scene.add_capsule(capsule).expect("a valid capsule");
    let before = scene.spheres().to_vec();
    (before, collide(scene, backend))
}

/// Upright: n is the axis, w = 1/(m1 + m2) = 1/2, j = 1.75 * 2 * 2 = 7, shared by mass. Each end receives 3.5, so both
/// leave at 1.5 = e * 2. The overlap of 0.01 began 5 ms ago, so both ends are displaced by 0.005 * 3.5 upwards.
///
/// Flat: both ends collide and receive half of the impulse each. They leave at the same speed and are not displaced.
/// The tolerance covers the error of at most 1.4e-4 of the impulse that the sweeps leave.
fn upright_and_flat_capsules_rebound_with_e(backend: Backend) {
    for floor in [floor_box, floor_polygon] {
        for end2 in [[0.0, 2.49, 0.0], [2.0, 0.49, 0.0]] {
            let (before, after) = drop_capsule(end2, backend, floor);
            for end in &after {
                near(end.velocity, [0.0, 1.5, 0.0], 1e-4, "velocity");
            }
            let lifted = if end2[0] == 0.0 { 0.005 * 3.5 } else { 0.0 };
            displacements(&before, &after, [[0.0, lifted, 0.0]; 2]);
        }
    }
}

/// The same in a whole run: the capsule falls, rebounds once at e times its speed and keeps its direction. Apart from
/// the impulse, only the contact force on the rounding error of the removed overlap acts, about 1e-7 * Cc * dt.
fn dropped_capsules_rebound_at_e_times_their_speed(backend: Backend) {
    for end2 in [[0.0, 2.6, 0.0], [2.0, 0.6, 0.0]] {
        let mut scene = weightless();
        floor_box(&mut scene);
        let capsule = Capsule::new([0.0, 0.6, 0.0], end2, 0.5).mass(2.0).velocity([0.0, -2.0, 0.0]);
        scene.add_capsule(capsule).expect("a valid capsule");
        let mut simulation = simulation(scene, backend);
        simulation.run(24, 0.005).expect("24 steps");
        for end in simulation.spheres().expect("both ends") {
            near(end.velocity, [0.0, 1.5, 0.0], 1e-4, "velocity after the bounce");
        }
    }
}

/// A dumbbell of masses 1 and `m2` with its axis along (0.8, 0.6, 0) and length 2. It falls at 2 with end 1 on the
/// floor.
fn slanted(m2: f32, fixed: bool) -> Scene {
    let mut scene = weightless();
    floor_box(&mut scene);
    let (near, far) = (Sphere::new([0.0, 0.49, 0.0], 0.5), Sphere::new([1.6, 1.69, 0.0], 0.5).mass(m2));
    let ends = if fixed {
        // Perpendicular to the axis, because the rod has a fixed length.
        [near.velocity([1.2, -1.6, 0.0]), far.fixed()]
    } else {
        [near, far].map(|end| end.velocity([0.0, -2.0, 0.0]))
    };
    dumbbell(&mut scene, ends, 0.5);
    scene
}

/// Rotates a vector about z by an angle.
fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// n = -y, d = (1.6, 1.2), M = 4, mu = 3/4, I = 0.1 and 0.3, It = 3/4 * 4 + 0.4 = 3.4. The lever of end 1 is -3/4,
/// T = -3/4 d x n = 1.2 z, so the inverse mass of the end is 1/4 + 1.44/3.4. With u = 2, j is 3.5 divided by it. The
/// centre of mass receives j/4 upwards, and the capsule turns at W = -1.2 j / 3.4 about z during the 5 ms since the
/// overlap of 0.01 began.
fn a_slanted_capsule_with_unequal_masses_rebounds_as_a_rigid_body(backend: Backend) {
    let scene = slanted(3.0, false);
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    let j = 3.5 / (0.25 + 1.44 / 3.4);
    let (rise, spin, time) = (0.25 * j, -1.2 * j / 3.4, 0.005);
    let d = turned([1.6, 1.2], spin * time);
    let levers = [-0.75, 0.25];
    let changes = levers.map(|lever| [-lever * spin * d[1], rise + lever * spin * d[0], 0.0]);
    velocities(&after, changes.map(|[x, y, z]| [x, y - 2.0, z]));
    displacements(&before, &after, levers.map(|lever| [lever * (d[0] - 1.6), rise * time + lever * (d[1] - 1.2), 0.0]));
    for (end, inertia) in after.iter().zip([0.1, 0.3]) {
        near(end.angular_momentum, [0.0, 0.0, inertia * spin], F32, "angular momentum");
    }
}

/// With end 2 fixed, the capsule is a rod from a fixed sphere to end 1. Only components perpendicular to the axis (0.8,
/// 0.6) count. The perpendicular part of n = -y is (0.48, -0.64, 0), so w = 0.64, u = 1.6, j = 1.75 * 1.6 / 0.64 = 4.375:
/// v' = (1.2, -1.6) - 4.375 (0.48, -0.64) = -0.75 v.
fn a_capsule_with_a_fixed_end_turns_about_that_end(backend: Backend) {
    let after = collide(slanted(3.0, true), backend);
    velocities(&after, [[-0.9, 1.2, 0.0], [0.0; 3]]);
}

/// A ball that hits an end of a resting capsule along the axis collides with the whole mass of the capsule. With equal
/// masses, 2 and 1 + 1, and e = 1 the ball stops, and both ends move on at its speed.
///
/// The oblique hit has n = (-0.6, 0.8, 0) from the end to the ball: d = (2, 0), It = 1/2 * 4 + 0.2 = 2.2,
/// T = -d/2 x n = -0.8 z, so w = 1/2 + 0.64/2.2 + 1/2, u = 3 * 0.8, j = 2 * 2.4 / w. The ball receives j n / 2, the
/// centre of mass the opposite, and the capsule turns at 0.8 j / 2.2 about z.
fn a_hit_on_an_end_moves_the_capsule_as_a_rigid_body(backend: Backend) {
    let hit = |from: [f32; 3], velocity: [f32; 3]| {
        let mut scene = weightless();
        scene.settings.restitution = 1.0;
        scene.add_capsule(Capsule::new([0.0; 3], [2.0, 0.0, 0.0], 0.5).mass(2.0)).expect("a valid capsule");
        spheres(&mut scene, [late(Sphere::new(from, 0.5).mass(2.0).velocity(velocity))]);
        collide(scene, backend)
    };
    let along = hit([-1.0, 0.0, 0.0], [3.0, 0.0, 0.0]);
    velocities(&along, [[3.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0; 3]]);
    let aslant = hit([-0.6, 0.8, 0.0], [0.0, -3.0, 0.0]);
    let j = 4.8 / (1.0 + 0.64 / 2.2);
    let spin = 0.8 * j / 2.2;
    let [dx, dy] = turned([spin, 0.0], spin * f64::from(LATE));
    let end = |lever: f64| [0.3 * j - 2.0 * lever * dy, -0.4 * j + 2.0 * lever * dx, 0.0];
    velocities(&aslant, [end(-0.5), end(0.5), [-0.3 * j, 0.4 * j - 3.0, 0.0]]);
}

/// A ball that hits the middle of a capsule's rod collides with 1/M = 1/4 + 1/4 = 1/2 of masses 1 and 1, as with any
/// rod. With mass 2 and e = 1 it stops, and the capsule moves on at its speed.
fn a_hit_on_the_middle_moves_both_ends_of_a_capsule_alike(backend: Backend) {
    let mut scene = weightless();
    scene.settings.restitution = 1.0;
    scene.add_capsule(Capsule::new([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.25).mass(2.0)).expect("a valid capsule");
    let ball = Sphere::new([0.0, 0.74, 0.0], 0.5).mass(2.0).velocity([0.0, -3.0, 0.0]);
    spheres(&mut scene, [ball]);
    velocities(&collide(scene, backend), [[0.0, -3.0, 0.0], [0.0, -3.0, 0.0], [0.0; 3]]);
}

/// Two capsules collide end to end: w = 1/2 + 1/6 = 2/3 for total masses 2 and 6, u = 4, e = 0.75: j = 7 * 3/2 = 10.5.
/// All four ends: vA = 4 - 10.5/2 = -1.25, vB = 10.5/6 = 1.75.
fn capsules_collide_end_to_end_with_their_total_masses(backend: Backend) {
    let mut scene = weightless();
    let first = Capsule::new([0.0; 3], [2.0, 0.0, 0.0], 0.5).mass(2.0).velocity([4.0, 0.0, 0.0]);
    let second = Capsule::new([2.98, 0.0, 0.0], [5.0, 0.0, 0.0], 0.5).mass(6.0);
    for capsule in [first, second] {
        scene.add_capsule(capsule).expect("a valid capsule");
    }
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    let (a, b) = ([-1.25, 0.0, 0.0], [1.75, 0.0, 0.0]);
    velocities(&after, [a, a, b, b]);
    // The overlap of 0.02 began 5 ms ago.
    let (a, b) = ([-5.25, 0.0, 0.0], [1.75, 0.0, 0.0]);
    displacements(&before, &after, over(0.005, [a, a, b, b]));
}

/// About the axis, both ends receive the common spin (L1 + L2).axis / (I1 + I2), I = 2/5 * 1 * 0.25 = 0.1. Spins of 2
/// and 4 about the axis become 3, and the capsule rolls by 3 t.
fn both_ends_get_the_common_spin_about_the_axis(backend: Backend) {
    let mut scene = weightless();
    let ends = [(0.0, 0.2), (2.0, 0.4)].map(|(z, l)| Sphere::new([0.0, 0.0, z], 0.5).angular_momentum([0.0, 0.0, l]));
    dumbbell(&mut scene, ends, 0.5);
    let mut simulation = simulation(scene, backend);
    simulation.run(16, DT).expect("16 steps");
    for end in simulation.spheres().expect("both ends") {
        near(end.angular_momentum, [0.0, 0.0, 0.3], 1e-6, "spin about the axis");
        // 3 rad/s for 1/4 s.
        let turned = end.rotation() * Vec3::X;
        near(turned, [0.75_f64.cos(), 0.75_f64.sin(), 0.0], 1e-5, "x axis of the capsule");
    }
}

/// A capsule rolls at 20 rad/s and tumbles at w = 10 rad/s. Its moments of inertia are 0.05 along and 0.55 across the
/// axis. Without torque its axis precesses about the angular momentum at W, W^2 = w^2 + (20 * 0.05 / 0.55)^2. A step of
/// h loses h^4 w^2 W^2 / 8 of the spin about the axis (`step/integrate/turn.rs`). If the axis only followed the ends, a
/// step would lose 1 - cos(h w) = 2 %.
fn a_tumbling_capsule_keeps_its_spin_about_the_axis(backend: Backend) {
    let (roll, w, h, steps) = (20.0, 10.0, 0.02_f64, 16);
    let mut scene = weightless();
    let end = |x: f32| Sphere::new([x, 0.0, 0.0], 0.25).velocity([0.0, 10.0 * x, 0.0]).angular_momentum([0.5, 0.0, 0.25]);
    dumbbell(&mut scene, [end(-0.5), end(0.5)], 0.25);
    let mut simulation = simulation(scene, backend);
    let before = simulation.energy().expect("energies").kinetic;
    simulation.run(steps, h as f32).expect("16 steps");
    let ends = simulation.spheres().expect("both ends");
    let axis = (ends[1].position - ends[0].position).normalize();
    let spin = (ends[0].angular_momentum + ends[1].angular_momentum).dot(axis) / 0.05;
    let round = w * w + (roll * 0.05_f64 / 0.55).powi(2);
    let left = (1.0 - h.powi(4) * w * w * round / 8.0).powi(steps as i32);
    close(spin, roll * left, 0.005, "spin about the axis");
    let energy = simulation.energy().expect("energies");
    near(energy.angular_momentum, [1.0, 0.0, 5.5], 1e-4, "angular momentum");
    // The roll contributes (T.a)^2 (1/0.05 - 1/0.55) / 2 to the energy.
    let lost = 0.5 * (1.0 - left * left) * (1.0 / 0.05 - 1.0 / 0.55);
    close(energy.kinetic, before - lost, 0.005, "energy");
}

/// The orientation of a capsule turns with its axis: its local x axis stays along its ends.
fn the_orientation_of_a_capsule_follows_its_axis(backend: Backend) {
    let mut scene = weightless();
    let capsule = Capsule::new([-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], 0.2);
    let parts = scene.add_capsule(capsule).expect("a valid capsule");
    let parts = *scene.capsule(parts).expect("the capsule");
    let mut simulation = simulation(scene, backend);
    simulation.set_velocity(parts.end1, [0.0, -1.5, 0.5]).expect("a sphere");
    simulation.set_velocity(parts.end2, [0.0, 1.5, -0.5]).expect("a sphere");
    simulation.run(on(backend, 300, 30), 0.02).expect("steps");
    let ends = simulation.spheres().expect("both ends");
    let axis = (ends[1].position - ends[0].position).normalize();
    assert!(axis.x < 0.9, "the capsule must have turned: {axis}");
    for end in ends {
        // The rotation of each step is exact except for rounding: 300 times 1e-7.
        near(end.rotation() * Vec3::X, axis.as_dvec3(), 5e-5, "local x axis of the capsule");
    }
}

both!(
    upright_and_flat_capsules_rebound_with_e,
    dropped_capsules_rebound_at_e_times_their_speed,
    a_slanted_capsule_with_unequal_masses_rebounds_as_a_rigid_body,
    a_capsule_with_a_fixed_end_turns_about_that_end,
    a_hit_on_an_end_moves_the_capsule_as_a_rigid_body,
    a_hit_on_the_middle_moves_both_ends_of_a_capsule_alike,
    capsules_collide_end_to_end_with_their_total_masses,
    both_ends_get_the_common_spin_about_the_axis,
    a_tumbling_capsule_keeps_its_spin_about_the_axis,
    the_orientation_of_a_capsule_follows_its_axis,
);
