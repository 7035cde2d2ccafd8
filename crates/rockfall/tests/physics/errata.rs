//! One test for each of the errata E1 to E18 of `docs/physics`. The expected value holds with the corrected formula
//! and differs clearly from the result of the thesis's formula, which the comment gives.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Backend, Capsule, Cuboid, Polygon, Scene, Sphere, SphereState, Spring};

use crate::common::*;

/// Collides a rod with a fixed sphere. The rod lies along x from 0 to 4 (masses 1 and 3, radius 0.1) and rises at 2. It
/// touched the sphere (radius 0.5) at a = 0.25, `LATE` ago. M = 12/7, because 1/M = 0.75^2/1 + 0.25^2/3 = 7/12.
fn struck_rod(backend: Backend) -> (Vec<Sphere>, Vec<SphereState>) {
    let mut scene = weightless();
    let ends = [Sphere::new([0.0; 3], 0.1), Sphere::new([4.0, 0.0, 0.0], 0.1).mass(3.0)];
    rod(&mut scene, ends.map(|end| late(end.velocity([0.0, 2.0, 0.0]))), 0.1);
    spheres(&mut scene, [Sphere::new([1.0, 0.6, 0.0], 0.5).fixed()]);
    let before = scene.spheres().to_vec();
    (before, collide(scene, backend))
}

/// The velocity of the contact point changes by 3.5, so its displacement is d = 3.5 `LATE`. The ends receive the shares
/// (1-a) M/m1 and a M/m2 of it: 9/7 d and d/7. The thesis has m1 + m2 in place of M: the ends receive 3 d and d/3, and
/// the contact point moves by 7/3 d.
fn e01_the_displacement_of_a_rod_is_shared_by_its_effective_mass(backend: Backend) {
    let (before, after) = struck_rod(backend);
    let d = 3.5 * f64::from(LATE);
    displacements(&before, &after, [[0.0, -0.75 * 12.0 / 7.0 * d, 0.0], [0.0, -0.25 * 12.0 / 7.0 / 3.0 * d, 0.0], [0.0; 3]]);
    let contact_point = after[0].position.lerp(after[1].position, 0.25);
    close(contact_point.y, 2.0 * f64::from(LATE) - d, F32_PLACE, "place of the contact point");
}

/// j = (1 + e) u M = 1.75 * 2 * 12/7 = 6. The ends receive 0.75 * 6 / 1 = 4.5 and 0.25 * 6 / 3 = 0.5, and the contact
/// point of the rod leaves at 0.75 * 4.5 + 0.25 * 0.5 = 3.5 = u + e u. The thesis multiplies by (1 + e) again: 7.875
/// and 0.875.
///
/// Two rods: the share of each end is divided by its own mass. The thesis would divide by mA1 = 1 for A2 (mass 4) and
/// B2 (mass 2). The rods cross at their middles: wA = (1 + 1/4)/4 = 5/16, wB = (1 + 1/2)/4 = 6/16, u = 2,
/// j = 3.5 * 16/11. A2 receives j/8 = 0.636 (thesis 2.545), B2 j/4 = 1.273 (thesis 2.545).
fn e02_an_impulse_is_shared_once_by_the_mass_of_each_end(backend: Backend) {
    let (_, after) = struck_rod(backend);
    velocities(&after, [[0.0, 2.0 - 4.5, 0.0], [0.0, 2.0 - 0.5, 0.0], [0.0; 3]]);

    let after = collide(crossing_rods(2.0, 0.15, Vec3::ZERO), backend);
    let j = 3.5 * 16.0 / 11.0;
    velocities(&after, [[0.0, 2.0 - j / 2.0, 0.0], [0.0, 2.0 - j / 8.0, 0.0], [0.0, j / 2.0, 0.0], [0.0, j / 4.0, 0.0]]);
}

/// Two rods of radius 0.1 that cross at their middles. The lower one lies along x (masses 1 and 4) and rises; the upper
/// one lies along z (masses 1 and 2).
fn crossing_rods(speed: f32, apart: f32, at: Vec3) -> Scene {
    let mut scene = weightless();
    let a = [(-2.0, 1.0), (2.0, 4.0)].map(|(x, mass)| {
        let place = at + Vec3::new(x, 0.0, 0.0);
        Sphere::new(place, 0.01).mass(mass).velocity([0.0, speed, 0.0])
    });
    let b = [(-1.0, 1.0), (1.0, 2.0)].map(|(z, mass)| Sphere::new(at + Vec3::new(0.0, apart, z), 0.01).mass(mass));
    rod(&mut scene, a, 0.1);
    rod(&mut scene, b, 0.1);
    scene
}

