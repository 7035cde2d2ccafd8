//! Free flight.

use glam::Vec3;

use super::scene::{Scene, close};

/// Problem 1.
#[test]
fn free_fall_is_exact() {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let ball = scene.ball(0.5, Vec3::new(0.0, 10.0, 0.0));
    scene.run(1.0);
    close(scene.at(ball).y, 10.0 - 4.905, 1e-4);
}
