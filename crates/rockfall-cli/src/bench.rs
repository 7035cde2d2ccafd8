//! `rockfall bench`: measures the speed of steps, the time of each stage, and the share of the memory bandwidth in use.
//!
//! Throughput is the wall time of plain runs, each on a newly generated scene. The stage times come from one additional run
//! with timestamps around every dispatch.

use std::path::PathBuf;

use rockfall::generate::Benchmark;
use rockfall::output::AtomicFile;

use crate::failure::Failure;
use crate::files;
use crate::options::{DEFAULT_TIME_STEP, Engine, Physics, whole};
use crate::output;

mod chart;
mod drum;
mod frames;
mod json;
mod measure;
mod phases;
mod repeat;
#[cfg(feature = "mpi")]
mod shared;
mod spread;
mod table;
mod worlds;

use measure::Measured;

/// What is measured instead of steps of one scene.
#[derive(Debug, clap::Subcommand)]
enum Other {
    Worlds(worlds::Arguments),
    Drum(drum::Arguments),
    Repeat(repeat::Arguments),
    Frames(frames::Arguments),
}

#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, disable_help_subcommand = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    other: Option<Other>,
    /// Scene to measure: thesis, lattice, pile, settled, shuffled, mixed, radii or boxes
    #[arg(default_value_t = Benchmark::Thesis)]
    scene: Benchmark,
    /// Numbers of spheres, separated by commas; each is measured separately (for the scenes mixed and boxes: numbers of bodies)
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "1024,2048,4096,8192,16384",
        value_parser = whole(0, u32::MAX), allow_negative_numbers = true)]
    spheres: Vec<u32>,
    /// Number of timed steps in each run
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    steps: u64,
    /// Steps before the timed ones [default: 200 for the scene settled, otherwise 20]
    #[arg(long, value_name = "N", value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    warmup: Option<u64>,
    /// Number of runs of each size; their median is reported
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    runs: u32,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// Seed of the random numbers; the same seed gives the same scenes
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Print one JSON object instead of the tables
    #[arg(long)]
    json: bool,
    /// Write an SVG chart of the time of every phase, with one stacked bar for each size
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl Arguments {
    /// Time step, in s.
    fn dt(&self) -> f32 {
        self.physics.dt_or(DEFAULT_TIME_STEP)
    }

    fn warmup(&self) -> u64 {
        let default = if self.scene == Benchmark::Settled { 200 } else { 20 };
        self.warmup.unwrap_or(default)
    }
}

pub(crate) fn bench(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.other {
        Some(Other::Worlds(arguments)) => return worlds::bench(arguments),
        #[cfg(feature = "mpi")]
        Some(Other::Drum(arguments)) if shared::bench(arguments)? => return Ok(()),
        Some(Other::Drum(arguments)) => return drum::bench(arguments),
        Some(Other::Repeat(arguments)) => return repeat::bench(arguments),
        Some(Other::Frames(arguments)) => return frames::bench(arguments),
        None => {}
    }
    if let Some(path) = &arguments.plot {
        files::check("--plot", path, files::CHART)?;
    }
    // Opened first, so that a bad path fails before the measurement.
    let plot = arguments.plot.as_deref().map(|path| {
        let file = AtomicFile::create(path).map_err(|error| Failure::file(path, &error));
        file.map(|file| (path, file))
    });
    let plot = plot.transpose()?;
    let mut sizes = Vec::new();
    for spheres in &arguments.spheres {
        sizes.push(measure::measure(arguments, *spheres)?);
    }
    if let Some((path, file)) = plot {
        chart::write(&title(arguments, &sizes), &sizes, file).map_err(|error| Failure::file(path, &error))?;
    }
    let text = if arguments.json { json::object(arguments, &sizes) } else { table::tables(arguments, &sizes) };
    output::print(&text)
}

/// Title of the report: the scene, the integrator and the device.
fn title(arguments: &Arguments, sizes: &[Measured]) -> String {
    let device = sizes.first().map_or("", |size| &size.backend.device);
    let integrator = sizes.first().map_or_else(String::new, |size| format!(", {}", size.integrator));
    format!("rockfall bench {}{integrator}: {device}", arguments.scene)
}