/// A polygon with the skew edges L = (1, 0, 2) and R = (2, 0, 0). The ball over its middle (1.5, 1) collides; the thesis
/// has (A-P).L = 3.5 and misses the polygon. The ball at (0.01, 0.4) lies outside the slanted edge, l = 0.2,
/// k = -0.095; the thesis has (A-P).L = 0.81 and (A-P).R = 0.02 and detects a collision.
fn e03_a_skew_polygon_is_hit_only_inside_its_edges(backend: Backend) {
    let over = |x: f32, z: f32| {
        let mut scene = weightless();
        let polygon = Polygon::new([0.0; 3], [1.0, 0.0, 2.0], [2.0, 0.0, 0.0]);
        scene.add_polygon(polygon).expect("a valid polygon");
        spheres(&mut scene, [Sphere::new([x, 0.25, z], 0.3).velocity([0.0, -2.0, 0.0])]);
        collide(scene, backend)[0].velocity
    };
    near(over(1.5, 1.0), [0.0, 1.5, 0.0], F32, "over the middle");
    near(over(0.01, 0.4), [0.0, -2.0, 0.0], 0.0, "beside the slanted edge");
}

/// A rod passes the vertex (1, 1, 1) of a box at a distance of 0.08 with a = 0.25, so the contact force acts at that
/// point, perpendicular to the rod. Unit masses: 1/M = 10/16, Cc o M = 1000 * 0.02 * 1.6 = 32 along (1, 1, 1)/sqrt 3,
/// shared as 24 and 8. The thesis's condition A.C = 0 would hold only where the foot of the perpendicular is
/// end 1 (a = 0). Here A.C = 0.25 |A|^2, so the thesis finds no contact.
fn e04_a_rod_touches_a_vertex_where_the_distance_is_perpendicular(backend: Backend) {
    let mut scene = with(|settings| (settings.gravity, settings.friction) = (0.0, 0.0));
    scene.add_box(Cuboid::between([-1.0; 3], [1.0; 3])).expect("a valid box");
    let along = Vec3::new(1.0, -1.0, 0.0).normalize();
    let point = Vec3::ONE + 0.08 * Vec3::ONE.normalize();
    rod(&mut scene, [point - along, point + 3.0 * along].map(|end| Sphere::new(end, 0.01)), 0.1);
    let f = 32.0 / 3.0_f64.sqrt();
    forces(&loads(scene, backend), [[0.75 * f; 3], [0.25 * f; 3]], 2e-3);
}

/// k = 10, l = 1, stretched to 3: the spring pulls A towards B with 20, and B towards A. The thesis's signs push them
/// apart: -20 on A.
fn e05_a_stretched_spring_pulls(backend: Backend) {
    let mut scene = weightless();
    let [a, b] = spheres(&mut scene, [0.0, 3.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1)));
    scene.add_spring(Spring::new(a, b, 10.0, 1.0)).expect("a valid spring");
    forces(&loads(scene, backend), [[20.0, 0.0, 0.0], [-20.0, 0.0, 0.0]], 1e-3);
}

/// Two balls of radius 0.5 with o = 0.2 and friction as the only force. They spin at `spins` about z, and B moves at
/// `slip` along y. m* = 1/2.
fn balls_with_friction_only(spins: [f32; 2], slip: f32, backend: Backend) -> Vec<Load> {
    let mut scene = with(|settings| {
        (settings.gravity, settings.contact_force, settings.contact_damping) = (0.0, 0.0, 0.0);
    });
    let [a, b] = [0.0, 0.8].map(|x| Sphere::new([x, 0.0, 0.0], 0.5));
    let spin = |ball: Sphere, w: f32| ball.angular_momentum([0.0, 0.0, w * ball.inertia()]);
    spheres(&mut scene, [spin(a, spins[0]), spin(b, spins[1]).velocity([0.0, slip, 0.0])]);
    loads(scene, backend)
}

/// t = y: F on A = 50 * 0.5 * 0.2 = 5 y. The arms are 0.5 - 0.1, so both torques are 0.4 * 5 = 2 about z. They balance
/// the moment of the forces, -0.8 * 5. With the thesis's arms of 0.5 they are 2.5 each, and the angular momentum of the
/// pair would grow by 1 every second.
fn e06_both_arms_end_at_the_same_point(backend: Backend) {
    let found = balls_with_friction_only([0.0, 0.0], 1.0, backend);
    forces(&found, [[0.0, 5.0, 0.0], [0.0, -5.0, 0.0]], 1e-4);
    torques(&found, [[0.0, 0.0, 2.0]; 2], 1e-4);
}

