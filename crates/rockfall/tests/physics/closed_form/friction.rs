//! Friction: its force, its torque, and the rolling that it causes.

use rockfall::glam::DVec3;
use rockfall::{Backend, Capsule, Scene, Simulation, Sphere};

use crate::common::*;

/// A scene with friction as the only force: no contact force and no damping. mu = 50.
fn friction_only() -> Scene {
    with(|settings| {
        settings.gravity = 0.0;
        settings.contact_force = 0.0;
        settings.contact_damping = 0.0;
    })
}

/// Tolerance of forces of the order of 1. They are computed from velocities that round by 6e-8, over dt = 1/64, and
/// from mu o with an overlap of 0.02 that rounds by 6e-8.
const FORCE: f64 = 3e-5;

/// o = 0.02, m* = 0.75, arms sA = sB = 0.5 - 0.01 = 0.49. A spins at (0, 0, 1): uA = w x (sA n) = 0.49 y. B moves at 0.25
/// y and spins at (0, 0, 2): uB = 0.25 - 2 * 0.49 = -0.73 y. t = uB - uA = -1.22 y: F on
/// A = 50 * 0.75 * 0.02 * t / sqrt|t| = -0.75 sqrt 1.22 y. Both torques are s n x F = -0.49 * 0.75 sqrt 1.22 z.
fn friction_between_two_spheres_includes_their_spins(backend: Backend) {
    let mut scene = friction_only();
    let spin = |sphere: Sphere, z: f32| sphere.angular_momentum([0.0, 0.0, z * sphere.inertia()]);
    let a = spin(Sphere::new([0.0; 3], 0.5), 1.0);
    let b = spin(Sphere::new([0.98, 0.0, 0.0], 0.5).mass(3.0), 2.0).velocity([0.0, 0.25, 0.0]);
    spheres(&mut scene, [a, b]);
    let found = loads(scene, backend);
    let f = 0.75 * 1.22_f64.sqrt();
    forces(&found, [[0.0, -f, 0.0], [0.0, f, 0.0]], FORCE);
    torques(&found, [[0.0, 0.0, -0.49 * f]; 2], FORCE);
}

/// Against a static object the whole overlap is on the sphere's side: s = 0.5 - 0.02 = 0.48, m* = 2. The sphere slides at
/// 0.3 x and spins at (0, 0, 1), n = -y: u = 0.3 + (z x (-y)) * 0.48 = 0.3 + 0.48 = 0.78 x. t = -0.78 x,
/// F = 50 * 2 * 0.02 * t/sqrt|t| = -2 sqrt 0.78 x, torque = 0.48 (-y) x F = -0.48 * 2 sqrt 0.78 z.
fn friction_on_boxes_and_polygons_includes_the_spin(backend: Backend) {
    for floor in [floor_box, floor_polygon] {
        let mut scene = friction_only();
        floor(&mut scene);
        let ball = Sphere::new([0.0, 0.48, 0.0], 0.5).mass(2.0).velocity([0.3, 0.0, 0.0]);
        spheres(&mut scene, [ball.angular_momentum([0.0, 0.0, ball.inertia()])]);
        let found = loads(scene, backend);
        let f = 2.0 * 0.78_f64.sqrt();
        forces(&found, [[-f, 0.0, 0.0]], FORCE);
        torques(&found, [[0.0, 0.0, -0.48 * f]], FORCE);
    }
}

