//! Contacts whose distance is 0 except for rounding. They have no normal of their own, so a rule gives it
//! (`docs/physics` section 2). Also contacts that have a small but real distance, and slips that are only rounding
//! errors.

use rockfall::glam::{EulerRot, Quat, Vec3};
use rockfall::{Backend, Contact, Cuboid, Sphere};

use super::observing::only_contact;
use crate::common::*;

#[track_caller]
fn assert_contact(contact: &Contact, normal: [f64; 3], overlap: f64) {
    near(contact.normal, normal, 1e-5, "normal");
    assert_overlap(contact, overlap);
}

#[track_caller]
fn assert_overlap(contact: &Contact, overlap: f64) {
    assert!((f64::from(contact.overlap) / overlap - 1.0).abs() < 0.02, "{contact:?}, expected an overlap of {overlap}");
}

/// The axis crosses the edge x = y = 0 at a third of its length, which is not a binary fraction. The outward direction
/// there is (-1, 1, 0) / sqrt(2).
fn a_rod_whose_axis_crosses_a_box_edge_is_pushed_out(backend: Backend) {
    let mut scene = weightless();
    scene.add_box(Cuboid::between([0.0, -2.0, -3.0], [2.0, 0.0, 3.0])).expect("a valid box");
    let ends = [[-1.0, -1.0, 0.3], [2.0, 2.0, 0.3]].map(|end| Sphere::new(end, 0.05));
    rod(&mut scene, ends, 0.1);
    let half = 0.5_f64.sqrt();
    assert_contact(&only_contact(scene, backend), [half, -half, 0.0], 0.1);
}

/// Two axes that cross at a third of one and three fourteenths of the other: the normal is the common normal of the
/// axes.
fn rods_whose_axes_cross_have_the_common_normal(backend: Backend) {
    let mut scene = weightless();
    rod(&mut scene, [[-1.0, 0.2, 0.7], [2.0, 0.2, 0.7]].map(|end| Sphere::new(end, 0.05)), 0.1);
    rod(&mut scene, [[0.0, 0.2, 0.4], [0.0, 0.2, 1.8]].map(|end| Sphere::new(end, 0.05)), 0.2);
    assert_contact(&only_contact(scene, backend), [0.0, -1.0, 0.0], 0.3);
}

/// The same with 1e-4 between the axes, whose lengths are 3 and 1.4: the normal is still the common normal.
fn rods_whose_axes_almost_cross_have_the_common_normal(backend: Backend) {
    for gap in [1e-4_f32, -1e-4] {
        let mut scene = weightless();
        rod(&mut scene, [[-1.0, 0.0, 0.7], [2.0, 0.0, 0.7]].map(|end| Sphere::new(end, 0.05)), 0.1);
        rod(&mut scene, [[0.1, gap, 0.4], [0.3, gap, 1.8]].map(|end| Sphere::new(end, 0.05)), 0.2);
        let contact = only_contact(scene, backend);
        assert_contact(&contact, [0.0, f64::from(gap.signum()), 0.0], 0.2999);
    }
}

/// Rods that are almost parallel, at angles from 1e-3 to 1e-1 and with an oblique orientation, touch where they cross.
/// Their overlap is 0.3 - 0.299.
fn almost_parallel_rods_touch_where_they_cross(backend: Backend) {
    let rotation = Quat::from_euler(EulerRot::XYZ, 0.7, -0.4, 1.1);
    for angle in [1e-3_f32, 3e-3, 1e-2, 3e-2, 1e-1] {
        let mut scene = weightless();
        let end = |place: [f32; 3]| Sphere::new(rotation * Vec3::from_array(place), 0.05);
        rod(&mut scene, [[-1.7, 0.0, 0.1], [2.3, 0.0, 0.1]].map(end), 0.1);
        rod(&mut scene, [-1.9_f32, 1.6].map(|x| end([0.2 + x * angle.cos(), 0.299, 0.1 + x * angle.sin()])), 0.2);
        let contact = only_contact(scene, backend);
        near(contact.normal, (rotation * Vec3::Y).as_dvec3(), 2e-3, "normal");
        assert_overlap(&contact, 0.001);
    }
}

/// A ball whose centre is on the far face of a box is pushed out through that face.
fn a_ball_with_its_centre_on_a_face_leaves_through_that_face(backend: Backend) {
    for width in [0.3, 0.7, 2.3, 4.9] {
        let mut scene = weightless();
        scene.add_box(Cuboid::between([20.1, 0.1, 0.1], [20.1 + width, 9.3, 7.7])).expect("a valid box");
        spheres(&mut scene, [Sphere::new([20.1 + width, 4.7, 3.3], 0.25)]);
        assert_contact(&only_contact(scene, backend), [-1.0, 0.0, 0.0], 0.25);
    }
}

