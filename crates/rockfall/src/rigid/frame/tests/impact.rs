//! Impacts of balls and boxes.

use glam::{Quat, Vec3};

use super::scene::{DT, G, Scene, close};
use crate::rigid::frame::energy;
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;

/// Heights of a body at the tops of its bounces.
fn apexes(scene: &mut Scene, body: usize, seconds: f32) -> Vec<f32> {
    let (mut tops, mut before) = (Vec::new(), -1.0);
    for _ in 0..(seconds / DT) as u32 {
        scene.step();
        let v = scene.velocity(body).y;
        if before > 0.0 && v <= 0.0 {
            // The top of the parabola through the present state.
            tops.push(scene.at(body).y + v * v / (2.0 * 9.81));
        }
        before = v;
    }
    tops
}

/// Problem 2.
#[test]
fn ball_bounces_to_a_quarter() {
    let mut scene = Scene::new(0.5, 0.5);
    scene.floor();
    let ball = scene.ball(0.1, Vec3::new(0.0, 1.1, 0.0));
    close(apexes(&mut scene, ball, 0.9)[0], 0.35, 5e-4);
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let ball = scene.ball(0.1, Vec3::new(0.0, 1.1, 0.0));
    scene.run(1.0);
    close(scene.velocity(ball).length(), 0.0, 1e-5);
}

/// Problem 3.
#[test]
fn elastic_ball_bounces_on() {
    let mut scene = Scene::new(0.5, 1.0);
    scene.floor();
    let ball = scene.ball(0.1, Vec3::new(0.0, 1.1, 0.0));
    let tops = apexes(&mut scene, ball, 30.0);
    assert_eq!(tops.len(), 33);
    for top in tops {
        close(top, 1.1, 1e-3);
    }
}

/// Problem 3: from top to top it takes 2 sqrt(2 / g).
#[test]
fn elastic_ball_keeps_its_period() {
    let mut scene = Scene::new(0.5, 1.0);
    scene.floor();
    let ball = scene.ball(0.1, Vec3::new(0.0, 1.1, 0.0));
    let (mut tops, mut before) = (Vec::new(), -1.0);
    for frame in 1..=1800 {
        scene.step();
        let v = scene.velocity(ball).y;
        if before > 0.0 && v <= 0.0 {
            // The time at which the present parabola has its top.
            tops.push(f64::from(frame) / 60.0 + f64::from(v) / 9.81);
        }
        before = v;
    }
    let period = (tops[tops.len() - 1] - tops[0]) / (tops.len() - 1) as f64;
    close(period as f32, 2.0 * (2.0_f32 / 9.81).sqrt(), 1e-3 * 0.9031);
}

/// Problem 46. Below a ceiling, a body turns back by the field just before it touches, or would be hit only by a field that pulls
/// upwards. Its energy stays.
#[test]
fn bodies_turn_back_below_a_ceiling() {
    let h = DT / 4.0;
    let mut most = 0.0_f64;
    for ball in [true, false] {
        // The speed over g h, and the gap over g h².
        for (speed, gap) in [(1.1, 1.1), (1.1, 1.4), (0.9, 1.0), (3.0, 3.2), (1.5, 1.2), (10.0, 10.1), (10.0, 60.0)] {
            let mut scene = Scene::new(0.5, 0.5);
            scene.plane(Vec3::ZERO, -Vec3::Y);
            let shape = if ball { Shape::ball(0.5) } else { Shape::cuboid(Vec3::splat(0.5)) };
            let at = Vec3::new(0.0, -0.5 - gap * G * h * h, 0.0);
            let body = scene.body(shape, Pose::new(at, Quat::IDENTITY), 1.0);
            scene.throw(body, Vec3::new(0.0, speed * G * h, 0.0), Vec3::ZERO);
            let mut before = energy(&scene.world);
            for _ in 0..20 {
                scene.step();
                let now = energy(&scene.world);
                assert!(now.is_finite());
                most = most.max(now - before);
                before = now;
            }
        }
    }
    assert!(most < 1e-6, "{most}");
}

