//! Pictures of joints.

use rockfall::glam::Vec3;
use rockfall::{Anchor, Backend, ContactLaw, Joint, Scene, Sphere};
use rockfall_viewer::camera::{Camera, Direction};
use rockfall_viewer::overlay::Overlay;

use crate::common::{ASPECT, HEIGHT, WIDTH, canvas, is_drawn, outlines, projected, renderer, simulation, take};

/// A ball that hangs on a distance joint, and one on a ball joint beside it, which falls off.
fn scene() -> Scene {
    let mut scene = Scene::new();
    scene.settings.contact_law = ContactLaw::Rigid;
    scene.settings.gravity = 10.0;
    let [one, other] = [-1.0, 1.0].map(|x| scene.add_sphere(Sphere::new([x, -1.0, 0.0], 0.3)).unwrap());
    scene.add_joint(Joint::distance(Anchor::World, one, [-1.0, 1.5, 0.0], [-1.0, -1.0, 0.0])).unwrap();
    scene.add_joint(Joint::ball(Anchor::World, other, [1.0, 1.0, 0.0])).unwrap();
    scene
}

#[test]
fn a_distance_joint_is_a_string_and_others_have_marks_if_asked_for() {
    let camera = Camera::new([0.0, 0.0, 7.0], [0.0; 3]);
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut simulation = simulation(scene(), backend);
        simulation.run(2, 1.0 / 60.0).unwrap();
        let picture = take(&mut simulation, &camera, &outlines());
        let drawn = |x: f32, y: f32| {
            let [x, y] = projected(&camera, Vec3::new(x, y, 0.0)).map(|place| place as u32);
            (x - 1..=x + 1).any(|x| is_drawn(&picture, x, y))
        };
        assert!(drawn(-1.0, 1.4) && drawn(-1.0, 0.3) && drawn(-1.0, -0.5), "{backend}");
        assert!(!drawn(-1.0, 1.6) && !drawn(-1.2, 0.3) && !drawn(1.0, 0.5) && !drawn(1.0, 1.0), "{backend}");
    }
}

#[test]
fn marks_of_joints_are_at_their_anchors() {
    let camera = Camera::new([0.0, 0.0, 7.0], [0.0; 3]);
    let mut simulation = simulation(scene(), Backend::Cpu);
    let (mut renderer, overlay) = (renderer(), Overlay { joints: true, ..Overlay::default() });
    renderer.set_overlay(&overlay);
    renderer.update(&mut simulation, &outlines()).unwrap();
    let mut picture = canvas().take(&mut renderer, &camera, &outlines()).unwrap();
    overlay.draw(renderer.motion(), &camera, &mut picture).unwrap();
    let [x, y] = projected(&camera, Vec3::new(1.0, 1.0, 0.0)).map(|place| place as u32);
    assert!(is_drawn(&picture, x, y) && !is_drawn(&picture, x, y - 12));
}

/// The string of a broken joint is gone, and its fixed end belongs to what the camera shows.
#[test]
fn strings_break_and_their_ends_are_in_view() {
    let camera = Camera::new([0.0, 0.0, 7.0], [0.0; 3]);
    let mut scene = scene();
    let string = scene.joint_ids().next().unwrap();
    scene.update_joint(string, |joint| joint.break_force = 1.0).unwrap();
    let [x, y] = projected(&Camera::of_scene(&scene, ASPECT, Direction::Front), Vec3::new(-1.0, 1.5, 0.0));
    assert!((0.0..WIDTH as f32).contains(&x) && (0.0..HEIGHT as f32).contains(&y), "{x} {y}");
    let mut simulation = simulation(scene, Backend::Cpu);
    simulation.run(2, 1.0 / 60.0).unwrap();
    let picture = take(&mut simulation, &camera, &outlines());
    let [x, y] = projected(&camera, Vec3::new(-1.0, 0.5, 0.0)).map(|place| place as u32);
    assert!((x - 2..=x + 2).all(|x| !is_drawn(&picture, x, y)));
}
