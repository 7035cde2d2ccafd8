//! The device solves frames with balls and capsules as the twin does.

use std::sync::Arc;

use glam::{Quat, Vec3};

use super::super::impact::flat_capsules;
use super::super::scene::{DT, Random, Scene, close};
use super::super::seams::clump_on_a_ball;
use super::device::{apart, open, run, stage};
use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::{Frame, bodies_alone, detect, energy};
use crate::rigid::gpu::Part;
use crate::rigid::gpu::world::GpuWorld;
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Hull, Shape};
use crate::rigid::world::RigidWorld;

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

/// A plate on more than 64 balls: all its blocks are left over. With restitution it falls on them.
fn hub(restitution: f32) -> Scene {
    let mut scene = Scene::new(0.5, restitution);
    scene.floor();
    for k in 0..100 {
        scene.ball(0.4, Vec3::new((k % 10) as f32, 0.4, (k / 10) as f32));
    }
    let pose = Pose::new(Vec3::new(4.5, 0.9 + 0.1 * restitution, 4.5), Quat::IDENTITY);
    let plate = scene.body(Shape::cuboid(Vec3::new(5.0, 0.1, 5.0)), pose, 50.0);
    scene.throw(plate, Vec3::new(0.1, -restitution, 0.0), Vec3::ZERO);
    scene
}

/// A ground of one-sided faces with hulls on it, a belt and a capsule that moves, and shapes that fall on them.
fn ground(restitution: f32) -> Scene {
    let mut scene = Scene::new(0.5, restitution);
    let up = Quat::from_rotation_arc(Vec3::Z, Vec3::Y);
    for x in -3..3 {
        for z in -3..3 {
            let core = Core::Face { u: 0.5 * Vec3::X, v: 0.5 * Vec3::Y, is_triangle: false, one_sided: true, is_facet: false };
            let at = Vec3::new(x as f32 + 0.5, 0.0, z as f32 + 0.5);
            scene.attach(0, Shape { core, radius: 0.0 }, Pose::new(at, up));
        }
    }
    let mut random = Random(9);
    for k in 0..4 {
        let points: Vec<Vec3> = (0..12).map(|_| 0.6 * random.vector()).collect();
        let core = Core::Hull(Arc::new(Hull::new(&points).expect("a hull").0));
        let at = Vec3::new((k % 2) as f32 - 0.5, 0.1, (k / 2) as f32 - 0.5);
        scene.attach(0, Shape { core, radius: 0.02 }, Pose::new(at, Quat::from_scaled_axis(random.vector())));
    }
    scene.block(Vec3::new(0.5, 0.2, 2.0), Pose::new(Vec3::new(2.0, 0.1, 0.0), Quat::from_rotation_z(0.2)));
    scene.world.colliders.last_mut().unwrap().surface_velocity = Vec3::new(1.0, 0.0, 0.5);
    let rod = scene.kinematic(Shape::capsule(1.0, 0.2), Vec3::new(-2.0, 0.3, 0.0), Vec3::new(0.5, 0.0, 0.0));
    scene.throw(rod, Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.3, 0.2, 1.0));
    for k in 0..24 {
        let shape = match k % 3 {
            0 => Shape::capsule(0.2, 0.12),
            1 => Shape::ball(0.2),
            _ => Shape::cuboid(Vec3::new(0.2, 0.12, 0.15)),
        };
        let cell = Vec3::new((k % 4) as f32 - 1.6, 1.2 + (k / 16) as f32, (k / 4 % 4) as f32 - 1.6);
        scene.body(shape, Pose::new(cell, Quat::from_scaled_axis(random.vector())), 1.0);
    }
    scene
}

