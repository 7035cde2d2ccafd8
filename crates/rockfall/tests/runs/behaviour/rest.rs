//! Piles, a Newton's cradle, and bodies that lie still.

use std::f64::consts::PI;

use rockfall::glam::Vec3;
use rockfall::{Backend, Capsule, Cuboid, Rod, Scene, Sphere};

use crate::common::*;

/// Half the inner width of the walled box.
const HALF: f32 = 3.0;
const RADIUS: f32 = 0.25;

/// Adds a box that is open at the top: a floor and four walls of thickness 1.
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

/// Layers of `side` x `side` spheres, with small displacements, that fall into the walled box.
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

/// Asserts that a pile comes to rest: the mean kinetic energy of a sphere is less than a thousandth of the energy that
/// it gains by falling through its own diameter. It need not be 0, because friction vanishes near rest, so a sphere
/// still rearranges now and then. The pile takes longer to come to rest where gravity is weak. No sphere escapes: every
/// centre lies between the walls and above the floor.
fn assert_pile_comes_to_rest(gravity: f32, backend: Backend) {
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
    assert!(kinetic < 1e-3 * scale, "kinetic energy per sphere: {kinetic:e}, scale {scale}");
    // The pile has settled: a pile of height h over an area A has the packing fraction V/(A h), and its mean height is
    // h/2. Random packings have 0.55 to 0.64, and less near walls. With gravity 10 a dozen layers press on the lowest
    // spheres, which then overlap by 12 m G / (Cc m*) = 0.24.
    let mean_height = spheres.iter().map(|sphere| f64::from(sphere.position.y)).sum::<f64>() / count as f64;
    let volume = count as f64 * 4.0 / 3.0 * PI * f64::from(RADIUS).powi(3);
    let filled = volume / (f64::from(4.0 * half * half) * 2.0 * mean_height);
    assert!((0.4..1.0).contains(&filled), "packing fraction {filled}");
}

fn a_pile_comes_to_rest_at_gravity_1(backend: Backend) {
    assert_pile_comes_to_rest(1.0, backend);
}

fn a_pile_comes_to_rest_at_gravity_10(backend: Backend) {
    assert_pile_comes_to_rest(10.0, backend);
}

/// A Newton's cradle: five balls of radius 0.1, `gap` apart, on rods of length 2. The first one starts at 0.4 rad.
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

/// Largest distance of each ball from its position at rest, after the first ball has arrived. It arrives after a
/// quarter of the period 2 pi sqrt(l/G) = 2.81 s. The last ball is at its farthest point after half of the period,
/// 1.405 s or 70 steps, plus or minus the steps that the impulse needs to pass four contacts.
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

/// The last ball goes as far as the first one started, 2 sin 0.4 = 0.779, and the others stay nearly still. This holds
/// with a small gap between the balls, and also where they touch, so that only rounding decides whether they overlap.
fn a_cradle_passes_the_swing_to_the_last_ball(backend: Backend) {
    for (gap, last, others) in [(5e-4, 0.98..1.02, 0.05), (0.0, 0.98..1.02, 0.05)] {
        let swings = swings(gap, backend).map(|swing| swing / 0.779);
        assert!(last.contains(&swings[4]), "the last one must leave, gap {gap}: {swings:?}");
        for still in &swings[..4] {
            assert!(*still < others, "the others must stay nearly still, gap {gap}: {swings:?}");
        }
    }
}

/// Runs a scene and asserts that nothing moves any more, and that nothing has moved farther than the overlap at rest.
#[track_caller]
fn assert_lies_still(scene: Scene, backend: Backend) {
    let before = scene.spheres().to_vec();
    let mut simulation = simulation(scene, backend);
    simulation.run(on(backend, 500, 100), 0.02).expect("steps");
    for (old, new) in before.iter().zip(simulation.spheres().expect("spheres are read back")) {
        let moved = new.position.distance(old.position);
        // G/Cc = 0.01 when the contacts at the ends carry the whole weight, and slightly more where a rod is supported
        // between its ends.
        assert!(moved < 0.03, "moved by {moved}");
        assert!(new.velocity.length() < 1e-3, "still moves: {}", new.velocity);
    }
}

fn a_capsule_lies_still_on_a_floor(backend: Backend) {
    for floor in [floor_box, floor_polygon] {
        let mut scene = with(|settings| settings.gravity = 10.0);
        floor(&mut scene);
        let capsule = Capsule::new([-1.0, 0.3, 0.2], [1.0, 0.3, -0.3], 0.3);
        scene.add_capsule(capsule).expect("a valid capsule");
        assert_lies_still(scene, backend);
    }
}

/// A rod of free length whose end spheres have its radius.
fn a_rod_lies_still_on_a_floor(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    floor_box(&mut scene);
    rod(&mut scene, [[-1.0, 0.3, 0.2], [1.0, 0.3, -0.3]].map(|end| Sphere::new(end, 0.3)), 0.3);
    assert_lies_still(scene, backend);
}

/// Adds a narrow box, from -1 to 1 along x, whose upper face is y = 0.
fn beam(scene: &mut Scene) {
    scene.add_box(Cuboid::between([-1.0, -1.0, -3.0], [1.0, 0.0, 3.0])).expect("a valid box");
}

fn a_capsule_lies_still_across_a_box(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    beam(&mut scene);
    scene.add_capsule(Capsule::new([-2.0, 0.3, 0.0], [2.0, 0.3, 0.0], 0.3)).expect("a valid capsule");
    assert_lies_still(scene, backend);
}

fn a_rod_lies_still_across_a_box(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 10.0);
    beam(&mut scene);
    let ends = spheres(&mut scene, [-1.5, 1.5].map(|x| Sphere::new([x, 0.3, 0.0], 0.2)));
    scene.add_rod(Rod::new(ends[0], ends[1], 0.3).length(3.0)).expect("a valid rod");
    assert_lies_still(scene, backend);
}

both!(
    a_pile_comes_to_rest_at_gravity_1,
    a_pile_comes_to_rest_at_gravity_10,
    a_cradle_passes_the_swing_to_the_last_ball,
    a_capsule_lies_still_on_a_floor,
    a_rod_lies_still_on_a_floor,
    a_capsule_lies_still_across_a_box,
    a_rod_lies_still_across_a_box,
);
