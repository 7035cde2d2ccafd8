//! Collisions of spheres, and several collisions of one body.

use rockfall::{Backend, Scene, Sphere};

use crate::common::*;

/// n = x, u = 2 - (-1) = 3, wA + wB = 1 + 1/3 = 4/3, e = 0.75: j = 1.75 * 3 / (4/3) = 3.9375, so vA = 2 - 3.9375 and
/// vB = -1 + 3.9375 / 3 = 0.3125.
fn a_head_on_collision_changes_velocities_by_inverse_mass(backend: Backend) {
    let mut scene = weightless();
    spheres(
        &mut scene,
        [
            Sphere::new([0.0, 0.0, 0.0], 0.5).velocity([2.0, 0.0, 0.0]),
            Sphere::new([1.0, 0.0, 0.0], 0.5).mass(3.0).velocity([-1.0, 0.0, 0.0]),
        ]
        .map(late),
    );
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    velocities(&after, [[-1.9375, 0.0, 0.0], [0.3125, 0.0, 0.0]]);
    displacements(&before, &after, over(LATE, [[-3.9375, 0.0, 0.0], [1.3125, 0.0, 0.0]]));
}

/// n = (0.6, 0.8, 0), u = (2, 0.5, -3).n = 1.6, wA + wB = 0.5 + 2 = 2.5, e = 0.5: j = 1.5 * 1.6 / 2.5 = 0.96. A
/// receives -0.48 n, B 1.92 n. The velocity perpendicular to n and the spin do not change, because collisions have no
/// friction.
fn an_oblique_collision_changes_only_the_normal_velocities(backend: Backend) {
    let mut scene = weightless();
    scene.settings.restitution = 0.5;
    spheres(
        &mut scene,
        [
            Sphere::new([0.0, 0.0, 0.0], 0.4).mass(2.0).velocity([1.0, 0.5, -2.0]).angular_momentum([0.1, 0.2, 0.3]),
            Sphere::new([0.6, 0.8, 0.0], 0.6).mass(0.5).velocity([-1.0, 0.0, 1.0]),
        ]
        .map(late),
    );
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    velocities(&after, [[0.712, 0.116, -2.0], [0.152, 1.536, 1.0]]);
    displacements(&before, &after, over(LATE, [[-0.288, -0.384, 0.0], [1.152, 1.536, 0.0]]));
    assert_eq!(after[0].angular_momentum, before[0].angular_momentum);
    assert_eq!(after[1].angular_momentum, before[1].angular_momentum);
}

/// e = 0: both move on with the velocity of the centre of mass, (1*3 + 2*0) / 3 = 1.
fn after_an_inelastic_collision_both_bodies_have_one_velocity(backend: Backend) {
    let mut scene = weightless();
    scene.settings.restitution = 0.0;
    spheres(
        &mut scene,
        [Sphere::new([0.0, 0.0, 0.0], 0.5).velocity([0.0, 0.0, 3.0]), Sphere::new([0.0, 0.0, 0.99], 0.5).mass(2.0)],
    );
    velocities(&collide(scene, backend), [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]);
}

fn pair_closing_at(speed: f32, threshold: f32) -> Scene {
    let mut scene = weightless();
    scene.settings.activation_threshold = threshold;
    spheres(&mut scene, [Sphere::new([0.0, 0.0, 0.0], 0.5).velocity([speed, 0.0, 0.0]), Sphere::new([0.74, 0.0, 0.0], 0.25)]);
    scene
}

/// The threshold is activation_threshold times the smaller radius, 0.25. Slightly above it there is an impulse of
/// j = 1.75 u / 2, slightly below it none.
fn the_smaller_radius_sets_the_threshold(backend: Backend) {
    untouched(pair_closing_at(0.2499, 1.0), backend);
    untouched(pair_closing_at(0.4999, 2.0), backend);
    for (speed, threshold) in [(0.2501, 1.0), (0.5001, 2.0)] {
        let u = f64::from(speed);
        let after = collide(pair_closing_at(speed, threshold), backend);
        velocities(&after, [[0.125 * u, 0.0, 0.0], [0.875 * u, 0.0, 0.0]]);
    }
}

