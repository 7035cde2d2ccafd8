//! Places of balls on static shapes that hide each other (docs/physics section 11.4).

use glam::{Quat, Vec2, Vec3, Vec3A};

use super::scene::{DT, Scene};
use crate::rigid::frame::Frame;
use crate::rigid::frame::contacts::Impulse;
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;
use crate::rigid::world::Body;

/// Two balls of one body lie on a static ball, with normals that differ by 0.008 rad: each carries half of the body.
pub(super) fn clump_on_a_ball(friction: f32) -> Scene {
    let (r, great, beside) = (0.2_f32, 100.0_f32, 0.4_f32);
    let mut scene = Scene::new(friction, 0.0);
    scene.attach(0, Shape::ball(great), Pose::new(Vec3::NEG_Y * great, Quat::IDENTITY));
    let height = f64::from(great + r).mul_add(f64::from(great + r), -f64::from(beside * beside)).sqrt() - f64::from(great);
    let ball = 0.4 * r * r;
    let moments = Vec3::new(ball, ball + beside * beside, ball + beside * beside);
    let mut body = Body::loose(Pose::new(Vec3::Y * height as f32, Quat::IDENTITY), 1.0, moments, Quat::IDENTITY);
    (body.radius, body.width) = (beside + r, 2.0 * r);
    scene.world.bodies.push(body);
    for x in [-beside, beside] {
        scene.attach(1, Shape::ball(r), Pose::new(Vec3::new(x, 0.0, 0.0), Quat::IDENTITY));
    }
    scene
}

#[test]
fn balls_of_a_body_on_one_static_ball_do_not_hide_each_other() {
    for (friction, speed) in [(0.5, 0.0), (0.0, 2.0)] {
        let mut scene = clump_on_a_ball(friction);
        scene.throw(1, Vec3::X * speed, Vec3::ZERO);
        for _ in 0..60 {
            scene.step();
            assert_eq!(scene.last.contacts, 2);
            let up = (scene.at(1) + 100.0 * Vec3::Y).normalize();
            let slope = (scene.world.bodies[1].pose.turn * Vec3::X).dot(up);
            assert!(slope.abs() < 1e-3, "{slope} at {}", scene.at(1));
        }
    }
}

/// A ball goes from one tile to the next. The friction impulse stays as it is in the plane of the floor: it is not
/// projected on the tangents of the place that becomes hidden. It goes over even where the normal impulse has become 0 in
/// the biased pass.
#[test]
fn a_hidden_place_hands_its_impulse_over_as_it_is() {
    for normal in [1.0, 0.0] {
        let mut scene = Scene::new(0.5, 0.0);
        for x in [-1.0, 1.0] {
            scene.block(Vec3::new(1.0, 0.5, 2.0), Pose::new(Vec3::new(x, -0.5, 0.0), Quat::IDENTITY));
        }
        scene.ball(0.4, Vec3::new(-0.05, 0.3, 0.0));
        let mut frame = Frame::open(&scene.world, DT, 4);
        let counts = |frame: &Frame<'_>| [0, 1].map(|k: usize| frame.contacts.pairs[k].count);
        assert_eq!(counts(&frame), [1, 0]);
        let own = frame.contacts.pairs[0];
        let given = Vec2::new(0.3, -0.2);
        frame.contacts.impulses[own.first as usize] = Impulse { normal, tangent: given };
        frame.bodies.poses[1].position.x = 0.1;
        frame.refresh();
        assert_eq!(counts(&frame), [0, 1]);
        let taken = frame.contacts.pairs[1];
        let impulse = frame.contacts.impulses[taken.first as usize];
        let along = |tangents: [Vec3A; 2], impulse: Vec2| impulse.x * tangents[0] + impulse.y * tangents[1];
        let missed = along(taken.tangents, impulse.tangent) - along(own.tangents, given);
        assert!(impulse.normal == normal && missed.length() < 1e-6, "{impulse:?}");
    }
}
