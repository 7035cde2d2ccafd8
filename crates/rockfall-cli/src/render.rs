//! `rockfall render`: writes a picture or a film of a scene, without a window.

use std::path::{Path, PathBuf};

use rockfall::exec::gpu::Gpu;
use rockfall::output::AtomicFile;
use rockfall::{Scene, Simulation};
use rockfall_viewer::camera::Camera;
use rockfall_viewer::draw::{ColourBy, FrameTimes, Pass, Range, Renderer, Style};
use rockfall_viewer::film::{self, Format, Player, Timing};
use rockfall_viewer::picture::{Canvas, FORMAT, Picture};

use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::{Engine, Physics, whole};
use crate::output;
use crate::progress::Progress;
use crate::source::Source;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene file, or - for standard input
    scene: PathBuf,
    /// FILE.png for a picture; for a film FILE.gif, FILE.apng, FILE.mp4 (needs the program ffmpeg) or FOLDER/
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Number of steps before the picture is taken or the film begins
    #[arg(long, value_name = "STEP", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    at: u64,
    /// Number of steps that the film shows
    #[arg(long, value_name = "N", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    steps: Option<u64>,
    /// Pictures per second of the film
    #[arg(long, value_name = "F", default_value_t = 25, value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    fps: u32,
    /// Simulated seconds per second of film: 1 for real time, less for slow motion
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed, allow_negative_numbers = true)]
    speed: f64,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size, allow_hyphen_values = true)]
    size: [u32; 2],
    /// Position of the camera [default: chosen so that the scene is in view]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    camera: Option<[f32; 3]>,
    /// Point in the middle of the picture [default: chosen so that the scene is in view]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    look_at: Option<[f32; 3]>,
    /// Quantity shown by colour, with a legend: kind, speed, contacts, overlap or force
    #[arg(long, value_name = "WHAT", value_parser = colour_by)]
    colour_by: Option<ColourBy>,
    /// Values at the ends of the colour scale [default: from 0 to about the largest value]
    #[arg(long, value_name = "FROM,TO", value_parser = range, allow_hyphen_values = true, requires = "colour_by")]
    range: Option<[f32; 2]>,
    /// Draw without shadows and ambient occlusion
    #[arg(long)]
    plain: bool,
    /// Draw the picture this number of times and print the time of each pass on the device
    #[arg(long, value_name = "N", hide = true, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    bench: Option<u32>,
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

fn numbers<const N: usize>(text: &str) -> Option<[f32; N]> {
    let finite = |number: &str| number.trim().parse().ok().filter(|number: &f32| number.is_finite());
    let numbers: Option<Vec<f32>> = text.split(',').map(finite).collect();
    numbers?.try_into().ok()
}

fn point(text: &str) -> Result<[f32; 3], String> {
    numbers(text).ok_or_else(|| "expected three finite numbers, as in 4,2.5,-8".to_owned())
}

fn range(text: &str) -> Result<[f32; 2], String> {
    let found = numbers(text).filter(|[from, to]| from < to);
    found.ok_or_else(|| "expected two finite numbers, the first less than the second, as in 0,2.5".to_owned())
}

fn speed(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|speed: &f64| speed.is_finite() && *speed > 0.0);
    found.ok_or_else(|| "expected a finite number greater than 0".to_owned())
}

fn colour_by(text: &str) -> Result<ColourBy, String> {
    let found = ColourBy::ALL.into_iter().find(|by| by.name() == text);
    found.ok_or_else(|| format!("expected one of: {}", ColourBy::ALL.map(ColourBy::name).join(" ")))
}

/// What is written: a picture or a film.
enum Product {
    Picture,
    Film(Format, Timing),
}

