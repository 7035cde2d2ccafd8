//! Bodies that pass, and bodies that must not.

use glam::{Quat, Vec3};

use super::scene::{Scene, close};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;

/// Problem 35: a ball at 20 m/s, 1 mm beside a ball, a face, an edge, a corner and a capsule.
#[test]
fn what_passes_is_not_deflected() {
    let r = 0.05;
    let miss = r + 1e-3;
    let slant = std::f32::consts::FRAC_1_SQRT_2;
    for e in [0.0, 1.0] {
        for step in 0..20 {
            for what in 0..5 {
                let mut scene = Scene::new(0.5, e).weightless();
                let x = -1.0 - 0.017 * step as f32;
                // The path is along x, at the height `miss` above the highest place of an obstacle below it.
                let (turn, depth) = match what {
                    0 | 4 => (Quat::IDENTITY, 0.3),
                    1 => (Quat::IDENTITY, 0.3),
                    2 => (Quat::from_rotation_z(std::f32::consts::FRAC_PI_4), 0.3 / slant),
                    _ => (Quat::from_rotation_arc(Vec3::ONE.normalize(), Vec3::Y), 0.3 * 3.0_f32.sqrt()),
                };
                let shape = match what {
                    0 => Shape::ball(0.3),
                    4 => Shape::capsule(0.2, 0.1),
                    _ => Shape::cuboid(Vec3::splat(0.3)),
                };
                let body = scene.body(shape, Pose::new(Vec3::new(0.0, -depth, 0.0), turn), 1.0);
                let ball = scene.ball(r, Vec3::new(x, miss, 0.0));
                scene.throw(ball, Vec3::new(20.0, 0.0, 0.0), Vec3::ZERO);
                scene.run(0.2);
                let change = (scene.velocity(ball) - Vec3::new(20.0, 0.0, 0.0)).length() + scene.velocity(body).length();
                assert!(change < 1e-4, "e {e}, start {x}, obstacle {what}: {change}");
            }
        }
    }
}

/// Problem 36.
#[test]
fn bullets_stay_on_their_side() {
    for e in [0.0, 0.5] {
        for ball in [true, false] {
            for step in 0..10 {
                let mut scene = Scene::new(0.5, e).weightless();
                scene.block(Vec3::new(0.01, 1.0, 1.0), Pose::IDENTITY);
                let shape = if ball { Shape::ball(0.05) } else { Shape::cuboid(Vec3::splat(0.05)) };
                let at = Vec3::new(-5.0 - 0.1 * step as f32, 0.03, 0.01);
                let turn = Quat::from_scaled_axis(Vec3::new(0.1, 0.2, 0.3));
                let bullet = scene.body(shape, Pose::new(at, turn), 1.0);
                scene.throw(bullet, Vec3::new(200.0, 0.0, 0.0), Vec3::ZERO);
                scene.run(0.2);
                assert!(scene.at(bullet).x < 0.0, "e {e}, ball {ball}, {at}: {}", scene.at(bullet));
            }
        }
    }
}

/// Problem 42: a ball at rest is hit, comes back from a wall and gives its speed back.
#[test]
fn ball_at_rest_is_hit_to_a_high_speed() {
    let mut scene = Scene::new(0.0, 1.0).weightless();
    scene.block(Vec3::new(0.01, 1.0, 1.0), Pose::IDENTITY);
    let target = scene.ball(0.05, Vec3::new(-0.21, 0.0, 0.0));
    let first = scene.ball(0.05, Vec3::new(-1.0, 0.0, 0.0));
    scene.throw(first, Vec3::new(20.0, 0.0, 0.0), Vec3::ZERO);
    scene.run(0.2);
    close(scene.velocity(first).x, -20.0, 1e-2);
    close(scene.velocity(target).x, 0.0, 1e-2);
    assert!(scene.repeats >= 1);
}
