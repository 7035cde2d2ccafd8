//! Collisions of rods with spheres, with rods and with boxes.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Backend, Scene, Sphere};

use crate::common::*;

/// Adds a rod along x from 0 to 4, with masses 1 and 3 and radius 0.1, advanced by `LATE`.
fn rod_along_x(scene: &mut Scene, velocities: [f32; 2]) {
    let [v1, v2] = velocities;
    let ends = [
        Sphere::new([0.0; 3], 0.2).velocity([0.0, v1, 0.0]),
        Sphere::new([4.0, 0.0, 0.0], 0.2).mass(3.0).velocity([0.0, v2, 0.0]),
    ];
    rod(scene, ends.map(late), 0.1);
}

/// a = 0.25, 1/M = 0.75^2/1 + 0.25^2/3 = 7/12 (2.6), w = 1/2 + 7/12 = 13/12; n = -y from the ball to the rod. The
/// contact point of the rod moves at 0.75 * 0.4 + 0.25 * (-1.2) = 0 (2.7), u = 2, j = 1.75 * 2 / (13/12) = 42/13. The
/// ball receives 42/13 / 2 upwards, the ends 0.75 * 42/13 / 1 and 0.25 * 42/13 / 3 downwards.
fn the_impulse_of_a_ball_is_shared_by_the_ends_of_the_rod(backend: Backend) {
    let mut scene = weightless();
    rod_along_x(&mut scene, [0.4, -1.2]);
    let ball = Sphere::new([1.0, 0.6, 0.0], 0.5).mass(2.0).velocity([0.3, -2.0, 0.0]);
    spheres(&mut scene, [late(ball)]);
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    let j = 42.0 / 13.0;
    velocities(&after, [[0.0, 0.4 - 0.75 * j, 0.0], [0.0, -1.2 - 0.25 * j / 3.0, 0.0], [0.3, -2.0 + 0.5 * j, 0.0]]);
    displacements(&before, &after, over(LATE, [[0.0, -0.75 * j, 0.0], [0.0, -0.25 * j / 3.0, 0.0], [0.0, 0.5 * j, 0.0]]));
}

/// With end 1 fixed, 1/M = a^2/m2 = (1/16)/3 = 1/48: w = 1/2 + 1/48 = 25/48, u = 2, j = 3.5 * 48/25 = 6.72.
fn a_rod_with_a_fixed_end_has_the_effective_mass_of_the_other_end(backend: Backend) {
    let mut scene = weightless();
    let ends = [Sphere::new([0.0; 3], 0.2).fixed(), Sphere::new([4.0, 0.0, 0.0], 0.2).mass(3.0)];
    rod(&mut scene, ends, 0.1);
    let ball = Sphere::new([1.0, 0.6, 0.0], 0.5).mass(2.0).velocity([0.0, -2.0, 0.0]);
    spheres(&mut scene, [late(ball)]);
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    velocities(&after, [[0.0; 3], [0.0, -0.25 * 6.72 / 3.0, 0.0], [0.0, -2.0 + 3.36, 0.0]]);
    displacements(&before, &after, over(LATE, [[0.0; 3], [0.0, -0.25 * 6.72 / 3.0, 0.0], [0.0, 3.36, 0.0]]));
}

/// Beyond an end of a rod, only the sphere at that end can make a contact. At 0.02 beyond the end, the thick rod (sum
/// of radii 0.9) does not collide with the ball, and the thin end sphere (sum of radii 0.7) is too far away at 0.8.
fn a_rod_does_not_collide_beyond_its_ends(backend: Backend) {
    let build = |x: f32| {
        let mut scene = weightless();
        let ends = [[0.0; 3], [4.0, 0.0, 0.0]].map(|end| Sphere::new(end, 0.2));
        rod(&mut scene, ends, 0.4);
        spheres(&mut scene, [Sphere::new([x, 0.8, 0.0], 0.5).velocity([0.0, -2.0, 0.0])]);
        scene
    };
    for x in [-0.02, 4.02] {
        untouched(build(x), backend);
    }
    for x in [0.02, 3.98] {
        assert!(collide(build(x), backend)[2].velocity.y > -1.0, "no collision at x = {x}");
    }
}

