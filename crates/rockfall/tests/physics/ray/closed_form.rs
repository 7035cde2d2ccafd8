//! Ray queries whose result follows from a drawing.

use rockfall::glam::Vec3;
use rockfall::{Backend, Body, Capsule, Cuboid, Error, Polygon, RayHit, Scene, Simulation, Sphere};

use crate::common::*;

fn cast(scene: Scene, origin: [f32; 3], direction: [f32; 3]) -> Option<RayHit> {
    simulation(scene, Backend::Cpu).cast_ray(origin, direction).expect("a valid ray")
}

#[track_caller]
fn hit(scene: &Scene, [origin, direction]: [[f32; 3]; 2], distance: f64, normal: [f64; 3]) -> Body {
    let hit = cast(scene.clone(), origin, direction).expect("the ray must hit something");
    close(hit.distance, distance, 1e-6 * distance.max(1.0), "distance");
    near(hit.normal, normal, 1e-6, "normal");
    let unit = Vec3::from(direction).as_dvec3().normalize();
    near(hit.point, Vec3::from(origin).as_dvec3() + distance * unit, 1e-5, "point");
    hit.body
}

#[track_caller]
fn missed(scene: &Scene, origin: [f32; 3], direction: [f32; 3]) {
    assert_eq!(cast(scene.clone(), origin, direction), None);
}

