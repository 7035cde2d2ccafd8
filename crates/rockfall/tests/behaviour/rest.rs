//! Piles, the cradle, and things that lie still.

use rockfall::glam::Vec3;
use rockfall::{Backend, Capsule, Cuboid, Rod, Scene, Simulation, Sphere};

use crate::common::*;

/// Half the inner width of the walled box.
const HALF: f32 = 3.0;
const RADIUS: f32 = 0.25;

/// A box open at the top: a floor and four walls, 1 thick.
fn walled(scene: &mut Scene, half: f32) {
    let (outer, top) = (half + 1.0, 12.0);
    for (min, max) in [
        ([-outer, -1.0, -outer], [outer, 0.0, outer]),
        ([-outer, 0.0, -outer], [-half, top, outer]),
        ([half, 0.0, -outer], [outer, top, outer]),
        ([-half, 0.0, -outer], [half, top, -half]),
        ([-half, 0.0, half], [half, top, outer]),
    ] {
        scene.add_box(Cuboid::between(min, max)).expect("a valid box");
    }
}

/// Layers of `side` x `side` spheres, a little out of line, that fall into the walled box.
fn pile(count: usize, side: usize, gravity: f32) -> Scene {
    let mut scene = with(|settings| settings.gravity = gravity);
    let half = HALF * side as f32 / 10.0;
    walled(&mut scene, half);
    for number in 0..count {
        let (column, layer) = (number % (side * side), number / (side * side));
        let cell = Vec3::new((column % side) as f32, layer as f32, (column / side) as f32);
        let jitter = Vec3::new((number as f32 * 1.3).sin(), 0.0, (number as f32 * 2.1).cos());
        let corner = Vec3::new(0.3 - half, 0.3, 0.3 - half);
        scene
            .add_sphere(Sphere::new(corner + 0.58 * cell + 0.02 * jitter, RADIUS))
            .expect("a valid sphere");
    }
    scene
}

/// Comes to rest: in the mean a sphere's kinetic energy is a millionth of what it loses by falling through its diameter. None escapes:
/// every centre lies between the walls, and above the floor but for what it is pressed into it.
fn comes_to_rest(gravity: f32, backend: Backend) {
    let (count, side, steps) = on(backend, (1000, 10, 1500), (150, 5, 300));
    let half = HALF * side as f32 / 10.0;
    let mut simulation = simulation(pile(count, side, gravity), backend);
    simulation.run(steps, 0.02).expect("steps");
    let spheres = simulation.spheres().expect("spheres are read back");
    for (index, sphere) in spheres.iter().enumerate() {
        let place = sphere.position;
        let inside = place.x.abs() < half && place.z.abs() < half && (0.0..12.0).contains(&place.y);
        assert!(inside, "sphere {index} escaped: {place}");
    }
    let kinetic = simulation.energy().expect("energies").kinetic / count as f64;
    let scale = f64::from(gravity) * 2.0 * f64::from(RADIUS);
    eprintln!("pile at gravity {gravity}: {kinetic:e} a sphere of {scale}");
    assert!(kinetic < 1e-4 * scale, "kinetic energy a sphere: {kinetic:e}, scale {scale}");
    let mean_height = spheres.iter().map(|sphere| sphere.position.y).sum::<f32>() / count as f32;
    assert!(mean_height < 3.0, "it must have fallen: {mean_height}");
}

fn pile_comes_to_rest_at_gravity_1(backend: Backend) {
    comes_to_rest(1.0, backend);
}

fn pile_comes_to_rest_at_gravity_10(backend: Backend) {
    comes_to_rest(10.0, backend);
}

/// Five touching balls of radius 0.1 on rods of length 2, the first one drawn aside by 0.4 rad.
fn cradle() -> Scene {
    let mut scene = with(|settings| (settings.gravity, settings.restitution) = (10.0, 1.0));
    for number in 0..5 {
        let anchor = Vec3::new(0.2 * number as f32, 2.0, 0.0);
        let (sin, cos) = if number == 0 { 0.4_f32.sin_cos() } else { (0.0, 1.0) };
        let ends = [
            Sphere::new(anchor, 0.05).fixed(),
            Sphere::new(anchor - 2.0 * Vec3::new(sin, cos, 0.0), 0.1),
        ];
        dumbbell(&mut scene, ends, 0.01);
    }
    scene
}