/// Two rods that cross at a = 0.25, b = 0.5, n = y. wA = 0.5625/1 + 0.0625/2 = 19/32, wB = 0.25/3 + 0.25/0.5 = 7/12,
/// w = 113/96. vA = 0.75 * 2 + 0.25 * (-2) = 1, vB = (-1 - 3)/2 = -2: u = 3, j = 1.75 * 3 / w.
fn the_impulse_of_crossing_rods_is_shared_by_their_ends(backend: Backend) {
    let mut scene = weightless();
    let a = [
        Sphere::new([-1.0, 0.0, 0.0], 0.05).velocity([0.0, 2.0, 0.0]),
        Sphere::new([3.0, 0.0, 0.0], 0.05).mass(2.0).velocity([0.0, -2.0, 0.0]),
    ];
    let b = [
        Sphere::new([0.0, 0.2, -1.0], 0.05).mass(3.0).velocity([0.0, -1.0, 0.0]),
        Sphere::new([0.0, 0.2, 1.0], 0.05).mass(0.5).velocity([0.0, -3.0, 0.0]),
    ];
    rod(&mut scene, a.map(late), 0.1);
    rod(&mut scene, b.map(late), 0.1);
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    let shared = |k: f64| [[0.0, -0.75 * k, 0.0], [0.0, -0.125 * k, 0.0], [0.0, k / 6.0, 0.0], [0.0, k, 0.0]];
    let dv = shared(5.25 * 96.0 / 113.0);
    velocities(
        &after,
        [[0.0, 2.0 + dv[0][1], 0.0], [0.0, -2.0 + dv[1][1], 0.0], [0.0, -1.0 + dv[2][1], 0.0], [0.0, -3.0 + dv[3][1], 0.0]],
    );
    displacements(&before, &after, over(LATE, dv));
}

/// Parallel rods from 0 to 4 and from 5 to 3 overlap between 3 and 4 and collide in the middle of that interval,
/// a = 3.5/4, b = 3/4. 1/MA = (1/8)^2 + (7/8)^2 = 50/64, 1/MB = 1/16 + 9/16 = 40/64, u = 2, e = 0.75: j = 3.5 * 64/90.
fn parallel_rods_collide_in_the_middle_of_their_common_interval(backend: Backend) {
    let mut scene = weightless();
    rod(&mut scene, [[0.0; 3], [4.0, 0.0, 0.0]].map(|end| Sphere::new(end, 0.01)), 0.1);
    let b = [[5.0, 0.15, 0.0], [3.0, 0.15, 0.0]].map(|end| Sphere::new(end, 0.01).velocity([0.0, -2.0, 0.0]));
    rod(&mut scene, b, 0.1);
    let after = collide(scene, backend);
    let j = 3.5 * 64.0 / 90.0;
    velocities(
        &after,
        [[0.0, -j / 8.0, 0.0], [0.0, -7.0 * j / 8.0, 0.0], [0.0, -2.0 + j / 4.0, 0.0], [0.0, -2.0 + 3.0 * j / 4.0, 0.0]],
    );
}

/// Two rods that share an end sphere ignore each other, and a rod ignores its own end spheres. The end spheres of a rod
/// of fixed length ignore each other. Control: two overlapping end spheres of a rod of free length do collide.
fn connected_rods_and_spheres_ignore_each_other(backend: Backend) {
    let ends =
        [Sphere::new([0.0; 3], 0.5).velocity([2.0, 0.0, 0.0]), Sphere::new([0.9, 0.0, 0.0], 0.5).velocity([-2.0, 0.0, 0.0])];
    let mut held = weightless();
    dumbbell(&mut held, ends, 0.3);
    uncounted(held, backend);

    let mut free = weightless();
    rod(&mut free, ends, 0.3);
    velocities(&collide(free, backend), [[-1.5, 0.0, 0.0], [1.5, 0.0, 0.0]]);

    let mut angle = weightless();
    let [knee, foot, hip] = spheres(
        &mut angle,
        [
            Sphere::new([0.0; 3], 0.1),
            Sphere::new([2.0, 0.3, 0.0], 0.1).velocity([0.0, -3.0, 0.0]),
            Sphere::new([2.0, -0.3, 0.0], 0.1).velocity([0.0, 3.0, 0.0]),
        ],
    );
    for end in [foot, hip] {
        angle.add_rod(rockfall::Rod::new(knee, end, 0.4)).expect("a valid rod");
    }
    uncounted(angle, backend);
}

