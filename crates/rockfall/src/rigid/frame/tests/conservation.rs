//! Energy, momentum and angular momentum.

use glam::{Quat, Vec3};

use super::scene::{Random, Scene, close};
use crate::rigid::frame::{energy, momenta};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;

fn cage(scene: &mut Scene, half: f32) {
    for axis in Vec3::AXES {
        scene.plane(-half * axis, axis);
        scene.plane(half * axis, -axis);
    }
}

/// Problem 6.
#[test]
fn elastic_gas_keeps_its_energy() {
    let mut scene = Scene::new(0.0, 1.0).weightless();
    cage(&mut scene, 2.5);
    let mut random = Random(1);
    for k in 0..100 {
        let ball = scene.ball(0.2, Vec3::new((k % 5) as f32 - 2.0, (k / 5 % 5) as f32 - 2.0, (k / 25) as f32 - 1.5));
        scene.throw(ball, 3.0 * random.vector(), Vec3::ZERO);
    }
    let start = energy(&scene.world);
    scene.run(20.0);
    assert!((energy(&scene.world) / start - 1.0).abs() < 1e-4, "{}", energy(&scene.world) / start);
    assert!(scene.world.bodies.iter().all(|body| body.pose.position.abs().max_element() < 2.301));
}

/// Problem 8.
#[test]
fn eccentric_boxes_keep_their_momenta() {
    for (e, mu) in [(0.0, 0.5), (0.5, 0.5), (1.0, 0.5), (1.0, 0.0)] {
        let mut scene = Scene::new(mu, e).weightless();
        let [a, b] =
            [Vec3::new(-1.5, 0.3, 0.2), Vec3::new(1.5, -0.2, -0.1)].map(|at| scene.cuboid(Vec3::new(0.5, 0.4, 0.3), at));
        scene.throw(a, Vec3::new(3.0, 0.0, 0.0), Vec3::new(1.0, 2.0, -1.0));
        scene.throw(b, Vec3::new(-2.0, 0.1, 0.0), Vec3::new(-2.0, 1.0, 0.5));
        let (start, (p, l)) = (energy(&scene.world), momenta(&scene.world));
        let mut before = start;
        for _ in 0..120 {
            scene.step();
            assert!(energy(&scene.world) <= before * (1.0 + 1e-6));
            before = energy(&scene.world);
        }
        let (p_end, l_end) = momenta(&scene.world);
        assert!((p_end - p).length() < 1e-6, "{}", (p_end - p).length());
        assert!((l_end - l).length() < 3e-4, "{}", (l_end - l).length());
        if (e, mu) == (1.0, 0.0) {
            assert!((before / start - 1.0).abs() < 1e-4);
        }
    }
}

/// Problem 25: 12 s for each e.
#[test]
fn piles_never_gain_energy() {
    for e in [0.0, 0.5, 1.0] {
        let mut scene = Scene::new(0.5, e);
        scene.floor();
        for axis in [Vec3::X, Vec3::Z] {
            scene.plane(-3.2 * axis, axis);
            scene.plane(3.2 * axis, -axis);
        }
        let mut random = Random(2);
        for k in 0..180 {
            let at = Vec3::new((k % 4) as f32 - 1.5, 0.5 + (k / 16) as f32, (k / 4 % 4) as f32 - 1.5) * 1.45;
            let shape = if k % 3 == 0 { Shape::ball(0.4) } else { Shape::cuboid(Vec3::new(0.45, 0.35, 0.4)) };
            scene.body(shape, Pose::new(at + 0.05 * random.vector(), Quat::from_scaled_axis(random.vector())), 1.0);
        }
        let start = energy(&scene.world);
        let (mut before, mut worst) = (start, 0.0_f64);
        for _ in 0..720 {
            scene.step();
            let now = energy(&scene.world);
            worst = worst.max((now - before) / start);
            before = now;
        }
        assert!(worst < 2e-5, "e {e}: {worst}");
        assert!(scene.world.bodies[1..].iter().all(|body| {
            let at = body.pose.position;
            at.x.abs() < 3.2 && at.z.abs() < 3.2 && at.y > 0.0
        }));
    }
}

/// Problem 43.
#[test]
fn spinning_crowd_keeps_its_angular_momentum() {
    let mut scene = Scene::new(0.5, 0.5).weightless();
    let mut random = Random(3);
    for k in 0..40 {
        let at = Vec3::new((k % 4) as f32 - 1.5, (k / 4 % 4) as f32 - 1.5, (k / 16) as f32 - 1.0) * 1.5;
        let shape = if k % 2 == 0 { Shape::ball(0.5) } else { Shape::cuboid(Vec3::new(0.5, 0.4, 0.3)) };
        let body = scene.body(shape, Pose::new(at, Quat::from_scaled_axis(random.vector())), 1.0);
        scene.throw(body, -0.7 * at + Vec3::Y.cross(at), 3.0 * random.vector());
    }
    let (start, (_, l)) = (energy(&scene.world), momenta(&scene.world));
    let mut before = start;
    for _ in 0..180 {
        scene.step();
        let now = energy(&scene.world);
        assert!(now - before < 1e-5 * start, "{}", (now - before) / start);
        before = now;
    }
    let change = (momenta(&scene.world).1 - l).length() / l.length();
    close(change as f32, 0.0, 1e-4);
}

/// A ball falls into a sharp groove: the sweeps are far from the end, and the energy is exact all the same.
#[test]
fn ball_in_a_groove_keeps_its_energy() {
    let mut scene = Scene::new(0.0, 1.0).weightless();
    let (sine, cosine) = 0.1_f32.sin_cos();
    scene.plane(Vec3::ZERO, Vec3::new(cosine, sine, 0.0));
    scene.plane(Vec3::ZERO, Vec3::new(-cosine, sine, 0.0));
    let ball = scene.ball(0.05, Vec3::new(0.0, 1.0, 0.0));
    scene.throw(ball, Vec3::new(0.0, -2.0, 0.0), Vec3::ZERO);
    let start = energy(&scene.world);
    for _ in 0..120 {
        scene.step();
        close((energy(&scene.world) / start) as f32, 1.0, 1e-4);
    }
    assert!(scene.velocity(ball).y > 1.9);
}