/// Both balls spin at 1 about z. At the contact, the surface of A moves at 0.4 along +y and that of B at 0.4 along -y,
/// so t = -0.8 y and F on A = 5 * -sqrt 0.8 y = -4.472 y. With B's contact point at +n, as in the thesis, both surfaces
/// would move along +y: no friction. Balls with opposite spins roll on each other, F = 0; the thesis has 4.472 there
/// (or 5, without the correction E6).
fn e07_the_contact_point_of_b_is_on_the_side_of_a(backend: Backend) {
    let f = 5.0 * 0.8_f64.sqrt();
    forces(&balls_with_friction_only([1.0, 1.0], 0.0, backend), [[0.0, -f, 0.0], [0.0, f, 0.0]], 1e-4);
    forces(&balls_with_friction_only([1.0, -1.0], 0.0, backend), [[0.0; 3]; 2], 1e-3);
}

/// A ball (mass 2) rests on a rod (1/M = 7/12, m* = 12/13) with o = 0.05: a force of 50 * 12/13 = 46.15 acts upwards on
/// the ball. The same force acts downwards on the rod, with 3/4 and 1/4 of it on the ends. In the thesis both have the
/// same sign: the ends of the rod would move up with the ball.
fn e08_a_ball_and_a_rod_push_each_other_apart(backend: Backend) {
    let mut scene = weightless();
    let ends = [Sphere::new([0.0; 3], 0.1), Sphere::new([4.0, 0.0, 0.0], 0.1).mass(3.0)];
    rod(&mut scene, ends, 0.1);
    spheres(&mut scene, [Sphere::new([1.0, 0.55, 0.0], 0.5).mass(2.0)]);
    let found = loads(scene, backend);
    let f = 50.0 * 12.0 / 13.0;
    forces(&found, [[0.0, -0.75 * f, 0.0], [0.0, -0.25 * f, 0.0], [0.0, f, 0.0]], 2e-3);
    near(found.iter().map(|load| load.force).sum::<DVec3>(), [0.0; 3], 1e-4, "sum of forces");
}

/// A ball spins in place at -1 about z with o = 0.02 in the floor. Its arm is 0.48, so its lowest point moves at -0.48
/// x. Friction accelerates it by 50 * 0.02 * sqrt 0.48 = 0.693 x and slows its spin by a torque of 0.48 times that. The
/// thesis uses v alone: no force, no torque. No friction acts on a rolling ball, v = 0.48; the thesis decelerates it
/// with 0.693.
fn e09_friction_on_static_objects_includes_the_spin(backend: Backend) {
    let on_floor = |speed: f32| {
        let mut scene = with(|settings| {
            (settings.gravity, settings.contact_force, settings.contact_damping) = (0.0, 0.0, 0.0);
        });
        // The coordinates are of the order of 1, so only the sum rounds.
        scene.add_box(Cuboid::between([-1.0; 3], [1.0, 0.0, 1.0])).expect("a valid box");
        let ball = Sphere::new([0.0, 0.48, 0.0], 0.5).velocity([speed, 0.0, 0.0]);
        spheres(&mut scene, [ball.angular_momentum([0.0, 0.0, -ball.inertia()])]);
        loads(scene, backend)
    };
    let spinning = on_floor(0.0);
    let f = 0.48_f64.sqrt();
    forces(&spinning, [[f, 0.0, 0.0]], 1e-4);
    torques(&spinning, [[0.0, 0.0, 0.48 * f]], 1e-4);
    // The square root of a slip that is a rounding error of 1e-7 is 3e-4.
    forces(&on_floor(0.48), [[0.0; 3]], 2e-3);
}

/// A ball 0.55 above a rod overlaps it, because the radii sum to 0.6, and rebounds. At 0.65 it does not collide. The
/// thesis has these cases reversed.
fn e10_a_ball_and_a_rod_collide_when_they_overlap(backend: Backend) {
    for (height, met) in [(0.55, true), (0.65, false)] {
        let mut scene = weightless();
        rod(&mut scene, [-2.0, 2.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1).fixed()), 0.1);
        spheres(&mut scene, [Sphere::new([0.0, height, 0.0], 0.5).velocity([0.0, -2.0, 0.0])]);
        // Both ends of the rod are fixed: w = 1, v' = e * 2.
        let speed = if met { 1.5 } else { -2.0 };
        near(collide(scene, backend)[2].velocity, [0.0, speed, 0.0], F32, "the ball");
    }
}

