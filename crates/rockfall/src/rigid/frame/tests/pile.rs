//! Large scenes: the same bits however they are computed, hubs, and more neighbours than colours.

use glam::{Quat, Vec3};

use super::scene::{Random, Scene, close};
use crate::rigid::frame::{energy, kinetic_energy};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;

/// Boxes in a heap, without overlap at the start.
pub(super) fn heap(count: usize, restitution: f32) -> Scene {
    let mut scene = Scene::new(0.5, restitution);
    scene.floor();
    let mut random = Random(5);
    let side = (count as f32).cbrt().ceil() as usize;
    for k in 0..count {
        let cell = Vec3::new((k % side) as f32, (k / (side * side)) as f32, (k / side % side) as f32);
        let at = 1.75 * (cell - 0.5 * Vec3::new(side as f32, 0.0, side as f32)) + Vec3::Y;
        scene.body(Shape::cuboid(Vec3::splat(0.5)), Pose::new(at, Quat::from_scaled_axis(random.vector())), 1.0);
    }
    scene
}

fn bits(scene: &Scene) -> Vec<u32> {
    let numbers = |body: &crate::rigid::world::Body| {
        let (pose, v, l) = (body.pose, body.velocity, body.momentum);
        [pose.position, v, l].map(|vector| vector.to_array()).concat().into_iter().chain(pose.turn.to_array())
    };
    scene.world.bodies.iter().flat_map(numbers).map(f32::to_bits).collect()
}

#[test]
fn threads_change_no_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut scene = heap(4096, 0.5);
            scene.run(0.5);
            bits(&scene)
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(3));
}

#[test]
fn split_runs_change_no_bit() {
    let mut whole = heap(100, 0.5);
    whole.run(2.0);
    let mut first = heap(100, 0.5);
    first.run(1.0);
    let mut second = Scene::new(0.5, 0.5);
    second.world = first.world.clone();
    second.run(1.0);
    assert!(bits(&whole) == bits(&second));
}
