//! Collisions of spheres with boxes and polygons.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Backend, Cuboid, Polygon, Scene, Sphere};

use crate::common::*;

/// Asserts that a ball that hits the plane y = 0 obliquely rebounds. With e = 0.75 the normal velocity -2 becomes 1.5,
/// and the other components do not change. The overlap of 0.02 began 10 ms ago.
fn assert_ball_rebounds(mut scene: Scene, backend: Backend) {
    let ball = Sphere::new([0.3, 0.48, 0.2], 0.5).mass(2.0).velocity([1.0, -2.0, 0.5]);
    spheres(&mut scene, [ball]);
    let after = collide(scene, backend);
    velocities(&after, [[1.0, 1.5, 0.5]]);
    displacements(&[ball], &after, over(0.01, [[0.0, 3.5, 0.0]]));
}

fn a_ball_rebounds_from_a_box_with_e(backend: Backend) {
    let mut scene = weightless();
    floor_box(&mut scene);
    assert_ball_rebounds(scene, backend);
}

fn a_ball_rebounds_from_a_polygon_with_e(backend: Backend) {
    let mut scene = weightless();
    floor_polygon(&mut scene);
    assert_ball_rebounds(scene, backend);
}

/// Asserts by how much the velocity of one ball changes that touched the floor's box `LATE` ago, with e = 0.75.
fn assert_velocity_change_on_floor_box(ball: Sphere, backend: Backend, change: [f64; 3]) {
    let mut scene = weightless();
    floor_box(&mut scene);
    let ball = late(ball);
    spheres(&mut scene, [ball]);
    let after = collide(scene, backend);
    near(after[0].velocity, DVec3::from(change) + ball.velocity.as_dvec3(), F32, "velocity");
    displacements(&[ball], &after, over(LATE, [change]));
}

/// The centre is (0.3, 0.4) outside the edge x = 5, y = 0: distance 0.5, n = (-0.6, -0.8, 0). u = (-1, -1, 3).n = 1.4,
/// so v' = v + 1.75 * 1.4 * (0.6, 0.8, 0).
fn a_ball_on_a_box_edge_collides_along_the_line_to_the_edge(backend: Backend) {
    let ball = Sphere::new([5.3, 0.4, 0.2], 0.5).velocity([-1.0, -1.0, 3.0]);
    assert_velocity_change_on_floor_box(ball, backend, [1.47, 1.96, 0.0]);
}

/// The centre is (1, 1/2, 1)/3 outside the vertex (5, 0, 5): distance 0.5, n = -(2, 1, 2)/3. u = (0, -3, 0).n = 1, so
/// v' = v + 1.75 (2, 1, 2)/3.
fn a_ball_on_a_box_vertex_collides_along_the_line_to_the_vertex(backend: Backend) {
    let ball = Sphere::new([5.0 + 1.0 / 3.0, 0.5 / 3.0, 5.0 + 1.0 / 3.0], 0.5).velocity([0.0, -3.0, 0.0]);
    let third = 1.75 / 3.0;
    assert_velocity_change_on_floor_box(ball, backend, [2.0 * third, third, 2.0 * third]);
}

/// A rotated box with the edges (3, 4, 0), (-4, 3, 0) and (0, 0, 5) from the origin. The face at the far end of the
/// second edge has the normal (-0.8, 0.6, 0). The ball's centre is 0.47 from the middle of that face: o = 0.03, which
/// began 15 ms ago. A velocity of 2 along -normal becomes 1.5 along the normal.
fn a_ball_rebounds_along_the_normal_of_a_rotated_box(backend: Backend) {
    let mut scene = weightless();
    let (i, j, k) = (Vec3::new(3.0, 4.0, 0.0), Vec3::new(-4.0, 3.0, 0.0), Vec3::new(0.0, 0.0, 5.0));
    scene.add_box(Cuboid::new([0.0; 3], i, j, k)).expect("a valid box");
    let normal = Vec3::new(-0.8, 0.6, 0.0);
    let ball = Sphere::new(0.5 * i + j + 0.5 * k + 0.47 * normal, 0.5).velocity(-2.0 * normal);
    spheres(&mut scene, [ball]);
    let after = collide(scene, backend);
    velocities(&after, [[-1.2, 0.9, 0.0]]);
    displacements(&[ball], &after, over(0.015, [[-2.8, 2.1, 0.0]]));
}

/// A ball above the skew polygon with corner 0, L = (1, 0, 2), R = (2, 0, 0), which faces up. Its points
/// have z = 2l, x = z/2 + 2k.
fn over_the_skew_polygon(x: f32, z: f32) -> Scene {
    let mut scene = weightless();
    scene.add_polygon(Polygon::new([0.0; 3], [1.0, 0.0, 2.0], [2.0, 0.0, 0.0])).expect("a valid polygon");
    spheres(&mut scene, [Sphere::new([x, 0.25, z], 0.3).velocity([0.0, -2.0, 0.0])]);
    scene
}

