use glam::Vec3;

use crate::mesh::Mesh;
use crate::scene::{Motion, MotionTerm, Polygon, Scene};

/// Two triangles that form a square, and a sliver.
fn square() -> Mesh {
    let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.5, 0.0, 1e-6]];
    Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3], [0, 1, 4]]).unwrap()
}

fn shapes(scene: &Scene) -> Vec<[Vec3; 3]> {
    scene.polygons().iter().map(|polygon| [polygon.corner, polygon.left, polygon.right]).collect()
}

#[test]
fn a_mesh_becomes_triangles_and_slivers_are_left_out() {
    let mut scene = Scene::new();
    let motion = scene.add_motion(Motion::new("drum", MotionTerm::translation([1.0, 0.0, 0.0]))).unwrap();
    let facets = scene.add_mesh(&square(), |triangle| triangle.group(3).motion(motion)).unwrap();
    assert_eq!((facets.ids.len(), facets.left_out), (2, 1));
    let is_right = |polygon: &Polygon| polygon.is_triangle() && polygon.group == 3 && polygon.motion == Some(motion);
    assert!(scene.polygons().iter().all(is_right));
    // The right angles of both triangles.
    let corners: Vec<Vec3> = shapes(&scene).iter().map(|shape| shape[0]).collect();
    assert_eq!(corners, [Vec3::Z, Vec3::X]);
}

#[test]
fn the_order_of_triangles_and_vertices_does_not_matter() {
    let mut mesh = Mesh::sphere(1.0, 2).unwrap();
    let mut scenes = Vec::new();
    for _ in 0..2 {
        let mut scene = Scene::new();
        scene.add_mesh(&mesh, |triangle| triangle).unwrap();
        scenes.push(shapes(&scene));
        mesh.triangles.reverse();
        mesh.triangles.iter_mut().for_each(|triangle| triangle.rotate_left(1));
    }
    assert_eq!(scenes[0], scenes[1]);
}

#[test]
fn a_wrong_mesh_adds_nothing() {
    let mut scene = Scene::new();
    let mut mesh = square();
    mesh.triangles.push([0, 1, 9]);
    let error = scene.add_mesh(&mesh, |triangle| triangle).unwrap_err().to_string();
    assert!(error.contains("triangle 3") && error.contains('9'), "{error}");
    let mut other = Scene::new();
    let motion = other.add_motion(Motion::new("drum", MotionTerm::default())).unwrap();
    assert!(scene.add_mesh(&square(), |triangle| triangle.motion(motion)).is_err());
    assert_eq!(scene.counts().polygons, 0);
}