/// Balls of radius 1 at a distance of 1.98, m* = 1/2: 1000 * 0.02 / 2 = 10. With the vector D as the direction the
/// force would be 19.8. The thesis writes n = |D|, which is not a vector.
fn e11_the_normal_is_a_unit_vector(backend: Backend) {
    let mut scene = weightless();
    spheres(&mut scene, [0.0, 1.98].map(|x| Sphere::new([x, 0.0, 0.0], 1.0)));
    forces(&loads(scene, backend), [[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]], 1e-3);
}

/// A ball of mass 2 with a velocity of 3 hits one of mass 1 at rest, e = 0.75: j = 1.75 * 3 / 1.5 = 3.5, velocities
/// 1.25 and 3.5, total momentum 6 as before. The thesis adds j n / m with the same sign to both: 1.25 and -3.5,
/// momentum -1. The same holds for rods: 8/11 * 3.5 = 2.545 for B1 (thesis -2.545).
fn e12_the_velocity_changes_of_a_pair_are_opposite(backend: Backend) {
    let mut scene = weightless();
    let ball = Sphere::new([0.0; 3], 0.5).mass(2.0).velocity([3.0, 0.0, 0.0]);
    spheres(&mut scene, [ball, Sphere::new([0.99, 0.0, 0.0], 0.5)]);
    velocities(&collide(scene, backend), [[1.25, 0.0, 0.0], [3.5, 0.0, 0.0]]);

    let scene = crossing_rods(2.0, 0.15, Vec3::ZERO);
    let after = collide(scene, backend);
    close(after[2].velocity.y, 3.5 * 8.0 / 11.0, F32, "velocity of B1");
    let momentum: f64 = after.iter().map(|end| f64::from(end.mass * end.velocity.y)).sum();
    close(momentum, 10.0, 1e-4, "momentum");
}

/// Rods that cross at (8, 8, 8) with o = 0.03, 15 ms after first contact: wA = 5/16, wB = 6/16, j = 3.5 * 16/11. A1
/// moves down by 0.015 j / 2 = 0.038, B1 up by the same distance. The thesis moves them by shares of the contact point
/// (8, 8, 8) itself.
fn e13_rods_are_not_displaced_by_their_contact_point(backend: Backend) {
    let scene = crossing_rods(2.0, 0.17, Vec3::splat(8.0));
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    let j = 3.5 * 16.0 / 11.0;
    let expected = [-j / 2.0, -j / 8.0, j / 2.0, j / 4.0].map(|y| [0.0, y, 0.0]);
    displacements(&before, &after, over(0.015, expected));
}

/// Crossing rods collide. With the thesis's C = B - A, the difference of the axes, here (-4, 0, 2), a = -1: no
/// collision.
fn e14_rods_collide_where_they_cross(backend: Backend) {
    let after = collide(crossing_rods(2.0, 0.15, Vec3::ZERO), backend);
    // As in E2: 2 - 3.5 * 8/11.
    close(after[0].velocity.y, 2.0 - 28.0 / 11.0, F32, "velocity of A1");
    untouched(crossing_rods(2.0, 0.21, Vec3::ZERO), backend);
}

/// A velocity of -2 towards a polygon becomes e * 2 = 1.5. The thesis adds (1 + e) times the velocity: -5.5.
fn e15_a_polygon_reverses_the_normal_velocity(backend: Backend) {
    let mut scene = weightless();
    floor_polygon(&mut scene);
    spheres(&mut scene, [Sphere::new([0.0, 0.49, 0.0], 0.5).velocity([1.0, -2.0, 0.0])]);
    velocities(&collide(scene, backend), [[1.0, 1.5, 0.0]]);
}

/// A ball (0.24, 0.32) outside the edge of a box whose corner is at (8, 8, 8). The closest point of the box is 0.4
/// away: o = 0.1, n = (-0.6, -0.8, 0), v' = v + 1.75 * 2 * (0.6, 0.8, 0). The thesis's X = (0.24, 0.32, 0) is 13 away
/// from the ball: no collision.
fn e16_the_closest_point_of_a_box_is_a_position(backend: Backend) {
    let mut scene = weightless();
    scene.add_box(Cuboid::between([8.0; 3], [9.0; 3])).expect("a valid box");
    spheres(&mut scene, [Sphere::new([9.24, 9.32, 8.5], 0.5).velocity([-1.2, -1.6, 0.0])]);
    velocities(&collide(scene, backend), [[0.9, 1.2, 0.0]]);
}