pub(super) fn scenes() -> Vec<(&'static str, Scene, f32)> {
    // With seconds before the frame that is compared.
    vec![
        ("rolling", rolling(), 0.15),
        ("billiard", billiard(), 0.0),
        ("pile", heap(60, 0.0, ball_or_box), 1.0),
        ("capsules", heap(60, 0.0, any_shape), 1.0),
        ("elastic pile", heap(60, 0.7, any_shape), 0.4),
        ("rods", rods(), 0.0),
        ("tiles", tiles(0.0), 0.4),
        ("elastic tiles", tiles(0.5), 0.0),
        ("clump on a ball", clump_on_a_ball(0.5), 0.1),
        ("passing", passing(0.0, 3), 0.0),
        ("elastic passing", passing(1.0, 7), 0.0),
        ("hub", hub(0.0), 0.2),
        ("elastic hub", hub(0.6), 0.0),
        ("ground", ground(0.0), 0.6),
        ("elastic ground", ground(0.6), 0.45),
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
            // The time of a hit is a root, which enlarges last bits.
            let most = if part == Part::Impacts { 5e-4 } else { 5e-6 };
            if apart >= most {
                wrong.push(format!("{name}, {part:?}: {kind} differs by {apart}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Boxes that fall on tiles: those of the world, whose side is a, and those of a kinematic body that is turned, whose side is b; some
/// stand on a wall on the tiles.
fn boxes_on_tiles() -> Scene {
    let mut scene = tiles(0.0);
    scene.block(Vec3::new(0.3, 0.5, 0.3), Pose::new(Vec3::new(-1.0, 0.5, 1.0), Quat::IDENTITY));
    let mut random = Random(3);
    for k in 0..40 {
        let at = Vec3::new((k % 8) as f32 * 0.7 - 2.4, 0.3 + 0.05 * random.number(), (k / 8) as f32 - 2.3);
        let turn = Quat::from_scaled_axis(0.1 * random.vector() + if k % 2 == 0 { Vec3::ZERO } else { Vec3::Y });
        scene.body(Shape::cuboid(Vec3::new(0.4, 0.3, 0.2)), Pose::new(at, turn), 1.0);
    }
    // The boxes come first, so that the table is their body b.
    let table = Pose::new(Vec3::new(10.0, -0.25, 0.0), Quat::from_rotation_z(0.3));
    for k in 0..20 {
        let inner = Vec3::new((k % 5) as f32 * 0.6, 0.53 + 0.02 * random.number(), (k / 5) as f32 * 0.4);
        let turn = table.turn * Quat::from_scaled_axis(0.02 * random.vector());
        scene.body(Shape::cuboid(Vec3::new(0.4, 0.3, 0.2)), Pose::new(table.point(inner), turn), 1.0);
    }
    let tile = Shape::cuboid(Vec3::new(0.5, 0.25, 0.5));
    let body = scene.kinematic(tile.clone(), table.position, Vec3::ZERO);
    for k in 1..8 {
        scene.attach(body, tile.clone(), Pose::new(Vec3::new((k / 2) as f32, 0.0, (k % 2) as f32), Quat::IDENTITY));
    }
    scene.world.bodies[body].pose = table;
    scene
}

/// Points that another static shape covers are left out as the twin does it before a frame.
#[test]
fn exposed_points_agree() {
    let gpu = open();
    let mut scene = boxes_on_tiles();
    let last = scene.world.bodies.len() as u32 - 1;
    let (mut left_out, mut kept, mut of_second) = (0, 0, 0);
    for _ in 0..10 {
        let bodies = Bodies::load(&scene.world, DT);
        let found = || detect::manifolds(&scene.world, &bodies, None);
        let wanted = detect::blocks(&scene.world, &bodies, found(), DT);
        let mut frame = Frame::open(&scene.world, DT, 4);
        frame.contacts = detect::blocks_with(&scene.world, &bodies, found(), DT, |_, _, _| ());
        let order: Vec<u32> = (0..frame.contacts.blocks.len() as u32).collect();
        frame.contacts.list_by_body(bodies.count(), &order);
        let on_device = gpu.frame(&frame.rows(4));
        on_device.run(&[Part::Expose]);
        let outcome = on_device.read().unwrap();
        for (before, row) in frame.contacts.pairs.iter().zip(&outcome.pairs) {
            let count = (row.info & 0xff) as usize;
            let same = wanted.pairs.iter().find(|pair| pair.colliders == row.colliders);
            assert_eq!(count, same.map_or(0, |pair| pair.count.into()), "{:?}", row.colliders);
            left_out += usize::from(before.count) - count;
            of_second += if row.bodies[1] == last { usize::from(before.count) - count } else { 0 };
            kept += count;
            for k in 0..count {
                let (point, place) = (&outcome.points[row.first as usize + k], same.unwrap().first as usize + k);
                let twin = &wanted.points[place];
                assert!(point.id == twin.id && point.on_a == twin.on_a.to_array() && point.on_b == twin.on_b.to_array());
            }
        }
        scene.step();
    }
    eprintln!("{left_out} points left out, {of_second} of them on the second body, {kept} kept");
    assert!(left_out > 100 && of_second > 10 && kept > 100);
}

/// Problem 35 on the device.
#[test]
fn what_passes_on_device_is_not_deflected() {
    let gpu = open();
    for (e, step) in [0.0, 1.0].into_iter().flat_map(|e| (0..20).step_by(3).map(move |step| (e, step))) {
        let mut scene = passing(e, step);
        run(&mut scene.world, 12, &gpu);
        for pair in scene.world.bodies[1..].chunks(2) {
            let change = (pair[1].velocity - Vec3::new(20.0, 0.0, 0.0)).length() + pair[0].velocity.length();
            assert!(change < 1e-4, "e {e}, start {step}: {change}");
            assert!(pair[1].pose.position.x > 2.0);
        }
    }
}

#[test]
fn flat_capsules_on_device_lose_no_energy() {
    let gpu = open();
    let mut scene = flat_capsules();
    let before = energy(&scene.world);
    let mut on_device = GpuWorld::new(&gpu, &scene.world, &bodies_alone(&scene.world)).unwrap();
    (0..6).for_each(|_| _ = on_device.advance(DT, 64, true).unwrap());
    on_device.download(&mut scene.world).unwrap();
    assert!((energy(&scene.world) / before - 1.0).abs() < 1e-4, "{}", energy(&scene.world) / before);
}

/// Problem 40 on the device.
#[test]
fn oblique_bounce_on_device_has_the_friction_of_the_closed_form() {
    let gpu = open();
    for (e, mu) in [(0.8, 0.5), (0.8, 0.1), (0.5, 0.5), (0.0, 0.5)] {
        let mut scene = Scene::new(mu, e).weightless();
        scene.floor();
        for step in 0..20 {
            let ball = scene.ball(0.05, Vec3::new(0.0, 0.3 + 0.004 * step as f32, step as f32));
            scene.throw(ball, Vec3::new(5.0, -10.0, 0.0), Vec3::ZERO);
        }
        run(&mut scene.world, 6, &gpu);
        for ball in 1..=20 {
            let j = (mu * (1.0 + e) * 10.0).min(2.0 / 7.0 * 5.0);
            close(scene.velocity(ball).x, 5.0 - j, 1e-3);
            close(scene.velocity(ball).y, 10.0 * e, 1e-3);
            close(-scene.spin(ball).z * 0.05, 2.5 * j, 1e-3);
        }
    }
}

/// Runs beside the twin, each on its own.
#[test]
fn round_scenes_run_as_the_twin() {
    let gpu = open();
    let on_device = |world: &RigidWorld| GpuWorld::new(&gpu, world, &bodies_alone(world)).unwrap();
    let mut wrong = false;
    // Bounds of places and of energies, as a part of the kinetic energy at the start and that of a fall by 1.
    for (name, mut scene, frames, most) in [
        ("rolling", rolling(), 90, 2e-3),
        ("billiard", billiard(), 40, 1e-4),
        ("tiles", tiles(0.0), 60, 1e-4),
        ("passing", passing(1.0, 7), 20, 1e-4),
    ] {
        let (mut other, mut on_device) = (scene.world.clone(), on_device(&scene.world));
        let mut worst = 0.0_f32;
        for _ in 0..frames {
            on_device.advance(DT, 4, true).unwrap();
            on_device.download(&mut other).unwrap();
            scene.step();
            worst = worst.max(apart(&scene.world, &other)[0]);
        }
        let [one, two] = [&scene.world, &other].map(energy);
        eprintln!("{name}: places {worst:.1e} apart, energies {one} and {two}");
        wrong |= worst >= most || (one - two).abs() >= 1e-3 * one.abs().max(1.0);
    }
    assert!(!wrong);
    // Heaps are chaotic: their energies stay together, and both come to rest.
    for (name, mut scene) in [("pile", heap(40, 0.0, ball_or_box)), ("capsules", heap(40, 0.0, any_shape))] {
        let (mut other, mut on_device) = (scene.world.clone(), on_device(&scene.world));
        let start = energy(&other);
        let mut before = start;
        for _ in 0..120 {
            on_device.advance(DT, 4, true).unwrap();
            on_device.download(&mut other).unwrap();
            scene.step();
            let now = energy(&other);
            assert!(now < before + 1e-3 * start, "{name}: {now} after {before}");
            before = now;
        }
        let [one, two] = [&scene.world, &other].map(energy);
        eprintln!("{name}: energies {start}, then {one} and {two}");
        assert!((one - two).abs() < 0.05 * start, "{name}");
        assert!(other.bodies.iter().all(|body| body.pose.position.y > -0.01), "{name}");
    }
}
