//! Pictures of the convex hulls of rigid bodies.

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{Backend, ContactLaw, Placement, Scene, Shape};
use rockfall_viewer::camera::Camera;

use crate::common::{assert_covers, outlines, simulation, take};

const POINTS: [Vec3; 5] =
    [Vec3::ZERO, Vec3::new(1.5, 0.0, 0.2), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.1, 0.2, 1.2), Vec3::new(-0.5, -0.4, 0.3)];

/// Whether a ray meets one of some triangles.
fn meets(triangles: Vec<[DVec3; 3]>) -> impl Fn(DVec3, DVec3) -> bool {
    move |origin, direction| {
        triangles.iter().any(|corners| {
            let side = |k: usize| (corners[k] - origin).cross(corners[(k + 1) % 3] - origin).dot(direction);
            let sides = [side(0), side(1), side(2)];
            sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
        })
    }
}

/// The sphere around a hull is not drawn, and a body of two hulls has both where they are.
#[test]
fn a_hull_covers_its_triangles() {
    let camera = Camera::new([2.0, 3.0, 7.0], [0.3, 0.4, 0.0]);
    let (turn, origin) = (Quat::from_euler(rockfall::glam::EulerRot::XYZ, 0.4, -0.7, 1.1), Vec3::new(0.4, 0.3, -0.2));
    let shift = Vec3::new(-2.0, 0.5, 0.0);
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut scene = Scene::new();
        scene.settings.contact_law = ContactLaw::Rigid;
        let shape = Shape::new().add_hull(POINTS).unwrap().add_hull(POINTS.map(|point| 0.5 * point + shift)).unwrap();
        let world = |point: Vec3| (origin + turn * point).as_dvec3();
        let triangles = shape.hulls.iter().flat_map(|hull| hull.triangles()).map(|triangle| triangle.map(world)).collect();
        let shape = scene.add_shape(shape).unwrap();
        scene.add_body(Placement::new(shape).at(origin.as_dvec3()).turned(turn)).unwrap();
        assert_covers(&take(&mut simulation(scene, backend), &camera, &outlines()), &camera, meets(triangles));
    }
}