/// At z = 1.5 the slanted edges are at x = 0.75 and x = 2.75. A ball inside of them collides. One whose distance from the nearest edge
/// exceeds sqrt(0.3^2 - 0.25^2) = 0.166 does not, although its position is above the bounding rectangle. The same holds at the straight
/// edges z = 0 and z = 2.
fn a_skew_polygon_ends_at_its_edges(backend: Backend) {
    for (x, z) in [(0.77, 1.5), (2.73, 1.5), (1.5, 0.02), (1.5, 1.98)] {
        let after = collide(over_the_skew_polygon(x, z), backend);
        velocities(&after, [[0.0, 1.5, 0.0]]);
    }
    for (x, z) in [(0.55, 1.5), (2.95, 1.5), (1.5, -0.18), (1.5, 2.18), (2.5, 0.5)] {
        untouched(over_the_skew_polygon(x, z), backend);
    }
}

/// Beside a polygon, a ball touches the nearest point of an edge or a corner. At rest the force is Cc m o = 1000 o away from that point:
/// o = 0.5 - 0.4 at the edge z = 0, o = 0.5 - 0.3 at the corner 0.
fn a_ball_touches_the_edge_and_the_corner_of_a_polygon(backend: Backend) {
    let at = |place: [f32; 3]| {
        let mut scene = weightless();
        scene.add_polygon(Polygon::new([0.0; 3], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0])).expect("a valid polygon");
        spheres(&mut scene, [Sphere::new(place, 0.5)]);
        loads(scene, backend)
    };
    forces(&at([1.0, 0.24, -0.32]), [[0.0, 60.0, -80.0]], 1e-4);
    forces(&at([-0.2, 0.2, -0.1]), [[-400.0 / 3.0, 400.0 / 3.0, -200.0 / 3.0]], 1e-4);
}

/// A polygon collides only where 0 <= d < r: not from behind, and not beyond the radius of the ball.
fn a_polygon_has_one_solid_side(backend: Backend) {
    for height in [-0.05, 0.51] {
        for speed in [-2.0, 2.0] {
            let mut scene = weightless();
            floor_polygon(&mut scene);
            spheres(&mut scene, [Sphere::new([0.0, height, 0.0], 0.5).velocity([0.0, speed, 0.0])]);
            untouched(scene, backend);
        }
    }
}

/// A ball from behind that is faster than threshold x radius passes through without any force: x = x0 + v t exactly,
/// because all numbers here are binary fractions.
fn a_fast_ball_from_behind_passes_through_a_polygon(backend: Backend) {
    let mut scene = weightless();
    floor_polygon(&mut scene);
    let [ball] = spheres(&mut scene, [Sphere::new([0.0, -0.5, 0.0], 0.25).velocity([0.0, 2.0, 0.0])]);
    let mut simulation = simulation(scene, backend);
    simulation.run(32, DT).expect("32 steps");
    let ball = simulation.sphere(ball).expect("the ball");
    near(ball.velocity, [0.0, 2.0, 0.0], 0.0, "velocity");
    near(ball.position, [0.0, 0.5, 0.0], 1e-6, "position");
    assert_eq!(simulation.report().total_collisions, 0);
}

/// The contacts with a floor and a wall at a right angle do not influence each other. With e = 1 both velocity
/// components are reversed, and each contact is a lone one. The overlaps of 0.01 began 5 ms and 10/3 ms ago.
fn an_elastic_ball_leaves_a_corner_at_its_speed(backend: Backend) {
    let mut scene = weightless();
    scene.settings.restitution = 1.0;
    floor_polygon(&mut scene);
    scene.add_polygon(Polygon::new([0.0, -5.0, -5.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0])).expect("a valid polygon");
    let ball = Sphere::new([0.49, 0.49, 0.0], 0.5).velocity([-2.0, -3.0, 1.0]);
    spheres(&mut scene, [ball]);
    let after = collide(scene, backend);
    velocities(&after, [[2.0, 3.0, 1.0]]);
    displacements(&[ball], &after, [[0.005 * 4.0, 0.01 / 3.0 * 6.0, 0.0]]);
}

