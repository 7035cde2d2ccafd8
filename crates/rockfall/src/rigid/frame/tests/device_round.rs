//! The device solves frames with balls and capsules as the twin does.

use glam::{Quat, Vec3};

use super::device::{apart, compare, open, stage};
use super::scene::{DT, Random, Scene};
use crate::rigid::frame::upload::advance_on_device;
use crate::rigid::frame::{Frame, energy};
use crate::rigid::gpu::{Part, Plan};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;

const PARTS: [Part; 7] = [Part::Impacts, Part::Kick, Part::Spare, Part::Biased, Part::Drift, Part::Refresh, Part::Relax];

/// Shapes in a heap, without overlap at the start.
fn heap(count: usize, restitution: f32, shape: impl Fn(usize) -> Shape) -> Scene {
    let mut scene = Scene::new(0.5, restitution);
    scene.floor();
    let mut random = Random(5);
    let side = (count as f32).cbrt().ceil() as usize;
    for k in 0..count {
        let cell = Vec3::new((k % side) as f32, (k / (side * side)) as f32, (k / side % side) as f32);
        let at = 1.75 * (cell - 0.5 * Vec3::new(side as f32, 0.0, side as f32)) + Vec3::Y;
        scene.body(shape(k), Pose::new(at, Quat::from_scaled_axis(random.vector())), 1.0);
    }
    scene
}

fn ball_or_box(k: usize) -> Shape {
    if k.is_multiple_of(2) { Shape::ball(0.5) } else { Shape::cuboid(Vec3::splat(0.5)) }
}

fn any_shape(k: usize) -> Shape {
    match k % 3 {
        0 => Shape::capsule(0.4, 0.3),
        1 => Shape::ball(0.4),
        _ => Shape::cuboid(Vec3::new(0.5, 0.3, 0.4)),
    }
}

/// Balls that roll over a floor and against a box.
fn rolling() -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    for k in 0..6 {
        let ball = scene.ball(0.2, Vec3::new(0.0, 0.2, k as f32));
        let speed = 0.5 + k as f32;
        scene.throw(ball, Vec3::new(speed, 0.0, 0.1 * speed), Vec3::new(0.5 * speed, 0.0, -5.0 * speed));
    }
    scene.cuboid(Vec3::new(0.2, 0.5, 3.0), Vec3::new(1.5, 0.5, 2.5));
    scene
}

/// Balls on a table without gravity, with e = 1, of which one comes fast; and balls that bounce off a floor with spin.
fn billiard() -> Scene {
    let mut scene = Scene::new(0.2, 1.0).weightless();
    scene.floor();
    for k in 0..15 {
        let row = (0..5).find(|row| k < (row + 1) * (row + 2) / 2).unwrap_or(4);
        let place = k - row * (row + 1) / 2;
        let at = Vec3::new(0.11 * row as f32, 1.0, 0.11 * (place as f32 - 0.5 * row as f32));
        scene.ball(0.05, at);
    }
    let first = scene.ball(0.05, Vec3::new(-0.4, 1.0, 0.013));
    scene.throw(first, Vec3::new(20.0, 0.0, 0.0), Vec3::new(0.0, 30.0, 0.0));
    for k in 0..5 {
        let ball = scene.ball(0.1, Vec3::new(3.0 + k as f32, 0.2 + 0.05 * k as f32, 0.0));
        scene.throw(ball, Vec3::new(2.0, -5.0, 1.0), Vec3::new(10.0, 5.0 * k as f32, -20.0));
    }
    scene
}

/// Balls, a box and a capsule on tiles, whose upper sides are at one height, and on their edges.
fn tiles(restitution: f32) -> Scene {
    let height = 0.1 * restitution;
    let mut scene = Scene::new(0.4, restitution);
    for x in -3..3 {
        for z in -3..3 {
            let at = Vec3::new(x as f32 + 0.5, -0.25, z as f32 + 0.5);
            scene.block(Vec3::new(0.5, 0.25, 0.5), Pose::new(at, Quat::IDENTITY));
        }
    }
    for k in 0..5 {
        let ball = scene.ball(0.3, Vec3::new(-2.0, 0.31 + height, -2.0 + k as f32));
        scene.throw(ball, Vec3::new(2.0, -2.0 * restitution, 0.4), Vec3::new(0.5, 1.0, -6.0));
    }
    let body = scene.cuboid(Vec3::new(0.6, 0.3, 0.4), Vec3::new(2.1, 0.3 + height, 0.05));
    scene.throw(body, Vec3::new(-0.5, 0.0, 0.3), Vec3::ZERO);
    let turn = Quat::from_rotation_z(1.5) * Quat::from_rotation_x(0.2);
    scene.body(Shape::capsule(0.6, 0.2), Pose::new(Vec3::new(1.5, 0.4 + height, 2.1), turn), 1.0);
    scene
}

