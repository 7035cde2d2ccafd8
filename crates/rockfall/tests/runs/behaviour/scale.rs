//! The unit of length is free: where all lengths are multiplied by a power of two, and all other numbers by the powers of it that
//! their units have, every step is the same up to that power.

use rockfall::glam::Vec3;
use rockfall::{Backend, Capsule, Cuboid, Polygon, Rod, Scene, Sphere};

use crate::common::*;

/// Runs two scenes, whose lengths and masses differ by the powers `length` and `mass` of two, and compares their spheres.
fn assert_similar(make: impl Fn(f32, f32) -> Scene, [length, mass]: [i32; 2], steps: u64, backend: Backend) {
    let (length, mass) = (2_f32.powi(length), 2_f32.powi(mass));
    let [mut small, mut large] = [make(1.0, 1.0), make(length, mass)].map(|scene| simulation(scene, backend));
    small.run(steps, DT).expect("steps without an error");
    large.run(steps, DT).expect("steps without an error");
    assert_eq!(small.report().total_collisions, large.report().total_collisions);
    let states = [&mut small, &mut large].map(|simulation| simulation.spheres().expect("spheres"));
    for (small, large) in states[0].iter().zip(&states[1]) {
        near(large.position / length, small.position.as_dvec3(), 1e-5, "position");
        near(large.velocity / length, small.velocity.as_dvec3(), 1e-5, "velocity");
        near(large.angular_momentum / length / length / mass, small.angular_momentum.as_dvec3(), 1e-5, "angular momentum");
    }
}

/// A capsule slides along its axis on a box. Friction turns it about an axis across.
fn long_capsules_have_friction(backend: Backend) {
    let make = |length: f32, mass: f32| {
        let mut scene = with(|settings| {
            (settings.gravity, settings.friction) = (10.0 * length, 0.0);
            (settings.coulomb_friction, settings.collision_friction) = (0.5, 0.5);
        });
        scene.add_box(Cuboid::between(length * Vec3::new(-64.0, -1.0, -64.0), length * Vec3::new(64.0, 0.0, 64.0))).unwrap();
        let ends = [Vec3::new(0.0, 0.49, 0.0), Vec3::new(1.0, 0.49, 0.25)].map(|end| length * end);
        let capsule = Capsule::new(ends[0], ends[1], 0.5 * length).mass(mass);
        scene.add_capsule(capsule.velocity(length * Vec3::new(3.0, 0.0, 1.0))).unwrap();
        scene
    };
    // GPUs may take numbers below 2^-126 for 0, such as those of the largest capsule.
    let lengths = on(backend, [13, 17, 22].as_slice(), [13, 17].as_slice());
    for &length in lengths {
        assert_similar(make, [length, 3 * length], on(backend, 20, 8), backend);
    }
}

/// Two capsules cross at right angles, and meet with their axes.
fn long_capsules_collide(backend: Backend) {
    let make = |length: f32, mass: f32| {
        let mut scene = weightless();
        let ends = |one: Vec3, y: f32| [one, -one].map(|end| length * (end + Vec3::new(0.125, y, 0.0)));
        for (one, y, velocity) in [(Vec3::X, 0.0, 2.0), (Vec3::Z, 0.45, -2.0)] {
            let [one, two] = ends(one, y);
            scene
                .add_capsule(Capsule::new(one, two, 0.25 * length).mass(mass).velocity([0.0, velocity * length, 0.0]))
                .unwrap();
        }
        scene
    };
    assert_similar(make, [34, 0], 2, backend);
}

/// Balls on a skew polygon with long edges, whose corner is far away.
fn polygons_may_be_long(backend: Backend) {
    let landed = |edge: f32| {
        let mut scene = weightless();
        let (left, right) = (Vec3::new(0.0, 0.0, edge), Vec3::new(edge, 0.0, 0.5 * edge));
        scene.add_polygon(Polygon::new(-0.5 * (left + right), left, right)).unwrap();
        for (x, speed) in [(0.0, 1.0), (4.0, 8.0), (edge, 8.0)] {
            scene.add_sphere(Sphere::new([x, 0.45, 0.0], 0.5).velocity([0.0, -speed, 0.0])).unwrap();
        }
        let mut simulation = simulation(scene, backend);
        simulation.run(4, DT).expect("steps without an error");
        simulation.spheres().expect("spheres").into_iter().map(|state| state.velocity.y).collect::<Vec<_>>()
    };
    let expected = landed(1024.0);
    assert!(expected[0] > -1.0 && expected[1] > 0.0 && expected[2] == -8.0, "{expected:?}");
    for edge in [4e7, 1e14] {
        for (velocity, expected) in landed(edge).iter().zip(&expected) {
            assert!((velocity - expected).abs() < 2e-6, "{edge}: {velocity}, expected {expected}");
        }
    }
}

/// A rod rests on a box edge that is much longer.
fn rods_meet_long_edges(backend: Backend) {
    let pushed = |edge: f32| {
        let mut scene = weightless();
        scene.add_box(Cuboid::new([0.0, -1.0, -0.5 * edge], Vec3::X, Vec3::Y, Vec3::new(0.0, 0.0, edge))).unwrap();
        let ends = [[-1.0, 0.5, 0.0], [0.5, -0.25, 0.0]].map(|end| Sphere::new(end, 0.01));
        let ids = spheres(&mut scene, ends);
        scene.add_rod(Rod::new(ids[0], ids[1], 0.125)).unwrap();
        loads(scene, backend).iter().map(|load| load.force.y).collect::<Vec<_>>()
    };
    let expected = pushed(16.0);
    assert!(expected.iter().all(|force| *force > 0.1), "{expected:?}");
    for (force, expected) in pushed(1e12).into_iter().zip(&expected) {
        close(force, *expected, 1e-3 * expected, "force on an end");
    }
}

both!(long_capsules_have_friction, long_capsules_collide, polygons_may_be_long, rods_meet_long_edges);