/// A fixed sphere acts as a conveyor: its velocity and spin count, but no force changes it. A roller under a resting ball
/// spins at (0, 0, -2) and moves at 0.1 x. With an arm of 0.49 its top moves at 0.1 + 2 * 0.49 = 1.08 x. m* = 3,
/// o = 0.02: F = 3 sqrt 1.08 x on the ball, torque = 0.49 (-y) x F = 0.49 * 3 sqrt 1.08 z. The result does not depend on
/// which of the two is A.
fn a_fixed_sphere_acts_as_a_conveyor(backend: Backend) {
    let roller = Sphere::new([0.0; 3], 0.5).velocity([0.1, 0.0, 0.0]).fixed();
    let roller = roller.angular_momentum([0.0, 0.0, -2.0 * roller.inertia()]);
    let ball = Sphere::new([0.0, 0.98, 0.0], 0.5).mass(3.0);
    let f = 3.0 * 1.08_f64.sqrt();
    for ball_first in [true, false] {
        let mut scene = friction_only();
        spheres(&mut scene, if ball_first { [ball, roller] } else { [roller, ball] });
        let mut found = loads(scene, backend);
        if !ball_first {
            found.reverse();
        }
        forces(&found, [[f, 0.0, 0.0], [0.0; 3]], FORCE);
        torques(&found, [[0.0, 0.0, 0.49 * f], [0.0; 3]], FORCE);
    }
}

/// A ball over a rod at a = 0.25 (masses 1, 3, 1/M = 7/12; ball 1/2; m* = 12/13), o = 0.02, n = -y, arms 0.5 - 0.01 and
/// 0.1 - 0.01. The ends of the rod spin at 4 and 0 about x, so w(a) = 3 x. The ball slides at 0.3 z. uA = 0.3 z,
/// uB = -(3 x) x (0.09 (-y)) = 0.27 z: t = -0.03 z, F on the ball = 50 * 12/13 * 0.02 t/sqrt|t| = -12/13 sqrt 0.03 z.
/// With f = 12/13 sqrt 0.03, the torque on the ball is 0.49 (-y) x F = 0.49 f x, and that on the rod 0.09 f x, shared as
/// 3/4 and 1/4 like the force.
fn friction_on_a_rod_is_shared_by_its_ends(backend: Backend) {
    let mut scene = friction_only();
    let one = Sphere::new([0.0; 3], 0.2);
    let ends = [one.angular_momentum([4.0 * one.inertia(), 0.0, 0.0]), Sphere::new([4.0, 0.0, 0.0], 0.2).mass(3.0)];
    rod(&mut scene, ends, 0.1);
    spheres(&mut scene, [Sphere::new([1.0, 0.58, 0.0], 0.5).mass(2.0).velocity([0.0, 0.0, 0.3])]);
    let found = loads(scene, backend);
    let f = 12.0 / 13.0 * 0.03_f64.sqrt();
    forces(&found, [[0.0, 0.0, 0.75 * f], [0.0, 0.0, 0.25 * f], [0.0, 0.0, -f]], FORCE);
    torques(&found, [[0.09 * 0.75 * f, 0.0, 0.0], [0.09 * 0.25 * f, 0.0, 0.0], [0.49 * f, 0.0, 0.0]], FORCE);
}

/// Friction between two rods. Unit masses, crossing at a = 0.25 and b = 0.5: 1/M = 10/16 and 1/2, m* = 8/9, o = 0.02,
/// n = y, arms 0.09. A moves at 0.64 x: t = -0.64 x, F = 50 * 8/9 * 0.02 * (-0.8) x on A. The torques are 0.09
/// y x F = 0.09 f z, shared like the force.
fn friction_between_two_rods_is_shared_by_their_ends(backend: Backend) {
    let mut scene = friction_only();
    let a = [-1.0, 3.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.05).velocity([0.64, 0.0, 0.0]));
    let b = [-1.0, 1.0].map(|z| Sphere::new([0.0, 0.18, z], 0.05));
    rod(&mut scene, a, 0.1);
    rod(&mut scene, b, 0.1);
    let found = loads(scene, backend);
    let f = 8.0 / 9.0 * 0.8;
    let (quarter, half) = (0.25 * f, 0.5 * f);
    forces(&found, [[-3.0 * quarter, 0.0, 0.0], [-quarter, 0.0, 0.0], [half, 0.0, 0.0], [half, 0.0, 0.0]], FORCE);
    let torque = [3.0 * quarter, quarter, half, half].map(|f| [0.0, 0.0, 0.09 * f]);
    torques(&found, torque, FORCE);
}

