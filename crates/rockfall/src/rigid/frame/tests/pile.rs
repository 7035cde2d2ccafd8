//! Large scenes: the same bits however they are computed, hubs, and more neighbours than colours.

use glam::{Quat, Vec3};

use super::scene::{DT, G, Random, Scene, close, spring_energy};
use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::{colours, detect, energy, kinetic_energy};
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
            // A block of bricks in bond: 20,000 pairs, so that all colours are done in parallel.
            let mut scene = Scene::new(0.5, 0.5);
            scene.floor();
            for k in 0..8000 {
                let (layer, row, place) = (k / 400, k / 20 % 20, k % 20);
                let shift = 0.5 * (layer % 2) as f32;
                let at = Vec3::new(place as f32 + shift, layer as f32 + 0.52, row as f32 + shift);
                scene.cuboid(Vec3::splat(0.499), at);
            }
            scene.run(0.15);
            assert!(scene.last.contacts > 50_000);
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

/// The order in which the broad phase finds pairs does not matter.
#[test]
fn order_of_pairs_changes_no_bit() {
    let mut scene = heap(200, 0.0);
    // Two pairs in each block with the world.
    scene.floor();
    scene.run(1.5);
    let bodies = Bodies::load(&scene.world, DT);
    let blocks = |turn: usize| {
        let mut found = detect::manifolds(&scene.world, &bodies, None);
        assert!(found.len() > 200);
        if turn > 0 {
            found.reverse();
        }
        let middle = turn % found.len();
        found.rotate_left(middle);
        let mut contacts = detect::blocks(&scene.world, &bodies, found, DT);
        scene.world.history.recall(&mut contacts, &bodies, DT / 4.0);
        colours::colour(&mut contacts, &bodies, &scene.world.history);
        (contacts.blocks, contacts.pairs, contacts.points, contacts.impulses)
    };
    let first = blocks(0);
    assert!(first == blocks(17) && first == blocks(101));
}

/// A plate on 400 balls has more blocks than a body may have colours.
fn plate(restitution: f32, above: f32) -> (Scene, usize) {
    let mut scene = Scene::new(0.5, restitution);
    scene.floor();
    for k in 0..400 {
        scene.ball(0.25, Vec3::new(0.6 * (k % 20) as f32 - 5.7, 0.25, 0.6 * (k / 20) as f32 - 5.7));
    }
    let half = Vec3::new(6.5, 0.25, 6.5);
    let pose = Pose::new(Vec3::new(0.0, 0.75 + above, 0.0), Quat::IDENTITY);
    let plate = scene.body(Shape::cuboid(half), pose, 200.0);
    (scene, plate)
}

/// Problem 47.
#[test]
fn plate_rests_on_many_balls() {
    let (mut scene, plate) = plate(0.0, 0.0);
    scene.run(3.0);
    let sink = 0.75 - scene.at(plate).y;
    let turn = scene.world.bodies[plate].pose.turn;
    assert!(sink > 0.0 && sink < 1e-3, "{sink}");
    close(2.0 * turn.x.hypot(turn.z), 0.0, 1e-4);
    assert!(kinetic_energy(&scene.world) < 1e-6, "{}", kinetic_energy(&scene.world));
}

/// Problem 47: the plate falls by 0.2 and bounces.
#[test]
fn plate_bounces_on_many_balls() {
    let (mut scene, plate) = plate(0.5, 0.2);
    let mut before = energy(&scene.world);
    let (start, mut springs) = (before, spring_energy(&scene));
    for _ in 0..240 {
        scene.step();
        let (now, springs_now) = (energy(&scene.world), spring_energy(&scene));
        let rise = now - before;
        assert!(rise < 3e-4 * start, "{}", rise / start);
        assert!(rise < 1e-5 * start || rise < springs - springs_now, "{rise} while springs lose {}", springs - springs_now);
        (before, springs) = (now, springs_now);
    }
    close(scene.at(plate).y, 0.75, 1e-3);
    assert!(kinetic_energy(&scene.world) < 1e-6, "{}", kinetic_energy(&scene.world));
}

/// Problem 51: a heavy ball into a wall of 12 rows touches more bodies than there are colours.
#[test]
fn heavy_ball_breaks_a_wall() {
    for (substeps, deepest) in [(4, 0.35), (8, 0.2)] {
        let mut scene = Scene::new(0.5, 0.0).substeps(substeps);
        scene.floor();
        for k in 0..120 {
            let (row, place) = (k / 10, k % 10);
            let x = place as f32 + 0.5 * (row % 2) as f32 - 5.0;
            scene.cuboid(Vec3::new(0.5, 0.25, 0.25), Vec3::new(x, 0.5 * row as f32 + 0.25, 0.0));
        }
        let ball = scene.body(Shape::ball(2.5), Pose::new(Vec3::new(0.0, 3.2, 3.2), Quat::IDENTITY), 200.0);
        scene.throw(ball, Vec3::new(0.0, 0.0, -10.0), Vec3::ZERO);
        let start = energy(&scene.world);
        let (mut before, mut overlap, mut most) = (start, 0.0, 0);
        // Later it climbs over bricks that lie between it and the floor.
        for _ in 0..24 {
            scene.step();
            most = most.max(scene.world.history.left_over());
            // Overlaps are pushed out against at most the weight of all bodies.
            let rise = energy(&scene.world) - before;
            assert!(rise <= 320.0 * f64::from(G) * overlap + 1e-4 * start, "{rise} {overlap}");
            overlap = f64::from(scene.last.max_overlap);
            assert!(scene.last.max_overlap < deepest, "{}", scene.last.max_overlap);
            before = energy(&scene.world);
        }
        assert!(most > 8, "{most} left-over blocks");
    }
}
