//! `rockfall render`: writes a picture or a film of a scene, a checkpoint or a trajectory, without a window.

use std::path::PathBuf;

use rockfall::Simulation;
use rockfall::glam::Vec3;
use rockfall_viewer::camera::{Direction, Vertical};
use rockfall_viewer::draw::{Background, ColourBy, Range, Style};
use rockfall_viewer::film::Format;
use rockfall_viewer::palette::Rgb;
use rockfall_viewer::plot::{Layout, Plot};

use crate::check;
use crate::failure::Failure;
use crate::files;
use crate::input::{Input, Saved};
use crate::interrupt::Interrupt;
use crate::options::{Engine, Physics, Substeps, is_rigid, whole};
use crate::output;
use crate::run::Given;
use crate::source::Source;

pub(crate) mod camera;
pub(crate) mod captions;
pub(crate) mod colours;
mod footage;
pub(crate) mod plots;
mod studio;

use camera::Named;
use captions::Captions;
use colours::Paint;
use footage::{Cut, Footage, Live, Recorded};
use studio::Studio;

/// Details that do not fit into the one-line descriptions of the options.
const AFTER_HELP: &str = "\
A checkpoint continues with its constants, time step and integrator; --at and --steps count from it. The scene of a trajectory \
is drawn as it was recorded, without running it again: --at is the number of a step in it, and a film shows all of it unless \
--steps is given. A trajectory is what `rockfall run --every K --out NAME.npz` or `NAME.pvd` writes.

Without --camera and --look-at, the camera shows what the bodies do over the whole film. For this a scene is run once before \
the film is drawn. Bodies that fall or fly away from all others do not count. At the end, the command prints the options that \
give this camera. A box or polygon that hides a body is not drawn, except for its edges. In a film of creatures, which muscles move, the \
camera moves with them instead.

Labels, arrows and trails are those of bodies: a rigid body (@place) and a capsule have one each, at the centre of mass. Plots need \
room: an error says how many fit into the picture.

--substeps N divides every step into N equal parts, as in `rockfall run`; --at and --steps count whole steps. Warnings are those \
of `rockfall run`.

The number of a body is its reference in the scene text; in a scene without references, the order of addition from 0. The lines \
@name NAME, @colour COLOUR and @label TEXT of a scene give the objects below them a name, a colour and a label. --colour overrides \
the colours of the scene.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// Scene, checkpoint or trajectory (.npz, .pvd), or - for a scene from standard input
    scene: PathBuf,
    /// FILE.png or .jpg for a picture; FILE.gif, .apng or FOLDER/ for a film, or .mp4 or .webm with the program ffmpeg
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Number of steps before the picture is taken or the film begins, or simulated time as in 0.5s; in a trajectory, the number of
    /// the step, or the time [default: the start; for a picture of a scene that begins without bodies, its last step]
    #[arg(long, value_name = "STEP", value_parser = At::parse, allow_negative_numbers = true)]
    at: Option<At>,
    /// Number of steps that the film shows [default: that of the scene]
    #[arg(long, value_name = "N", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    steps: Option<u64>,
    /// Pictures per second of the film
    #[arg(long, value_name = "F", default_value_t = 25, value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    fps: u32,
    /// Simulated seconds per second of film: 1 for real time, less for slow motion [default: that of the scene, else 1]
    #[arg(long, value_name = "X", value_parser = speed, allow_negative_numbers = true)]
    speed: Option<f64>,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size, allow_hyphen_values = true)]
    size: [u32; 2],
    /// Direction from which the camera looks, if its position is not given: front, side, top or iso [default: obliquely from above]
    #[arg(long, value_name = "NAME", value_parser = Direction::named, conflicts_with = "camera")]
    view: Option<Direction>,
    /// Axis to the top of the picture: y, z or auto, opposite to gravity if that is along an axis, else y
    #[arg(long, value_name = "AXIS", default_value = "auto", value_parser = Vertical::named)]
    up: Vertical,
    /// Position of the camera [default: chosen so that all that happens is in view]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    camera: Option<[f32; 3]>,
    /// Point in the middle of the picture [default: chosen so that all that happens is in view]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    look_at: Option<[f32; 3]>,
    /// Keep this body in the middle of the picture: a name in the scene, or the number of a sphere
    #[arg(long, value_name = "BODY", value_parser = Named::parse, conflicts_with = "look_at")]
    follow: Option<Named>,
    /// Turn the camera around the middle of the picture, in degrees per second of film
    #[arg(long, value_name = "DEGREES", value_parser = degrees, allow_negative_numbers = true)]
    orbit: Option<f32>,
    /// What colours show, with a legend: kind, speed, contacts, overlap, force, body, contact-force for force chains, or tension of springs
    #[arg(long, value_name = "WHAT", value_parser = colour_by)]
    colour_by: Option<ColourBy>,
    /// Values at the ends of the colour scale [default: from 0, or for tension from minus that value, to about the 99th percentile]
    #[arg(long, value_name = "FROM,TO", value_parser = range, allow_hyphen_values = true, requires = "colour_by")]
    range: Option<[f32; 2]>,
    /// Colour of the objects with a name, of a sphere (3), of spheres (1-9) or of a kind (boxes): red, ff8800 and others; may be
    /// repeated
    #[arg(long, value_name = "WHAT=COLOUR", value_parser = colours::paint)]
    colour: Vec<Paint>,
    /// Colour of the background, or two: at the horizon and straight up
    #[arg(long, value_name = "COLOUR[,COLOUR]", value_parser = colours::background)]
    background: Option<[Rgb; 2]>,
    /// Direction from the scene towards the sun [default: -0.45,0.8,0.4 with y up]
    #[arg(long, value_name = "X,Y,Z", value_parser = light, allow_hyphen_values = true)]
    light: Option<[f32; 3]>,
    #[command(flatten)]
    captions: Captions,
    /// Plot a quantity over time beside the picture: energy, kinetic, potential, momentum, contacts, the size of the force on the walls
    /// of gauges, as in gauge:weight, the position of joints, as in joint:door, or their speed, force or torque, as in joint:door.speed,
    /// or height, speed, x, y, z, vx, vy or vz of bodies, as in height:left,right; may be repeated
    #[arg(long, value_name = "WHAT", value_parser = Plot::parse)]
    plot: Vec<Plot>,
    /// Draw without shadows and ambient occlusion
    #[arg(long)]
    plain: bool,
    /// Draw the picture this number of times and print the time of each pass on the device
    #[arg(long, value_name = "N", hide = true, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    bench: Option<u32>,
    /// Divide every step into N equal parts; auto chooses the smallest stable N for springs and contacts [default: that of the
    /// scene or the checkpoint, else 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    substeps: Option<Substeps>,
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