/// A fixed sphere has inverse mass 0 but a surface velocity: u = 1, j = 1.75 * 2, so the ball leaves at 1.75. The fixed
/// sphere does not change. It is not moved back in time, and the ball is at rest, so no time of contact is found and
/// the whole time step of 20 ms is used.
fn a_fixed_sphere_with_a_surface_velocity_hits_a_ball(backend: Backend) {
    let mut scene = weightless();
    spheres(
        &mut scene,
        [Sphere::new([0.0, 0.0, 0.0], 0.5).velocity([1.0, 0.0, 0.0]).fixed(), Sphere::new([0.99, 0.0, 0.0], 0.5).mass(2.0)],
    );
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    velocities(&after, [[1.0, 0.0, 0.0], [1.75, 0.0, 0.0]]);
    displacements(&before, &after, over(0.02, [[0.0; 3], [1.75, 0.0, 0.0]]));
}

fn fixed_spheres_do_not_collide_with_each_other(backend: Backend) {
    let mut scene = weightless();
    spheres(
        &mut scene,
        [Sphere::new([0.0, 0.0, 0.0], 0.5).velocity([3.0, 0.0, 0.0]).fixed(), Sphere::new([0.5, 0.0, 0.0], 0.5).fixed()],
    );
    uncounted(scene, backend);
}

/// A ball hits two balls at 30 degrees to either side of its path. n1.n2 = cos 60 = 0.5, G_kk = 2, G_kl = wA n1.n2 = 0.5,
/// and both impulses are equal: j = 2 u / (2 + 0.5), u = 2 cos 30 = sqrt 3, e = 1: j = 0.8 sqrt 3.
/// vA = 2 - 2 * 0.8 * sqrt 3 cos 30 = -0.4, vB = 0.8 sqrt 3 (cos 30, +-1/2) = (1.2, +-0.4 sqrt 3). The two collisions
/// share a body, so nothing is displaced.
fn a_ball_that_hits_two_balls_at_once_gives_both_equal_impulses(backend: Backend) {
    let mut scene = weightless();
    scene.settings.restitution = 1.0;
    let (cos, sin) = (0.999 * 0.75_f32.sqrt(), 0.999 * 0.5);
    spheres(
        &mut scene,
        [
            Sphere::new([0.0, 0.0, 0.0], 0.5).velocity([2.0, 0.0, 0.0]),
            Sphere::new([cos, sin, 0.0], 0.5),
            Sphere::new([cos, -sin, 0.0], 0.5),
        ],
    );
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    let side = 0.4 * 3.0_f64.sqrt();
    velocities(&after, [[-0.4, 0.0, 0.0], [1.2, side, 0.0], [1.2, -side, 0.0]]);
    displacements(&before, &after, [[0.0; 3]; 3]);
}

/// Two balls hit a third one of twice their mass from both sides at speeds 2 and 1. Both separate at e times their
/// approach velocity when 1.5 j1 - 0.5 j2 = 3.5 and 1.5 j2 - 0.5 j1 = 1.75: j1 = 3.0625, j2 = 2.1875. v1 = 2 - j1,
/// v2 = j2 - 1, middle: (j1 - j2) / 2. The sweeps leave an error of at most 1.4e-4 of the difference.
fn a_ball_hit_from_both_sides_separates_from_both_with_e(backend: Backend) {
    let mut scene = weightless();
    spheres(
        &mut scene,
        [
            Sphere::new([-0.99, 0.0, 0.0], 0.5).velocity([2.0, 0.0, 0.0]),
            Sphere::new([0.0, 0.0, 0.0], 0.5).mass(2.0),
            Sphere::new([0.98, 0.0, 0.0], 0.5).velocity([-1.0, 0.0, 0.0]),
        ],
    );
    let before = scene.spheres().to_vec();
    let after = collide(scene, backend);
    for (ball, expected) in after.iter().zip([-1.0625, 0.4375, 1.1875]) {
        near(ball.velocity, [expected, 0.0, 0.0], 1e-4, "velocity");
    }
    displacements(&before, &after, [[0.0; 3]; 3]);
}

