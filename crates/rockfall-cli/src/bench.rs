//! `rockfall bench`: how fast steps are, where their time goes, and how near that is to what the memory allows.
//!
//! Throughput is the wall time of plain runs, each on a scene made anew; the times of the stages come from one more run,
//! with timestamps around every dispatch.

use std::path::PathBuf;

use rockfall::generate::Benchmark;
use rockfall::output::AtomicFile;

use crate::failure::Failure;
use crate::options::{Engine, Physics, whole};
use crate::output;

mod chart;
mod json;
mod measure;
mod phases;
mod spread;
mod table;

use measure::Measured;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// thesis, lattice, pile, settled, shuffled, mixed or radii
    #[arg(default_value_t = Benchmark::Thesis)]
    scene: Benchmark,
    /// Numbers of spheres (of mixed: of bodies), with commas between; one measurement each
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "1024,2048,4096,8192,16384",
        value_parser = whole(0, u32::MAX), allow_negative_numbers = true)]
    spheres: Vec<u32>,
    /// Steps of a run
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    steps: u64,
    /// Steps before the clock starts; 200 for settled, else 20
    #[arg(long, value_name = "N", value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    warmup: Option<u64>,
    /// Runs of each size, of which the median is taken
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    runs: u32,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// The same seed makes the same scenes
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Print one JSON object instead of the tables
    #[arg(long)]
    json: bool,
    /// Draw the time of every phase as stacked bars, one for each size, into an SVG file
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl Arguments {
    fn warmup(&self) -> u64 {
        let of_scene = if self.scene == Benchmark::Settled { 200 } else { 20 };
        self.warmup.unwrap_or(of_scene)
    }
}

pub(crate) fn bench(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(path) = arguments.plot.as_deref().filter(|path| path.extension().is_none_or(|extension| extension != "svg")) {
        return Err(Failure::usage(format!("--plot {}: expected a FILE.svg", path.display())));
    }
    // Opened first, so that a bad path shows before the long work.
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

/// What was measured, and where.
fn title(arguments: &Arguments, sizes: &[Measured]) -> String {
    let device = sizes.first().map_or("", |size| &size.backend.device);
    let (scene, integrator) = (arguments.scene, arguments.physics.integrator);
    format!("rockfall bench {scene}, {integrator}: {device}")
}
