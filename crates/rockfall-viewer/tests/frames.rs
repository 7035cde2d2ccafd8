//! Sequences of frames: blending between two states, and objects that are added, removed or reordered.
#![cfg(feature = "gpu")]

use rockfall::generate::Kind;
use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, BroadPhase, Options, Scene, Simulation, Sphere};
use rockfall_viewer::camera::Camera;
use rockfall_viewer::draw::Style;

mod common;
use common::{canvas, drawn_box, gpu, outlines, projected, renderer, simulation, take};

fn camera() -> Camera {
    Camera::new([0.0, 0.0, 8.0], [0.0, 0.0, 0.0])
}

#[test]
fn bodies_are_blended_between_two_states() {
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut scene = Scene::new();
        scene.settings.gravity = 0.0;
        let ball = scene.add_sphere(Sphere::new([-1.0, 0.0, 0.0], 0.5)).unwrap();
        let mut simulation = simulation(scene, backend);
        let (mut renderer, canvas, style) = (renderer(), canvas(), outlines());
        renderer.update(&mut simulation, &style).unwrap();
        renderer.remember();
        simulation.set_position(ball, [1.0, 0.0, 0.0]).unwrap();
        simulation.set_orientation(ball, Quat::from_rotation_y(0.3)).unwrap();
        renderer.update(&mut simulation, &style).unwrap();
        for (blend, middle) in [(0.0, -1.0), (0.25, -0.5), (1.0, 1.0)] {
            renderer.set_blend(blend);
            let [left, _, right, _] = drawn_box(&canvas.take(&mut renderer, &camera(), &style).unwrap());
            let expected = projected(&camera(), Vec3::new(middle, 0.0, 0.0))[0];
            let found = 0.5 * (left + right + 1) as f32;
            assert!((found - expected).abs() < 1.5, "{backend} {blend}: {found} {expected}");
        }
    }
}

#[test]
fn update_detects_added_and_removed_objects() {
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut scene = Scene::new();
        let first = scene.add_sphere(Sphere::new([-1.0, 0.0, 0.0], 0.5)).unwrap();
        let mut simulation = simulation(scene, backend);
        let (mut renderer, canvas, style) = (renderer(), canvas(), outlines());
        let mut shown = |simulation: &mut Simulation| {
            renderer.update(simulation, &style).unwrap();
            drawn_box(&canvas.take(&mut renderer, &camera(), &style).unwrap())
        };
        let alone = shown(&mut simulation);
        simulation.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.5)).unwrap();
        let both = shown(&mut simulation);
        assert!(both[0] == alone[0] && both[2] > alone[2] + 50, "{alone:?} {both:?}");
        simulation.remove_sphere(first).unwrap();
        let other = shown(&mut simulation);
        assert!(other[0] > alone[2] && other[2] == both[2], "{other:?}");
    }
}

#[test]
fn the_memory_order_does_not_change_the_picture() {
    let style = Style::default();
    let pictures = [BroadPhase::BruteForce, BroadPhase::Grid].map(|broad_phase| {
        let scene = Kind::Mixed.generate(300, 1).unwrap();
        let camera = Camera::of_scene(&scene, common::ASPECT);
        let options = Options::new().backend(Backend::Gpu).broad_phase(broad_phase);
        let mut simulation = Simulation::on_device(scene, options, gpu().device(), gpu().queue()).unwrap();
        take(&mut simulation, &camera, &style)
    });
    // Only pixels of bodies at equal depths may differ, because they depend on the drawing order.
    let differing = pictures[0].pixels.iter().zip(&pictures[1].pixels).filter(|(one, two)| one != two).count();
    assert!(differing < 40, "{differing}");
}
