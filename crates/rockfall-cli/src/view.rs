//! `rockfall view`: shows a scene in a window.

use std::path::PathBuf;
use std::rc::Rc;

use rockfall::{Backend, Options, Scene, Simulation};
use rockfall_trajectory::Reader;
use rockfall_viewer::camera::{Direction, Vertical};
use rockfall_viewer::draw::Style;
use rockfall_viewer::film::{Moment, surveyed};
use rockfall_viewer::plot::{Plot, Quantity};
use rockfall_viewer::survey::Survey;
use rockfall_viewer::window::controls::Controls;
use rockfall_viewer::window::follow::Find;
use rockfall_viewer::window::session::Prepare;
use rockfall_viewer::window::session::picked::MOST_KEPT;
use rockfall_viewer::window::session::playback::Playback;
use rockfall_viewer::window::{self, Launch};

use crate::failure::Failure;
use crate::input::Input;
use crate::options::{Engine, Physics};
use crate::render::camera::Named;
use crate::render::captions::{Captions, find_trails, warn_of_letters};
use crate::render::colours::{self, Paint};
use crate::render::plots::check_names;
use crate::run::Given;
use crate::source::Source;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene, checkpoint or trajectory (.npz, .pvd), or - for a scene from standard input [default: a built-in scene]
    scene: Option<PathBuf>,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// What the mouse does: standard (left drag orbits, right drag pans), or thesis
    #[arg(long, default_value_t)]
    controls: Controls,
    /// Direction from which the camera looks: front, side, top or iso [default: obliquely from above]
    #[arg(long, value_name = "NAME", value_parser = Direction::named)]
    view: Option<Direction>,
    /// Axis to the top of the picture: y, z or auto, opposite to gravity if that is along an axis, else y
    #[arg(long, value_name = "AXIS", default_value = "auto", value_parser = Vertical::named)]
    up: Vertical,
    /// Keep this body where it is in the picture: a name in the scene, or the number of a sphere
    #[arg(long, value_name = "BODY", value_parser = Named::parse)]
    follow: Option<Named>,
    /// Colour of the objects with a name, of a sphere (3), of spheres (1-9) or of a kind (boxes): red, ff8800 and others; may be
    /// repeated
    #[arg(long, value_name = "WHAT=COLOUR", value_parser = colours::paint)]
    colour: Vec<Paint>,
    /// Plot the energies or the forces on walls, as in gauge:weight, which the panel always has, the position, speed, force or
    /// torque of joints, as in joint:door or joint:door.speed, or height and speed of bodies over time, as in height:left,right; may be
    /// repeated
    #[arg(long, value_name = "WHAT", value_parser = plot)]
    plot: Vec<Plot>,
    #[command(flatten)]
    captions: Captions,
    /// Write the state of the window as JSON after every frame
    #[arg(long, value_name = "FILE", hide = true)]
    report: Option<PathBuf>,
    /// Destroy the graphics device after this number of frames, to test that the window recovers
    #[arg(long, value_name = "FRAMES", hide = true)]
    lose_device_after: Option<u64>,
}

/// What the window shows.
struct Shown {
    name: String,
    scene: Scene,
    warnings: Vec<String>,
    options: Options,
    time_step: f32,
    playback: Option<Playback>,
    /// The scene text, which can be read again.
    path: Option<PathBuf>,
}

impl Shown {
    fn read(arguments: &Arguments, given: &Given) -> Result<Self, Failure> {
        let name = arguments.scene.as_ref().map_or(String::new(), |path| path.display().to_string());
        let options = arguments.engine.options(&arguments.physics);
        match Input::read(arguments.scene.as_deref())? {
            Input::Scene(source) => {
                let Source { name, loaded } = *source;
                let mut scene = loaded.scene;
                arguments.physics.change(&mut scene.settings)?;
                let warnings = loaded.warnings.iter();
                let warnings = warnings.map(|warning| format!("{name}:{}: {}", warning.line, warning.text)).collect();
                let time_step = arguments.physics.part_for(&scene);
                let path = arguments.scene.clone().filter(|path| path.as_os_str() != "-");
                Ok(Self { name, scene, warnings, options, time_step, playback: None, path })
            }
            Input::Checkpoint(saved) => {
                let (dt, parts, checkpoint) = saved.changed(given, &arguments.physics, &arguments.engine)?;
                let integrator = checkpoint.options.integrator;
                let options = options.integrator(integrator);
                let time_step = dt / parts as f32;
                Ok(Self { name, scene: checkpoint.scene, warnings: Vec::new(), options, time_step, playback: None, path: None })
            }
            Input::Trajectory(reader) => {
                given.refuse_for_trajectory(&name)?;
                let (scene, playback) = playback(name.clone(), *reader, arguments.up)?;
                let time_step = playback.time_step().unwrap_or(arguments.physics.dt_for(&scene));
                Ok(Self { name, scene, warnings: Vec::new(), options, time_step, playback: Some(playback), path: None })
            }
        }
    }
}

