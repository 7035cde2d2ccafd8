//! Bodies that come to rest.

use glam::{Quat, Vec3};

use super::scene::{G, Scene, close};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;

#[test]
fn ball_rests_at_the_overlap_of_a_soft_row() {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let ball = scene.ball(0.5, Vec3::new(0.0, 0.52, 0.0));
    scene.run(2.0);
    close(scene.velocity(ball).length(), 0.0, 1e-4);
    let w = std::f32::consts::TAU * 0.36 * 240.0;
    close(scene.at(ball).y, 0.5 - G / (w * w), 1e-6);
}

/// Problem 10.
#[test]
fn overlap_is_pushed_out_without_speed() {
    for ball in [true, false] {
        let mut scene = Scene::new(0.5, 0.0).weightless();
        let shape = if ball { Shape::ball(0.5) } else { Shape::cuboid(Vec3::splat(0.5)) };
        let [a, b] = [0.0, 0.9].map(|x| scene.body(shape.clone(), Pose::new(Vec3::new(x, 0.0, 0.0), Quat::IDENTITY), 1.0));
        scene.run(3.0);
        close((scene.velocity(b) - scene.velocity(a)).length(), 0.0, 1e-3);
        assert!(scene.at(b).x - scene.at(a).x > 0.999);
    }
}

/// Problem 48: all three planes in one block of 12 points.
#[test]
fn box_rests_in_a_corner() {
    let mut scene = Scene::new(0.5, 0.0);
    Vec3::AXES.into_iter().for_each(|axis| scene.plane(Vec3::ZERO, axis));
    scene.world.gravity = -G * Vec3::ONE.normalize();
    let body = scene.cuboid(Vec3::splat(0.5), Vec3::splat(0.5));
    scene.run(2.0);
    assert_eq!(scene.last.contacts, 12);
    assert!((scene.at(body) - Vec3::splat(0.5)).abs().max_element() < 1e-4, "{}", scene.at(body));
    close(scene.velocity(body).length(), 0.0, 1e-6);

    // With more friction it may stay on an edge.
    let mut scene = Scene::new(0.1, 0.5);
    Vec3::AXES.into_iter().for_each(|axis| scene.plane(Vec3::ZERO, axis));
    scene.world.gravity = -G * Vec3::ONE.normalize();
    let body = scene.cuboid(Vec3::splat(0.5), Vec3::splat(1.5));
    scene.throw(body, Vec3::splat(-2.0), Vec3::new(1.0, 2.0, 3.0));
    scene.run(10.0);
    close(scene.velocity(body).length(), 0.0, 1e-5);
    assert!((scene.at(body) - Vec3::splat(0.5)).abs().max_element() < 1e-3, "{}", scene.at(body));
}

/// Half the edges of a plate.
const PLATE: Vec3 = Vec3::new(0.2112, 0.00453, 0.1336);

/// A plate that lies across the seam of two triangles, with its lowest corner beside the seam, and turns towards the other
/// side. The number of the plate is 1.
pub(super) fn plate_on_a_seam() -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    for side in [-1.0, 1.0] {
        scene.triangle([Vec3::NEG_Z, Vec3::new(0.0, 0.0, 2.0), Vec3::new(2.0 * side, 0.0, 0.0)]);
    }
    let turn = Quat::from_xyzw(-0.933142, -0.013642, 0.358828, -0.017398).normalize();
    let pose = Pose::new(Vec3::new(0.100526, 0.011323, 0.273943), turn);
    let plate = scene.body(Shape::cuboid(PLATE), pose, 0.001);
    scene.throw(plate, Vec3::new(0.018, 0.344, -0.042), Vec3::new(-4.1356, 0.0505, -1.4211));
    scene
}

/// Height of the lowest corner of the plate.
pub(super) fn lowest_corner(scene: &Scene) -> f32 {
    let pose = scene.world.bodies[1].pose;
    let corner = |k: u32| PLATE * Vec3::from_array([0, 1, 2].map(|i| if k >> i & 1 == 0 { -1.0 } else { 1.0 }));
    (0..8).map(|k| pose.point(corner(k)).y).fold(f32::INFINITY, f32::min)
}

#[test]
fn plates_touch_on_both_sides_of_a_seam() {
    let mut scene = plate_on_a_seam();
    scene.step();
    assert!(lowest_corner(&scene) > -0.003, "{}", lowest_corner(&scene));
}
