//! Degenerate input: the state stays finite, and bodies are pushed in the documented direction.
//!
//! Where the distance of two bodies is 0, the normal from A to B is (0, 1, 0). A is the body that was added first;
//! spheres come before rods, boxes and polygons, in this order. For rods that cross, the normal is their common normal
//! A x B. At a box edge or vertex it is the reversed outward direction.

use rockfall::glam::Vec3;
use rockfall::{Backend, Cuboid, Polygon, Rod, Scene, Sphere, Spring, Tether};

use crate::common::*;

/// Tolerance of forces of the order of 1000, over dt = 1/64, from velocities of the order of 16, which round by 1e-6.
const FORCE: f64 = 1e-2;

/// Runs a scene for some steps with and without collisions, asserts that it stays finite, and returns the loads at its
/// start.
fn loads_of_finite_scene(scene: Scene, backend: Backend) -> Vec<Load> {
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

fn frictionless() -> Scene {
    with(|settings| (settings.gravity, settings.friction) = (0.0, 0.0))
}

/// o = 1, m* = 1/2: 500, A down, B up.
fn spheres_with_one_centre_are_pushed_apart_along_y(backend: Backend) {
    let mut scene = frictionless();
    spheres(&mut scene, [Sphere::new([1.0, 2.0, 3.0], 0.5); 2]);
    let found = loads_of_finite_scene(scene, backend);
    forces(&found, [[0.0, -500.0, 0.0], [0.0, 500.0, 0.0]], FORCE);
}

/// A ball whose centre lies on the axis of a rod, in the middle: o = 0.6, m* = 1/(1 + 1/2) = 2/3. The ball moves down,
/// the ends of the rod move up.
fn a_ball_centred_on_the_axis_of_a_rod_is_pushed_along_y(backend: Backend) {
    let mut scene = frictionless();
    rod(&mut scene, [-1.0, 1.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1)), 0.1);
    spheres(&mut scene, [Sphere::new([0.0; 3], 0.5)]);
    let found = loads_of_finite_scene(scene, backend);
    forces(&found, [[0.0, 200.0, 0.0], [0.0, 200.0, 0.0], [0.0, -400.0, 0.0]], FORCE);
}

/// Rods along x and z whose axes cross: the normal from A to B is A x B = -y, o = 0.2, m* = 1. A moves up.
fn rods_whose_axes_cross_are_pushed_along_their_common_normal(backend: Backend) {
    let mut scene = frictionless();
    rod(&mut scene, [-1.0, 1.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1)), 0.1);
    rod(&mut scene, [-1.0, 1.0].map(|z| Sphere::new([0.0, 0.0, z], 0.1)), 0.1);
    let found = loads_of_finite_scene(scene, backend);
    let (up, down) = ([0.0, 100.0, 0.0], [0.0, -100.0, 0.0]);
    forces(&found, [up, up, down, down], FORCE);
}

/// Parallel rods side by side at the same height move apart along the line between them. o = 0.05; A extends from 0 to
/// 4, B from 2 to 6. The middle of the common interval is at a = 0.75, b = 0.25, m* = 1/(10/16 + 10/16) = 0.8: a force
/// of 40, shared as 1/4 and 3/4.
fn parallel_rods_are_pushed_apart_sideways(backend: Backend) {
    let mut scene = frictionless();
    rod(&mut scene, [0.0, 4.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.01)), 0.1);
    rod(&mut scene, [2.0, 6.0].map(|x| Sphere::new([x, 0.0, 0.15], 0.01)), 0.1);
    let found = loads_of_finite_scene(scene, backend);
    forces(&found, [[0.0, 0.0, -10.0], [0.0, 0.0, -30.0], [0.0, 0.0, 30.0], [0.0, 0.0, 10.0]], FORCE);
}

/// Collinear rods that overlap, o = 0.2: A moves down, B up, with a force of 160 shared as above. One end of each also
/// lies on the axis of the other, in its middle. Its contact is covered, because the end is inside its own rod.
fn collinear_rods_are_pushed_apart_along_y(backend: Backend) {
    let build = |gap: f32| {
        let mut scene = frictionless();
        rod(&mut scene, [0.0, 4.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.01)), 0.1);
        rod(&mut scene, [gap, gap + 4.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.01)), 0.1);
        scene
    };
    let shared = 160.0;
    let found = loads_of_finite_scene(build(2.0), backend);
    forces(
        &found,
        [[0.0, -shared / 4.0, 0.0], [0.0, -shared * 0.75, 0.0], [0.0, shared * 0.75, 0.0], [0.0, shared / 4.0, 0.0]],
        FORCE,
    );
    // With a gap between their ends the rods have no contact.
    forces(&loads_of_finite_scene(build(4.5), backend), [[0.0; 3]; 4], 0.0);
}