/// Two polygons whose normals form an angle of 60 degrees are hit along the bisector: G_12 / G_11 = n1.n2 = 1/2, and both
/// impulses are equal: j = 2 u / (3/2) with u = 2 cos 30 and e = 1. The ball receives 2/3 * 2u (n1 + n2) =
/// 2/3 * 4 * 2 cos^2 30 = 4 upwards: from -2 to 2. The contacts share the ball, so nothing is displaced.
fn an_elastic_ball_leaves_a_sharp_groove_at_its_speed(backend: Backend) {
    let mut scene = weightless();
    scene.settings.restitution = 1.0;
    let (cos, sin) = (0.75_f32.sqrt(), 0.5);
    for side in [-1.0, 1.0] {
        // The face contains the origin and the z direction, and its normal is (-side sin, cos, 0).
        let along = Vec3::new(cos * side, sin, 0.0);
        let [left, right] = if side > 0.0 { [Vec3::Z, along] } else { [along, Vec3::Z] };
        let corner = -5.0 * Vec3::Z;
        scene
            .add_polygon(Polygon::new(corner, 10.0 * left, 10.0 * right))
            .map(|_| ())
            .unwrap_or_else(|error| panic!("{error}"));
    }
    let height = 0.49 / cos;
    let ball = Sphere::new([0.0, height, 0.0], 0.5).velocity([0.0, -2.0, 0.0]);
    spheres(&mut scene, [ball]);
    let after = collide(scene, backend);
    velocities(&after, [[0.0, 2.0, 0.0]]);
    displacements(&[ball], &after, [[0.0; 3]]);
}

/// A ball that falls from rest in a whole run rebounds from the floor with e: it arrives at sqrt(2 G h) and rises to
/// e^2 h. G = 8, h = 1: it arrives after t = 0.5 s at 4, leaves at 3 and is at rest again after 3/8 s at a height of 9/16.
/// With time steps of 1/512 s the collision is detected up to one step late, which displaces the ball by up to
/// (1 + e) * 4 / 512 = 0.014.
fn a_falling_ball_rises_to_e_squared_of_its_height(backend: Backend) {
    let dt = 1.0 / 512.0;
    let mut scene = with(|settings| settings.gravity = 8.0);
    floor_box(&mut scene);
    let [ball] = spheres(&mut scene, [Sphere::new([0.0, 1.5, 0.0], 0.5)]);
    let mut simulation = simulation(scene, backend);
    simulation.run(448, dt).expect("7/8 s");
    assert_eq!(simulation.report().total_collisions, 1);
    let ball = simulation.sphere(ball).expect("the ball");
    close(ball.position.y, 0.5 + 9.0 / 16.0, 0.014, "height");
    // Besides the delay (8 * 1/512 * 1.75 = 0.027), the removal of the overlap has an effect of the order of
    // 8 * 0.008 / 4.
    close(ball.velocity.y, 0.0, 0.05, "velocity at the top");
}

/// An elastic ball in a closed room of six polygons without gravity keeps its speed and stays inside.
fn an_elastic_ball_stays_in_a_room_and_keeps_its_speed(backend: Backend) {
    let mut scene = weightless();
    scene.settings.restitution = 1.0;
    for axis in 0..3 {
        let [x, y, z] = [0, 1, 2].map(|shift| Vec3::AXES[(axis + shift) % 3]);
        // y x z = x: the low wall faces in the positive direction of the axis, the high one in the negative direction.
        for (corner, left, right) in [(-y - z, y, z), (2.0 * x - y - z, z, y)] {
            let polygon = Polygon::new(corner - x, 2.0 * left, 2.0 * right);
            scene.add_polygon(polygon).expect("a valid polygon");
        }
    }
    let velocity = DVec3::new(3.0, -4.0, 2.0);
    let ball = Sphere::new([0.1, 0.2, -0.3], 0.25).velocity(velocity.as_vec3());
    let [ball] = spheres(&mut scene, [ball]);
    let mut simulation = simulation(scene, backend);
    for _ in 0..on(backend, 60, 12) {
        simulation.run(10, 0.01).expect("10 steps");
        let ball = simulation.sphere(ball).expect("the ball");
        near(ball.velocity.abs(), velocity.abs(), 1e-3, "speed along each axis");
        assert!(ball.position.abs().max_element() < 0.8, "{}", ball.position);
    }
    assert!(simulation.report().total_collisions > 3);
}

both!(
    a_ball_rebounds_from_a_box_with_e,
    a_ball_rebounds_from_a_polygon_with_e,
    a_ball_on_a_box_edge_collides_along_the_line_to_the_edge,
    a_ball_on_a_box_vertex_collides_along_the_line_to_the_vertex,
    a_ball_rebounds_along_the_normal_of_a_rotated_box,
    a_skew_polygon_ends_at_its_edges,
    a_ball_touches_the_edge_and_the_corner_of_a_polygon,
    a_polygon_has_one_solid_side,
    a_fast_ball_from_behind_passes_through_a_polygon,
    an_elastic_ball_leaves_a_corner_at_its_speed,
    an_elastic_ball_leaves_a_sharp_groove_at_its_speed,
    a_falling_ball_rises_to_e_squared_of_its_height,
    an_elastic_ball_stays_in_a_room_and_keeps_its_speed,
);
