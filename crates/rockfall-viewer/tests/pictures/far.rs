//! Culled and simplified spheres do not change the picture visibly.

use rockfall::glam::{DVec3, UVec3, Vec3};
use rockfall::{Backend, Scene, Sphere};
use rockfall_viewer::camera::{Axes, Camera};
use rockfall_viewer::draw::{FrameTimes, Renderer};
use rockfall_viewer::picture::Picture;

use crate::common::{HEIGHT, WIDTH, assert_covers, canvas, outlines, picture, renderer, simulation};

#[test]
fn spheres_at_the_edges_of_the_picture_are_drawn() {
    let camera = Camera::new([1.0, 2.0, 6.0], [0.0, 0.0, 0.0]);
    let Axes { right, up, .. } = camera.axes();
    let half = camera.eye.length() * (0.5 * camera.field_of_view).tan();
    let radius = 0.6_f32;
    for (x, y) in [(-1.0, 0.0), (1.0, 0.2), (0.1, 1.0), (-0.3, -1.0), (1.0, 1.0)] {
        // A sixth of the radius is within the picture.
        let inset = |side: f32, half: f32| side * half + 0.84 * radius * side.trunc();
        let centre = inset(x, half * crate::common::ASPECT) * right + inset(y, half) * up;
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new(centre, radius)).unwrap();
        // A second sphere in the middle, so that enough pixels are covered.
        scene.add_sphere(Sphere::new(Vec3::ZERO, 0.3)).unwrap();
        let balls = [(centre.as_dvec3(), f64::from(radius)), (DVec3::ZERO, 0.3)];
        let meets = move |origin: DVec3, direction: DVec3| {
            balls.iter().any(|(centre, radius)| (*centre - origin).cross(direction).length() < *radius)
        };
        assert_covers(&picture(scene, &camera, &outlines()), &camera, meets);
    }
}

/// A square lattice of equal spheres that fills much of the picture without occlusion.
fn lattice(side: u32, radius: f32) -> Scene {
    let mut scene = Scene::new();
    let apart = 2.0 / side as f32;
    for k in 0..side * side {
        let (x, y) = (k % side, k / side);
        let place = Vec3::new((x as f32 + 0.5) * apart - 1.0, (y as f32 + 0.5) * apart - 1.0, 0.0);
        // Shifted, so that the lattice is not aligned with the pixels.
        scene
            .add_sphere(Sphere::new(place + 0.13 * apart * Vec3::new((k as f32).sin(), (1.7 * k as f32).cos(), 0.0), radius))
            .unwrap();
    }
    scene
}

/// Returns the total darkness of a picture of a lattice and how its spheres were drawn; `pixels` is the radius in pixels.
fn darkness(side: u32, pixels: f32) -> (f32, FrameTimes) {
    let camera = Camera::new([0.0, 0.0, 5.0], [0.0, 0.0, 0.0]);
    let pixel = 2.0 * 5.0 * (0.5 * camera.field_of_view).tan() / HEIGHT as f32;
    let mut simulation = simulation(lattice(side, pixels * pixel), Backend::Cpu);
    let (mut renderer, style) = (renderer(), outlines());
    renderer.time_frames().unwrap();
    renderer.update(&mut simulation, &style).unwrap();
    let Picture { pixels, .. } = canvas().take(&mut renderer, &camera, &style).unwrap();
    assert_eq!(pixels.len() as u32, WIDTH * HEIGHT);
    // Decoded to linear light, because coverage is proportional to light.
    let light = |channel: u8| (f32::from(channel) / 255.0).powf(2.2);
    let dark = pixels.iter().map(|[r, g, b, _]| 3.0 - light(*r) - light(*g) - light(*b)).sum();
    (dark, renderer.frame_times().unwrap().unwrap())
}

#[test]
fn small_spheres_cover_the_area_of_their_discs() {
    let (near, times) = darkness(20, 2.1);
    assert_eq!((times.near, times.far), (400, 0));
    // From far away the outline is a circle with the radius of the sphere.
    let per_pixel = near / (400.0 * 2.1_f32.powi(2));
    for (side, radius, tolerance) in [(20, 1.9, 0.03), (30, 1.0, 0.05), (60, 0.4, 0.08)] {
        let (dark, times) = darkness(side, radius);
        assert_eq!((times.near, times.far), (0, side * side), "{radius}");
        let expected = per_pixel * (side * side) as f32 * radius * radius;
        assert!((dark / expected - 1.0).abs() < tolerance, "{radius}: {dark} {expected}");
    }
    // About one in 3.1 of these is drawn.
    let (dark, times) = darkness(100, 0.2);
    let share = times.far as f32 / 10_000.0;
    assert!((share - (0.2_f32 / 0.35).powi(2)).abs() < 0.03, "{share}");
    assert!((dark / (per_pixel * 400.0) - 1.0).abs() < 0.15, "{dark} {}", per_pixel * 400.0);
}

#[test]
fn hidden_spheres_are_culled_without_changing_any_frame() {
    const SIDE: u32 = 28;
    let mut scene = Scene::new();
    for k in 0..SIDE.pow(3) {
        let place = UVec3::new(k % SIDE, k / SIDE % SIDE, k / SIDE.pow(2)).as_vec3();
        // Slightly irregular, so that no two spheres have the same depth.
        let shift = Vec3::new((k as f32).sin(), (1.3 * k as f32).sin(), (1.7 * k as f32).sin());
        scene.add_sphere(Sphere::new(place + 0.03 * shift, 0.5)).unwrap();
    }
    let middle = Vec3::splat(0.5 * (SIDE - 1) as f32);
    let cameras = [[50.0, 40.0, 90.0], [-40.0, 60.0, -70.0], [20.0, 20.0, 36.0]].map(|eye| Camera::new(eye, middle));
    let mut simulation = simulation(scene, Backend::Cpu);
    let style = outlines();
    let mut take = |renderer: &mut Renderer, camera: &Camera| {
        renderer.update(&mut simulation, &style).unwrap();
        let picture = canvas().take(renderer, camera, &style).unwrap();
        let times = renderer.frame_times().unwrap().unwrap();
        (picture, times.near + times.far)
    };
    let timed = || {
        let mut renderer = renderer();
        renderer.time_frames().unwrap();
        renderer
    };
    let mut reused = timed();
    for camera in &cameras {
        // A new renderer draws all spheres in the picture, because none was visible before.
        let (whole, all) = take(&mut timed(), camera);
        // A frame draws the spheres that were visible in the last frame first, and then those that these do not hide. The first
        // frame of all has nothing to hide others with, the second finds the hidden spheres, and the third culls them.
        for turn in 0..3 {
            let (picture, drawn) = take(&mut reused, camera);
            assert!(picture == whole, "{camera:?}, turn {turn}");
            assert!(turn < 2 || drawn < all / 2, "{drawn} of {all} are drawn");
        }
    }
}