/// A capsule (masses 1 and 1, length 1, thin ends) turns at 10 rad/s about y: L = 1/2 * 1^2 * 10 = 5, plus the spins of
/// the ends, 2/5 r^2 = 4e-5 each. It keeps L within 0.1 % over 16 steps of 20 ms. The thesis loses 1 - cos 0.2 = 2 % in
/// every step: 3.6 remains.
fn e17_a_capsule_keeps_its_angular_momentum(backend: Backend) {
    let mut scene = weightless();
    let ends = [-0.5, 0.5].map(|x| Sphere::new([x, 0.0, 0.0], 0.01).velocity([0.0, 0.0, -10.0 * x]));
    dumbbell(&mut scene, ends, 0.01);
    let mut simulation = simulation(scene, backend);
    simulation.run(16, 0.02).expect("16 steps");
    let energy = simulation.energy().expect("energies");
    near(energy.angular_momentum, [0.0, 5.0, 0.0], 0.005, "angular momentum");
    close(energy.kinetic, 25.0, 0.05, "energy");
}

/// A short, thick capsule: masses 1 and 1, d = 0.5, r = 0.5, mu d^2 = 1/8, I1 + I2 = 0.2. Initially only its ends spin,
/// across the axis, with H = 0.2 in total. The whole capsule then turns at w = 0.2 / 0.325. The ends move at
/// w d/2 = 0.15385, and each keeps the angular momentum I w = 0.06154. The thesis converts all of H into momentum of the
/// ends: w = 0.2 / 0.125, 0.4 each, and no spin remains. The kinetic energy, 0.1 at the start, would become 0.16; the
/// correct value is 0.06154. The ends receive their momentum during the whole step, so at its end the axis has turned by
/// q with tan q = w h/2.
fn e18_only_the_excess_spin_of_a_capsule_becomes_momentum_of_its_ends(backend: Backend) {
    let mut scene = weightless();
    let capsule = Capsule::new([-0.25, 0.0, 0.0], [0.25, 0.0, 0.0], 0.5).mass(2.0);
    let parts = scene.add_capsule(capsule).expect("a valid capsule");
    let parts = *scene.capsule(parts).expect("the capsule");
    let mut simulation = simulation(scene, backend);
    for end in [parts.end1, parts.end2] {
        simulation.set_angular_momentum(end, [0.0, 0.0, 0.1]).expect("a sphere");
    }
    simulation.step(DT).expect("a step");
    let w = 0.2 / 0.325;
    let ends = simulation.spheres().expect("both ends");
    let (sin, cos) = (0.5 * w * f64::from(DT)).atan().sin_cos();
    velocities(&ends, [[0.25 * w * sin, -0.25 * w * cos, 0.0], [-0.25 * w * sin, 0.25 * w * cos, 0.0]]);
    near(ends[1].position, [0.25 * cos, 0.25 * sin, 0.0], 1e-6, "position of an end");
    for end in ends {
        near(end.angular_momentum, [0.0, 0.0, 0.1 * w], 1e-6, "spin of an end");
    }
    // From here on it turns freely as a rigid body and keeps its angular momentum and energy.
    simulation.run(32, DT).expect("32 steps");
    let energy = simulation.energy().expect("energies");
    near(energy.angular_momentum, [0.0, 0.0, 0.2], 2e-6, "angular momentum");
    close(energy.kinetic, 0.1 * w, 1e-5, "energy");
}

both!(
    e01_the_displacement_of_a_rod_is_shared_by_its_effective_mass,
    e02_an_impulse_is_shared_once_by_the_mass_of_each_end,
    e03_a_skew_polygon_is_hit_only_inside_its_edges,
    e04_a_rod_touches_a_vertex_where_the_distance_is_perpendicular,
    e05_a_stretched_spring_pulls,
    e06_both_arms_end_at_the_same_point,
    e07_the_contact_point_of_b_is_on_the_side_of_a,
    e08_a_ball_and_a_rod_push_each_other_apart,
    e09_friction_on_static_objects_includes_the_spin,
    e10_a_ball_and_a_rod_collide_when_they_overlap,
    e11_the_normal_is_a_unit_vector,
    e12_the_velocity_changes_of_a_pair_are_opposite,
    e13_rods_are_not_displaced_by_their_contact_point,
    e14_rods_collide_where_they_cross,
    e15_a_polygon_reverses_the_normal_velocity,
    e16_the_closest_point_of_a_box_is_a_position,
    e17_a_capsule_keeps_its_angular_momentum,
    e18_only_the_excess_spin_of_a_capsule_becomes_momentum_of_its_ends,
);
