//! A scene with every kind of object, and bitwise comparison of runs.

use rockfall::glam::Vec3;
use rockfall::{Capsule, Cuboid, Polygon, Report, Rod, Scene, Simulation, Sphere, SphereId, SphereState, Spring, Tether};

use super::{floor_box, spheres, with};

/// Builds a scene in which every kind of object falls into a walled area: loose spheres, a chain on a fixed sphere,
/// capsules, a triangle of springs and a tether. So there are collisions, contacts, contacts of rods with every kind of
/// object, and fixed lengths to restore.
pub(crate) fn mixed(balls: usize) -> Scene {
    let mut scene = with(|settings| settings.gravity = 10.0);
    floor_box(&mut scene);
    for (corner, left, right) in [
        ([-1.5, 0.0, -1.5], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]),
        ([1.5, 0.0, -1.5], [0.0, 0.0, 3.0], [0.0, 4.0, 0.0]),
        ([-1.5, 0.0, -1.5], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]),
    ] {
        scene.add_polygon(Polygon::new(corner, left, right)).expect("a valid polygon");
    }
    scene.add_box(Cuboid::between([-1.5, 0.0, 1.5], [1.5, 4.0, 2.5])).expect("a valid box");
    for ball in 0..balls {
        let (column, layer) = (ball % 16, ball / 16);
        let place = Vec3::new((column % 4) as f32 * 0.6, layer as f32 * 0.52, (column / 4) as f32 * 0.6);
        let jitter = 0.05 * Vec3::new((ball as f32).sin(), 0.0, (ball as f32 * 1.7).cos());
        let radius = 0.2 + 0.05 * (ball as f32 * 0.9).sin();
        let ball = Sphere::new(place + jitter + Vec3::new(-0.9, 0.3, -0.9), radius).mass(1.0 + layer as f32);
        scene.add_sphere(ball.velocity([0.0, -2.0, 0.0])).expect("a valid sphere");
    }
    let top = 0.5 + 0.52 * balls.div_ceil(16) as f32;
    add_chain(&mut scene, top);
    add_triangle(&mut scene, top + 0.6);
    for (x, z) in [(-0.8, -0.6), (0.3, 0.7), (0.9, -0.9)] {
        let end = Vec3::new(x, top + 1.2, z);
        let capsule = Capsule::new(end, end + Vec3::new(0.4, 0.2, -0.3), 0.15).velocity([0.0, -3.0, 0.0]);
        scene.add_capsule(capsule).expect("a valid capsule");
    }
    scene
}

/// Adds a chain of five rods that hangs on a fixed sphere, through the middle of the walled area.
fn add_chain(scene: &mut Scene, height: f32) {
    let links: Vec<SphereId> = (0..6)
        .map(|link| {
            let mut sphere = Sphere::new([-1.2 + 0.4 * link as f32, height, 0.1], 0.1);
            sphere.fixed = link == 0;
            scene.add_sphere(sphere).expect("a valid sphere")
        })
        .collect();
    for pair in links.windows(2) {
        scene.add_rod(Rod::new(pair[0], pair[1], 0.05).length(0.4)).expect("a valid rod");
    }
}

/// Adds three spheres with three springs between them. One side is also a rod of free length, and one corner has a
/// tether.
fn add_triangle(scene: &mut Scene, height: f32) {
    let corners = [[0.0, height, 0.0], [0.6, height, 0.0], [0.3, height, 0.5]].map(|corner| Sphere::new(corner, 0.12));
    let corners = spheres(scene, corners);
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        let spring = Spring::new(corners[a], corners[b], 200.0, 0.6).damping(1.0);
        scene.add_spring(spring).expect("a valid spring");
    }
    scene.add_rod(Rod::new(corners[0], corners[1], 0.1)).expect("a valid rod");
    let tether = Tether::new(corners[2], [0.0, height + 0.5, 0.0], 20.0);
    scene.add_tether(tether).expect("a valid tether");
}

/// Final state of a run.
pub(crate) struct Run {
    pub(crate) spheres: Vec<SphereState>,
    pub(crate) report: Report,
}

impl Run {
    pub(crate) fn of(simulation: &mut Simulation) -> Self {
        Self { spheres: simulation.spheres().expect("spheres are read back"), report: simulation.report() }
    }
}

/// Asserts that two runs are bitwise identical. `==` on floats would accept 0 for -0 and fail for equal NaNs.
#[track_caller]
pub(crate) fn assert_bitwise_identical(one: &Run, other: &Run) {
    let bits = |run: &Run| -> Vec<Vec<u32>> {
        let of = |sphere: &SphereState| {
            let vectors = [sphere.position, sphere.velocity, sphere.angular_momentum];
            let numbers = vectors.iter().flat_map(Vec3::to_array).chain(sphere.orientation.to_array());
            numbers.map(f32::to_bits).collect()
        };
        run.spheres.iter().map(of).collect()
    };
    let (one_bits, other_bits) = (bits(one), bits(other));
    let differing: Vec<usize> = (0..one_bits.len()).filter(|&at| one_bits[at] != other_bits[at]).collect();
    assert!(differing.is_empty() && one_bits.len() == other_bits.len(), "spheres {differing:?} differ");
    let counts = |run: &Run| (run.report.contacts, run.report.max_overlap.to_bits(), run.report.total_collisions);
    assert_eq!(counts(one), counts(other));
}