/// Problem 40.
#[test]
fn oblique_bounce_has_the_friction_of_the_closed_form() {
    for (e, mu) in [(0.8, 0.5), (0.8, 0.1), (0.5, 0.5), (0.0, 0.5)] {
        for step in 0..20 {
            let mut scene = Scene::new(mu, e).weightless();
            scene.floor();
            let ball = scene.ball(0.05, Vec3::new(0.0, 0.3 + 0.004 * step as f32, 0.0));
            scene.throw(ball, Vec3::new(5.0, -10.0, 0.0), Vec3::ZERO);
            scene.run(0.1);
            let j = (mu * (1.0 + e) * 10.0).min(2.0 / 7.0 * 5.0);
            close(scene.velocity(ball).x, 5.0 - j, 1e-3);
            close(scene.velocity(ball).y, 10.0 * e, 1e-3);
            close(-scene.spin(ball).z * 0.05, 2.5 * j, 1e-3);
        }
    }
}

/// A body that is at the surface at the end of a substep, up to rounding, has its impact all the same: 1/24 = 10/240, and so are others.
#[test]
fn impacts_at_the_ends_of_substeps_are_not_lost() {
    for (ball, block) in [(true, true), (true, false), (false, true), (false, false)] {
        for speed in [1.0, 2.0, 5.0, 10.0, 20.0] {
            for substeps in 1..=24 {
                for nudge in [-1, 0, 1] {
                    let mut scene = Scene::new(0.5, 0.8).weightless();
                    if block {
                        scene.block(Vec3::new(5.0, 0.5, 5.0), Pose::new(Vec3::new(0.0, -0.5, 0.0), Quat::IDENTITY));
                    } else {
                        scene.floor();
                    }
                    let shape = if ball { Shape::ball(0.05) } else { Shape::cuboid(Vec3::splat(0.05)) };
                    let height = 0.05 + speed * substeps as f32 / 240.0;
                    let height = f32::from_bits(height.to_bits().wrapping_add_signed(nudge));
                    let body = scene.body(shape, Pose::new(Vec3::new(0.0, height, 0.0), Quat::IDENTITY), 1.0);
                    scene.throw(body, Vec3::new(0.0, -speed, 0.0), Vec3::ZERO);
                    scene.run(0.2);
                    let v = scene.velocity(body).y;
                    assert!((v - 0.8 * speed).abs() < 1e-3, "ball {ball}, block {block}, {speed}, {substeps}: {v}");
                }
            }
        }
    }
}

/// Problem 7: balls that touch.
#[test]
fn cradles_pass_the_impulse_on() {
    for count in [5, 20] {
        let mut scene = Scene::new(0.0, 1.0).weightless();
        let balls: Vec<usize> = (0..count).map(|k| scene.ball(0.5, Vec3::new(k as f32, 0.0, 0.0))).collect();
        let first = balls[0];
        scene.world.bodies[first].pose.position.x = -0.5;
        scene.throw(first, Vec3::X, Vec3::ZERO);
        scene.run(2.0);
        let v: Vec<f32> = balls.iter().map(|ball| scene.velocity(*ball).x).collect();
        let within = if count == 5 { 1e-3 } else { 1e-2 };
        close(v[count - 1], 1.0, within);
        let energy: f32 = v.iter().map(|v| v * v).sum();
        close(energy, 1.0, 2e-3);
        if count == 5 {
            v[..4].iter().for_each(|v| close(*v, 0.0, 1e-3));
        }
    }
}

/// Problem 9.
#[test]
fn elastic_ball_leaves_a_moving_wall_with_twice_its_speed() {
    let mut scene = Scene::new(0.5, 1.0).weightless();
    scene.kinematic(Shape::ball(0.5), Vec3::new(-2.0, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0));
    let ball = scene.ball(0.5, Vec3::ZERO);
    scene.run(1.0);
    close(scene.velocity(ball).x, 4.0, 1e-3);
}

/// Problem 9 with a wall.
#[test]
fn elastic_bodies_leave_a_moving_wall_with_twice_its_speed() {
    for ball in [true, false] {
        let mut scene = Scene::new(0.5, 1.0).weightless();
        scene.kinematic(Shape::cuboid(Vec3::new(0.1, 3.0, 3.0)), Vec3::new(-1.6, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0));
        let shape = if ball { Shape::ball(0.5) } else { Shape::cuboid(Vec3::splat(0.5)) };
        let body = scene.body(shape, Pose::IDENTITY, 1.0);
        scene.run(1.0);
        close(scene.velocity(body).x, 4.0, 1e-3);
        close(scene.spin(body).length(), 0.0, 1e-3);
    }
}