/// A 3-4-5 triangle: the line y = 3 enters a sphere of radius 5 about the origin at x = -4.
#[test]
fn a_ray_enters_a_sphere_half_a_chord_before_its_centre() {
    let mut scene = Scene::new();
    let [ball] = spheres(&mut scene, [Sphere::new([0.0; 3], 5.0)]);
    let body = hit(&scene, [[-10.0, 3.0, 0.0], [1.0, 0.0, 0.0]], 6.0, [-0.8, 0.6, 0.0]);
    assert_eq!(body, Body::Sphere(ball));
    // The length of the direction does not matter.
    hit(&scene, [[-10.0, 3.0, 0.0], [1e-30, 0.0, 0.0]], 6.0, [-0.8, 0.6, 0.0]);
    hit(&scene, [[-10.0, 3.0, 0.0], [1e30, 0.0, 0.0]], 6.0, [-0.8, 0.6, 0.0]);
    // A ray that starts on the surface and points inwards.
    hit(&scene, [[-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]], 0.0, [-1.0, 0.0, 0.0]);
    missed(&scene, [-10.0, 5.01, 0.0], [1.0, 0.0, 0.0]);
    missed(&scene, [-10.0, 3.0, 0.0], [-1.0, 0.0, 0.0]);
    missed(&scene, [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
}

/// A ball of radius 0.5 at a distance of 10,000. With f32 alone the error would exceed the radius.
#[test]
fn a_far_sphere_is_hit_at_its_exact_position() {
    let mut scene = Scene::new();
    spheres(&mut scene, [Sphere::new([10_000.0, 0.25, 0.0], 0.5)]);
    let hit = cast(scene.clone(), [0.0; 3], [1.0, 0.0, 0.0]).expect("a hit");
    near(hit.normal, [-0.75_f64.sqrt(), -0.5, 0.0], 1e-6, "normal");
    missed(&scene, [0.0, -0.2501, 0.0], [1.0, 0.0, 0.0]);
    assert!(cast(scene, [0.0, -0.2499, 0.0], [1.0, 0.0, 0.0]).is_some());
}

/// A rod of radius 0.5 along x from -2 to 2. Its end spheres are smaller, so the test sees the shape of the rod itself.
#[test]
fn a_rod_has_the_shape_of_a_capsule() {
    let mut scene = Scene::new();
    let id = rod(&mut scene, [Sphere::new([-2.0, 0.0, 0.0], 0.1), Sphere::new([2.0, 0.0, 0.0], 0.1)], 0.5);
    // Its side, with a 0.3-0.4-0.5 triangle.
    assert_eq!(hit(&scene, [[1.0, 5.0, 0.3], [0.0, -1.0, 0.0]], 4.6, [0.0, 0.8, 0.6]), Body::Rod(id));
    // Its ends, perpendicular to the axis and along it.
    hit(&scene, [[2.4, 5.0, 0.0], [0.0, -1.0, 0.0]], 4.7, [0.8, 0.6, 0.0]);
    hit(&scene, [[-2.4, 5.0, 0.0], [0.0, -1.0, 0.0]], 4.7, [-0.8, 0.6, 0.0]);
    hit(&scene, [[9.0, 0.3, 0.0], [-1.0, 0.0, 0.0]], 6.6, [0.8, 0.6, 0.0]);
    hit(&scene, [[-9.0, 0.3, 0.0], [1.0, 0.0, 0.0]], 6.6, [-0.8, 0.6, 0.0]);
    missed(&scene, [2.6, 5.0, 0.0], [0.0, -1.0, 0.0]);
    missed(&scene, [9.0, 0.51, 0.0], [-1.0, 0.0, 0.0]);
    // Rays that start inside: between the ends, and in one end.
    missed(&scene, [0.0; 3], [0.0, 1.0, 0.0]);
    missed(&scene, [2.2, 0.0, 0.0], [1.0, 0.0, 0.0]);
}

/// The end of a capsule counts as its sphere, the side as its rod.
#[test]
fn at_equal_distances_the_sphere_is_reported_before_the_rod() {
    let mut scene = Scene::new();
    let capsule = scene.add_capsule(Capsule::new([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.25)).expect("a valid capsule");
    let parts = *scene.capsule(capsule).expect("the capsule");
    let end = hit(&scene, [[5.0, 0.1, 0.05], [-1.0, 0.0, 0.0]], 4.0 - 0.05_f64.sqrt(), [0.05_f64.sqrt() * 4.0, 0.4, 0.2]);
    assert_eq!(end, Body::Sphere(parts.end2));
    assert_eq!(hit(&scene, [[0.5, 5.0, 0.0], [0.0, -1.0, 0.0]], 4.75, [0.0, 1.0, 0.0]), Body::Rod(parts.rod));
}

#[test]
fn a_ray_enters_a_box_through_the_last_face_plane_it_crosses() {
    let mut scene = Scene::new();
    let id = scene.add_box(Cuboid::between([-1.0, -2.0, -3.0], [1.0, 2.0, 3.0])).expect("a valid box");
    assert_eq!(hit(&scene, [[-5.0, 1.0, 2.0], [1.0, 0.0, 0.0]], 4.0, [-1.0, 0.0, 0.0]), Body::Box(id));
    hit(&scene, [[0.0, 0.0, 9.0], [0.0, 0.0, -1.0]], 6.0, [0.0, 0.0, 1.0]);
    // At 45 degrees the ray crosses the plane x = -1 at y = 2.5, outside the box, and the top of the box at x = -0.5.
    hit(&scene, [[-3.0, 4.5, 0.0], [1.0, -1.0, 0.0]], 2.5 * 2.0_f64.sqrt(), [0.0, 1.0, 0.0]);
    missed(&scene, [-5.0, 2.1, 0.0], [1.0, 0.0, 0.0]);
    missed(&scene, [-5.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
    missed(&scene, [0.0; 3], [1.0, 0.0, 0.0]);
}

/// A box rotated by 45 degrees about z. One edge points at the ray; the adjacent edges are 1 above and below it.
#[test]
fn a_rotated_box_is_hit_on_its_faces() {
    let mut scene = Scene::new();
    scene.add_box(Cuboid::new([-1.0, 0.0, -1.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, 2.0])).expect("a valid box");
    let half = 0.5_f64.sqrt();
    hit(&scene, [[-5.0, 0.25, 0.0], [1.0, 0.0, 0.0]], 4.25, [-half, half, 0.0]);
    hit(&scene, [[-5.0, -0.25, 0.0], [1.0, 0.0, 0.0]], 4.25, [-half, -half, 0.0]);
    missed(&scene, [-5.0, 1.01, 0.0], [1.0, 0.0, 0.0]);
}

/// A polygon with the skew edges (1, 0, 0) and (1, 0, -2), which faces up.
#[test]
fn a_polygon_is_hit_from_both_sides() {
    let mut scene = Scene::new();
    let polygon = Polygon::new([0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, -2.0]);
    let id = scene.add_polygon(polygon).expect("a valid polygon");
    assert_eq!(hit(&scene, [[1.0, 3.0, -1.0], [0.0, -1.0, 0.0]], 3.0, [0.0, 1.0, 0.0]), Body::Polygon(id));
    hit(&scene, [[1.0, -3.0, -1.0], [0.0, 1.0, 0.0]], 3.0, [0.0, -1.0, 0.0]);
    // Inside its bounding rectangle, but outside the polygon.
    missed(&scene, [0.2, 3.0, -1.0], [0.0, -1.0, 0.0]);
    missed(&scene, [1.8, 3.0, -1.0], [0.0, -1.0, 0.0]);
    missed(&scene, [1.0, -3.0, -1.0], [0.0, -1.0, 0.0]);
    // A ray in the plane of the polygon.
    missed(&scene, [-1.0, 0.0, -0.1], [1.0, 0.0, 0.0]);
}

/// A ball in front of a box in front of a wall. Without the ball the ray hits the box, then without the box the wall.
#[test]
fn the_nearest_body_is_reported() {
    let mut scene = Scene::new();
    let [ball] = spheres(&mut scene, [Sphere::new([1.0, 0.0, 0.0], 0.5)]);
    let cuboid = scene.add_box(Cuboid::between([2.0, -1.0, -1.0], [3.0, 1.0, 1.0])).expect("a valid box");
    let wall = scene.add_polygon(Polygon::new([4.0, -1.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0])).expect("a valid polygon");
    let mut simulation = simulation(scene, Backend::Cpu);
    let seen = |simulation: &mut Simulation| simulation.cast_ray(Vec3::ZERO, Vec3::X).expect("a valid ray").map(|hit| hit.body);
    assert_eq!(seen(&mut simulation), Some(Body::Sphere(ball)));
    simulation.remove_sphere(ball).expect("the ball");
    assert_eq!(seen(&mut simulation), Some(Body::Box(cuboid)));
    simulation.remove_box(cuboid).expect("the box");
    assert_eq!(seen(&mut simulation), Some(Body::Polygon(wall)));
}

/// Two steps of symplectic Euler at a speed of 8 move the ball by 2 * 8 / 64.
fn a_ray_query_uses_the_present_state(backend: Backend) {
    let mut scene = weightless();
    spheres(&mut scene, [Sphere::new([0.0; 3], 0.5).velocity([8.0, 0.0, 0.0])]);
    let mut simulation = euler(scene, backend);
    simulation.run(2, DT).expect("two steps");
    let hit = simulation.cast_ray([5.0, 0.0, 0.0], [-1.0, 0.0, 0.0]).expect("a valid ray").expect("a hit");
    close(hit.distance, 5.0 - 0.25 - 0.5, 1e-6, "distance");
}

both!(a_ray_query_uses_the_present_state);

#[test]
fn degenerate_rays_are_rejected() {
    let mut simulation = simulation(Scene::new(), Backend::Cpu);
    let zero = [0.0; 3];
    assert_eq!(simulation.cast_ray(zero, [0.0, 1.0, 0.0]).expect("a valid ray"), None);
    let bad = [
        (zero, zero, "ray.direction"),
        (zero, [0.0, f32::NAN, 1.0], "ray.direction"),
        (zero, [f32::INFINITY, 0.0, 0.0], "ray.direction"),
        ([f32::NAN, 0.0, 0.0], [0.0, 0.0, 1.0], "ray.origin"),
        ([0.0, f32::NEG_INFINITY, 0.0], [0.0, 0.0, 1.0], "ray.origin"),
    ];
    for (origin, direction, expected) in bad {
        let error = simulation.cast_ray(origin, direction).expect_err("a degenerate ray");
        assert!(matches!(error, Error::Invalid { field, .. } if field == expected), "{error}");
    }
}
