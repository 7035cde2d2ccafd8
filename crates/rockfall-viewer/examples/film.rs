//! A film of a ball that falls onto a tower of balls, drawn without a window.
//!
//! `cargo run --release -p rockfall-viewer --example film`

use rockfall::exec::gpu::Gpu;
use rockfall::{Cuboid, Options, Scene, Simulation, Sphere};
use rockfall_viewer::camera::{Camera, Direction};
use rockfall_viewer::draw::{Renderer, Style};
use rockfall_viewer::film::{self, Format, Player, Timing};
use rockfall_viewer::picture::{Canvas, FORMAT};

fn main() -> rockfall::Result<()> {
    let mut scene = Scene::new();
    scene.add_box(Cuboid::between([-4.0, -0.2, -4.0], [4.0, 0.0, 4.0]))?;
    for place in 0..4 {
        scene.add_sphere(Sphere::new([0.02 * place as f32, 0.3 + 0.6 * place as f32, 0.0], 0.3))?;
    }
    scene.add_sphere(Sphere::new([0.1, 4.0, 0.0], 0.5).mass(5.0))?;
    let camera = Camera::of_scene(&scene, 16.0 / 9.0, Direction::Oblique);

    // Software Vulkan is sufficient.
    let gpu = Gpu::open_blocking(true)?;
    let mut simulation = Simulation::on_device(scene, Options::new(), gpu.device(), gpu.queue())?;
    let mut renderer = Renderer::new(gpu.device(), gpu.queue(), FORMAT)?;
    let canvas = Canvas::new(gpu.device(), gpu.queue(), 320, 180)?;
    let style = Style::default();

    let timing = Timing { steps: 100, dt: 0.02, fps: 10, speed: 1.0 };
    let mut player = Player::new(timing.dt);
    let pictures = (0..timing.pictures()).map(|index| {
        player.show(&mut simulation, &mut renderer, &style, timing.moment(index))?;
        canvas.take(&mut renderer, &camera, &style)
    });
    let path = std::env::temp_dir().join("tower.gif");
    film::write(&path, Format::Gif, &timing, pictures)?;
    println!("{}: {} pictures", path.display(), timing.pictures());
    Ok(())
}