impl Arguments {
    fn product(&self) -> Result<Product, Failure> {
        let path = self.out.display();
        let is_picture = self.out.extension().is_some_and(|extension| extension == "png");
        match (is_picture, Format::of(&self.out), self.steps) {
            (true, None, None) => Ok(Product::Picture),
            (false, Some(Format::Gif), Some(_)) if self.fps > 50 => {
                Err(Failure::usage(format!("--fps {}: a GIF has at most 50 pictures per second", self.fps)))
            }
            (false, Some(format), Some(steps)) => {
                Ok(Product::Film(format, Timing { steps, dt: self.physics.dt, fps: self.fps, speed: self.speed }))
            }
            (true, ..) => Err(Failure::usage(format!(
                "--out {path} is a single picture, but --steps asks for a film: name a .gif, .apng or .mp4 file or a folder/, \
                 or use --at N to choose the step of the picture"
            ))),
            (false, Some(_), None) => Err(Failure::usage(format!("--out {path} is a film: expected --steps N for its length"))),
            (false, None, _) => Err(Failure::usage(format!(
                "--out {path}: expected a name that ends in .png, .gif, .apng or .mp4, or a folder name that ends in /"
            ))),
        }
    }

    fn style(&self) -> Style {
        let mut style = Style::default();
        style.colour_by = self.colour_by.unwrap_or_default();
        style.range = self.range.map_or(Range::Auto, Range::Given);
        style.shadows = !self.plain;
        style.occlusion = !self.plain;
        style
    }

    /// Camera from the arguments. What they do not set comes from the camera that frames the scene.
    fn camera(&self, scene: &Scene) -> Result<Camera, Failure> {
        let [width, height] = self.size.map(|side| side as f32);
        let framing = Camera::of_scene(scene, width / height);
        let eye = self.camera.map_or(framing.eye, Into::into);
        let target = self.look_at.map_or(framing.target, Into::into);
        if eye == target {
            return Err(Failure::usage("--camera and --look-at are the same point, expected two different points"));
        }
        Ok(Camera { eye, target, ..framing })
    }
}

pub(crate) fn render(arguments: &Arguments, interrupt: &'static Interrupt) -> Result<(), Failure> {
    let product = arguments.product()?;
    let Source { name, loaded } = Source::read(Some(&arguments.scene))?;
    for warning in &loaded.warnings {
        output::note(&format!("warning: {name}:{}: {}", warning.line, warning.text));
    }
    let mut scene = loaded.scene;
    arguments.physics.change(&mut scene.settings)?;
    let simulation = Simulation::with_options(scene, arguments.engine.options(&arguments.physics))?;
    // Created first, so that a picture size that the device does not support fails before the simulation.
    let mut studio = Studio::new(arguments, simulation, interrupt)?;
    interrupt.hold();
    interrupt.leaves("; no picture or film is written".to_owned());
    match product {
        Product::Picture => {
            let path = &arguments.out;
            let mut file = AtomicFile::create(path).map_err(|error| Failure::file(path, &error))?;
            let picture = studio.picture(arguments)?;
            if let Some(frames) = arguments.bench {
                studio.bench(arguments, frames)?;
            }
            picture.write_png(&mut file).and_then(|()| file.commit()).map_err(|error| Failure::file(path, &error))
        }
        Product::Film(format, timing) => studio.film(arguments, &arguments.out, format, timing),
    }
}

/// A simulation and everything needed to draw it.
struct Studio {
    simulation: Simulation,
    renderer: Renderer,
    canvas: Canvas,
    style: Style,
    interrupt: &'static Interrupt,
}

impl Studio {
    fn new(arguments: &Arguments, simulation: Simulation, interrupt: &'static Interrupt) -> Result<Self, Failure> {
        // Draws on the device of the simulation. A simulation on the CPU is drawn on any adapter, including software.
        let gpu = match simulation.gpu_view() {
            Some(view) => view.gpu().clone(),
            None => Gpu::open_blocking(true).map_err(|error| {
                Failure::Run(format!(
                    "drawing needs a graphics adapter, even with --backend cpu; software Vulkan is enough: {error}"
                ))
            })?,
        };
        let [width, height] = arguments.size;
        let canvas = Canvas::new(gpu.device(), gpu.queue(), width, height)?;
        let renderer = Renderer::new(gpu.device(), gpu.queue(), FORMAT)?;
        Ok(Self { simulation, renderer, canvas, style: arguments.style(), interrupt })
    }

