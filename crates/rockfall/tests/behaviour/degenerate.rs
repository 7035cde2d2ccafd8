//! Degenerate input: no NaN, and the push-out direction that is documented.
//!
//! Where two bodies have no distance the normal from A (the one added first; spheres before rods before boxes before
//! polygons) to B is (0, 1, 0), for rods that cross their common normal A x B, at a box edge or vertex the outward
//! direction reversed.

use rockfall::glam::Vec3;
use rockfall::{Backend, Cuboid, Polygon, Rod, Scene, Sphere, Spring, Tether};

use crate::common::*;

/// Forces of the order of 1000 over dt = 1/64 from velocities of the order of 16, which round by 1e-6.
const FORCE: f64 = 1e-2;

/// The loads of a scene at its start, after having seen that it stays finite for some steps, with collisions and without.
fn harmless_loads(scene: Scene, backend: Backend) -> Vec<Load> {
    for collisions in [true, false] {
        let mut scene = scene.clone();
        scene.settings.collisions = collisions;
        let mut simulation = simulation(scene, backend);
        let report = simulation.run(5, 0.02).expect("steps without an error");
        assert_eq!(report.non_finite, 0);
        for sphere in simulation.spheres().expect("spheres are read back") {
            let finite = sphere.position.is_finite() && sphere.velocity.is_finite() && sphere.orientation.is_finite();
            assert!(finite, "{sphere:?}");
        }
    }
    loads(scene, backend)
}

fn smooth() -> Scene {
    with(|settings| (settings.gravity, settings.friction) = (0.0, 0.0))
}

/// o = 1, m* = 1/2: 500, A down, B up.
fn coincident_centres(backend: Backend) {
    let mut scene = smooth();
    spheres(&mut scene, [Sphere::new([1.0, 2.0, 3.0], 0.5); 2]);
    let found = harmless_loads(scene, backend);
    forces(&found, [[0.0, -500.0, 0.0], [0.0, 500.0, 0.0]], FORCE);
}

/// A ball whose centre lies on a rod's axis, at its middle: o = 0.6, m* = 1/(1 + 1/2) = 2/3: the ball goes down, the
/// rod's ends up.
fn ball_on_the_axis_of_a_rod(backend: Backend) {
    let mut scene = smooth();
    rod(&mut scene, [-1.0, 1.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1)), 0.1);
    spheres(&mut scene, [Sphere::new([0.0; 3], 0.5)]);
    let found = harmless_loads(scene, backend);
    forces(&found, [[0.0, 200.0, 0.0], [0.0, 200.0, 0.0], [0.0, -400.0, 0.0]], FORCE);
}

/// Rods whose axes cross: along x and z, so that A x B = -y is the normal from A to B: o = 0.2, m* = 1, A goes up.
fn rods_whose_axes_cross(backend: Backend) {
    let mut scene = smooth();
    rod(&mut scene, [-1.0, 1.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1)), 0.1);
    rod(&mut scene, [-1.0, 1.0].map(|z| Sphere::new([0.0, 0.0, z], 0.1)), 0.1);
    let found = harmless_loads(scene, backend);
    let (up, down) = ([0.0, 100.0, 0.0], [0.0, -100.0, 0.0]);
    forces(&found, [up, up, down, down], FORCE);
}

/// Parallel rods at the same height, side by side: they part along the line between them. o = 0.05; A from 0 to 4, B
/// from 2 to 6: the middle of the shared stretch is a = 0.75, b = 0.25, m* = 1/(10/16 + 10/16) = 0.8: 40 shared as 1/4
/// and 3/4.
fn parallel_rods(backend: Backend) {
    let mut scene = smooth();
    rod(&mut scene, [0.0, 4.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.01)), 0.1);
    rod(&mut scene, [2.0, 6.0].map(|x| Sphere::new([x, 0.0, 0.15], 0.01)), 0.1);
    let found = harmless_loads(scene, backend);
    forces(&found, [[0.0, 0.0, -10.0], [0.0, 0.0, -30.0], [0.0, 0.0, 30.0], [0.0, 0.0, 10.0]], FORCE);
}

/// Collinear rods that overlap, o = 0.2: A goes down, B up, shared as above (160). Their ends lie on the other's axis,
/// too: an end sphere on a rod, o = 0.11, m* = 1/(1 + 10/16) = 8/13: ball down, rod up (880/13, at the middle of each).
fn collinear_rods(backend: Backend) {
    let build = |gap: f32| {
        let mut scene = smooth();
        rod(&mut scene, [0.0, 4.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.01)), 0.1);
        rod(&mut scene, [gap, gap + 4.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.01)), 0.1);
        scene
    };
    // 1/M = 1/2 at a rod's middle: m* = 2/3, 1000 * 0.11 * 2/3 = 220/3 for an end at the other's middle.
    let (shared, ends) = (160.0, 220.0 / 3.0);
    let found = harmless_loads(build(2.0), backend);
    forces(
        &found,
        [
            [0.0, -shared / 4.0 + ends / 2.0, 0.0],
            [0.0, -shared * 0.75 + ends / 2.0 - ends, 0.0],
            [0.0, shared * 0.75 + ends / 2.0 - ends, 0.0],
            [0.0, shared / 4.0 + ends / 2.0, 0.0],
        ],
        FORCE,
    );
    // Apart, with a gap between their ends, they do not meet.
    forces(&harmless_loads(build(4.5), backend), [[0.0; 3]; 4], 0.0);
}