/// Problem 41.
#[test]
fn billiards_leave_along_the_line_of_centres() {
    let r = 0.05_f32;
    for step in 0..19 {
        let offset = 0.1 * step as f32 * r;
        for gap in 0..5 {
            let mut scene = Scene::new(0.0, 1.0).weightless();
            let target = scene.ball(r, Vec3::ZERO);
            let shooter = scene.ball(r, Vec3::new(-0.4 - 0.021 * gap as f32, offset, 0.0));
            scene.throw(shooter, Vec3::new(20.0, 0.0, 0.0), Vec3::ZERO);
            scene.run(0.1);
            let sine = offset / (2.0 * r);
            let cosine = (1.0 - sine * sine).sqrt();
            let line = Vec3::new(cosine, -sine, 0.0);
            let (v, u) = (scene.velocity(target), scene.velocity(shooter));
            close(v.length(), 20.0 * cosine, 0.02);
            assert!(v.normalize().cross(line).length() < 5e-4, "{v} {line} at {offset} {gap}");
            if sine > 0.0 {
                close(u.length(), 20.0 * sine, 0.02);
                assert!(u.normalize().dot(line).abs() < 5e-4, "{u}");
            }
            let moment = |i: usize| scene.at(i).cross(scene.velocity(i)) + scene.world.bodies[i].momentum;
            let change = moment(target) + moment(shooter) - Vec3::new(0.0, 0.0, -20.0 * offset);
            assert!(change.length() < 1e-4, "{change}");
        }
    }
}

/// Problem 4.
#[test]
fn flat_box_bounces_without_spin() {
    for (e, wanted) in [(0.5, 0.25), (1.0, 1.0)] {
        for narrow in [false, true] {
            let mut scene = Scene::new(0.5, e);
            if narrow {
                let pose = Pose::new(Vec3::new(0.0, -0.5, 0.0), Quat::IDENTITY);
                scene.block(Vec3::new(0.375, 0.5, 0.375), pose);
            } else {
                scene.floor();
            }
            let body = scene.cuboid(Vec3::splat(0.5), Vec3::new(0.0, 1.5, 0.0));
            close(apexes(&mut scene, body, 1.5)[0] - 0.5, wanted, 1e-3);
            close(scene.spin(body).length(), 0.0, 1e-3);
        }
    }
}

/// Problem 5: a rod at 45 degrees without friction, against the impulse of the closed form.
#[test]
fn slanting_rod_takes_the_impulse_of_the_closed_form() {
    let (e, half, radius, speed) = (0.8_f32, 0.5, 0.05, 2.0_f32);
    for step in 0..10 {
        let mut scene = Scene::new(0.0, e).weightless();
        scene.floor();
        let turn = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_4);
        let at = Vec3::new(0.0, 0.6 + 0.003 * step as f32, 0.0);
        let rod = scene.body(Shape::capsule(half, radius), Pose::new(at, turn), 1.0);
        scene.throw(rod, Vec3::new(0.0, -speed, 0.0), Vec3::ZERO);
        scene.run(0.2);
        let (lever, inertia) = (half * std::f32::consts::FRAC_1_SQRT_2, scene.world.bodies[rod].moments.x);
        let j = (1.0 + e) * speed / (1.0 + lever * lever / inertia);
        close(scene.velocity(rod).y, j - speed, 2e-3);
        close(scene.spin(rod).z.abs(), lever * j / inertia, 5e-3);
    }
}

/// Elastic capsules that land on a floor almost flat: one end leaves while the other one comes.
pub(super) fn flat_capsules() -> Scene {
    let mut scene = Scene::new(0.0, 1.0).weightless();
    scene.floor();
    for k in 0..40 {
        let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2 - 0.001 * k as f32);
        let at = Vec3::new(0.0, 0.1 + 0.005 * k as f32, 0.2 * k as f32);
        let body = scene.body(Shape::capsule(0.06, 0.03), Pose::new(at, turn), 1.0);
        scene.throw(body, Vec3::new(0.0, -7.0, 0.0), Vec3::ZERO);
    }
    scene
}

#[test]
fn flat_capsules_lose_no_energy() {
    for substeps in [4, 16, 64] {
        let mut scene = flat_capsules().substeps(substeps);
        scene.run(0.1);
        for body in &scene.world.bodies[1..] {
            let sum = 0.5 * body.velocity.length_squared() / body.inverse_mass + 0.5 * body.spin.dot(body.momentum);
            close(sum, 24.5, 0.01);
        }
    }
}
