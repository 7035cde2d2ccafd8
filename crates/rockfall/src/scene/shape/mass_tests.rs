use std::f64::consts::PI;

use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

use super::*;
use crate::scene::{Shape, ShapeMass};

fn properties(shape: &Shape) -> MassProperties {
    shape.mass_properties_of().expect("a valid shape")
}

fn tensor(properties: &MassProperties) -> DMat3 {
    let [xx, yy, zz, xy, xz, yz] = properties.inertia;
    DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
}

fn near(found: f64, expected: f64, share: f64) {
    assert!((found - expected).abs() <= share * expected.abs().max(1e-9), "{found}, expected {expected}");
}

/// The greatest difference of two tensors, as a share of the trace.
fn difference(a: DMat3, b: DMat3) -> f64 {
    (a - b).to_cols_array().iter().fold(0.0_f64, |most, x| most.max(x.abs())) / (a.x_axis.x + a.y_axis.y + a.z_axis.z)
}

#[test]
fn a_lone_sphere_has_its_closed_form() {
    let found = properties(&Shape::new().sphere([1.0, -2.0, 3.0], 0.5).mass(3.0));
    assert_eq!((found.mass, found.centre), (3.0, [1.0, -2.0, 3.0]));
    for (element, expected) in found.inertia.into_iter().zip([0.3, 0.3, 0.3, 0.0, 0.0, 0.0]) {
        assert!((element - expected).abs() < 1e-15, "{element}");
    }
}

#[test]
fn spheres_that_do_not_overlap_add_up() {
    let found = properties(&Shape::new().sphere([0.0; 3], 1.0).sphere([5.0, 0.0, 0.0], 0.5).density(2.0));
    let [m, n] = [1.0_f64, 0.5].map(|r| 2.0 * 4.0 / 3.0 * PI * r.powi(3));
    near(found.mass, m + n, 1e-14);
    near(found.centre[0], 5.0 * n / (m + n), 1e-14);
    let along = 0.4 * (m + 0.25 * n);
    near(found.inertia[0], along, 1e-14);
    near(found.inertia[1], along + 25.0 * m * n / (m + n), 1e-14);
    near(found.inertia[2], found.inertia[1], 1e-14);
}

#[test]
fn a_capsule_is_a_solid_spherocylinder() {
    let (r, l) = (0.5_f64, 1.5_f64);
    let shape = Shape::new().capsule([0.0; 3], [0.0, 1.5, 0.0], 0.5).density(1.0);
    let found = properties(&shape);
    // A cylinder and two half balls (parallel axes with 3/8 r).
    let (rod, ball) = (PI * r * r * l, 4.0 / 3.0 * PI * r.powi(3));
    near(found.mass, rod + ball, 1e-14);
    let along = 0.5 * rod * r * r + 0.4 * ball * r * r;
    let across = rod * (l * l / 12.0 + r * r / 4.0) + ball * (0.4 * r * r + l * l / 4.0 + 3.0 / 8.0 * r * l);
    near(found.inertia[1], along, 1e-14);
    near(found.inertia[0], across, 1e-14);
    near(found.inertia[2], across, 1e-14);
    near(found.centre[1], 0.75, 1e-14);
    // The same by integration: a grain far away keeps the closed form of the capsule from being used.
    let far = properties(&shape.sphere([0.0, 0.0, 40.0], 1e-3));
    near(far.mass, rod + ball, 1e-5);
    near(far.inertia[1], along, 1e-3);
    near(far.inertia[0], across, 1e-3);
}

#[test]
fn a_lens_counts_once() {
    for (small, d) in [(1.0, 1.0), (0.7, 0.9), (0.4, 1.3), (0.2, 0.9)] {
        let found = properties(&Shape::new().sphere([0.0; 3], 1.0).sphere([0.0, d as f32, 0.0], small as f32).density(1.0));
        let (large, small, d) = (1.0_f64, f64::from(small as f32), f64::from(d as f32));
        let lens =
            PI * (large + small - d).powi(2) * (d * d + 2.0 * d * (large + small) - 3.0 * (large - small).powi(2)) / (12.0 * d);
        let balls = 4.0 / 3.0 * PI * (large.powi(3) + small.powi(3));
        near(balls - found.mass, lens, 1e-3);
        near(found.mass, balls - lens, 1e-4);
    }
}

/// Two equal balls that touch the centre of each other: integrals of the ball without the cap beyond the plane in the middle.
#[test]
fn a_dimer_has_the_inertia_of_two_cut_balls() {
    let found = properties(&Shape::new().sphere([-0.5, 0.0, 0.0], 1.0).sphere([0.5, 0.0, 0.0], 1.0).density(1.0));
    // The cut ball about its centre reaches from x = -1/2 to 1, in discs of radius squared s = 1 - x².
    let along = simpson(|x| 0.5 * PI * (1.0 - x * x).powi(2), -0.5, 1.0);
    let across = simpson(|x| PI * ((1.0 - x * x).powi(2) / 4.0 + (1.0 - x * x) * (x + 0.5).powi(2)), -0.5, 1.0);
    near(found.mass, 2.0 * simpson(|x| PI * (1.0 - x * x), -0.5, 1.0), 1e-4);
    near(found.inertia[0], 2.0 * along, 1e-4);
    near(found.inertia[1], 2.0 * across, 1e-4);
    near(found.inertia[2], 2.0 * across, 1e-4);
    assert!(found.centre.iter().all(|x| x.abs() < 1e-12), "{:?}", found.centre);
    assert_eq!(found.principal().1, DQuat::IDENTITY);
}

fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let n = 1000;
    let h = (to - from) / f64::from(n);
    let weight = |k| if k == 0 || k == n { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
    (0..=n).map(|k| weight(k) * f(from + h * f64::from(k))).sum::<f64>() * h / 3.0
}

#[test]
fn a_tetrapod_has_equal_moments() {
    let legs = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0_f32]];
    let with_leg = |(number, shape): (usize, Shape), leg: [f32; 3]| (number + 1, shape.sphere(leg, 0.4).rod(0, number, 0.3));
    let (_, shape) = legs.into_iter().fold((1, Shape::new().sphere([0.0; 3], 0.5)), with_leg);
    let found = properties(&shape.mass(2.0));
    let [xx, yy, zz, ..] = found.inertia;
    near(xx, yy, 1e-12);
    near(xx, zz, 1e-4);
    assert!(found.inertia[3..].iter().all(|element| element.abs() < 1e-12 * xx), "{:?}", found.inertia);
    assert!(found.centre.iter().all(|x| x.abs() < 1e-12), "{:?}", found.centre);
}

#[test]
fn a_rotated_shape_has_the_rotated_tensor() {
    let centres = [[0.0, 0.0, 0.0], [0.8, 0.1, 0.0], [0.2, 0.9, 0.3], [-0.4, 0.3, 0.7]].map(Vec3::from_array);
    let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
    let place = Vec3::new(3.0, -1.0, 0.5);
    let shape = |at: &dyn Fn(Vec3) -> Vec3| {
        let all = centres.iter().zip([0.5, 0.6, 0.4, 0.7]);
        all.fold(Shape::new(), |shape, (centre, radius)| shape.sphere(at(*centre), radius)).rod(1, 2, 0.3).rod(0, 3, 0.45)
    };
    let (one, other) = (properties(&shape(&|x| x)), properties(&shape(&|x| turn * x + place)));
    let wide = turn.as_dquat().normalize();
    let rotation = DMat3::from_quat(wide);
    let expected = rotation * tensor(&one) * rotation.transpose();
    assert!(difference(tensor(&other), expected) < 1e-4, "{:?}\n{expected:?}", other.inertia);
    let centre = wide * DVec3::from_array(one.centre) + place.as_dvec3();
    assert!(DVec3::from_array(other.centre).distance(centre) < 1e-4);
    let ([moments, turned], [axes, _]) = ([one.principal().0, other.principal().0], [one.principal().1, other.principal().1]);
    assert!((moments - turned).abs().max_element() < 1e-4 * moments.max_element(), "{moments} {turned}");
    assert!(moments.x <= moments.y && moments.y <= moments.z);
    let back = DMat3::from_quat(axes);
    let again = back * DMat3::from_diagonal(moments) * back.transpose();
    assert!(difference(again, tensor(&one)) < 1e-14, "{again:?}\n{:?}", one.inertia);
}

#[test]
fn given_properties_are_kept() {
    let shape = Shape::new().sphere([0.0; 3], 1.0).mass_properties(2.0, [0.5, 0.0, 0.0], [3.0, 2.0, 2.0, 0.5, 0.0, 0.0]);
    let found = properties(&shape);
    assert_eq!(found, MassProperties { mass: 2.0, centre: [0.5, 0.0, 0.0], inertia: [3.0, 2.0, 2.0, 0.5, 0.0, 0.0] });
    let (moments, axes) = found.principal();
    near(moments.x, 2.5 - 0.5_f64.sqrt(), 1e-14);
    near(moments.z, 2.5 + 0.5_f64.sqrt(), 1e-14);
    near(moments.y, 2.0, 1e-14);
    let first = axes * DVec3::X;
    assert!((tensor(&found) * first).distance(first * moments.x) < 1e-14);
}

#[test]
fn impossible_shapes_are_refused() {
    let ball = || Shape::new().sphere([0.0; 3], 1.0);
    let given = |inertia| ball().mass_properties(1.0, [0.0; 3], inertia);
    for (shape, part) in [
        (Shape::new(), "shape.parts: 0 is not allowed, expected at least one sphere"),
        (ball().mass(0.0), "shape.mass: 0"),
        (ball().density(f32::NAN), "shape.density: NaN"),
        (ball().mass(1e-40), "shape.mass: "),
        (Shape::new().sphere([f32::INFINITY, 0.0, 0.0], 1.0), "shape.sphere.centre: "),
        (Shape::new().sphere([0.0; 3], -1.0), "shape.sphere.radius: -1"),
        (ball().rod(0, 1, 1.0), "shape.rod: [0, 1] is not allowed, expected the numbers, from 0, of two spheres"),
        (ball().sphere([0.0; 3], 1.0).rod(0, 1, 1.0), "shape.rod: [0, 1]"),
        (ball().sphere([1.0; 3], 1.0).rod(0, 1, 0.0), "shape.rod.radius: 0"),
        (given([1.0, 1.0, 3.0, 0.0, 0.0, 0.0]), "none of which is greater than the sum of the other two"),
        (given([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]), "principal moments greater than 0"),
        (given([1.0, 1.0, 1.0, 1.5, 0.0, 0.0]), "principal moments greater than 0"),
        (given([1.0, 1.0, 1.0, f32::NAN, 0.0, 0.0]), "expected finite numbers"),
        (ball().name("two words"), "shape.name: 'two words'"),
    ] {
        let error = shape.mass_properties_of().expect_err(part).to_string();
        assert!(error.contains(part), "{error}");
    }
    assert!(matches!(given([1.0; 6]).mass, ShapeMass::Given { .. }));
}