/// A rod whose ends are at the same place has no axis and no contacts of its own; its ends have theirs. Held at a
/// length, it is opened along (0, 1, 0): end 1 goes down, end 2 up.
fn rods_without_length(backend: Backend) {
    let mut scene = smooth();
    rod(&mut scene, [Sphere::new([0.0; 3], 0.1); 2].map(|end| end.group(1)), 0.4);
    scene.add_box(Cuboid::between([-1.0; 3], [1.0, -0.2, 1.0])).expect("a valid box");
    spheres(&mut scene, [Sphere::new([0.3, 0.0, 0.0], 0.1)]);
    // The ends of a free rod meet: o = 0.2, m* = 1/2.
    let found = harmless_loads(scene, backend);
    forces(&found, [[0.0, -100.0, 0.0], [0.0, 100.0, 0.0], [0.0; 3]], FORCE);

    let mut scene = smooth();
    let [one, two] = spheres(&mut scene, [Sphere::new([0.0; 3], 0.1); 2]);
    scene.add_rod(Rod::new(one, two, 0.1).length(1.0)).expect("a valid rod");
    harmless_loads(scene.clone(), backend);
    let mut simulation = simulation(scene, backend);
    simulation.step(DT).expect("a step");
    let ends = simulation.spheres().expect("both ends");
    near(ends[0].position, [0.0, -0.5, 0.0], 1e-6, "end 1");
    near(ends[1].position, [0.0, 0.5, 0.0], 1e-6, "end 2");
}

/// A spring or tether whose ends are at the same place does nothing, whatever its rest length.
fn springs_without_length(backend: Backend) {
    let mut scene = smooth();
    let [a, b] = spheres(&mut scene, [1, 2].map(|group| Sphere::new([1.0; 3], 0.5).group(group)));
    scene.add_spring(Spring::new(a, b, 100.0, 2.0).damping(3.0)).expect("a valid spring");
    scene.add_tether(Tether::new(a, [1.0; 3], 100.0).length(2.0)).expect("a valid tether");
    forces(&harmless_loads(scene, backend), [[0.0; 3]; 2], 0.0);
}

/// The force on a resting ball (radius 0.5, mass 1) with its centre at a place in or on the box from -1 to 1.
fn in_the_box(place: [f32; 3], backend: Backend) -> Vec<Load> {
    let mut scene = smooth();
    scene.add_box(Cuboid::between([-1.0; 3], [1.0; 3])).expect("a valid box");
    spheres(&mut scene, [Sphere::new(place, 0.5)]);
    harmless_loads(scene, backend)
}

/// A centre on a face or inside leaves by the nearest face, o = r + depth; from the very middle by the first, the low
/// end of edge I. A centre on an edge leaves by the first of its two faces, on a vertex by the first of three.
fn ball_centred_on_a_box_face_or_inside(backend: Backend) {
    for (place, force) in [
        ([0.25, 1.0, 0.5], [0.0, 500.0, 0.0]),
        ([0.25, -1.0, 0.5], [0.0, -500.0, 0.0]),
        ([0.25, 0.5, -0.75], [0.0, 0.0, -750.0]),
        ([0.0, 0.0, 0.0], [-1500.0, 0.0, 0.0]),
        ([1.0, 1.0, 0.0], [500.0, 0.0, 0.0]),
        ([1.0, -1.0, 1.0], [500.0, 0.0, 0.0]),
    ] {
        forces(&in_the_box(place, backend), [force], FORCE);
    }
}

/// A centre on the plane of a polygon still belongs to its front: pushed along the face's normal, o = r.
fn ball_centred_on_a_polygon(backend: Backend) {
    let mut scene = smooth();
    let polygon = Polygon::new([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]);
    scene.add_polygon(polygon).expect("a valid polygon");
    spheres(&mut scene, [Sphere::new([0.0; 3], 0.5)]);
    forces(&harmless_loads(scene, backend), [[0.0, 500.0, 0.0]], FORCE);
}

/// A rod whose axis cuts the edge x = y = 1 of a box, at its own middle: pushed outward, along (1, 1, 0)/sqrt 2, o =
/// 0.1, m* = 2.
fn rod_whose_axis_cuts_a_box_edge(backend: Backend) {
    let mut scene = smooth();
    scene.add_box(Cuboid::between([-1.0; 3], [1.0; 3])).expect("a valid box");
    rod(&mut scene, [[0.0, 2.0, 0.0], [2.0, 0.0, 0.0]].map(|end| Sphere::new(end, 0.01)), 0.1);
    let f = 100.0 / 2.0_f64.sqrt();
    forces(&harmless_loads(scene, backend), [[f, f, 0.0]; 2], FORCE);
}

/// A rod whose axis goes through a vertex: whether that counts as up to three edges or as the vertex is a matter of
/// rounding, but outward it goes.
fn rod_whose_axis_goes_through_a_box_vertex(backend: Backend) {
    let mut scene = smooth();
    scene.add_box(Cuboid::between([-1.0; 3], [1.0; 3])).expect("a valid box");
    rod(&mut scene, [[0.0, 2.0, 1.0], [2.0, 0.0, 1.0]].map(|end| Sphere::new(end, 0.01)), 0.1);
    let found = harmless_loads(scene, backend);
    let outward = (found[0].force + found[1].force).dot(Vec3::ONE.normalize().as_dvec3());
    assert!(outward > 50.0, "{found:?}");
}

both!(
    coincident_centres,
    ball_on_the_axis_of_a_rod,
    rods_whose_axes_cross,
    parallel_rods,
    collinear_rods,
    rods_without_length,
    springs_without_length,
    ball_centred_on_a_box_face_or_inside,
    ball_centred_on_a_polygon,
    rod_whose_axis_cuts_a_box_edge,
    rod_whose_axis_goes_through_a_box_vertex,
);
