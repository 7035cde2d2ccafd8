//! Sliding, sticking and rolling.

use glam::{Quat, Vec3};

use super::scene::{DT, G, Scene, close};
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};

/// A box of a mass on a plane whose slope along x has a tangent: the field is turned.
fn incline(mu: f32, tangent: f32, half: Vec3, mass: f32) -> (Scene, usize) {
    let mut scene = Scene::new(mu, 0.0);
    scene.floor();
    let angle = tangent.atan();
    scene.world.gravity = G * Vec3::new(angle.sin(), -angle.cos(), 0.0);
    let body = scene.body(Shape::cuboid(half), Pose::new(Vec3::new(0.0, half.y, 0.0), Quat::IDENTITY), mass);
    (scene, body)
}

/// Problem 11.
#[test]
fn box_sticks_below_the_angle_of_friction() {
    let (mut scene, body) = incline(0.5, 0.49, Vec3::splat(0.5), 1.0);
    scene.run(1.0);
    let start = scene.at(body);
    scene.run(4.0);
    assert!((scene.at(body) - start).length() < 4e-6, "{}", scene.at(body) - start);
}

/// Problem 12.
#[test]
fn box_slides_above_the_angle_of_friction() {
    for (tangent, mass) in [(0.51, 1.0), (0.6, 1.0), (0.51, 1000.0), (0.6, 1000.0)] {
        let (mut scene, body) = incline(0.5, tangent, Vec3::splat(0.5), mass);
        scene.run(1.0);
        let start = scene.velocity(body).x;
        scene.run(2.0);
        let angle = f32::atan(tangent);
        let wanted = G * (angle.sin() - 0.5 * angle.cos());
        close((scene.velocity(body).x - start) / 2.0 / wanted, 1.0, 1e-3);
    }
}

/// Problem 13: the limit is 1/3.
#[test]
fn tall_box_tips_at_its_limit() {
    for (tangent, tips) in [(0.331_f32, false), (0.336, true)] {
        let (mut scene, body) = incline(1.0, 0.3, Vec3::new(0.5, 1.5, 0.5), 1.0);
        scene.run(1.0);
        // The slope grows slowly: where the field turns at once, the box begins to fall before its friction has come.
        for part in 1..=60 {
            let angle = (0.3 + (tangent - 0.3) * part as f32 / 60.0).atan();
            scene.world.gravity = G * Vec3::new(angle.sin(), -angle.cos(), 0.0);
            scene.step();
        }
        scene.run(10.0);
        let tilt = (scene.world.bodies[body].pose.turn * Vec3::Y).y;
        assert_eq!(tilt < 0.9, tips, "{tangent}: {tilt}");
    }
}

/// Problem 14.
#[test]
fn sliding_ball_begins_to_roll() {
    let mut scene = Scene::new(0.3, 0.0);
    scene.floor();
    let ball = scene.ball(0.5, Vec3::new(0.0, 0.5, 0.0));
    scene.throw(ball, Vec3::new(5.0, 0.0, 0.0), Vec3::ZERO);
    let mut rolls = None;
    for frame in 1..=120 {
        scene.step();
        let slip = scene.velocity(ball).x + 0.5 * scene.spin(ball).z;
        if slip.abs() < 1e-3 && rolls.is_none() {
            rolls = Some(DT * frame as f32);
        }
    }
    close(scene.velocity(ball).x, 25.0 / 7.0, 1e-3);
    close(rolls.unwrap(), 0.485, 0.017);
}

/// Problem 15.
#[test]
fn rolling_ball_rolls_on() {
    let mut scene = Scene::new(0.3, 0.0);
    scene.floor();
    let ball = scene.ball(0.5, Vec3::new(0.0, 0.5, 0.0));
    scene.throw(ball, Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 0.0, -4.0));
    scene.run(0.5);
    let start = scene.velocity(ball).x;
    scene.run(10.0);
    close(scene.velocity(ball).x / start, 1.0, 1e-4);
}

/// Problem 16.
#[test]
fn thrown_box_stops_after_its_distance() {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let half = Vec3::new(0.5, 0.25, 0.5);
    let body = scene.body(Shape::cuboid(half), Pose::new(Vec3::new(0.0, 0.25, 0.0), Quat::from_rotation_y(0.4)), 1.0);
    let along = Vec3::new(0.7_f32.cos(), 0.0, -(0.7_f32.sin()));
    scene.throw(body, 4.0 * along, Vec3::ZERO);
    scene.run(2.0);
    let way = scene.at(body) - Vec3::new(0.0, scene.at(body).y, 0.0);
    close(way.length(), 1.631 - 2.0 * DT / 4.0, 2e-3);
    assert!(way.normalize().cross(along).length() < 1e-3, "{way}");
    let yaw = scene.world.bodies[body].pose.turn * Quat::from_rotation_y(-0.4);
    close(2.0 * yaw.y, 0.0, 1e-3);
}

/// Problem 17.
#[test]
fn spinning_cube_stops_in_its_time() {
    let mut scene = Scene::new(0.3, 0.0);
    scene.floor();
    let body = scene.cuboid(Vec3::splat(0.5), Vec3::new(0.0, 0.5, 0.0));
    scene.throw(body, Vec3::ZERO, Vec3::new(0.0, 5.0, 0.0));
    let mut stop = None;
    for frame in 1..=60 {
        scene.step();
        if scene.spin(body).length() < 1e-3 && stop.is_none() {
            stop = Some(DT * frame as f32);
        }
    }
    close(stop.unwrap(), 0.4, 0.02);
    close(scene.at(body).x.hypot(scene.at(body).z), 0.0, 1e-3);
}

