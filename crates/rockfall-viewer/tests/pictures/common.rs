//! Pictures of small scenes, and their expected pixels.
#![allow(dead_code)]

use std::sync::OnceLock;

use rockfall::exec::gpu::Gpu;
use rockfall::glam::{DVec3, Vec3};
use rockfall::{Backend, Options, Scene, Simulation};
use rockfall_viewer::camera::Camera;
use rockfall_viewer::draw::{Background, ColourBy, Range, Renderer, Style};
use rockfall_viewer::picture::{Canvas, FORMAT, Picture};

pub(crate) const WIDTH: u32 = 320;
pub(crate) const HEIGHT: u32 = 240;
pub(crate) const ASPECT: f32 = WIDTH as f32 / HEIGHT as f32;
const BEHIND: [u8; 3] = [255, 255, 255];

/// Opens any adapter; software Vulkan is sufficient.
pub(crate) fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open_blocking(true).expect("these tests need an adapter; scripts/test installs a software one"))
}

pub(crate) fn simulation(scene: Scene, backend: Backend) -> Simulation {
    let options = Options::new().backend(backend);
    match backend {
        Backend::Gpu => Simulation::on_device(scene, options, gpu().device(), gpu().queue()).unwrap(),
        _ => Simulation::with_options(scene, options).unwrap(),
    }
}

/// A style with a white background and without shadows. Bodies are coloured by speed: at rest all have the darkest colour.
pub(crate) fn outlines() -> Style {
    let mut style = Style::default();
    style.colour_by = ColourBy::Speed;
    style.range = Range::Given([0.0, 1.0]);
    (style.shadows, style.occlusion, style.ground) = (false, false, false);
    style.background = Background { horizon: BEHIND, zenith: BEHIND };
    style
}

pub(crate) fn renderer() -> Renderer {
    Renderer::new(gpu().device(), gpu().queue(), FORMAT).unwrap()
}

pub(crate) fn canvas() -> Canvas {
    Canvas::new(gpu().device(), gpu().queue(), WIDTH, HEIGHT).unwrap()
}

pub(crate) fn take(simulation: &mut Simulation, camera: &Camera, style: &Style) -> Picture {
    let mut renderer = renderer();
    renderer.update(simulation, style).unwrap();
    canvas().take(&mut renderer, camera, style).unwrap()
}

pub(crate) fn picture(scene: Scene, camera: &Camera, style: &Style) -> Picture {
    take(&mut simulation(scene, Backend::Cpu), camera, style)
}

pub(crate) fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
    let [r, g, b, _] = picture.pixels[(y * picture.width + x) as usize];
    [r, g, b]
}

/// Whether something is drawn in a pixel or a part of it.
pub(crate) fn is_drawn(picture: &Picture, x: u32, y: u32) -> bool {
    pixel(picture, x, y) != BEHIND
}

/// Returns the least x and y and the greatest x and y of the pixels in which something is drawn.
pub(crate) fn drawn_box(picture: &Picture) -> [u32; 4] {
    let mut found = [u32::MAX, u32::MAX, 0, 0];
    for (x, y) in pixels().filter(|(x, y)| is_drawn(picture, *x, *y)) {
        found = [found[0].min(x), found[1].min(y), found[2].max(x), found[3].max(y)];
    }
    found
}

/// Coordinates of all pixels.
pub(crate) fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)))
}

/// Returns the origin and direction of the ray through a point of the picture, in pixels from the upper left corner.
pub(crate) fn ray(camera: &Camera, x: f32, y: f32) -> (DVec3, DVec3) {
    let (ndc_x, ndc_y) = (2.0 * x / WIDTH as f32 - 1.0, 1.0 - 2.0 * y / HEIGHT as f32);
    let (origin, direction) = camera.ray(ndc_x, ndc_y, ASPECT);
    (origin.as_dvec3(), direction.as_dvec3())
}

/// Returns the position of a point in the picture, in pixels from the upper left corner.
pub(crate) fn projected(camera: &Camera, point: Vec3) -> [f32; 2] {
    let ndc = camera.view_projection(ASPECT).project_point3(point);
    [0.5 * (ndc.x + 1.0) * WIDTH as f32, 0.5 * (1.0 - ndc.y) * HEIGHT as f32]
}

/// Returns the result of `meets` for the rays through a pixel. The rays go through its centre and through points slightly
/// outside its corners; `None` if their results differ, as at an edge.
pub(crate) fn expected<T: PartialEq>(camera: &Camera, x: u32, y: u32, meets: impl Fn(DVec3, DVec3) -> T) -> Option<T> {
    const PLACES: [(f32, f32); 5] = [(0.5, 0.5), (-0.2, -0.2), (1.2, -0.2), (-0.2, 1.2), (1.2, 1.2)];
    let mut answers = PLACES.iter().map(|(dx, dy)| {
        let (origin, direction) = ray(camera, x as f32 + dx, y as f32 + dy);
        meets(origin, direction)
    });
    let first = answers.next()?;
    answers.all(|answer| answer == first).then_some(first)
}

/// Asserts that every pixel that a shape covers completely is drawn, and none that it does not touch.
#[track_caller]
pub(crate) fn assert_covers(picture: &Picture, camera: &Camera, meets: impl Fn(DVec3, DVec3) -> bool) {
    let (mut inside, mut wrong) = (0, Vec::new());
    for (x, y) in pixels() {
        if let Some(hit) = expected(camera, x, y, &meets) {
            inside += u32::from(hit);
            if hit != is_drawn(picture, x, y) {
                wrong.push((x, y, hit));
            }
        }
    }
    assert!(inside > 300, "the test shows too little of the shape: {inside} pixels");
    assert!(wrong.is_empty(), "{} pixels, among them {:?}", wrong.len(), &wrong[..wrong.len().min(5)]);
}
