//! The camera moves with a body. Colours of scenes that are opened later.

use std::rc::Rc;

use rockfall::glam::{Vec2, Vec3};
use rockfall::{Body, Colour, ObjectId, Scene, SphereId, Tag};
use rockfall_viewer::window::controls::Command;
use rockfall_viewer::window::viewer::Viewer;

use crate::common::*;

const STRIDER: &str = include_str!("../../../../scenes/creatures/strider.txt");
const ROLLING: &str = "set gravity 0\nS 1 0 0 0 20 0 0 0 0 0 1 0.5\nS 2 0 4 0 0 0 0 0 0 0 1 0.5\n";

fn run(viewer: &mut Viewer, steps: u32) {
    viewer.session.set_running(true);
    for _ in 0..steps {
        viewer.session.frame(0.0, 0.0, |_| ());
        viewer.follow();
    }
}

/// Returns the middle of all spheres, and its place in the picture from -1 to 1.
fn middle(viewer: &mut Viewer) -> (Vec3, Vec2) {
    let spheres = viewer.session.simulation().spheres().expect("spheres are read");
    let middle = spheres.iter().map(|sphere| sphere.position).sum::<Vec3>() / spheres.len() as f32;
    let ndc = viewer.camera.view_projection(viewer.aspect()).project_point3(middle);
    (middle, ndc.truncate())
}

#[test]
fn creatures_are_followed_from_the_start() {
    let mut viewer = viewer(STRIDER);
    viewer.session.set_time_step(0.005);
    assert!(viewer.is_following());
    let (start, before) = middle(&mut viewer);
    run(&mut viewer, 1000);
    let (end, place) = middle(&mut viewer);
    assert!(end.distance(start) > 5.0, "{start} {end}");
    assert!(place.distance(before) < 0.15, "{before} {place}");
    // The initial direction and distance, but around the creature.
    viewer.command(Command::ResetCamera);
    viewer.follow();
    let (_, place) = middle(&mut viewer);
    assert!(place.distance(before) < 0.15, "{before} {place}");
    // After a reset the camera is back at the start.
    viewer.command(Command::Reset);
    viewer.follow();
    let (_, place) = middle(&mut viewer);
    assert!(place.distance(before) < 0.15, "{before} {place}");
}

#[test]
fn the_picked_body_is_followed_until_the_key_is_pressed_again() {
    let mut viewer = viewer(ROLLING);
    viewer.command(Command::Follow);
    assert!(!viewer.is_following() && messages(&viewer.session)[0].contains("click the body"));
    let id = viewer.session.simulation().scene().sphere_ids().next().expect("a sphere");
    viewer.session.set_picked(Some(Body::Sphere(id)));
    let start = viewer.camera;
    viewer.command(Command::Follow);
    run(&mut viewer, 50);
    let moved = viewer.camera.eye - start.eye;
    assert!((moved - Vec3::new(20.0, 0.0, 0.0)).length() < 1e-2, "{moved}");
    assert!((viewer.camera.target - start.target - moved).length() < 1e-3);
    viewer.command(Command::Follow);
    run(&mut viewer, 50);
    assert!(!viewer.is_following() && viewer.camera.eye == start.eye + moved);
}

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
    viewer.find = Some(Rc::new(left));
    viewer.follow_initially();
    assert_eq!(viewer.camera.target, Vec3::new(3.0, 1.0, 0.0));
    // The camera may be moved, and keeps its distance from the body.
    let up = Vec3::new(0.0, 2.0, 0.0);
    viewer.camera.eye += up;
    viewer.camera.target += up;
    let before = viewer.camera;
    for _ in 0..10 {
        viewer.session.single_step();
    }
    viewer.follow();
    let moved = Vec3::new(1.0, 0.0, 0.0);
    assert!(viewer.camera.target.distance(before.target + moved) < 1e-5, "{:?}", viewer.camera);
    assert!(viewer.camera.eye.distance(before.eye + moved) < 1e-5, "{:?}", viewer.camera);
    // A scene without the body leaves the camera alone.
    viewer.find = Some(Rc::new(|_| None));
    viewer.follow_initially();
    viewer.follow();
    assert!(viewer.camera.target.distance(before.target + moved) < 1e-5);
}

#[test]
fn bodies_are_plotted_from_the_start_in_every_scene() {
    let mut viewer = viewer(ROLLING);
    let nth = |index: usize| -> rockfall_viewer::window::follow::Find { Rc::new(move |scene| scene.sphere_ids().nth(index)) };
    viewer.plotted = vec![nth(1), nth(0), nth(7)];
    viewer.plot_initially();
    let ids: Vec<_> = viewer.session.simulation().scene().sphere_ids().collect();
    assert_eq!(viewer.session.picked(), Some(Body::Sphere(ids[1])));
    let kept: Vec<_> = viewer.session.kept().map(|kept| (kept.body, kept.track.points().len())).collect();
    assert_eq!(kept, [(Body::Sphere(ids[0]), 1)]);
    viewer.session.single_step();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    std::fs::write(&path, MOVING).unwrap();
    assert!(viewer.load(&path));
    let ids: Vec<_> = viewer.session.simulation().scene().sphere_ids().collect();
    assert_eq!(viewer.session.picked(), Some(Body::Sphere(ids[1])));
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

/// Whether all spheres are in the picture.
fn all_in_picture(viewer: &mut Viewer) -> bool {
    let (camera, aspect) = (viewer.camera, viewer.aspect());
    let spheres = viewer.session.simulation().spheres().expect("spheres are read");
    spheres.iter().all(|sphere| {
        let ndc = camera.view_projection(aspect).project_point3(sphere.position);
        ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0
    })
}

fn show(viewer: &mut Viewer, frames: std::ops::Range<u32>) {
    viewer.session.set_running(true);
    for frame in frames {
        viewer.session.frame(f64::from(frame) * 0.05, 0.05, |_| ());
        viewer.keep_in_view();
    }
}

/// A ball that leaves the picture is kept in it, until the user moves the camera.
#[test]
fn the_camera_shows_what_leaves_the_picture_until_it_is_moved() {
    let flying = "set gravity 0\nS 1 -2 0 0 1.5 0 0 0 0 0 1 0.5\nS 2 -2 3 0 0 0 0 0 0 0 1 0.5\n";
    let mut viewer = viewer(flying);
    let before = viewer.camera;
    show(&mut viewer, 0..2);
    assert_eq!(viewer.camera, before, "a camera that shows all does not move");
    show(&mut viewer, 2..200);
    assert!(viewer.camera.eye.distance(viewer.camera.target) > 1.05 * before.eye.distance(before.target));
    assert!(all_in_picture(&mut viewer));
    // The camera eases and does not jump.
    let moved = viewer.camera;
    viewer.scroll(1.0);
    let turned = viewer.camera;
    show(&mut viewer, 200..500);
    assert!(viewer.camera == turned && moved != turned && !all_in_picture(&mut viewer));
    // Home shows the scene from the initial direction, and keeps it in view again.
    viewer.command(Command::ResetCamera);
    show(&mut viewer, 500..700);
    assert!(all_in_picture(&mut viewer));
}