/// A rod along x lies with a = 0.5 on the edge of a box. The edge runs along z below the rod. o = 0.02, n = -y, arm
/// 0.1 - 0.02, m* = 2 of unit masses. Both ends move at 0.36 z: F = 50 * 2 * 0.02 * (-0.6) z, torque = 0.08
/// (-y) x F = 0.08 * 1.2 x, half of it on each end.
fn friction_on_a_box_edge_is_shared_by_the_ends_of_the_rod(backend: Backend) {
    let mut scene = friction_only();
    // A box that stands on its edge. Its upper edge runs along z through the origin.
    let (i, j) = ([1.0, -1.0, 0.0], [-1.0, -1.0, 0.0]);
    scene.add_box(rockfall::Cuboid::new([0.0, 0.0, -2.0], i, j, [0.0, 0.0, 4.0])).expect("a valid box");
    // The end spheres are so large that they turn slowly. It would take 16 times this force to remove half of the slip
    // in one step.
    let ends = [-1.0, 1.0].map(|x| Sphere::new([x, 0.08, 0.0], 0.2).velocity([0.0, 0.0, 0.36]));
    rod(&mut scene, ends, 0.1);
    let found = loads(scene, backend);
    forces(&found, [[0.0, 0.0, -0.6]; 2], FORCE);
    torques(&found, [[0.048, 0.0, 0.0]; 2], FORCE);
}

/// Coulomb's law, mu_c = 0.25, as one impulse per step. o = 0.02, m* = 2, Cc o = 20. Closing at 0.4 (Cd u = 5) N = 2
/// (20 + 5) = 50; opening at 0.4 N = 2 (20 - 5) = 30. The ball does not spin and slides at 0.64 x, so its impulse is mu_c
/// N dt: 12.5 dt or 7.5 dt. At a lower speed the impulse stops the slip: the inverse mass is 1/2 + 0.48^2 / 0.2 = 1.652,
/// so at 0.09 x it is 0.09 / 1.652. Where damping exceeds the contact force (opening at 2: N = 0), there is no friction
/// impulse. There is none either with damping that pulls (N = 2 (20 - 25) < 0): friction never accelerates the slip.
fn friction_impulses_are_limited_by_coulombs_law(backend: Backend) {
    let arm = 0.48;
    let slides = [
        (0.64, -0.4, false, 12.5),
        (0.64, 0.4, false, 7.5),
        (0.09, -0.4, false, 0.09 / 1.652 / DT),
        (0.64, 2.0, false, 0.0),
        (0.64, 2.0, true, 0.0),
    ];
    for (along, up, contact_pull, size) in slides {
        let mut scene = with(|settings| {
            settings.gravity = 0.0;
            settings.friction = 500.0;
            settings.coulomb_friction = 0.25;
            settings.contact_pull = contact_pull;
        });
        floor_box(&mut scene);
        spheres(&mut scene, [Sphere::new([0.0, arm, 0.0], 0.5).mass(2.0).velocity([along, up, 0.0])]);
        let found = loads(scene, backend);
        // Half a unit in the last place of a velocity up to 2, divided by dt, for a mass of 2.
        close(found[0].force.x, -f64::from(size), 2e-4, "friction");
        close(found[0].torque.z, -f64::from(arm * size), 2e-4, "torque");
    }
}