fn light(text: &str) -> Result<[f32; 3], String> {
    let found = numbers(text).filter(|numbers| *numbers != [0.0; 3]);
    found.ok_or_else(|| "expected three finite numbers that are not all 0, as in 0.5,1,0.5".to_owned())
}

fn degrees(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|angle: &f32| angle.is_finite()).ok_or_else(|| "expected a finite number of degrees".to_owned())
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

/// When the picture is taken or the film begins.
#[derive(Clone, Copy, Debug, PartialEq)]
enum At {
    Step(u64),
    /// Simulated time, in s.
    Time(f64),
}

impl At {
    fn parse(text: &str) -> Result<Self, String> {
        let time = text.strip_suffix('s').and_then(|time| time.trim_end().parse::<f64>().ok());
        let time = time.filter(|time| time.is_finite() && *time >= 0.0).map(Self::Time);
        let found = time.or_else(|| text.parse().ok().map(Self::Step));
        found.ok_or_else(|| "expected a whole number of steps, or a time in s as in 0.5s".to_owned())
    }
}

/// What is written: a picture or a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Product {
    Png,
    Jpeg,
    Film(Format),
}

/// The names that `--out` can have.
const EXPECTED: &str = "a name that ends in .png, .jpg or .jpeg, .gif, .apng, .mp4 or .webm, or a folder name that ends in /";

impl Product {
    /// The one place that knows which extension stands for what.
    fn of(path: &std::path::Path) -> Option<Self> {
        if let Some(format) = Format::of(path) {
            return Some(Self::Film(format));
        }
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" => Some(Self::Png),
            "jpg" | "jpeg" => Some(Self::Jpeg),
            _ => None,
        }
    }
}

impl Arguments {
    /// Checks what can be checked before the scene is read. `has_length` says whether the input itself has an end.
    fn product(&self, has_length: bool) -> Result<Product, Failure> {
        let path = self.out.display();
        let product = Product::of(&self.out).ok_or_else(|| files::unknown("--out", &self.out, EXPECTED))?;
        let wrong = match (product, self.steps) {
            (Product::Film(_), None) if !has_length => {
                format!("--out {path} is a film: expected --steps N for its length")
            }
            (Product::Film(Format::Gif), _) if self.fps > 50 => {
                format!("--fps {}: a GIF has at most 50 pictures per second", self.fps)
            }
            (Product::Png | Product::Jpeg, Some(_)) => format!(
                "--out {path} is a single picture, but --steps asks for a film: name a .gif, .apng, .mp4 or .webm file or a \
                 folder/, or use --at N to choose the step of the picture"
            ),
            (Product::Png | Product::Jpeg, None) if self.orbit.is_some() => {
                format!("--out {path} is a single picture, but --orbit asks for a film")
            }
            _ if self.orbit.is_some() && self.view == Some(Direction::Top) => {
                "--orbit turns the camera around the vertical, along which --view top looks".to_owned()
            }
            _ => return Ok(product),
        };
        Err(Failure::usage(wrong))
    }

