//! Touches that have no normal of their own, for the distance is 0 but for rounding: a rule gives it (physics.md section 2). And slips that
//! are.

use rockfall::glam::{EulerRot, Quat, Vec3};
use rockfall::{Backend, Contact, Cuboid, Sphere};

use crate::common::*;
use crate::observing::only_contact;

#[track_caller]
fn touch(contact: &Contact, normal: [f64; 3], overlap: f64) {
    near(contact.normal, normal, 1e-5, "normal");
    depth(contact, overlap);
}

#[track_caller]
fn depth(contact: &Contact, overlap: f64) {
    assert!((f64::from(contact.overlap) / overlap - 1.0).abs() < 0.02, "{contact:?}, expected an overlap of {overlap}");
}

/// The axis meets the edge x = y = 0 at a third of its length, which is no binary fraction. Outward there is (-1, 1, 0) / sqrt(2).
fn rod_through_a_box_edge(backend: Backend) {
    let mut scene = weightless();
    scene.add_box(Cuboid::between([0.0, -2.0, -3.0], [2.0, 0.0, 3.0])).expect("a valid box");
    let ends = [[-1.0, -1.0, 0.3], [2.0, 2.0, 0.3]].map(|end| Sphere::new(end, 0.05));
    rod(&mut scene, ends, 0.1);
    let half = 0.5_f64.sqrt();
    touch(&only_contact(scene, backend), [half, -half, 0.0], 0.1);
}

/// Two axes that cross at a third of one and three fourteenths of the other: the normal is that of both.
fn rods_whose_axes_cross(backend: Backend) {
    let mut scene = weightless();
    rod(&mut scene, [[-1.0, 0.2, 0.7], [2.0, 0.2, 0.7]].map(|end| Sphere::new(end, 0.05)), 0.1);
    rod(&mut scene, [[0.0, 0.2, 0.4], [0.0, 0.2, 1.8]].map(|end| Sphere::new(end, 0.05)), 0.2);
    touch(&only_contact(scene, backend), [0.0, -1.0, 0.0], 0.3);
}

/// The same with 1e-4 between the axes, of lengths of 3 and 1.4: it lies along the common normal all the same.
fn rods_whose_axes_all_but_cross(backend: Backend) {
    for gap in [1e-4_f32, -1e-4] {
        let mut scene = weightless();
        rod(&mut scene, [[-1.0, 0.0, 0.7], [2.0, 0.0, 0.7]].map(|end| Sphere::new(end, 0.05)), 0.1);
        rod(&mut scene, [[0.1, gap, 0.4], [0.3, gap, 1.8]].map(|end| Sphere::new(end, 0.05)), 0.2);
        let contact = only_contact(scene, backend);
        touch(&contact, [0.0, f64::from(gap.signum()), 0.0], 0.2999);
    }
}

/// Logs that are all but parallel, at angles from 1e-3 to 1e-1 and askew in space, touch where they cross, as deep as they do: 0.3 -
/// 0.299.
fn logs_all_but_parallel(backend: Backend) {
    let askew = Quat::from_euler(EulerRot::XYZ, 0.7, -0.4, 1.1);
    for angle in [1e-3_f32, 3e-3, 1e-2, 3e-2, 1e-1] {
        let mut scene = weightless();
        let end = |place: [f32; 3]| Sphere::new(askew * Vec3::from_array(place), 0.05);
        rod(&mut scene, [[-1.7, 0.0, 0.1], [2.3, 0.0, 0.1]].map(end), 0.1);
        rod(&mut scene, [-1.9_f32, 1.6].map(|x| end([0.2 + x * angle.cos(), 0.299, 0.1 + x * angle.sin()])), 0.2);
        let contact = only_contact(scene, backend);
        near(contact.normal, (askew * Vec3::Y).as_dvec3(), 2e-3, "normal");
        depth(&contact, 0.001);
    }
}

/// A ball whose centre is on the far face of a box leaves through it.
fn centre_on_a_face_of_a_box(backend: Backend) {
    for width in [0.3, 0.7, 2.3, 4.9] {
        let mut scene = weightless();
        scene.add_box(Cuboid::between([20.1, 0.1, 0.1], [20.1 + width, 9.3, 7.7])).expect("a valid box");
        spheres(&mut scene, [Sphere::new([20.1 + width, 4.7, 3.3], 0.25)]);
        touch(&only_contact(scene, backend), [-1.0, 0.0, 0.0], 0.25);
    }
}

/// A rule is for what has no normal alone: a grain on a floor a million times as wide sinks in as deep as it does.
fn grain_on_a_wide_floor(backend: Backend) {
    for height in [0.0002, 0.0004, 0.0009] {
        let mut scene = weightless();
        scene.add_box(Cuboid::between([-500.0, -1.0, -500.0], [500.0, 0.0, 500.0])).expect("a valid box");
        spheres(&mut scene, [Sphere::new([0.0, height, 0.0], 0.001)]);
        touch(&only_contact(scene, backend), [0.0, -1.0, 0.0], 0.001 - f64::from(height));
    }
}

/// Balls 1e-5 away from an axis and from a face are pushed straight away from it. Where their foot is, is rounded, and that by
/// a hundredth of the distance.
fn centres_all_but_on_an_axis_and_on_a_face(backend: Backend) {
    for place in [-0.7_f32, 0.1, 0.3, 1.1, 1.7] {
        let mut scene = weightless();
        rod(&mut scene, [[-1.0, 0.0, 0.7], [2.0, 0.0, 0.7]].map(|end| Sphere::new(end, 0.05)), 0.1);
        spheres(&mut scene, [Sphere::new([place, 1e-5, 0.7], 0.2)]);
        let contact = only_contact(scene, backend);
        // From the sphere or from the rod: whichever was added first is A.
        touch(&contact, [0.0, f64::from(contact.normal.y.signum()), 0.0], 0.3);

        let mut scene = weightless();
        scene.add_box(Cuboid::between([-1.3, -1.0, -0.9], [2.3, 0.0, 2.9])).expect("a valid box");
        spheres(&mut scene, [Sphere::new([place, 1e-5, 0.7], 0.2)]);
        touch(&only_contact(scene, backend), [0.0, -1.0, 0.0], 0.2);
    }
}

/// What moves alike does not rub, nor what moves along the normal alone, and what rolls: all there is of a slip comes from
/// rounding, and friction goes with its root.
fn rounding_does_not_rub(backend: Backend) {
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
        // The arm is the height: 0.48.
        let ball = Sphere::new([0.0, 0.48, 0.0], 0.5).velocity([speed, 0.0, 0.0]);
        spheres(&mut scene, [ball.angular_momentum([0.0, 0.0, -speed / 0.48 * ball.inertia()])]);
        torques(&loads(scene, backend), [[0.0; 3]], 0.0);
    }
}

both!(
    rod_through_a_box_edge,
    rods_whose_axes_cross,
    rods_whose_axes_all_but_cross,
    logs_all_but_parallel,
    centre_on_a_face_of_a_box,
    grain_on_a_wide_floor,
    centres_all_but_on_an_axis_and_on_a_face,
    rounding_does_not_rub,
);