/// A rod in the plane z = 0.3 perpendicular to the edge x = 5, y = 0 of the floor's box, advanced by `time`. Before
/// that, its axis was at `distance` from the edge along the edge's outward normal (1, 1, 0)/sqrt 2, at a = 0.25. Masses
/// 1 and 2.
fn rod_across_the_edge(distance: f32, radius: f32, time: f32) -> Scene {
    let mut scene = weightless();
    floor_box(&mut scene);
    let root = 0.5_f32.sqrt();
    let (out, along) = (Vec3::new(root, root, 0.0), Vec3::new(root, -root, 0.0));
    let point = Vec3::new(5.0, 0.0, 0.3) + distance * out;
    let ends = [
        Sphere::new(point - along, 0.05).velocity([0.0, -2.0, 0.0]),
        Sphere::new(point + 3.0 * along, 0.05).mass(2.0).velocity([0.0, -2.0, 0.0]),
    ];
    rod(&mut scene, ends.map(|end| late_by(end, time)), radius);
    scene
}

/// Collides a rod with the edge and compares the result. Both ends move at (0, -2, 0), n = -(1, 1, 0)/sqrt 2: u = sqrt 2.
/// w = 0.5625 + 0.0625/2 = 19/32, j = 1.75 sqrt 2 / w along -n. The velocities of the ends change by 0.75 j and 0.25
/// j / 2.
fn assert_edge_collision(scene: Scene, time: f32, backend: Backend) {
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    let w = 19.0 / 32.0;
    let [dv1, dv2] = [0.75, 0.125].map(|share| share * 1.75 / w);
    velocities(&after, [[dv1, dv1 - 2.0, 0.0], [dv2, dv2 - 2.0, 0.0]]);
    displacements(&before, &after, over(time, [[dv1, dv1, 0.0], [dv2, dv2, 0.0]]));
}

/// The rod touched the edge when its axis was at its radius, 0.1, from it.
fn a_rod_collides_with_a_box_edge(backend: Backend) {
    assert_edge_collision(rod_across_the_edge(0.1, 0.1, LATE), LATE, backend);
}

/// A time step of 20 ms ago the axis was already 0.03 inside the edge: n is reversed and o = 0.1 + 0.03, so the rod is
/// pushed out, not through the box. The contact began before that step, so the state of one step ago is used.
fn a_rod_with_its_axis_inside_a_box_is_pushed_out(backend: Backend) {
    assert_edge_collision(rod_across_the_edge(-0.03, 0.1, 0.02), 0.02, backend);
}

/// The rod is too far from the edge, though its AABB overlaps that of the box.
fn a_rod_near_a_box_edge_does_not_collide(backend: Backend) {
    untouched(rod_across_the_edge(0.11, 0.1, 0.0), backend);
}

/// A rod along (1, -1, 0)/sqrt 2 touched the vertex (5, 0, 5) when its axis was 0.1, its radius, from it along (1, 1,
/// 1)/sqrt 3. The closest points on the lines of all three edges lie beyond the vertex, so this is a vertex contact:
/// a = 0.25, n = -(1, 1, 1)/sqrt 3, u = 2/sqrt 3, w = 19/32 as above.
fn a_rod_collides_with_a_box_vertex(backend: Backend) {
    let mut scene = weightless();
    floor_box(&mut scene);
    let out = Vec3::ONE.normalize();
    let along = Vec3::new(1.0, -1.0, 0.0).normalize();
    let point = Vec3::new(5.0, 0.0, 5.0) + 0.1 * out;
    let ends = [
        Sphere::new(point - along, 0.05).velocity([0.0, -2.0, 0.0]),
        Sphere::new(point + 3.0 * along, 0.05).mass(2.0).velocity([0.0, -2.0, 0.0]),
    ];
    rod(&mut scene, ends.map(late), 0.1);
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    let w = 19.0 / 32.0;
    // Each component of j times the unit vector (1, 1, 1)/sqrt 3.
    let [dv1, dv2] = [0.75, 0.125].map(|share| share * 1.75 * 2.0 / 3.0 / w);
    velocities(&after, [[dv1, dv1 - 2.0, dv1], [dv2, dv2 - 2.0, dv2]]);
    displacements(&before, &after, over(LATE, [[dv1; 3], [dv2; 3]]));
}

