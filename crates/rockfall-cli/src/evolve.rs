//! `rockfall evolve`: evolves creatures of masses, springs and muscles.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rockfall::{Backend, Integrator};
use rockfall_evolve::{Body, Evolution, Generation, Goal, Ground, Plan};

use crate::failure::Failure;
use crate::files;
use crate::interrupt::Interrupt;
use crate::options::whole;
use crate::output;
use crate::progress::Progress;
use crate::source::Source;

mod outputs;

/// Details that do not fit into the one-line descriptions of the options.
const AFTER_HELP: &str = "\
A creature has 4 to 20 masses and up to 64 springs. Springs join those that are near each other, and each spring is a muscle. Body and \
muscles evolve together: every generation is made from the best creatures of each kind so far, by mutation and crossover, and lives side by \
side for --seconds. What counts begins when the creatures have come to stand: after a fifth of the time, at most 2 s.

Creatures that explode, fall once or go downhill do not count. A creature that would become the champion is audited: it must keep \
70 % of its fitness at half and at a quarter of the time step and with starts that are disturbed by 0.0001 units, and its energy must \
come from its muscles. docs/creatures.md gives the rules.

The same seed gives the same champion on the same device. --checkpoint is written after every generation, and --resume goes on \
from it up to --generations in all, with the same result as without a stop. Ctrl-C leaves out the generation under way, writes \
all files and exits with code 130.

--out is an ordinary scene: `rockfall run`, `render` and `view` show the champion, with the --dt of the evolution.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// Creatures per generation
    #[arg(long, value_name = "N", default_value_t = 10_240, value_parser = whole(2_usize, 1_000_000), allow_negative_numbers = true)]
    population: usize,
    /// Number of generations, including those before --resume
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = whole(1_u64, 1_000_000), allow_negative_numbers = true)]
    generations: u64,
    /// Time that each creature lives, in seconds
    #[arg(long, value_name = "S", default_value = "10", value_parser = seconds, allow_negative_numbers = true)]
    seconds: f64,
    /// Time step in seconds
    #[arg(long, value_name = "S", default_value = "0.005", value_parser = crate::options::time_step, allow_negative_numbers = true)]
    dt: f32,
    /// What counts: distance, speed, height, jump or climb (which needs --ground); heights are above the ground below
    #[arg(long, default_value_t = Goal::Distance)]
    goal: Goal,
    /// Scene with the ground and the constants; only boxes and polygons [default: level, with gravity 9.81]
    #[arg(long, value_name = "FILE")]
    ground: Option<PathBuf>,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Where masses may be: lattice or free
    #[arg(long, default_value_t = Body::Lattice)]
    body: Body,
    /// Integrator: rk4, symplectic-euler or velocity-verlet
    #[arg(long, default_value_t)]
    integrator: Integrator,
    /// Where to compute: auto, gpu or cpu
    #[arg(long, default_value_t)]
    backend: Backend,
    /// Scene file of the champion: .txt
    #[arg(long, value_name = "FILE", default_value = "best.txt")]
    out: PathBuf,
    /// Write the best and the mean fitness of every generation, and why creatures did not count: .csv
    #[arg(long, value_name = "FILE")]
    history: Option<PathBuf>,
    /// Write the scenes of the best creatures of up to 12 kinds, and a list of them, at the end
    #[arg(long, value_name = "FOLDER")]
    gallery: Option<PathBuf>,
    /// Write the state after every generation, for --resume: .json
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Go on from such a file, and write further ones to it; takes everything but the outputs, --generations and --backend from it
    #[arg(long, value_name = "FILE", conflicts_with_all = ["population", "seconds", "dt", "goal", "ground", "seed", "body", "integrator", "checkpoint"])]
    resume: Option<PathBuf>,
    /// Film of the champion at the end, as `rockfall render` writes it: .gif, .mp4 and others
    #[cfg(feature = "view")]
    #[arg(long, value_name = "FILE")]
    film: Option<PathBuf>,
}

fn seconds(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|time: &f64| (1.0..=1000.0).contains(time));
    found.ok_or_else(|| "expected a number of seconds from 1 to 1000".to_owned())
}