/// The rule applies only to contacts without a normal. A grain on a floor a million times as wide keeps its actual
/// overlap.
fn a_grain_on_a_wide_floor_keeps_its_overlap(backend: Backend) {
    for height in [0.0002, 0.0004, 0.0009] {
        let mut scene = weightless();
        scene.add_box(Cuboid::between([-500.0, -1.0, -500.0], [500.0, 0.0, 500.0])).expect("a valid box");
        spheres(&mut scene, [Sphere::new([0.0, height, 0.0], 0.001)]);
        assert_contact(&only_contact(scene, backend), [0.0, -1.0, 0.0], 0.001 - f64::from(height));
    }
}

/// Balls whose centres are 1e-5 from an axis and from a face are pushed directly away from it. Rounding moves the foot
/// of the perpendicular by a hundredth of the distance.
fn centres_almost_on_an_axis_or_a_face_are_pushed_away_from_it(backend: Backend) {
    for place in [-0.7_f32, 0.1, 0.3, 1.1, 1.7] {
        let mut scene = weightless();
        rod(&mut scene, [[-1.0, 0.0, 0.7], [2.0, 0.0, 0.7]].map(|end| Sphere::new(end, 0.05)), 0.1);
        spheres(&mut scene, [Sphere::new([place, 1e-5, 0.7], 0.2)]);
        let contact = only_contact(scene, backend);
        // The normal points from the sphere or from the rod: the one that was added first is A.
        assert_contact(&contact, [0.0, f64::from(contact.normal.y.signum()), 0.0], 0.3);

        let mut scene = weightless();
        scene.add_box(Cuboid::between([-1.3, -1.0, -0.9], [2.3, 0.0, 2.9])).expect("a valid box");
        spheres(&mut scene, [Sphere::new([place, 1e-5, 0.7], 0.2)]);
        assert_contact(&only_contact(scene, backend), [0.0, -1.0, 0.0], 0.2);
    }
}

/// There is no friction between bodies that have the same velocity, that move along the normal only, or that roll.
/// Their slip comes from rounding only, and the friction force grows with its square root.
fn rounding_errors_cause_no_friction(backend: Backend) {
    for velocity in [[0.3, 0.7, 1.1], [2.3, -0.7, 0.1], [-0.1, 0.9, -7.3]] {
        let mut scene = weightless();
        let end = |place: [f32; 3]| Sphere::new(place, 0.05).velocity(velocity);
        rod(&mut scene, [[-1.0, 0.0, 0.7], [2.0, 0.0, 0.7]].map(end), 0.1);
        rod(&mut scene, [[0.1, 0.2, 0.4], [0.3, 0.2, 1.8]].map(end), 0.15);
        torques(&loads(scene, backend), [[0.0; 3]; 4], 0.0);
    }
    let place = Vec3::new(0.3, -0.4, 0.7);
    for speed in [0.3, 1.7, 3.1] {
        let mut scene = weightless();
        let falling = Sphere::new(place, 0.5).velocity(speed * place.normalize());
        spheres(&mut scene, [Sphere::new(Vec3::ZERO, 0.5).fixed(), falling]);
        torques(&loads(scene, backend), [[0.0; 3]; 2], 0.0);

        let mut scene = weightless();
        floor_box(&mut scene);
        // The arm is the height, 0.48.
        let ball = Sphere::new([0.0, 0.48, 0.0], 0.5).velocity([speed, 0.0, 0.0]);
        spheres(&mut scene, [ball.angular_momentum([0.0, 0.0, -speed / 0.48 * ball.inertia()])]);
        torques(&loads(scene, backend), [[0.0; 3]], 0.0);
    }
}

both!(
    a_rod_whose_axis_crosses_a_box_edge_is_pushed_out,
    rods_whose_axes_cross_have_the_common_normal,
    rods_whose_axes_almost_cross_have_the_common_normal,
    almost_parallel_rods_touch_where_they_cross,
    a_ball_with_its_centre_on_a_face_leaves_through_that_face,
    a_grain_on_a_wide_floor_keeps_its_overlap,
    centres_almost_on_an_axis_or_a_face_are_pushed_away_from_it,
    rounding_errors_cause_no_friction,
);