/// A rod that lies flat on a narrow box touches two edges at once, at a = 0.25 and 0.75. With equal masses
/// G_11 = G_22 = 10/16, G_12 = 2 * 3/16 = 6/16, and both impulses are equal: j = 1.75 * 2 / (10/16 + 6/16) = 3.5. Each
/// end receives (0.75 + 0.25) j. The rod rebounds flat at 1.5, as a ball would. The contacts share the ends, so nothing
/// is displaced.
fn a_rod_that_lands_flat_on_two_edges_rebounds_flat(backend: Backend) {
    let mut scene = weightless();
    scene.add_box(rockfall::Cuboid::between([-1.0, -2.0, -3.0], [1.0, 0.0, 3.0])).expect("a valid box");
    let ends = [-2.0, 2.0].map(|x| Sphere::new([x, 0.09, 0.0], 0.05).velocity([0.0, -2.0, 0.0]));
    rod(&mut scene, ends, 0.1);
    let after = collide(scene, backend);
    velocities(&after, [[0.0, 1.5, 0.0], [0.0, 1.5, 0.0]]);
    displacements(&ends, &after, [[0.0; 3]; 2]);
}

/// Both ends of a rod land on the floor while a ball hits the rod along z. That collision is lone, because the floor is at a right angle
/// to it, up to the tolerance of section 3.6: n = (0, s, 1). So it takes no part in the cluster of the others (section 3.7): each end
/// rebounds at 0.75 from the floor, as if there was no ball, and gets its share of j = 1.75 * 10 / (1 + 0.75^2 + 0.25^2) along n.
fn a_lone_collision_takes_no_part_in_the_cluster_beside_it(backend: Backend) {
    let mut scene = weightless();
    let s = 5e-4;
    let ends = [0.0, 4.0].map(|x| Sphere::new([x, 0.2, 0.0], 0.2).velocity([0.0, -1.0, 0.0]));
    rod(&mut scene, ends.map(late), 0.1);
    spheres(&mut scene, [late(Sphere::new([1.0, 0.2 + 0.25 * s, 0.25], 0.15).velocity([0.0, -1.0, -10.0]))]);
    floor_box(&mut scene);
    let after = collide(scene, backend);
    let j = 1.75 * 10.0 / 1.625;
    let n = DVec3::new(0.0, f64::from(s), 1.0);
    let expected = [-0.75, -0.25, 1.0].map(|share| share * j * n);
    for (k, floor) in [0.75, 0.75, -1.0].into_iter().enumerate() {
        let before = DVec3::new(0.0, floor, if k == 2 { -10.0 } else { 0.0 });
        near(after[k].velocity, before + expected[k], 2e-4, "velocity");
    }
}

both!(
    the_impulse_of_a_ball_is_shared_by_the_ends_of_the_rod,
    a_rod_with_a_fixed_end_has_the_effective_mass_of_the_other_end,
    a_rod_does_not_collide_beyond_its_ends,
    the_impulse_of_crossing_rods_is_shared_by_their_ends,
    parallel_rods_collide_in_the_middle_of_their_common_interval,
    connected_rods_and_spheres_ignore_each_other,
    a_rod_collides_with_a_box_edge,
    a_rod_with_its_axis_inside_a_box_is_pushed_out,
    a_rod_near_a_box_edge_does_not_collide,
    a_rod_collides_with_a_box_vertex,
    a_rod_that_lands_flat_on_two_edges_rebounds_flat,
    a_lone_collision_takes_no_part_in_the_cluster_beside_it,
);