    fn style(&self) -> Style {
        let mut style = Style::default();
        style.colour_by = self.colour_by.unwrap_or_default();
        style.range = self.range.map_or(Range::Auto, Range::Given);
        style.shadows = !self.plain;
        style.occlusion = !self.plain;
        if let Some([horizon, zenith]) = self.background {
            style.background = Background { horizon, zenith };
        }
        style.light = self.light.map(Vec3::from);
        style
    }

    /// Where the scene and the plots are in the pictures.
    fn layout(&self) -> Layout {
        Layout::new(self.size, self.plot.len()).dark(self.style().background.is_dark())
    }

    /// Says how the size of a film differs from the one that was asked for.
    fn note_size(&self, product: Product) {
        let [width, height] = self.size;
        if matches!(product, Product::Film(Format::Mp4 | Format::WebM)) && (width % 2 == 1 || height % 2 == 1) {
            let [wide, high] = self.size.map(|side| side.next_multiple_of(2));
            output::note(&format!(
                "note: --size {width}x{height}: this format needs even sides, so the film has {wide}x{high}"
            ));
        }
    }

    fn cut(&self) -> Cut {
        Cut { fps: self.fps, speed: self.speed, steps: self.steps }
    }
}

pub(crate) fn render(arguments: &Arguments, given: &Given, interrupt: &'static Interrupt) -> Result<(), Failure> {
    // A name that no file can have is refused before a long file is read.
    arguments.product(true)?;
    Layout::check(arguments.size, arguments.plot.len()).map_err(|error| Failure::usage(format!("--plot: {error}")))?;
    let input = Input::read(Some(&arguments.scene))?;
    let own_steps = match &input {
        Input::Scene(source) => source.loaded.scene.run.steps,
        _ => None,
    };
    let product = arguments.product(matches!(input, Input::Trajectory(_)) || own_steps.is_some())?;
    Source::is_not(Some(&arguments.scene), &arguments.out)?;
    arguments.note_size(product);
    let footage = match input {
        Input::Scene(source) => Footage::Live(Box::new(scene(arguments, *source, interrupt)?)),
        Input::Checkpoint(saved) => Footage::Live(Box::new(checkpoint(arguments, given, *saved, interrupt)?)),
        Input::Trajectory(reader) => {
            let name = arguments.scene.display().to_string();
            given.refuse_for_trajectory(&name)?;
            Footage::Recorded(Box::new(Recorded::new(name, *reader)?))
        }
    };
    // Created first, so that a picture size that the device does not support fails before the simulation.
    let studio = Studio::new(arguments, footage, interrupt)?;
    interrupt.hold();
    interrupt.leaves("; no picture or film is written".to_owned());
    match product {
        Product::Png | Product::Jpeg => studio.picture(arguments, product),
        Product::Film(format) => studio.film(arguments, format),
    }
}

/// Prepares a run of a scene.
fn scene(arguments: &Arguments, Source { name, loaded }: Source, interrupt: &'static Interrupt) -> Result<Live, Failure> {
    let (scene, parts) = check::prepare(&name, loaded, &arguments.physics, arguments.substeps)?;
    let dt = arguments.physics.dt_for(&scene);
    let simulation = Simulation::with_options(scene, arguments.engine.options(&arguments.physics))?;
    Live::new(name, simulation, dt, parts, interrupt)
}

/// Prepares a run that continues a checkpoint. Options on the command line override those of the checkpoint.
fn checkpoint(arguments: &Arguments, given: &Given, saved: Saved, interrupt: &'static Interrupt) -> Result<Live, Failure> {
    let name = arguments.scene.display().to_string();
    let (dt, mut parts, mut checkpoint) = saved.changed(given, &arguments.physics, &arguments.engine)?;
    let integrator = checkpoint.options.integrator.resolve(checkpoint.scene.settings.contact_law);
    if is_rigid(&checkpoint.scene) {
        Substeps::give(arguments.substeps, &mut checkpoint.scene);
    } else if let Some(substeps) = arguments.substeps {
        parts = substeps.of(&checkpoint.scene, dt, integrator)?;
        checkpoint.time_step = dt / parts as f32;
    }
    check::warn(&name, &checkpoint.scene, dt / parts as f32, integrator);
    Live::new(name, Simulation::resume(checkpoint)?, dt, parts, interrupt)
}