pub(crate) fn evolve(arguments: &Arguments, interrupt: &'static Interrupt) -> Result<(), Failure> {
    check_names(arguments)?;
    let mut evolution = match &arguments.resume {
        Some(path) => resume(path, arguments.backend)?,
        None => begin(arguments)?,
    };
    interrupt.hold();
    interrupt.leaves("; the files are those of the last generation".to_owned());
    let start = Instant::now();
    let completed = generations(&mut evolution, arguments, interrupt)?;
    interrupt.finishes();
    if !completed {
        let done = evolution.history().len();
        let next = match arguments.resume.as_ref().or(arguments.checkpoint.as_ref()) {
            Some(path) => format!("; go on with rockfall evolve --resume {}", path.display()),
            None => String::new(),
        };
        return Err(Failure::Interrupted(format!("stopped after generation {done} of {}{next}", arguments.generations)));
    }
    if let Some(folder) = &arguments.gallery {
        outputs::write_gallery(&evolution, folder)?;
    }
    output::print(&outputs::summary(&evolution, arguments, start.elapsed().as_secs_f64()))?;
    #[cfg(feature = "view")]
    if let Some(film) = arguments.film.as_ref().filter(|_| evolution.champion().is_some()) {
        outputs::film(&evolution, &arguments.out, film, interrupt)?;
    }
    Ok(())
}

/// Returns an error for an output with an unknown extension.
fn check_names(arguments: &Arguments) -> Result<(), Failure> {
    files::check("--out", &arguments.out, files::SCENE)?;
    let others = [
        ("--history", &arguments.history, files::TRACE),
        ("--checkpoint", &arguments.checkpoint, files::EVOLUTION),
        ("--resume", &arguments.resume, files::EVOLUTION),
    ];
    for (option, path, known) in others {
        if let Some(path) = path {
            files::check(option, path, known)?;
        }
    }
    if let Some(ground) = &arguments.ground {
        Source::is_not(Some(ground), &arguments.out)?;
    }
    #[cfg(feature = "view")]
    if let Some(film) = &arguments.film {
        outputs::check_film(film)?;
    }
    Ok(())
}

fn begin(arguments: &Arguments) -> Result<Evolution, Failure> {
    let ground = match &arguments.ground {
        Some(path) => ground_of(Source::read(Some(path))?)?,
        None if arguments.goal == Goal::Climb => {
            return Err(Failure::usage("--goal climb needs --ground: on level ground there is nothing to climb"));
        }
        None => Ground::level(arguments.seconds)?,
    };
    let plan = Plan {
        population: arguments.population,
        seed: arguments.seed,
        body: arguments.body,
        goal: arguments.goal,
        seconds: arguments.seconds,
        dt: arguments.dt,
        integrator: arguments.integrator.to_string(),
        ground: ground.scene().to_text(),
    };
    let trial = plan.trial(arguments.backend)?;
    if trial.steps() < 20 {
        return Err(Failure::usage(format!(
            "--seconds {} with --dt {} is {} steps, expected at least 20",
            arguments.seconds,
            arguments.dt,
            trial.steps()
        )));
    }
    Ok(Evolution::new(plan, trial))
}

/// A ground without bodies that move.
fn ground_of(source: Source) -> Result<Ground, Failure> {
    let counts = source.loaded.scene.counts();
    if counts.spheres > 0 {
        return Err(Failure::usage(format!(
            "--ground {}: it has {} spheres, expected only boxes, polygons and settings",
            source.name, counts.spheres
        )));
    }
    Ok(Ground::of(source.loaded.scene))
}

fn resume(path: &Path, backend: Backend) -> Result<Evolution, Failure> {
    let wrong = |error: std::io::Error| Failure::usage(format!("{}: {error}", path.display()));
    Evolution::load(path, |plan| plan.trial(backend).map_err(std::io::Error::other)).map_err(wrong)
}

/// Runs the generations that are left, and writes the files after each. Returns whether all are done.
fn generations(evolution: &mut Evolution, arguments: &Arguments, interrupt: &Interrupt) -> Result<bool, Failure> {
    let first = evolution.history().len() as u64;
    let mut progress = Progress::generations(arguments.generations.saturating_sub(first));
    for _ in first..arguments.generations {
        let Some(generation) = evolution.generation(&|| interrupt.is_requested())?.cloned() else {
            outputs::write(evolution, arguments)?;
            return Ok(false);
        };
        outputs::write(evolution, arguments)?;
        progress.tell(&line(&generation, evolution.plan().goal));
        progress.advance(1);
    }
    outputs::write(evolution, arguments)?;
    Ok(true)
}

/// A generation in a few words.
fn line(generation: &Generation, goal: Goal) -> String {
    let Generation { champion, mean, niches, .. } = generation;
    format!("{goal}: champion {champion:.2}, mean {mean:.2} {}, {niches} kinds", goal.unit())
}
