//! `rockfall render`: a picture of a scene, without a window.

use std::path::{Path, PathBuf};

use rockfall::gpu::Gpu;
use rockfall::output::AtomicFile;
use rockfall::{Scene, Simulation};
use rockfall_viewer::camera::Camera;
use rockfall_viewer::draw::{Renderer, Style};
use rockfall_viewer::picture::{Canvas, FORMAT};

use crate::failure::Failure;
use crate::options::{Engine, Physics};
use crate::output;
use crate::progress::Progress;
use crate::source::Source;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene file, or - for standard input
    scene: PathBuf,
    /// The picture to write: FILE.png
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Steps before the picture is taken
    #[arg(long, value_name = "STEP", default_value_t = 0)]
    at: u64,
    /// Size in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    size: [u32; 2],
    /// Where the camera stands; chosen to have the scene in the picture if left out
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    camera: Option<[f32; 3]>,
    /// The point in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    look_at: Option<[f32; 3]>,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| *side > 0);
    let sides = text.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
    sides.ok_or_else(|| "expected two whole numbers greater than 0, as in 1280x720".to_owned())
}

fn point(text: &str) -> Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> =
        text.split(',').map(|number| number.trim().parse().ok().filter(|number: &f32| number.is_finite())).collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| "expected three finite numbers, as in 4,2.5,-8".to_owned())
}

pub(crate) fn render(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.out;
    if path.extension().is_none_or(|extension| extension != "png") {
        return Err(Failure::usage(format!("--out {}: expected a name that ends in .png", path.display())));
    }
    let Source { name, loaded } = Source::read(Some(&arguments.scene))?;
    for warning in &loaded.warnings {
        output::note(&format!("warning: {name}:{}: {}", warning.line, warning.text));
    }
    let mut scene = loaded.scene;
    arguments.physics.change(&mut scene.settings)?;
    // Opened first, so that a bad path shows before the long work.
    let file = AtomicFile::create(path).map_err(|error| Failure::file(path, &error))?;

    let mut simulation = Simulation::with_options(scene, arguments.engine.options(&arguments.physics))?;
    // Bodies are drawn where they are moved, and on any device there is where that is the CPU.
    let gpu = match simulation.gpu_view() {
        Some(view) => view.gpu().clone(),
        None => Gpu::open_blocking(true)?,
    };
    let [width, height] = arguments.size;
    let canvas = Canvas::new(gpu.device(), gpu.queue(), width, height)?;
    let mut renderer = Renderer::new(gpu.device(), gpu.queue(), FORMAT)?;
    advance(&mut simulation, arguments)?;
    let style = Style::default();
    renderer.update(&mut simulation, &style)?;
    let camera = camera(arguments, simulation.sync()?)?;
    let picture = canvas.take(&mut renderer, &camera, &style)?;
    write(path, file, |file| picture.write_png(file))
}

fn write(path: &Path, mut file: AtomicFile, write: impl FnOnce(&mut AtomicFile) -> std::io::Result<()>) -> Result<(), Failure> {
    write(&mut file).and_then(|()| file.commit()).map_err(|error| Failure::file(path, &error))
}

/// Does the steps before the picture.
fn advance(simulation: &mut Simulation, arguments: &Arguments) -> Result<(), Failure> {
    let mut progress = Progress::new(arguments.at);
    let mut left = arguments.at;
    let mut result = Ok(());
    while left > 0 && result.is_ok() {
        let chunk = progress.chunk();
        result = simulation.run(chunk, arguments.physics.dt).map(drop);
        left -= chunk;
        progress.advance(chunk);
    }
    progress.finish();
    Ok(result?)
}

/// The camera that was asked for; what was not is as in the default one.
fn camera(arguments: &Arguments, scene: &Scene) -> Result<Camera, Failure> {
    let [width, height] = arguments.size.map(|side| side as f32);
    let framing = Camera::of_scene(scene, width / height);
    let eye = arguments.camera.map_or(framing.eye, Into::into);
    let target = arguments.look_at.map_or(framing.target, Into::into);
    if eye == target {
        return Err(Failure::usage("--camera and --look-at are the same point"));
    }
    Ok(Camera { eye, target, ..framing })
}