/// A ball that slides at v0 with Coulomb's law alone rolls after 2 v0 / (7 mu_c g), at 5/7 v0, after a distance of 12
/// v0^2 / (49 mu_c g). The impulses are applied at the beginning of steps, so after t the ball is behind by mu_c g t
/// dt / 2. It rests at o = G/Cc = 0.001; the resulting arm of 0.999 changes all values by about 3e-4.
fn a_ball_sliding_under_coulombs_law_rolls_after_the_expected_distance(backend: Backend) {
    let mut scene = with(|settings| settings.coulomb_friction = 0.25);
    floor_box(&mut scene);
    spheres(&mut scene, [Sphere::new([-2.0, 0.999, 0.0], 1.0).velocity([1.0, 0.0, 0.0])]);
    let mut simulation = simulation(scene, backend);
    // Rolling begins after 8/7 s or 73.1 steps.
    simulation.run(64, DT).expect("steps");
    let sliding = simulation.spheres().expect("spheres are read back")[0];
    close(sliding.velocity.x, 0.75, 1e-4, "velocity after 1 s");
    close(sliding.position.x, -2.0 + 0.875 - 0.125 / 64.0, 1e-4, "position after 1 s");
    simulation.run(32, DT).expect("steps");
    let rolling = simulation.spheres().expect("spheres are read back")[0];
    let distance = 48.0 / 49.0 + 5.0 / 7.0 * (1.5 - 8.0 / 7.0);
    close(rolling.velocity.x, 5.0 / 7.0, 1e-3, "velocity when rolling");
    close(rolling.position.x, -2.0 + distance - 0.125 / 64.0 * 8.0 / 7.0, 1e-3, "position after 1.5 s");
}

/// An isolated pair with friction and contact forces keeps its momentum and angular momentum: sum F = 0 and sum
/// (x cross F + T) = 0. The bodies have oblique positions and velocities in all directions; friction and contact forces
/// are of the order of 10.
fn isolated_pairs_keep_their_momenta(backend: Backend) {
    let ball = Sphere::new([1.1, 0.5, 0.3], 0.5).mass(2.0).velocity([0.2, -0.3, 0.4]).angular_momentum([0.3, 0.1, -0.2]);
    let ends = [
        Sphere::new([0.1, 0.0, -0.2], 0.1).velocity([0.1, 0.2, -0.3]).angular_momentum([0.002, 0.001, 0.0]),
        Sphere::new([4.0, 0.3, 0.2], 0.1).mass(3.0).velocity([-0.1, 0.1, 0.1]),
    ];
    let across = [
        Sphere::new([1.5, 0.25, -1.7], 0.1).velocity([0.3, -0.2, 0.1]),
        Sphere::new([1.2, 0.35, 2.1], 0.1).mass(0.5).angular_momentum([0.0, 0.001, 0.003]),
    ];
    let other = Sphere::new([1.5, 1.2, 0.6], 0.4).mass(0.7).angular_momentum([0.0, 0.2, 0.1]);
    type Ends = [Sphere; 2];
    let pairs: [fn(&mut Scene, Ends, Ends, Ends); 3] = [
        |scene, _, _, balls| {
            spheres(scene, balls);
        },
        |scene, ends, _, [ball, _]| {
            rod(scene, ends, 0.25);
            spheres(scene, [ball]);
        },
        |scene, ends, across, _| {
            rod(scene, ends, 0.15);
            rod(scene, across, 0.15);
        },
    ];
    for build in pairs {
        let mut scene = weightless();
        build(&mut scene, ends, across, [ball, other]);
        let places: Vec<DVec3> = scene.spheres().iter().map(|sphere| sphere.position.as_dvec3()).collect();
        let found = loads(scene, backend);
        assert!(
            found[0].force.length() > 1.0 && found[0].torque.length() > 0.01,
            "the pair must have contact and friction forces"
        );
        let force: DVec3 = found.iter().map(|load| load.force).sum();
        near(force, [0.0; 3], 1e-4, "sum of forces");
        let moments = found.iter().zip(places).map(|(load, place)| place.cross(load.force) + load.torque);
        near(moments.sum::<DVec3>(), [0.0; 3], 1e-4, "sum of moments");
    }
}