/// A rod whose ends coincide has no axis and no contacts of its own; its end spheres keep theirs. A rod of fixed length
/// separates its ends along (0, 1, 0): end 1 moves down, end 2 up.
fn a_rod_whose_ends_coincide_has_no_contacts_and_opens_along_y(backend: Backend) {
    let mut scene = frictionless();
    rod(&mut scene, [Sphere::new([0.0; 3], 0.1); 2].map(|end| end.group(1)), 0.4);
    scene.add_box(Cuboid::between([-1.0; 3], [1.0, -0.2, 1.0])).expect("a valid box");
    spheres(&mut scene, [Sphere::new([0.3, 0.0, 0.0], 0.1)]);
    // The ends of a rod of free length have a contact with each other: o = 0.2, m* = 1/2.
    let found = loads_of_finite_scene(scene, backend);
    forces(&found, [[0.0, -100.0, 0.0], [0.0, 100.0, 0.0], [0.0; 3]], FORCE);

    let mut scene = frictionless();
    let [one, two] = spheres(&mut scene, [Sphere::new([0.0; 3], 0.1); 2]);
    scene.add_rod(Rod::new(one, two, 0.1).length(1.0)).expect("a valid rod");
    loads_of_finite_scene(scene.clone(), backend);
    let mut simulation = simulation(scene, backend);
    simulation.step(DT).expect("a step");
    let ends = simulation.spheres().expect("both ends");
    near(ends[0].position, [0.0, -0.5, 0.0], 1e-6, "end 1");
    near(ends[1].position, [0.0, 0.5, 0.0], 1e-6, "end 2");
}

/// A spring or tether whose ends coincide exerts no force, whatever its rest length.
fn springs_whose_ends_coincide_exert_no_force(backend: Backend) {
    let mut scene = frictionless();
    let [a, b] = spheres(&mut scene, [1, 2].map(|group| Sphere::new([1.0; 3], 0.5).group(group)));
    scene.add_spring(Spring::new(a, b, 100.0, 2.0).damping(3.0)).expect("a valid spring");
    scene.add_tether(Tether::new(a, [1.0; 3], 100.0).length(2.0)).expect("a valid tether");
    forces(&loads_of_finite_scene(scene, backend), [[0.0; 3]; 2], 0.0);
}

/// Force on a ball (radius 0.5, mass 1) at rest whose centre is in or on the box from -1 to 1.
fn in_the_box(place: [f32; 3], backend: Backend) -> Vec<Load> {
    let mut scene = frictionless();
    scene.add_box(Cuboid::between([-1.0; 3], [1.0; 3])).expect("a valid box");
    spheres(&mut scene, [Sphere::new(place, 0.5)]);
    loads_of_finite_scene(scene, backend)
}

/// A ball with its centre on a face or inside the box is pushed out through the nearest face, o = r + depth. From the
/// exact middle it is the first face, the low end of edge I. From an edge it is the first of its two faces, from a
/// vertex the first of three.
fn a_ball_centred_in_a_box_leaves_through_the_nearest_face(backend: Backend) {
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

/// A centre in the plane of a polygon counts as in front of it: the ball is pushed along the normal of the face, o = r.
fn a_ball_centred_on_a_polygon_is_pushed_to_the_front(backend: Backend) {
    let mut scene = frictionless();
    let polygon = Polygon::new([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]);
    scene.add_polygon(polygon).expect("a valid polygon");
    spheres(&mut scene, [Sphere::new([0.0; 3], 0.5)]);
    forces(&loads_of_finite_scene(scene, backend), [[0.0, 500.0, 0.0]], FORCE);
}

/// The axis of a rod crosses the edge x = y = 1 of a box in the middle of the rod. The rod is pushed outward, along
/// (1, 1, 0)/sqrt 2: o = 0.1, m* = 2.
fn a_rod_whose_axis_crosses_a_box_edge_is_pushed_outward(backend: Backend) {
    let mut scene = frictionless();
    scene.add_box(Cuboid::between([-1.0; 3], [1.0; 3])).expect("a valid box");
    rod(&mut scene, [[0.0, 2.0, 0.0], [2.0, 0.0, 0.0]].map(|end| Sphere::new(end, 0.01)), 0.1);
    let f = 100.0 / 2.0_f64.sqrt();
    forces(&loads_of_finite_scene(scene, backend), [[f, f, 0.0]; 2], FORCE);
}

/// The axis of a rod passes through a vertex. Rounding decides whether that counts as contacts with up to three edges
/// or as one with the vertex, but the rod is pushed outward in every case.
fn a_rod_whose_axis_passes_through_a_vertex_is_pushed_outward(backend: Backend) {
    let mut scene = frictionless();
    scene.add_box(Cuboid::between([-1.0; 3], [1.0; 3])).expect("a valid box");
    rod(&mut scene, [[0.0, 2.0, 1.0], [2.0, 0.0, 1.0]].map(|end| Sphere::new(end, 0.01)), 0.1);
    let found = loads_of_finite_scene(scene, backend);
    let outward = (found[0].force + found[1].force).dot(Vec3::ONE.normalize().as_dvec3());
    assert!(outward > 50.0, "{found:?}");
}

both!(
    spheres_with_one_centre_are_pushed_apart_along_y,
    a_ball_centred_on_the_axis_of_a_rod_is_pushed_along_y,
    rods_whose_axes_cross_are_pushed_along_their_common_normal,
    parallel_rods_are_pushed_apart_sideways,
    collinear_rods_are_pushed_apart_along_y,
    a_rod_whose_ends_coincide_has_no_contacts_and_opens_along_y,
    springs_whose_ends_coincide_exert_no_force,
    a_ball_centred_in_a_box_leaves_through_the_nearest_face,
    a_ball_centred_on_a_polygon_is_pushed_to_the_front,
    a_rod_whose_axis_crosses_a_box_edge_is_pushed_outward,
    a_rod_whose_axis_passes_through_a_vertex_is_pushed_outward,
);