/// Fast balls that pass a ball, a face, an edge, a corner and a capsule by 1 mm.
fn passing(e: f32, step: usize) -> Scene {
    let (r, slant) = (0.05, std::f32::consts::FRAC_1_SQRT_2);
    let mut scene = Scene::new(0.5, e).weightless();
    for what in 0..5 {
        let (turn, depth) = match what {
            0 | 1 | 4 => (Quat::IDENTITY, 0.3),
            2 => (Quat::from_rotation_z(std::f32::consts::FRAC_PI_4), 0.3 / slant),
            _ => (Quat::from_rotation_arc(Vec3::ONE.normalize(), Vec3::Y), 0.3 * 3.0_f32.sqrt()),
        };
        let shape = match what {
            0 => Shape::ball(0.3),
            4 => Shape::capsule(0.2, 0.1),
            _ => Shape::cuboid(Vec3::splat(0.3)),
        };
        let z = 3.0 * what as f32;
        scene.body(shape, Pose::new(Vec3::new(0.0, -depth, z), turn), 1.0);
        let ball = scene.ball(r, Vec3::new(-1.0 - 0.017 * step as f32, r + 1e-3, z));
        scene.throw(ball, Vec3::new(20.0, 0.0, 0.0), Vec3::ZERO);
    }
    scene
}

/// Elastic capsules and boxes that fly at each other and at walls, with spin.
fn rods() -> Scene {
    let mut scene = Scene::new(0.3, 0.8).weightless();
    scene.block(Vec3::new(0.01, 5.0, 5.0), Pose::new(Vec3::new(8.0, 0.0, 0.0), Quat::IDENTITY));
    for k in 0..8 {
        let shape =
            if k % 3 == 2 { Shape::cuboid(Vec3::new(0.3, 0.2, 0.25)) } else { Shape::capsule(0.3, 0.1 + 0.01 * k as f32) };
        let turn = Quat::from_scaled_axis(Vec3::new(0.3 * k as f32, 0.5, 0.2));
        let body = scene.body(shape, Pose::new(Vec3::new(0.9 * k as f32, 0.1 * k as f32, 0.0), turn), 1.0);
        scene.throw(body, Vec3::new(40.0 - 5.0 * k as f32, 0.0, 1.0), Vec3::new(1.0, 2.0 - k as f32, 3.0));
    }
    scene
}

fn scenes() -> Vec<(&'static str, Scene, f32)> {
    // With seconds before the frame that is compared.
    vec![
        ("rolling", rolling(), 0.0),
        ("billiard", billiard(), 0.0),
        ("pile", heap(60, 0.0, ball_or_box), 1.0),
        ("capsules", heap(60, 0.0, any_shape), 1.0),
        ("elastic pile", heap(60, 0.7, any_shape), 0.4),
        ("rods", rods(), 0.0),
        ("tiles", tiles(0.0), 0.0),
        ("elastic tiles", tiles(0.5), 0.0),
        ("passing", passing(0.0, 3), 0.0),
        ("elastic passing", passing(1.0, 7), 0.0),
    ]
}

/// Each stage from the state that the twin has before it.
#[test]
fn round_stages_agree() {
    let gpu = open();
    let mut wrong = Vec::new();
    for (name, mut scene, seconds) in scenes() {
        scene.run(seconds);
        let mut worst: Vec<(Part, &str, f32)> = PARTS.iter().map(|part| (*part, "", 0.0)).collect();
        let mut kinds = [0; 4];
        for _ in 0..12 {
            let mut frame = Frame::open(&scene.world, DT, 4);
            kinds[0] = frame.contacts.pairs.iter().filter(|pair| pair.round).count().max(kinds[0]);
            for _ in 0..4 {
                for (part, worst) in PARTS.iter().zip(&mut worst) {
                    let next = stage(&gpu, &mut frame, *part);
                    if next.1 > worst.2 {
                        (worst.1, worst.2) = next;
                    }
                    if *part == Part::Impacts {
                        kinds[1] += frame.bodies.clocks.iter().filter(|clock| **clock > 0.0).count();
                    } else if *part == Part::Spare {
                        kinds[2] += frame.contacts.rows.iter().filter(|row| row.spare > 0.0).count();
                    }
                    kinds[3] += frame.contacts.pairs.iter().filter(|pair| pair.count == 0).count();
                }
            }
            scene.step();
        }
        eprintln!("{name}: {} round pairs, {} clocks, {} spare gaps, {} hidden", kinds[0], kinds[1], kinds[2], kinds[3]);
        for (part, kind, apart) in &worst {
            eprintln!("  {part:?}: {apart:.1e} ({kind})");
        }
        for (part, kind, apart) in worst {
            let most = if part == Part::Impacts { 2e-4 } else { 5e-6 };
            if apart >= most {
                wrong.push(format!("{name}, {part:?}: {kind} differs by {apart}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