    fn picture(&mut self, arguments: &Arguments) -> Result<Picture, Failure> {
        self.advance(arguments)?;
        // The default camera depends on the positions of the bodies at this step.
        let camera = arguments.camera(self.simulation.sync()?)?;
        self.renderer.update(&mut self.simulation, &self.style)?;
        Ok(self.take(&camera, arguments)?)
    }

    fn take(&mut self, camera: &Camera, arguments: &Arguments) -> rockfall::Result<Picture> {
        let mut picture = self.canvas.take(&mut self.renderer, camera, &self.style)?;
        if arguments.colour_by.is_some() {
            self.renderer.legend(&self.style).draw(&mut picture)?;
        }
        Ok(picture)
    }

    fn film(&mut self, arguments: &Arguments, path: &Path, format: Format, timing: Timing) -> Result<(), Failure> {
        self.advance(arguments)?;
        let camera = arguments.camera(self.simulation.sync()?)?;
        let mut player = Player::new(timing.dt);
        let mut progress = Progress::pictures(timing.pictures());
        let interrupt = self.interrupt;
        let mut taken = 0;
        // After a signal the film ends with the pictures so far, at least one.
        let indices = (0..timing.pictures()).take_while(|index| *index == 0 || !interrupt.is_requested());
        let pictures = indices.map(|index| {
            player.show(&mut self.simulation, &mut self.renderer, &self.style, timing.moment(index))?;
            let picture = self.take(&camera, arguments)?;
            progress.advance(1);
            taken += 1;
            if taken == timing.pictures() {
                interrupt.finishes();
            }
            Ok(picture)
        });
        let result = film::write(path, format, &timing, pictures);
        progress.finish();
        result?;
        if taken < timing.pictures() {
            let (path, all) = (path.display(), timing.pictures());
            return Err(Failure::Interrupted(format!("stopped after {taken} of {all} pictures, written to {path}")));
        }
        Ok(())
    }

    /// Prints the median time of every pass and the number of spheres drawn by each method.
    fn bench(&mut self, arguments: &Arguments, frames: u32) -> Result<(), Failure> {
        let camera = arguments.camera(self.simulation.sync()?)?;
        self.renderer.time_frames()?;
        let mut found = Vec::new();
        for _ in 0..frames {
            self.canvas.draw(&mut self.renderer, &camera, &self.style)?;
            found.extend(self.renderer.frame_times()?);
        }
        let median = |of: &dyn Fn(&FrameTimes) -> f64| {
            let mut times: Vec<f64> = found.iter().map(of).collect();
            times.sort_by(f64::total_cmp);
            1e3 * times[times.len() / 2]
        };
        let last = found.last().copied().unwrap_or_default();
        let [width, height] = arguments.size;
        let mut text = format!("{frames} frames of {width}x{height}, medians\n");
        for pass in Pass::ALL {
            text += &format!("  {:<10} {:9.3} ms\n", pass.name(), median(&|times| times.passes[pass as usize]));
        }
        text += &format!("  {:<10} {:9.3} ms\n", "all", median(&FrameTimes::total));
        text += &format!("  spheres    {} ray-cast, {} as discs, {} in shadows\n", last.near, last.far, last.shadows);
        output::print(&text)
    }

    /// Runs the steps before the picture or the film.
    fn advance(&mut self, arguments: &Arguments) -> Result<(), Failure> {
        let mut progress = Progress::new(arguments.at);
        let mut left = arguments.at;
        let mut result = Ok(());
        while left > 0 && result.is_ok() {
            let chunk = progress.chunk();
            result = self.simulation.run(chunk, arguments.physics.dt).map(drop);
            left -= chunk;
            progress.advance(chunk);
            if left > 0 && self.interrupt.is_requested() {
                progress.finish();
                let (step, all) = (arguments.at - left, arguments.at);
                return Err(Failure::Interrupted(format!("stopped at step {step} of {all}, before the first picture")));
            }
        }
        progress.finish();
        Ok(result?)
    }
}
