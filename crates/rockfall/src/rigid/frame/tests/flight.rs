//! Free flight.

use glam::{Quat, Vec3};

use super::scene::{DT, Scene, close};
use crate::rigid::frame::{auto_substeps, energy, momenta};
use crate::rigid::pose::Pose;
use crate::rigid::world::Body;

/// Problem 1.
#[test]
fn free_fall_is_exact() {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let ball = scene.ball(0.5, Vec3::new(0.0, 10.0, 0.0));
    scene.run(1.0);
    close(scene.at(ball).y, 10.0 - 4.905, 1e-4);
}

/// Problem 29: moments 1, 2, 3, spin (0.01, 1, 0).
#[test]
fn asymmetric_top_flips_on_time() {
    let mut scene = Scene::new(0.5, 0.0).weightless();
    let mut body = Body::loose(Pose::IDENTITY, 1.0, Vec3::new(1.0, 2.0, 3.0), Quat::IDENTITY);
    body.radius = 1.0;
    body.set_spin(Vec3::new(0.01, 1.0, 0.0));
    scene.world.bodies.push(body);
    let (e, l) = (energy(&scene.world), momenta(&scene.world).1);
    let (mut flip, mut before) = (0.0, 1.0);
    for frame in 0..7200 {
        scene.step();
        let body = &scene.world.bodies[1];
        let along = (body.pose.turn * Vec3::Y).dot(body.momentum);
        if flip == 0.0 && along <= 0.0 {
            flip = DT * (frame as f32 + before / (before - along));
        }
        before = along;
        assert!((energy(&scene.world) / e - 1.0).abs() < 5e-5);
    }
    close(flip, 10.377, 0.005);
    assert!((momenta(&scene.world).1 - l).length() < 1e-6);
}

#[test]
fn small_bodies_need_more_substeps() {
    for (width, wanted) in [(1.0, 4), (0.3, 8), (0.1, 13), (0.01, 32)] {
        let mut scene = Scene::new(0.5, 0.0);
        scene.cuboid(Vec3::splat(0.5 * width), Vec3::ZERO);
        assert_eq!(auto_substeps(&scene.world, DT), wanted);
    }
}
