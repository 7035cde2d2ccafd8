//! `rockfall run`: move a scene, and tell what became of it.

use std::path::PathBuf;
use std::time::Instant;

use rockfall::Simulation;

use crate::check;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::{Engine, Physics, Substeps, whole};
use crate::output;
use crate::progress::Progress;
use crate::source::Source;
use crate::summary::Summary;

mod outputs;
mod past;
mod resume;

use outputs::{Outputs, Wanted};
use past::Past;
pub(crate) use resume::Given;

/// What does not fit into a line.
const AFTER_HELP: &str = "\
A run that is ended by Ctrl-C or SIGTERM finishes its step, writes what was computed (--out, --trace, --checkpoint) and exits \
with code 130; a second Ctrl-C ends it at once. A run that fails writes --out and --trace up to the step that failed, where the \
device still gives it, and leaves the last checkpoint alone.

--resume FILE goes on to step N in all (--steps N). It takes everything from the checkpoint: constants, time step, integrator, \
backend, --out, --every, --trace and --checkpoint-every, and goes on writing checkpoints to FILE. What is given on the command \
line comes before that; a change of what decides the motion is noted. With the same on the same device, the run ends in the \
same bits as one that was never stopped, and its trace and trajectory are the same files. Until a run ends, they are beside \
their places as .NAME.part; a run that was killed leaves them there, for --resume or for the next run that writes to that place.

--substeps N divides every step into N equal parts; auto takes as few as the springs and the contact force of the scene bear \
(rockfall check tells). Steps and the time step keep their meaning everywhere else. A line of the trace counts the collisions of \
all parts; its contacts and overlap are those of the last one.

--out goes by the extension. Without --every: .npz (NumPy) and .vtp (ParaView), else CSV, hold the final state. With --every K: \
every K steps from the first state on, .npz holds arrays [frames, spheres, ...], .vtp or .pvd makes NAME.pvd and a folder NAME \
of frames, else CSV has the columns step,time before the others.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// Scene file, or - for standard input; a built-in scene if left out
    scene: Option<PathBuf>,
    /// Number of steps; with --resume those before the checkpoint count
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    steps: u64,
    /// Divide every step into N equal parts, or auto: as few as springs and contacts bear
    #[arg(long, value_name = "N", default_value = "1", allow_negative_numbers = true)]
    substeps: Substeps,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// Write the final state of every sphere, as CSV, .npz or .vtp
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the state to --out every K steps instead: .npz, .pvd, else CSV
    #[arg(long, value_name = "K", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    every: Option<u64>,
    /// Write energies and momenta of every step, as CSV
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Keep what is needed to go on in a file: at the end, and when the run is interrupted
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Write the checkpoint every N steps too, over the one before
    #[arg(long, value_name = "N", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    checkpoint_every: Option<u64>,
    /// Go on from a checkpoint
    #[arg(long, value_name = "FILE", conflicts_with = "scene")]
    resume: Option<PathBuf>,
    /// Print one JSON object instead of the summary
    #[arg(long)]
    json: bool,
    /// Go on when a body stops being finite: it is stopped and counted
    #[arg(long)]
    keep_going: bool,
    /// Words that the pair lists may take at the start
    #[arg(long, value_name = "N", hide = true)]
    capacity: Option<u32>,
}

/// A run before its first step, or its next.
struct Run {
    simulation: Simulation,
    outputs: Outputs,
    past: Past,
}

