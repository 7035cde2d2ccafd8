//! Mass and rays of boxes of rigid bodies (docs/physics section 1.5).

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, Body, Cuboid, Options, Placement, Scene, Shape, Simulation};

const ORIGIN: [f32; 3] = [0.0; 3];

/// A box with these edges about the origin.
fn block(edges: [f32; 3]) -> Shape {
    let half = 0.5 * Vec3::from_array(edges);
    Shape::new().density(1000.0).cuboid(Cuboid::between(-half, half))
}

/// The mass properties are those of the sharp box.
#[test]
fn a_box_has_its_closed_form() {
    let mut scene = Scene::new();
    let shape = scene.add_shape(block([0.2, 0.3, 0.5])).unwrap();
    let properties = scene.shape(shape).unwrap().mass_properties_of().unwrap();
    assert!((properties.mass - 30.0).abs() < 1e-4, "{properties:?}");
    let [xx, yy, zz, ..] = properties.inertia;
    for (found, exact) in [(xx, 30.0 / 12.0 * 0.34), (yy, 30.0 / 12.0 * 0.29), (zz, 30.0 / 12.0 * 0.13)] {
        assert!((found / exact - 1.0).abs() < 1e-5, "{properties:?}");
    }
    // A box that a ball overlaps by an eighth of the ball: the volume of the union.
    let corner = Shape::new().density(1.0).cuboid(Cuboid::between([-1.0; 3], ORIGIN)).sphere(ORIGIN, 0.5);
    let union = 1.0 + 7.0 / 8.0 * std::f64::consts::PI / 6.0;
    let found = corner.mass_properties_of().unwrap();
    assert!((found.mass / union - 1.0).abs() < 1e-3, "{found:?} {union}");
}

/// A ray meets the faces of a turned box, and neither the sphere that stands for it nor its vertices and edges.
#[test]
fn rays_meet_the_faces_of_a_box() {
    let mut scene = Scene::new();
    let shape = scene.add_shape(block([0.4, 0.2, 0.2])).unwrap();
    let body = scene.add_body(Placement::new(shape).at([1.0, 0.0, 0.0]).turned(Quat::from_rotation_z(0.5))).unwrap();
    let solid = scene.body(body).unwrap().spheres()[0];
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("the simulation opens");
    // Along x through the centre: the long face is h / sin a away from the centre, nearer than the end at H / cos a.
    let hit = simulation.cast_ray([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]).unwrap().expect("a hit");
    assert_eq!(hit.body, Body::Sphere(solid));
    assert!((hit.distance - (1.0 - 0.1 / 0.5_f32.sin())).abs() < 1e-5, "{hit:?}");
    let normal = Quat::from_rotation_z(0.5) * Vec3::Y;
    assert!(hit.normal.distance(normal) < 1e-5, "{hit:?}");
    assert_eq!(simulation.cast_ray([0.0, 0.15, 0.0], [1.0, 0.0, 0.0]).unwrap().map(|hit| hit.body), Some(Body::Sphere(solid)));
    // Past a corner and past a face, but inside the sphere around the box.
    for origin in [[0.0, 0.2, 0.0], [0.0, 0.0, 0.15]] {
        assert_eq!(simulation.cast_ray(origin, [1.0, 0.0, 0.0]).unwrap(), None);
    }
}
