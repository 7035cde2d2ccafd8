//! Piles, the cradle, and things that lie still.

use std::f64::consts::PI;

use rockfall::glam::Vec3;
use rockfall::{Backend, Capsule, Cuboid, Rod, Scene, Sphere};

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
        scene.add_sphere(Sphere::new(corner + 0.58 * cell + 0.02 * jitter, RADIUS)).expect("a valid sphere");
    }
    scene
}

/// Comes to rest: in the mean a sphere's kinetic energy is less than a thousandth of what it gains by falling through
/// its own diameter (friction falls off near rest, so that now and then one finds a better place). It takes longer
/// where gravity is weak. None escapes: every centre lies between the walls and above the floor.
fn comes_to_rest(gravity: f32, backend: Backend) {
    let (count, side) = on(backend, (1000, 10), (150, 5));
    let steps = if gravity < 10.0 { on(backend, 1200, 900) } else { on(backend, 1200, 500) };
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
    assert!(kinetic < 1e-3 * scale, "kinetic energy a sphere: {kinetic:e}, scale {scale}");
    // It has fallen together: a pile of height h over an area A is filled to V/(A h), and its mean height is h/2.
    // Random packings are filled to 0.55..0.64, looser at walls; with gravity 10 a dozen layers press the lowest by 12
    // m G / (Cc m*) = 0.24 into each other.
    let mean_height = spheres.iter().map(|sphere| f64::from(sphere.position.y)).sum::<f64>() / count as f64;
    let volume = count as f64 * 4.0 / 3.0 * PI * f64::from(RADIUS).powi(3);
    let filled = volume / (f64::from(4.0 * half * half) * 2.0 * mean_height);
    assert!((0.4..1.0).contains(&filled), "filled to {filled}");
}

fn pile_comes_to_rest_at_gravity_1(backend: Backend) {
    comes_to_rest(1.0, backend);
}

fn pile_comes_to_rest_at_gravity_10(backend: Backend) {
    comes_to_rest(10.0, backend);
}

/// Five balls of radius 0.1, `gap` apart, on rods of length 2, the first one drawn aside by 0.4 rad.
fn cradle(gap: f32) -> Scene {
    let mut scene = with(|settings| (settings.gravity, settings.restitution) = (10.0, 1.0));
    for number in 0..5 {
        let anchor = Vec3::new((0.2 + gap) * number as f32, 2.0, 0.0);
        let (sin, cos) = if number == 0 { 0.4_f32.sin_cos() } else { (0.0, 1.0) };
        let ends = [Sphere::new(anchor, 0.05).fixed(), Sphere::new(anchor - 2.0 * Vec3::new(sin, cos, 0.0), 0.1)];
        dumbbell(&mut scene, ends, 0.01);
    }
    scene
}

/// How far each ball goes from where it hangs at rest, once the first one has arrived. It arrives after a quarter of
/// the period 2 pi sqrt(l/G) = 2.81 s, and the last one is farthest out after half of it, 1.405 s or 70 steps, give or
/// take those that it takes to go through four contacts.
fn swings(gap: f32, backend: Backend) -> [f32; 5] {
    let mut simulation = simulation(cradle(gap), backend);
    simulation.run(48, 0.02).expect("steps");
    let mut farthest = [0.0_f32; 5];
    for _ in 0..16 {
        simulation.run(2, 0.02).expect("steps");
        let spheres = simulation.spheres().expect("spheres are read back");
        for (ball, farthest) in farthest.iter_mut().enumerate() {
            let [anchor, ball] = [2 * ball, 2 * ball + 1].map(|index| spheres[index].position.x);
            *farthest = farthest.max((ball - anchor).abs());
        }
    }
    farthest
}

/// The last ball goes as far as the first one was, 2 sin 0.4 = 0.779, and the others stay nearly still: a hair's breadth
/// apart, and where they touch, so that rounding alone decides whether they overlap.
fn cradle_passes_the_swing_on(backend: Backend) {
    for (gap, last, others) in [(5e-4, 0.98..1.02, 0.05), (0.0, 0.98..1.02, 0.05)] {
        let swings = swings(gap, backend).map(|swing| swing / 0.779);
        assert!(last.contains(&swings[4]), "the last one must leave, gap {gap}: {swings:?}");
        for still in &swings[..4] {
            assert!(*still < others, "the others must stay nearly still, gap {gap}: {swings:?}");
        }
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
    rod(&mut scene, [[-1.0, 0.3, 0.2], [1.0, 0.3, -0.3]].map(|end| Sphere::new(end, 0.3)), 0.3);
    lies_still(scene, backend);
}

/// A narrow box, from -1 to 1, whose upper face is y = 0.
fn beam(scene: &mut Scene) {
    scene.add_box(Cuboid::between([-1.0, -1.0, -3.0], [1.0, 0.0, 3.0])).expect("a valid box");
}

fn capsule_lies_still_across_a_box(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    beam(&mut scene);
    scene.add_capsule(Capsule::new([-2.0, 0.3, 0.0], [2.0, 0.3, 0.0], 0.3)).expect("a valid capsule");
    lies_still(scene, backend);
}

fn rod_lies_still_across_a_box(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    beam(&mut scene);
    let ends = spheres(&mut scene, [-1.5, 1.5].map(|x| Sphere::new([x, 0.3, 0.0], 0.2)));
    scene.add_rod(Rod::new(ends[0], ends[1], 0.3).length(3.0)).expect("a valid rod");
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