/// Where the five balls are, seen from where they hang at rest.
fn swings(simulation: &mut Simulation) -> Vec<f32> {
    let spheres = simulation.spheres().expect("spheres are read back");
    (0..5)
        .map(|ball| spheres[2 * ball + 1].position.x - 0.2 * ball as f32)
        .collect()
}

/// The first ball arrives after a quarter of the period 2 pi sqrt(l/G) = 2.81 s, the last one is farthest out after half of it, 1.405 s
/// or 70 steps: as far as the first one was, 2 sin 0.4 = 0.779. It takes 4 steps more to go through the four contacts.
fn cradle_passes_the_swing_on(backend: Backend) {
    let mut simulation = simulation(cradle(), backend);
    let mut farthest = [0.0_f32; 5];
    simulation.run(48, 0.02).expect("steps");
    for _ in 0..16 {
        simulation.run(2, 0.02).expect("steps");
        for (farthest, swing) in farthest.iter_mut().zip(swings(&mut simulation)) {
            *farthest = farthest.max(swing.abs());
        }
    }
    eprintln!("cradle: {farthest:?}");
    assert!(farthest[4] > 0.9 * 0.779, "the last one must leave: {farthest:?}");
    for still in &farthest[..4] {
        assert!(*still < 0.1 * 0.779, "the others must stay nearly still: {farthest:?}");
    }
}

/// Runs for a while and asserts that nothing has moved: neither by more than it sinks in until it is held, nor still moving.
#[track_caller]
fn lies_still(scene: Scene, backend: Backend) {
    let before = scene.spheres().to_vec();
    let mut simulation = simulation(scene, backend);
    simulation.run(on(backend, 500, 100), 0.02).expect("steps");
    for (old, new) in before.iter().zip(simulation.spheres().expect("spheres are read back")) {
        let moved = new.position.distance(old.position);
        // G/Cc = 0.01 with all the weight on the contacts at the ends; a little more where a rod is borne off its ends.
        assert!(moved < 0.03, "moved by {moved}");
        assert!(new.velocity.length() < 1e-3, "still moves: {}", new.velocity);
    }
}

fn capsule_lies_still_on_a_floor(backend: Backend) {
    for floor in [floor_box, floor_polygon] {
        let mut scene = with(|settings| settings.gravity = 10.0);
        floor(&mut scene);
        let capsule = Capsule::new([-1.0, 0.3, 0.2], [1.0, 0.3, -0.3], 0.3);
        scene.add_capsule(capsule).expect("a valid capsule");
        lies_still(scene, backend);
    }
}

/// A rod whose end spheres are as thick as it, of free length, and one on its edges only.
fn rod_lies_still_on_a_floor(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    floor_box(&mut scene);
    rod(
        &mut scene,
        [[-1.0, 0.3, 0.2], [1.0, 0.3, -0.3]].map(|end| Sphere::new(end, 0.3)),
        0.3,
    );
    lies_still(scene, backend);
}

/// A narrow box, from -1 to 1, whose upper face is y = 0.
fn beam(scene: &mut Scene) {
    scene
        .add_box(Cuboid::between([-1.0, -1.0, -3.0], [1.0, 0.0, 3.0]))
        .expect("a valid box");
}

fn capsule_lies_still_across_a_box(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    beam(&mut scene);
    scene
        .add_capsule(Capsule::new([-2.0, 0.3, 0.0], [2.0, 0.3, 0.0], 0.3))
        .expect("a valid capsule");
    lies_still(scene, backend);
}

fn rod_lies_still_across_a_box(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    beam(&mut scene);
    let ends = spheres(&mut scene, [-1.5, 1.5].map(|x| Sphere::new([x, 0.3, 0.0], 0.2)));
    scene
        .add_rod(Rod::new(ends[0], ends[1], 0.3).length(3.0))
        .expect("a valid rod");
    lies_still(scene, backend);
}

both!(
    pile_comes_to_rest_at_gravity_1,
    pile_comes_to_rest_at_gravity_10,
    cradle_passes_the_swing_on,
    capsule_lies_still_on_a_floor,
    rod_lies_still_on_a_floor,
    capsule_lies_still_across_a_box,
    rod_lies_still_across_a_box,
);
