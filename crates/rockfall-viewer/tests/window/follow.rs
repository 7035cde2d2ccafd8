//! A camera that follows a body, and colours of scenes that are opened later.

use std::rc::Rc;

use rockfall::glam::Vec3;
use rockfall::{Colour, ObjectId, Scene, SphereId, Tag};
use rockfall_viewer::window::follow::Follow;

use super::common::{session, viewer};

const MOVING: &str = "set gravity 0\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n@name left\nS 2 3 1 0 5 0 0 0 0 0 1 0.5\n";

fn left(scene: &Scene) -> Option<SphereId> {
    match scene.named("left").ok()?.first()? {
        ObjectId::Sphere(id) => Some(*id),
        _ => None,
    }
}

#[test]
fn the_camera_moves_with_the_body_that_it_follows() {
    let mut viewer = viewer(MOVING);
    viewer.follow = Some(Follow::new(Rc::new(left)));
    viewer.follow_body();
    assert_eq!(viewer.camera.target, Vec3::new(3.0, 1.0, 0.0));
    // The camera may be moved, and keeps its distance from the body.
    let up = Vec3::new(0.0, 2.0, 0.0);
    viewer.camera.eye += up;
    viewer.camera.target += up;
    let before = viewer.camera;
    for _ in 0..10 {
        viewer.session.single_step();
    }
    viewer.follow_body();
    let moved = Vec3::new(1.0, 0.0, 0.0);
    assert!(viewer.camera.target.distance(before.target + moved) < 1e-5, "{:?}", viewer.camera);
    assert!(viewer.camera.eye.distance(before.eye + moved) < 1e-5, "{:?}", viewer.camera);
    // A scene without the body leaves the camera alone.
    viewer.follow = Some(Follow::new(Rc::new(|_| None)));
    viewer.follow_body();
    assert!(viewer.camera.target.distance(before.target + moved) < 1e-5);
}

#[test]
fn scenes_that_are_opened_later_are_prepared() {
    let mut session = session(MOVING);
    session.prepare = Some(Rc::new(|scene| {
        if let Some(sphere) = left(scene) {
            scene.set_tag(sphere, Tag::new().name("left").colour(Colour([1, 2, 3]))).unwrap();
        }
    }));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    std::fs::write(&path, MOVING).unwrap();
    assert!(session.load(&path));
    let scene = session.simulation().scene();
    let tag = scene.tag(left(scene).unwrap()).unwrap();
    assert_eq!(tag, Some(&Tag::new().name("left").colour(Colour([1, 2, 3]))));
}