/// Returns the scene and what plays the frames. The scene has the states of the first frame where the spheres are the same in all of
/// them, otherwise all spheres.
fn playback(name: String, mut reader: Reader, up: Vertical) -> Result<(Scene, Playback), Failure> {
    let mut simulation = Simulation::with_options(reader.scene().clone(), Options::new().backend(Backend::Cpu))?;
    reader.show(0, &mut simulation).map_err(Failure::usage)?;
    let first = simulation.sync()?.clone();
    let frames: Vec<Moment> = (0..reader.moments().len() as u64).map(|step| Moment { step, blend: 0.0 }).collect();
    let mut survey = Survey::with_up(&first, up.of(&first));
    for moment in surveyed(&frames).skip(1) {
        reader.show(moment.step as usize, &mut simulation).map_err(Failure::usage)?;
        survey.add(simulation.sync()?);
    }
    let moments = reader.moments().iter().map(|moment| (moment.step, moment.time)).collect();
    let scene = if reader.is_constant() { first } else { reader.scene().clone() };
    let show = Box::new(move |index: usize, simulation: &mut Simulation| reader.show(index, simulation));
    Ok((scene, Playback { name, moments, show, survey: Some(survey) }))
}

/// Colours scenes that are opened later. What they lack has no effect.
fn prepare(paints: Vec<Paint>) -> Prepare {
    Rc::new(move |scene| {
        for paint in &paints {
            let tags = colours::apply(std::slice::from_ref(paint), scene, &mut Style::default()).unwrap_or_default();
            // These objects are in the scene, and the tags were checked.
            tags.into_iter().for_each(|(object, tag)| drop(scene.set_tag(object, tag)));
        }
    })
}

/// Parses a `--plot` argument.
fn plot(text: &str) -> Result<Plot, String> {
    let plot = Plot::parse(text)?;
    match plot.quantity() {
        Quantity::Energy | Quantity::Height | Quantity::Speed | Quantity::Gauge | Quantity::Joint(_) => Ok(plot),
        other => Err(format!("the window does not plot {}, expected energy, height, speed, gauge or joint", other.name())),
    }
}

/// The bodies whose heights and speeds are plotted, each once.
fn plotted(plots: &[Plot]) -> Result<Vec<Named>, Failure> {
    let mut texts: Vec<&String> = Vec::new();
    for body in plots.iter().flat_map(Plot::bodies) {
        if !texts.contains(&body) {
            texts.push(body);
        }
    }
    let most = MOST_KEPT + 1;
    if texts.len() > most {
        return Err(Failure::usage(format!("--plot: the window plots at most {most} bodies, got {}", texts.len())));
    }
    texts
        .into_iter()
        .map(|text| Named::parse(text).map_err(|error| Failure::usage(format!("--plot {text}: {error}"))))
        .collect()
}

/// Finds the sphere that an option means in a scene.
fn find(named: Named, option: &'static str) -> Find {
    Rc::new(move |scene| named.of(scene, option).ok())
}

pub(crate) fn view(arguments: &Arguments, given: &Given) -> Result<(), Failure> {
    let Shown { name, mut scene, warnings, options, time_step, playback, path } = Shown::read(arguments, given)?;
    let mut style = Style::default();
    for (object, tag) in colours::apply(&arguments.colour, &scene, &mut style)? {
        scene.set_tag(object, tag)?;
    }
    if let Some(followed) = &arguments.follow {
        followed.of(&scene, "--follow")?;
    }
    for plot in &arguments.plot {
        check_names(plot, playback.is_some(), &scene)?;
    }
    let plotted = plotted(&arguments.plot)?;
    for body in &plotted {
        body.of(&scene, "--plot")?;
    }
    let mut overlay = arguments.captions.overlay();
    warn_of_letters(&overlay, &scene);
    find_trails(&mut overlay, &scene)?;
    window::run(Launch {
        source: window::session::Source { name, path, scene },
        warnings,
        playback: playback.into(),
        options,
        time_step,
        keeps_time_step: given.has("dt"),
        overrides: arguments.physics.overrides(),
        controls: arguments.controls,
        overlay,
        style,
        prepare: Some(prepare(arguments.colour.clone())),
        view: arguments.view.unwrap_or_default(),
        up: arguments.up,
        follow: arguments.follow.clone().map(|followed| find(followed, "--follow")),
        plotted: plotted.into_iter().map(|body| find(body, "--plot")).collect(),
        joints: arguments.plot.iter().filter(|plot| matches!(plot.quantity(), Quantity::Joint(_))).cloned().collect(),
        report: arguments.report.clone(),
        lose_device_after: arguments.lose_device_after,
    })
    .map_err(|failure| match failure {
        window::Failure::Rockfall(error) => error.into(),
        other => Failure::Run(other.to_string()),
    })
}