/// A ball hits a ball at rest.
fn ball_hits_ball() -> Scene {
    let mut scene = weightless();
    spheres(&mut scene, [Sphere::new([-0.97, 0.0, 0.0], 0.5).velocity([2.0, 0.0, 0.0]), Sphere::new([0.0; 3], 0.5)]);
    scene
}

/// j = 1.75 * 2 / 2 = 1.75, even when other objects touch the two balls without approaching them. The overlap of 0.03
/// began 15 ms ago. The balls are displaced by their velocity change over that time only if no other contact is
/// pressed, except a wall perpendicular to the impulse. A neighbour in line with the impulse or beside it is a pressed
/// contact.
fn only_lone_collisions_displace(backend: Backend) {
    let wall = |scene: &mut Scene, low: [f32; 3], high: [f32; 3]| {
        scene.add_box(rockfall::Cuboid::between(low, high)).expect("a valid box");
    };
    type Beside<'a> = &'a dyn Fn(&mut Scene);
    let neighbour = |place: [f32; 3]| move |scene: &mut Scene| _ = spheres(scene, [Sphere::new(place, 0.5)]);
    let (in_line, across) = (neighbour([0.99, 0.0, 0.0]), neighbour([0.0, 0.99, 0.0]));
    let cases: [(Beside, f32); 5] = [
        (&|_| {}, 0.015),
        (&in_line, 0.0),
        (&across, 0.0),
        (&|scene| wall(scene, [-0.4, -2.0, -1.0], [1.0, -0.49, 1.0]), 0.015),
        (&|scene| wall(scene, [0.49, -1.0, -1.0], [2.0, 1.0, 1.0]), 0.0),
    ];
    for (add, time) in cases {
        let mut scene = ball_hits_ball();
        add(&mut scene);
        let before = scene.spheres()[..2].to_vec();
        let after = &collide(scene, backend)[..2];
        velocities(after, [[0.25, 0.0, 0.0], [1.75, 0.0, 0.0]]);
        displacements(&before, after, over(time, [[-1.75, 0.0, 0.0], [1.75, 0.0, 0.0]]));
    }
}

/// Objects of different groups have neither collisions nor contacts, whatever their kinds.
fn objects_of_different_groups_ignore_each_other(backend: Backend) {
    let build = |group: u16| {
        let mut scene = weightless();
        spheres(
            &mut scene,
            [
                Sphere::new([0.0, 0.4, 0.0], 0.5).velocity([0.0, -3.0, 0.0]).group(group),
                Sphere::new([0.8, 0.4, 0.0], 0.5).velocity([-3.0, 0.0, 0.0]),
            ],
        );
        let ends = [[-1.0, 0.6, 0.3], [1.0, 0.6, 0.3]].map(|end| Sphere::new(end, 0.01).group(2));
        rod(&mut scene, ends, 0.2);
        let id = scene.rod_ids().next().expect("a rod");
        scene.update_rod(id, |rod| rod.group = group + 2).expect("a valid rod");
        scene
    };
    let mut apart = build(1);
    let floor = rockfall::Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.3, 5.0]).group(9);
    apart.add_box(floor).expect("a valid box");
    untouched(apart.clone(), backend);
    for load in loads(apart, backend) {
        near(load.force, [0.0; 3], 0.0, "force across groups");
    }
    // Control: the same spheres in one group do collide.
    let after = collide(build(0), backend);
    assert!(after[1].velocity.x > -1.0, "the control must collide: {}", after[1].velocity);
}

both!(
    a_head_on_collision_changes_velocities_by_inverse_mass,
    an_oblique_collision_changes_only_the_normal_velocities,
    after_an_inelastic_collision_both_bodies_have_one_velocity,
    the_smaller_radius_sets_the_threshold,
    a_fixed_sphere_with_a_surface_velocity_hits_a_ball,
    fixed_spheres_do_not_collide_with_each_other,
    a_ball_that_hits_two_balls_at_once_gives_both_equal_impulses,
    a_ball_hit_from_both_sides_separates_from_both_with_e,
    only_lone_collisions_displace,
    objects_of_different_groups_ignore_each_other,
);
