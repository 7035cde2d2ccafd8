//! Bodies that come to rest.

use glam::Vec3;

use super::scene::{G, Scene, close};

#[test]
fn ball_rests_on_the_floor() {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let ball = scene.ball(0.5, Vec3::new(0.0, 0.52, 0.0));
    scene.run(2.0);
    close(scene.velocity(ball).length(), 0.0, 1e-4);
    println!("{}", scene.at(ball).y);
    // Overlap at rest is g / w² of the soft row.
    let w = std::f32::consts::TAU * 0.36 * 240.0;
    close(scene.at(ball).y, 0.5 - G / (w * w), 1e-6);
}
