//! `rockfall run`: move a scene, and tell what became of it.

use std::path::PathBuf;
use std::time::Instant;

use rockfall::Simulation;

use crate::csv::Output;
use crate::failure::Failure;
use crate::options::{Engine, Physics};
use crate::output;
use crate::progress::Progress;
use crate::source::Source;
use crate::summary::Summary;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene file, or - for standard input; a built-in scene if left out
    scene: Option<PathBuf>,
    /// Number of steps
    #[arg(long, value_name = "N", default_value_t = 1000)]
    steps: u64,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// Write the final state of every sphere, as CSV
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write energies and momenta of every step, as CSV
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Print one JSON object instead of the summary
    #[arg(long)]
    json: bool,
    /// Go on when a body stops being finite: it is stopped and counted
    #[arg(long)]
    keep_going: bool,
    /// Words that the pair lists may take at the start
    #[arg(long, value_name = "N", hide = true, value_parser = clap::value_parser!(u32).range(..=i64::from(rockfall::layout::MAX_PAIR_WORDS)))]
    capacity: Option<u32>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.out.is_some() && arguments.out == arguments.trace {
        return Err(Failure::usage("--out and --trace name the same file"));
    }
    let Source { name, loaded } = Source::read(arguments.scene.as_deref())?;
    for warning in &loaded.warnings {
        output::note(&format!("warning: {name}:{}: {}", warning.line, warning.text));
    }
    let mut scene = loaded.scene;
    arguments.physics.change(&mut scene.settings)?;
    let mut state = arguments.out.as_deref().map(Output::create).transpose()?;
    let mut trace = arguments.trace.as_deref().map(Output::create).transpose()?;

    let mut options = arguments.engine.options(&arguments.physics).keep_going(arguments.keep_going);
    options.pair_capacity = arguments.capacity;
    let mut simulation = Simulation::with_options(scene, options)?;
    let before = simulation.energy()?;
    let start = Instant::now();
    steps(&mut simulation, arguments, trace.as_mut())?;
    let seconds = start.elapsed().as_secs_f64();

    if let Some(file) = &mut state {
        file.state(&simulation.spheres()?)?;
    }
    for file in [state, trace].into_iter().flatten() {
        file.commit()?;
    }
    let summary = Summary { name: &name, dt: arguments.physics.dt, seconds, before };
    let text = if arguments.json { summary.json(&simulation) } else { summary.table(&mut simulation)? };
    output::print(&text)
}

/// Does all steps; with a trace, one at a time.
fn steps(simulation: &mut Simulation, arguments: &Arguments, mut trace: Option<&mut Output>) -> Result<(), Failure> {
    if let Some(trace) = &mut trace {
        trace.trace_header()?;
        trace.trace(simulation)?;
    }
    let mut progress = Progress::new(arguments.steps);
    let mut left = arguments.steps;
    while left > 0 {
        let chunk = if trace.is_some() { 1 } else { progress.chunk() };
        let result = simulation.run(chunk, arguments.physics.dt);
        if result.is_err() {
            progress.finish();
            return Err(result.map(drop).unwrap_err().into());
        }
        if let Some(trace) = &mut trace {
            trace.trace(simulation)?;
        }
        left -= chunk;
        progress.advance(chunk);
    }
    progress.finish();
    Ok(())
}