pub(crate) fn run(arguments: &Arguments, given: &Given) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let mut run = match &arguments.resume {
        Some(path) => resume::open(arguments, given, path)?,
        None => begin(arguments)?,
    };
    let result = steps(&mut run, &interrupt);
    let Run { mut simulation, outputs, past } = run;

    let step = past.step(simulation.report().steps);
    let checkpoint = outputs.checkpoint().map(|path| path.display().to_string());
    let finished = outputs.finish(&mut simulation);
    let stopped = step < past.steps;
    if stopped || result.is_err() {
        outputs::tell(finished.as_deref().unwrap_or_default(), step);
    }
    // The first failure is the one that explains the others.
    result.and(finished.map(drop))?;
    let (dt, substeps) = (past.dt, past.parts());
    let summary = Summary { name: &past.scene, steps: step, dt, substeps, seconds: past.seconds, before: past.before() };
    output::print(&if arguments.json { summary.json(&simulation) } else { summary.table(&mut simulation)? })?;
    if stopped {
        let how = checkpoint.map_or(String::new(), |path| format!("; rockfall run --resume {path} goes on"));
        return Err(Failure::Interrupted(format!("stopped at step {step} of {}{how}", past.steps)));
    }
    Ok(())
}

/// A run of a scene, from its start.
fn begin(arguments: &Arguments) -> Result<Run, Failure> {
    let wanted = arguments.wanted()?;
    let Source { name, loaded } = Source::read(arguments.scene.as_deref())?;
    for file in [&arguments.out, &arguments.trace, &arguments.checkpoint].into_iter().flatten() {
        Source::is_not(arguments.scene.as_deref(), file)?;
    }
    if loaded.scene.counts().spheres == 0 {
        output::note(&format!("warning: {name}: no spheres, so nothing will move"));
    }
    for warning in &loaded.warnings {
        output::note(&format!("warning: {name}:{}: {}", warning.line, warning.text));
    }
    let mut scene = loaded.scene;
    arguments.physics.change(&mut scene.settings)?;
    let (dt, integrator) = (arguments.physics.dt, arguments.physics.integrator);
    let substeps = arguments.substeps.of(&scene, dt, integrator);
    let mut past = Past { scene: name, steps: arguments.steps, dt, substeps, ..Past::default() };
    for line in check::concerns(&past.scene, &scene, past.part(), integrator).lines() {
        output::note(line);
    }
    let mut outputs = Outputs::open(wanted, None)?;
    let mut options = arguments.engine.options(&arguments.physics).keep_going(arguments.keep_going);
    options.pair_capacity = arguments.capacity;
    let mut simulation = Simulation::with_options(scene, options)?;
    past.set_before(&simulation.energy()?);
    outputs.begin(&mut simulation, &past)?;
    Ok(Run { simulation, outputs, past })
}

impl Arguments {
    /// The files that were asked for.
    fn wanted(&self) -> Result<Wanted, Failure> {
        let wanted = Wanted {
            out: self.out.clone(),
            every: self.every,
            trace: self.trace.clone(),
            checkpoint: self.checkpoint.clone(),
            checkpoint_every: self.checkpoint_every,
        };
        if self.resume.is_none() {
            wanted.check()?;
        }
        Ok(wanted)
    }
}

/// Does the steps that are left, until the run is asked to end; the checkpoint is that of the last one.
fn steps(run: &mut Run, interrupt: &Interrupt) -> Result<(), Failure> {
    let (start, seconds) = (Instant::now(), run.past.seconds);
    let parts = u64::from(run.past.parts());
    let done = |run: &Run| run.past.step(run.simulation.report().steps);
    let mut progress = Progress::new(run.past.steps - done(run));
    let mut result = Ok(());
    while result.is_ok() && !interrupt.is_asked() && done(run) < run.past.steps {
        let chunk = run.outputs.steps_from(done(run), progress.chunk());
        let moved = run.simulation.run(chunk.saturating_mul(parts), run.past.part());
        result = moved.map(drop).map_err(|error| Failure::from(run.past.in_steps(error)));
        run.past.seconds = seconds + start.elapsed().as_secs_f64();
        result = result.and_then(|()| run.outputs.after_step(&mut run.simulation, &mut run.past));
        progress.advance(chunk);
    }
    progress.finish();
    run.past.seconds = seconds + start.elapsed().as_secs_f64();
    result?;
    run.outputs.save(&mut run.simulation, &mut run.past)
}
