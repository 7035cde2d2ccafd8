use glam::Vec3;

use crate::scene::{Cuboid, MassProperties, Placement, Scene, Shape};

const TETRAHEDRON: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];

fn corners(edge: f32) -> Vec<Vec3> {
    (0..8).map(|k| edge * Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32)).collect()
}

fn near(found: &MassProperties, expected: &MassProperties, share: f64) {
    let numbers = |of: &MassProperties| [&[of.mass], of.centre.as_slice(), &of.inertia].concat();
    let greatest = numbers(expected).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (one, other) in numbers(found).iter().zip(numbers(expected)) {
        assert!((one - other).abs() < share * greatest, "{found:?}, expected {expected:?}");
    }
}

/// A tetrahedron with the edges a, b, c on the axes has the volume abc/6, its centre at a quarter of them, and about it the inertia
/// xx = 3/80 m (b² + c²), xy = m ab / 80.
#[test]
fn a_tetrahedron_has_its_closed_form() {
    let found = Shape::new().density(1000.0).add_hull(TETRAHEDRON).unwrap().mass_properties_of().unwrap();
    let m = 1000.0;
    let inertia = [13.0, 10.0, 5.0].map(|sum| 3.0 / 80.0 * m * sum);
    let products = [2.0, 3.0, 6.0].map(|product| m * product / 80.0);
    let inertia = [inertia[0], inertia[1], inertia[2], products[0], products[1], products[2]];
    near(&found, &MassProperties { mass: m, centre: [0.25, 0.5, 0.75], inertia }, 1e-6);
}

#[test]
fn a_hull_that_is_a_box_has_its_mass_alone_and_in_overlaps() {
    let cube = Cuboid::between([0.0; 3], [2.0; 3]);
    let (hull, solid) = (|shape: Shape| shape.add_hull(corners(2.0)).unwrap(), |shape: Shape| shape.cuboid(cube));
    for shape in [Shape::new().density(3.0), Shape::new().density(3.0).sphere([2.0, 1.0, 1.0], 0.7)] {
        let [found, expected] = [hull(shape.clone()), solid(shape)].map(|shape| shape.mass_properties_of().unwrap());
        near(&found, &expected, 1e-4);
    }
    // All of the second hull is inside the first.
    let twice = hull(Shape::new().density(3.0)).add_hull(corners(1.0)).unwrap().mass_properties_of().unwrap();
    near(&twice, &solid(Shape::new().density(3.0)).mass_properties_of().unwrap(), 1e-4);
}

/// Points inside shift the middle of all points, so that sums round differently. The hull of the vertices alone has the same digits.
#[test]
fn points_inside_do_not_count() {
    let share = |number: u32| (number.wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 24) as f32;
    for round in 0..100 {
        let inside = (0..5).map(|k| 0.7 * Vec3::from_array([0, 1, 2].map(|axis| share(15 * round + 3 * k + axis))));
        let whole = Shape::new().add_hull(inside.chain(corners(0.7)).map(|point| point + Vec3::splat(0.1))).unwrap();
        let points = whole.hulls[0].points().to_vec();
        assert_eq!(points.len(), 8);
        assert_eq!(Shape::new().add_hull(points).unwrap().hulls, whole.hulls, "round {round}");
    }
}

#[test]
fn a_hull_is_a_sphere_of_the_scene_with_its_share_of_the_mass() {
    let mut scene = Scene::new();
    let shape = Shape::new().mass(8.0).sphere([9.0, 0.0, 0.0], 0.5).add_hull(corners(2.0)).unwrap();
    let shape = scene.add_shape(shape).unwrap();
    let body = scene.add_body(Placement::new(shape).at([0.0, 5.0, 0.0])).unwrap();
    assert_eq!(scene.body(body).unwrap().spheres().len(), scene.shape(shape).unwrap().sphere_count());
    let sphere = &scene.spheres()[1];
    assert!((sphere.position - Vec3::new(1.0, 6.0, 1.0)).length() < 1e-5 && (sphere.radius - 3_f32.sqrt()).abs() < 1e-6);
    let volume = std::f32::consts::PI / 6.0;
    assert!((sphere.mass - 8.0 * 8.0 / (8.0 + volume)).abs() < 1e-5, "{}", sphere.mass);
    let reach = scene.shape_reach(shape).unwrap();
    assert!(reach > 8.0 && reach < 9.0, "{reach}");
}

#[test]
fn the_surface_is_closed_and_has_the_volume() {
    let shape = Shape::new().add_hull(corners(2.0).into_iter().map(|corner| corner + Vec3::splat(3.0))).unwrap();
    let triangles: Vec<_> = shape.hulls[0].triangles().collect();
    let volume = triangles.iter().map(|[p, q, r]| p.dot(q.cross(*r)) / 6.0).sum::<f32>();
    assert!(triangles.len() == 12 && (volume - 8.0).abs() < 1e-4, "{volume}");
}

#[test]
fn points_without_a_hull_are_refused_by_name() {
    let error = |points: &[Vec3]| Shape::new().add_hull(points.iter().copied()).unwrap_err().to_string();
    let ball = |count: u32| {
        let place = |k: u32| {
            let (height, angle) = (1.0 - 2.0 * (k as f32 + 0.5) / count as f32, 2.4 * k as f32);
            let across = (1.0 - height * height).sqrt();
            Vec3::new(across * angle.cos(), height, across * angle.sin())
        };
        (0..count).map(place).collect::<Vec<_>>()
    };
    for (points, part) in [
        (corners(1.0)[..3].to_vec(), "shape.hull.points: 3 points is not allowed, expected 4 to 100000"),
        (vec![Vec3::ZERO; 100_001], "100001 points"),
        (corners(1.0).into_iter().map(|corner| corner * Vec3::new(1.0, 0.0, 1.0)).collect(), "one plane"),
        (vec![Vec3::NAN; 4], "[NaN, NaN, NaN] of point 0 is not allowed, expected three finite numbers"),
        (vec![Vec3::INFINITY; 4], "three finite numbers"),
        (corners(1e16), "at most 1e15"),
        (ball(40), "a hull with 76 faces is not allowed, expected a hull with at most 32 faces"),
        (ball(3000), "at most 32 faces"),
    ] {
        assert!(error(&points).contains(part), "{}: {part}", error(&points));
    }
}