/// Problem 18.
#[test]
fn belt_takes_a_box_along() {
    let mut scene = Scene::new(0.4, 0.0);
    scene.floor();
    scene.world.colliders[0].surface_velocity = Vec3::new(2.0, 0.0, 0.0);
    let body = scene.cuboid(Vec3::splat(0.5), Vec3::new(0.0, 0.5, 0.0));
    let mut reached = None;
    for frame in 1..=90 {
        scene.step();
        if scene.velocity(body).x > 2.0 - 1e-3 && reached.is_none() {
            reached = Some(DT * frame as f32);
        }
    }
    close(scene.velocity(body).x, 2.0, 1e-3);
    close(reached.unwrap(), 0.51, 0.017);
}

/// Problem 26: a thin card against a smooth wall, 25 degrees from the vertical. It slides below mu = tan(25°) / 2.
#[test]
fn leaning_card_slides_at_its_limit() {
    for (mu, stands) in [(0.3, true), (0.2, false)] {
        let mut scene = Scene::new(mu, 0.0);
        scene.floor();
        scene.plane(Vec3::ZERO, Vec3::X);
        scene.world.materials = 2;
        let [rough, smooth] = [mu, 0.0].map(|friction| crate::rigid::world::Surface { friction, restitution: 0.0 });
        scene.world.surfaces = vec![rough, smooth, smooth, smooth];
        scene.world.colliders[1].material = 1;
        let (angle, half) = (25.0_f32.to_radians(), Vec3::new(0.01, 1.0, 0.5));
        let turn = Quat::from_rotation_z(angle);
        // The lowest and the leftmost corner touch the floor and the wall.
        let corners = [-1.0, 1.0].map(|x| [-1.0, 1.0].map(|y| turn * Vec3::new(x * half.x, y * half.y, 0.0)));
        let least = |f: fn(&Vec3) -> f32| corners.iter().flatten().map(f).fold(f32::INFINITY, f32::min);
        let at = Vec3::new(-least(|c| c.x), -least(|c| c.y), 0.0);
        let card = scene.body(Shape::cuboid(half), Pose::new(at, turn), 1.0);
        scene.run(4.0);
        let moved = (scene.at(card) - at).length();
        assert_eq!(moved < 1e-3, stands, "{mu}: {moved}");
    }
}

/// A floor of tiles without friction.
fn tiles(mu: f32, e: f32) -> Scene {
    let mut scene = Scene::new(mu, e);
    for k in 0..32 {
        for row in 0..2 {
            let at = Vec3::new(k as f32, -0.25, row as f32 - 0.4);
            scene.block(Vec3::new(0.5, 0.25, 0.5), Pose::new(at, Quat::IDENTITY));
        }
    }
    scene
}

/// A floor of triangles.
fn mesh(mu: f32, e: f32, size: f32) -> Scene {
    let mut scene = Scene::new(mu, e);
    scene.mesh(size, 31.0, 1.0);
    scene
}

/// Problem 34: seams stop neither a box nor a ball. They slow a capsule by up to 8 % in 7 s.
#[test]
fn seams_of_tiles_are_not_felt() {
    let shapes = [Shape::ball(0.4), Shape::cuboid(Vec3::splat(0.4)), Shape::capsule(0.3, 0.4)];
    let floors: [fn() -> Scene; 3] = [|| tiles(0.0, 0.0), || mesh(0.0, 0.0, 1.0), || mesh(0.0, 0.0, 0.31)];
    for (number, (shape, floor)) in shapes.iter().flat_map(|shape| floors.map(|floor| (shape, floor))).enumerate() {
        let mut scene = floor();
        let turn = if matches!(shape.core, Core::Segment { .. }) { Quat::from_rotation_x(1.57) } else { Quat::IDENTITY };
        let body = scene.body(shape.clone(), Pose::new(Vec3::new(0.0, 0.4, 0.0), turn), 1.0);
        scene.throw(body, Vec3::new(4.0, 0.0, 0.0), Vec3::ZERO);
        for _ in 0..7 {
            scene.run(1.0);
            let (at, v) = (scene.at(body), scene.velocity(body));
            // A capsule has seams (limits, section 11.12).
            let most = if matches!(shape.core, Core::Segment { .. }) { 0.35 } else { 1e-3 };
            assert!((v.x - 4.0).abs() < most && (at.y - 0.4).abs() < most, "{number}: {at} {v}");
        }
    }
}

/// A ball that bounces on tiles keeps its speed and its height, wherever it lands.
#[test]
fn seams_do_not_scatter_what_bounces() {
    for mut scene in [tiles(0.5, 1.0), mesh(0.5, 1.0, 1.0), mesh(0.5, 1.0, 0.31)] {
        let ball = scene.ball(0.4, Vec3::new(0.0, 1.0, 0.05));
        scene.throw(ball, Vec3::new(4.0, 0.0, 0.1), Vec3::new(0.1 / 0.4, 0.0, -4.0 / 0.4));
        let start = crate::rigid::frame::energy(&scene.world);
        scene.run(7.0);
        close(scene.velocity(ball).x, 4.0, 2e-3);
        close((crate::rigid::frame::energy(&scene.world) / start) as f32, 1.0, 1e-4);
    }
}