/// Runs until all sliding has ended, and returns the mean velocity of the moving spheres along x. It is a mean because
/// the law t / sqrt|t| leaves a jitter near rest.
fn mean_speed_after(mut simulation: Simulation, steps: u64) -> f64 {
    simulation.run(steps, DT).expect("steps");
    let spheres = simulation.spheres().expect("spheres are read back");
    let moving: Vec<f64> = spheres.iter().filter(|sphere| !sphere.fixed).map(|sphere| sphere.velocity.x.into()).collect();
    moving.iter().sum::<f64>() / moving.len() as f64
}

/// A ball of radius 1 that slides at 1 finally rolls at 5/7. Its angular momentum about the line of contact, m v s + L,
/// is constant for any law of friction, and finally v = w s. The arm is s = r - G/Cc = 0.999: v = k/(1 + k), k = 5/2
/// s^2, 3e-4 below 5/7. With mu = 500 the sliding ends when 7/2 * 0.25 t = 1 (d sqrt|t| / dt = -7/2 * mu/(2 Cc) G):
/// after 1.14 s or 73 steps.
fn a_sliding_ball_finally_rolls(backend: Backend) {
    for floor in [floor_box, floor_polygon] {
        let mut scene = with(|settings| settings.friction = 500.0);
        floor(&mut scene);
        spheres(&mut scene, [Sphere::new([-2.0, 0.999, 0.0], 1.0).mass(2.0).velocity([1.0, 0.0, 0.0])]);
        let speed = mean_speed_after(simulation(scene, backend), 85);
        close(speed, 5.0 / 7.0, 1e-3, "velocity when rolling");
    }
}

/// The same for a capsule that slides perpendicular to its axis. Friction acts on both ends, and the spin about the
/// axis is that of the two spheres.
fn a_sliding_capsule_finally_rolls(backend: Backend) {
    let mut scene = with(|settings| settings.friction = 500.0);
    floor_box(&mut scene);
    let capsule = Capsule::new([-2.0, 0.999, -1.0], [-2.0, 0.999, 1.0], 1.0).velocity([1.0, 0.0, 0.0]);
    scene.add_capsule(capsule).expect("a valid capsule");
    close(mean_speed_after(simulation(scene, backend), 85), 5.0 / 7.0, 1e-3, "velocity when rolling");
}

/// A thick rod (radius 1) along z on two rails along x rolls on its own surface. Its inertia is that of its end spheres
/// (radius 0.5, mass 1 each), so k = R^2 / (2/5 r^2) = 10 and v = 10/11. The rails are rods between fixed spheres. They
/// touch the rod at a = 1/4 and 3/4, where 1/M = 10/16: the resting overlap is G / (Cc 1.6) = 6.25e-4, which reduces R
/// by half of that.
fn a_sliding_rod_finally_rolls(backend: Backend) {
    let mut scene = with(|settings| settings.friction = 500.0);
    for z in [-1.0, 1.0] {
        rod(&mut scene, [-3.0, 3.0].map(|x| Sphere::new([x, 0.0, z], 0.05).fixed()), 0.25);
    }
    let ends = [-2.0, 2.0].map(|z| Sphere::new([-2.0, 1.249_375, z], 0.5).velocity([1.0, 0.0, 0.0]));
    rod(&mut scene, ends, 1.0);
    close(mean_speed_after(simulation(scene, backend), 64), 10.0 / 11.0, 1e-3, "velocity when rolling");
}

both!(
    friction_between_two_spheres_includes_their_spins,
    friction_on_boxes_and_polygons_includes_the_spin,
    a_fixed_sphere_acts_as_a_conveyor,
    friction_on_a_rod_is_shared_by_its_ends,
    friction_between_two_rods_is_shared_by_their_ends,
    friction_on_a_box_edge_is_shared_by_the_ends_of_the_rod,
    friction_impulses_are_limited_by_coulombs_law,
    a_ball_sliding_under_coulombs_law_rolls_after_the_expected_distance,
    isolated_pairs_keep_their_momenta,
    a_sliding_ball_finally_rolls,
    a_sliding_capsule_finally_rolls,
    a_sliding_rod_finally_rolls,
);
