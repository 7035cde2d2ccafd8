//! Problems of the colours: few of them, kept ones, and many blocks.

use glam::Vec3;

use super::scene::{DT, Scene};
use crate::rigid::common::LEFT_OVER;
use crate::rigid::frame::{Frame, colours, kinetic_energy};
use crate::rigid::history::History;
use crate::rigid::world::RigidWorld;

/// A frame in which only the first `most` colours are given.
fn advance_with(world: &mut RigidWorld, most: u8) -> usize {
    let mut frame = Frame::open(world, DT, 4);
    colours::cap(&mut frame.contacts, &frame.bodies, most);
    frame.refresh();
    (0..4).for_each(|_| frame.substep());
    let Frame { bodies, contacts, h, .. } = frame;
    bodies.store(&mut world.bodies);
    world.history = History::new(&contacts, h);
    world.history.left_over()
}

/// Bricks 1 x 0.5 x 0.5 in bond, with half ones at the ends of every second row.
fn wall(rows: usize) -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    for row in 0..rows {
        let y = 0.5 * row as f32 + 0.25;
        if row % 2 == 0 {
            (0..8).for_each(|k| _ = scene.cuboid(Vec3::new(0.5, 0.25, 0.25), Vec3::new(k as f32, y, 0.0)));
            continue;
        }
        (1..8).for_each(|k| _ = scene.cuboid(Vec3::new(0.5, 0.25, 0.25), Vec3::new(k as f32 - 0.5, y, 0.0)));
        [-0.25, 7.25].into_iter().for_each(|x| _ = scene.cuboid(Vec3::new(0.25, 0.25, 0.25), Vec3::new(x, y, 0.0)));
    }
    scene
}

/// Problem 37: with four colours a part of the blocks is left over, and the wall stands.
#[test]
fn wall_stands_with_four_colours() {
    let mut scene = wall(16);
    let start: Vec<Vec3> = scene.world.bodies.iter().map(|body| body.pose.position).collect();
    let mut most = 0;
    for _ in 0..360 {
        most = most.max(advance_with(&mut scene.world, 4));
    }
    let ends = scene.world.bodies.iter().map(|body| body.pose.position);
    let moved = start.iter().zip(ends).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
    assert!(most > 20, "{most} left-over blocks");
    assert!(moved < 0.03 && kinetic_energy(&scene.world) < 1e-3, "{moved} {}", kinetic_energy(&scene.world));
}

/// Problem 37: a heap with four colours comes to rest.
#[test]
fn heap_comes_to_rest_with_four_colours() {
    let mut scene = super::pile::heap(60, 0.0);
    for _ in 0..600 {
        advance_with(&mut scene.world, 4);
    }
    assert!(kinetic_energy(&scene.world) < 1e-3, "{}", kinetic_energy(&scene.world));
    assert!(scene.world.bodies[1..].iter().all(|body| body.pose.position.y > 0.2));
}

/// Bricks in bond, `count` along each axis.
pub(super) fn bond(count: usize) -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    for k in 0..count * count * count {
        let (layer, row, place) = (k / (count * count), k / count % count, k % count);
        let shift = 0.5 * (layer % 2) as f32;
        scene.cuboid(Vec3::splat(0.5), Vec3::new(place as f32 + shift, layer as f32 + 0.5, row as f32 + shift));
    }
    scene
}

/// Problem 52: the first frame gives all blocks of 64,000 bricks a colour or leaves them over, and no body has two of one colour.
#[test]
fn first_frame_colours_a_great_block() {
    let scene = bond(40);
    let frame = Frame::open(&scene.world, DT, 4);
    let mut taken: Vec<(u32, u8)> = Vec::new();
    let mut left_over = 0;
    for block in &frame.contacts.blocks {
        if block.colour == LEFT_OVER {
            left_over += 1;
            continue;
        }
        taken.extend(block.bodies.iter().filter(|body| **body > 0).map(|body| (*body, block.colour)));
    }
    let count = taken.len();
    taken.sort_unstable();
    taken.dedup();
    assert!(taken.len() == count, "two blocks of one body share a colour");
    assert!(frame.contacts.blocks.len() > 200_000 && left_over * 100 < frame.contacts.blocks.len(), "{left_over} left over");
}

/// Problem 52: the sink after 60 frames does not depend on whether the colours were loaded.
#[test]
fn loaded_colours_do_not_change_the_sink() {
    let mut own = bond(10);
    own.run(1.0);
    let mut loaded = bond(10);
    loaded.world.history = History { colours: own.world.history.colours.clone(), ..History::default() };
    loaded.run(1.0);
    let [one, two] = [&own, &loaded].map(|scene| {
        let top = &scene.world.bodies[901..];
        9.5 - top.iter().map(|body| body.pose.position.y).sum::<f32>() / 100.0
    });
    assert!((one / two - 1.0).abs() < 0.02, "{one} {two}");
}
