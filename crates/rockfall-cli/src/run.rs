//! `rockfall run`: simulates a scene and prints a summary.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rockfall::Simulation;
use rockfall_trajectory::Format;

use crate::aftermath;
use crate::check;
use crate::failure::Failure;
use crate::files;
use crate::interrupt::Interrupt;
use crate::options::{Engine, Physics, Substeps, whole};
use crate::output;
use crate::progress::Progress;
use crate::source::Source;
use crate::summary::Summary;

mod bodies;
mod checkpoints;
mod contacts;
mod errors;
mod events;
mod gauges;
mod joints;
mod outputs;
mod past;
mod place;
mod resume;
mod samples;
mod save;
pub(crate) mod team;
mod tensions;
mod trace;
mod wanted;

use outputs::Outputs;
pub(crate) use past::Past;
pub(crate) use resume::Given;
use team::{Next, Starting, Team};
use wanted::Wanted;

/// Number of steps of scenes that have none.
const DEFAULT_STEPS: u64 = 1000;

/// Details that do not fit into the one-line descriptions of the options.
const AFTER_HELP: &str = "\
Examples:
  rockfall run scenes/wall.txt
  rockfall run scenes/wall.txt --steps 600 --bodies poses.csv --every 10
  rockfall run pile.txt --out pile.npz --every 100 --trace energies.csv
  rockfall run pile.txt --checkpoint pile.ckpt
  rockfall run --resume pile.ckpt --steps 20000

The line @run of a scene says how it is meant to be run. Options override its values.

Files have the final state, with --every K the state at the start and after every K-th step.
The extension chooses the format: .csv, .npz (NumPy), .vtp and .pvd (ParaView), .txt, .ckpt.
  --out       spheres: place, velocity, orientation, angular momentum, reference
  --contacts  both objects, point, normal, overlap, force or impulse on the second one. Friction
              impulses of coulomb_friction are left out
  --tensions  step,time,kind,index,a,b,length,tension: kind is spring, muscle or tether; a and b are
              spheres; the tension is in mass units/s\u{b2} with the damping, negative where it pushes
  --gauges    step,time,gauge,fx,fy,fz,tx,ty,tz,mass,count: for walls the force of the bodies and its
              torque about the origin, with --every means over the steps; for planes what passed
  --bodies    body,name,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz: centre of mass, velocity, orientation,
              angular momentum about the centre. Motions of walls follow, with angular velocities
  --joints    step,time,joint,position,speed,fx,fy,fz,tx,ty,tz,error: angle in rad or length, its rate,
              force and torque on the second body (means over the step), error of the anchors
  --events    step,time,event,a,b,x,y,z,nx,ny,nz,fx,fy,fz: contacts that begin and end, what enters and
              leaves a @sensor. Every step is read back for it
  --trace     energies, momenta, contacts and collisions of every step. work is that of walls and
              muscles; dissipated is empty where the law does not know it
  --save      the final state as a scene. It lacks impulses and springs of contacts, so loaded
              machines jolt for some steps; --checkpoint keeps them

--resume takes everything from the checkpoint, also outputs; options override it. N of --steps counts
from the start of the first run. On the same device all files have the bits of one uninterrupted run.

Ctrl-C or SIGTERM finishes the step, writes all files and exits with code 130. A second Ctrl-C after
1 s ends the run at once. Exit codes: 0 done, 1 the run failed, 2 wrong usage or a bad scene.

`mpirun -n N rockfall run SCENE` gives a scene of spheres among walls to N processes (docs/cluster.md).
More: docs/guide.md";

#[derive(Debug, clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// Scene file, or - for standard input [default: a built-in scene]
    scene: Option<PathBuf>,
    /// Number of steps; with --resume, including the steps before the checkpoint [default: that of the scene, else 1000]
    #[arg(long, value_name = "N", value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    steps: Option<u64>,
    /// Divide every step into N equal parts; auto chooses the smallest stable N for springs and contacts [default: that of the scene,
    /// else 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    substeps: Option<Substeps>,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// Write the final state of every sphere: .csv, .npz or .vtp
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the files below every K steps instead, but --trace and --save: .csv, .npz or .pvd [default: that of the scene]
    #[arg(help_heading = "Files", long, value_name = "K", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    every: Option<u64>,
    /// In periodic scenes, write to --out where spheres have got to, with all periods that they have passed, not where they are in the box
    #[arg(help_heading = "Files", long)]
    unwrapped: bool,
    /// Write the energies and momenta of every step: .csv
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Write a line of --trace every K steps instead
    #[arg(help_heading = "Files", long, value_name = "K", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    trace_every: Option<u64>,
    /// Write every contact of the final state, with both bodies, point, normal, overlap and force: .csv, .npz or .vtp
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    contacts: Option<PathBuf>,
    /// Write the length and tension of every spring, muscle and tether of the final state: .csv
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    tensions: Option<PathBuf>,
    /// Write what the gauges of the scene measure in the final state, or their means over K steps every K steps: .csv
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    gauges: Option<PathBuf>,
    /// Write the pose and the motion of every rigid body in the final state, or every K steps: .csv
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    bodies: Option<PathBuf>,
    /// Write the position, the speed and the load of every joint in the final state, or every K steps: .csv
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    joints: Option<PathBuf>,
    /// Write a line for every contact that begins or ends, and for all that enters or leaves a sensor: .csv
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    events: Option<PathBuf>,
    /// Write the final state as a scene file, with its settings: .txt
    #[arg(help_heading = "Files", long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Write a checkpoint for --resume when the run ends or is interrupted: .ckpt
    #[arg(help_heading = "Checkpoints", long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Also write the checkpoint every N steps, replacing the previous one
    #[arg(help_heading = "Checkpoints", long, value_name = "N", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    checkpoint_every: Option<u64>,
    /// Continue the run from a checkpoint
    #[arg(help_heading = "Checkpoints", long, value_name = "FILE", conflicts_with = "scene")]
    resume: Option<PathBuf>,
    /// With --resume, also write to outputs of the checkpoint that are not below its folder
    #[arg(help_heading = "Checkpoints", long, requires = "resume", conflicts_with = "scene")]
    outputs_as_recorded: bool,
    /// Print one JSON object instead of the summary
    #[arg(help_heading = "Report and failures", long)]
    json: bool,
    /// Fail with exit code 1 when the energy grows without a cause in the scene, as after an explosion
    #[arg(help_heading = "Report and failures", long)]
    strict: bool,
    /// Continue when the state of a body is no longer finite: the body is stopped and counted
    #[arg(help_heading = "Report and failures", long)]
    keep_going: bool,
    /// Initial capacity of the pair lists, in words
    #[arg(long, value_name = "N", hide = true)]
    capacity: Option<u32>,
}

/// A run that is ready for its next step.
struct Run {
    simulation: Simulation,
    outputs: Outputs,
    past: Past,
    /// The precision of contacts, and why it was chosen.
    precision: String,
    team: Team,
}

pub(crate) fn run(arguments: &Arguments, given: &Given, interrupt: &'static Interrupt) -> Result<(), Failure> {
    // From the start, because output files that were only created are removed again.
    interrupt.hold();
    interrupt.leaves("; no results are written".to_owned());
    let mut starting = Starting::start()?;
    let begun = match &arguments.resume {
        Some(path) => resume::open(arguments, given, path, &starting),
        None => begin(arguments, &starting),
    };
    let mut run = starting.all(begun)?;
    let result = steps(&mut run, interrupt);
    interrupt.finishes();
    let Run { mut simulation, outputs, past, precision, team } = run;

    if !team.is_first() {
        // The first process reports what happened.
        return Ok(());
    }
    let step = past.step(team.steps(&simulation));
    let command = outputs.command();
    let finished = outputs.finish(&mut simulation, &past);
    let stopped = step < past.steps;
    if stopped || result.is_err() {
        outputs::note_written(finished.as_deref().unwrap_or_default(), step);
    }
    // The first failure is the one to report: it is the cause of the others.
    result.and(finished.map(drop))?;
    let summary = Summary {
        name: &past.scene,
        comments: past.comments,
        precision: &precision,
        steps: step,
        time: past.time(step),
        dt: past.dt,
        substeps: past.parts(),
        frame_substeps: simulation.substeps(),
        seconds: past.seconds,
        energies: [past.before(), simulation.energy()?],
        overlap: simulation.max_overlap()?,
        broken_joints: simulation.joints()?.iter().filter(|joint| joint.broken).count(),
    };
    let before = (!past.changed).then(|| past.before());
    let grown = if stopped { None } else { aftermath::grown(&past.scene, &mut simulation, before.as_ref())? };
    let growth = grown.as_ref().map(|grown| grown.size);
    output::print(&if arguments.json { summary.json(&simulation, growth) } else { summary.table(&mut simulation)? })?;
    if !stopped {
        aftermath::warn_of_overlaps(&past.scene, &mut simulation, step)?;
    }
    aftermath::warn_of_passages(&past.scene, &simulation, past.parts().into());
    match grown {
        Some(grown) if arguments.strict => return Err(Failure::Run(grown.message)),
        Some(grown) => output::note(&format!("warning: {}", grown.message)),
        None => {}
    }
    if stopped {
        let how = command.map_or(String::new(), |command| format!("; continue with: {command}"));
        return Err(Failure::Interrupted(format!("stopped at step {step} of {}{how}", past.steps)));
    }
    Ok(())
}

/// Prepares a run of a scene from its start.
fn begin(arguments: &Arguments, starting: &Starting) -> Result<Run, Failure> {
    if starting.is_shared() && arguments.scene.as_deref() == Some(Path::new("-")) {
        return Err(Failure::usage("-: standard input reaches one process alone: expected a scene file"));
    }
    let Source { name, loaded } = Source::read(arguments.scene.as_deref())?;
    let wanted = arguments.wanted(loaded.scene.run.every)?;
    let Arguments { out, trace, contacts, tensions, gauges, bodies, joints, events, save, checkpoint, .. } = arguments;
    for file in [out, trace, contacts, tensions, gauges, bodies, joints, events, save, checkpoint].into_iter().flatten() {
        Source::is_not(arguments.scene.as_deref(), file)?;
    }
    let (comments, title) = (loaded.comments, loaded.title.clone());
    let (scene, substeps) = check::prepare(&name, loaded, &arguments.physics, arguments.substeps)?;
    let dt = arguments.physics.dt_for(&scene);
    let steps = arguments.steps.or(scene.run.steps).unwrap_or(DEFAULT_STEPS);
    let mut past = Past { scene: name, comments, title, steps, dt, substeps, ..Past::default() };
    // Rods that jump to their length change the energy; a warning above has the reason.
    past.changed = scene.odd_rods().iter().any(|rod| rod.length.is_some());
    let counts = scene.counts();
    if arguments.tensions.is_some() && counts.springs + counts.tethers == 0 {
        output::note(&format!("note: --tensions: {}", output::NO_LINKS));
    }
    if arguments.gauges.is_some() && scene.gauges().is_empty() {
        output::note("note: --gauges: the scene has no gauges (a line `@gauge name=N wall=NAME` adds one)");
    }
    if arguments.bodies.is_some() && counts.bodies == 0 && scene.shapes().is_empty() && scene.motions().is_empty() {
        let how = "a line `@place NAME at=x,y,z` adds a body, a line `@motion` moves walls";
        output::note(&format!("note: --bodies: the scene has no rigid bodies and no motions ({how})"));
    }
    if arguments.joints.is_some() && scene.joints().is_empty() {
        output::note("note: --joints: the scene has no joints (a line `@joint hinge A B at=x,y,z axis=x,y,z` adds one)");
    }
    let mut outputs = Outputs::open(if starting.is_first() { wanted } else { Wanted::default() }, None)?;
    let mut options = starting.options(arguments.engine.options(&arguments.physics).keep_going(arguments.keep_going));
    options.pair_capacity = arguments.capacity;
    let precision = scene.with_grains().chosen_precision().to_string();
    let mut simulation = Simulation::with_options(scene, options)?;
    let team = starting.share(&mut simulation)?;
    // Energies and contacts at the start depend on it.
    simulation.set_time_step(past.part())?;
    past.set_before(&simulation.energy()?);
    outputs.begin(&mut simulation, &past)?;
    starting.check(&outputs)?;
    Ok(Run { simulation, outputs, past, precision, team })
}

impl Arguments {
    /// Output files from the arguments. `every` is the number of steps between two frames that the scene has.
    fn wanted(&self, every: Option<u64>) -> Result<Wanted, Failure> {
        let has_frames = [&self.out, &self.contacts, &self.tensions, &self.gauges, &self.bodies, &self.joints]
            .into_iter()
            .any(Option::is_some);
        let every = self.every.or(every.filter(|_| has_frames));
        // Without --every, a .pvd file has an error of its own.
        let of_states = |path: &Option<PathBuf>| {
            let is_series = path.as_deref().is_some_and(|path| Format::of(path) == Some(Format::Vtp));
            if is_series || every.is_some() || self.resume.is_some() { files::SERIES } else { files::STATE }
        };
        for (option, path, known) in [
            ("--out", &self.out, of_states(&self.out)),
            ("--contacts", &self.contacts, of_states(&self.contacts)),
            ("--tensions", &self.tensions, files::TENSIONS),
            ("--gauges", &self.gauges, files::GAUGES),
            ("--bodies", &self.bodies, files::BODIES),
            ("--joints", &self.joints, files::JOINTS),
            ("--events", &self.events, files::EVENTS),
            ("--trace", &self.trace, files::TRACE),
            ("--save", &self.save, files::SCENE),
            ("--checkpoint", &self.checkpoint, files::CHECKPOINT),
        ] {
            path.as_deref().map_or(Ok(()), |path| files::check(option, path, known))?;
        }
        let wanted = Wanted {
            out: self.out.clone(),
            every,
            unwrapped: self.unwrapped,
            trace: self.trace.clone(),
            trace_every: self.trace_every,
            contacts: self.contacts.clone(),
            tensions: self.tensions.clone(),
            gauges: self.gauges.clone(),
            bodies: self.bodies.clone(),
            joints: self.joints.clone(),
            events: self.events.clone(),
            save: self.save.clone(),
            checkpoint: self.checkpoint.clone(),
            checkpoint_every: self.checkpoint_every,
        };
        if self.resume.is_none() {
            wanted.check()?;
        }
        Ok(wanted)
    }
}

/// Runs the remaining steps until the end or an interrupt, then writes a checkpoint of the last step.
fn steps(run: &mut Run, interrupt: &Interrupt) -> Result<(), Failure> {
    let (start, seconds) = (Instant::now(), run.past.seconds);
    let parts = u64::from(run.past.parts());
    let done = |run: &Run| run.past.step(run.team.steps(&run.simulation));
    let mut progress = Progress::new(run.past.steps - done(run));
    let mut result = Ok(());
    interrupt.leaves(run.outputs.left());
    loop {
        let step = done(run);
        let stops = result.is_err() || interrupt.is_requested() || step >= run.past.steps;
        let chunk = run.outputs.steps_from(step, progress.chunk());
        let Next { stops, chunk, is_due } = run.team.agree(Next { stops, chunk, is_due: run.outputs.are_due(step + chunk) })?;
        if stops {
            break;
        }
        let steps = (chunk.saturating_mul(parts), run.past.part());
        let moved = run.team.advance(&mut run.simulation, &mut run.outputs, steps, is_due);
        result = moved.map_err(|error| Failure::of(run.past.in_steps(error), run.simulation.scene()));
        // Also those of the steps before one that fails.
        let noted = run.outputs.add_events(&mut run.simulation, &run.past);
        result = result.and(noted);
        run.past.seconds = seconds + start.elapsed().as_secs_f64();
        if is_due {
            result = result.and_then(|()| run.outputs.after_step(&mut run.simulation, &mut run.past));
        }
        interrupt.leaves(run.outputs.left());
        progress.advance(chunk);
    }
    progress.finish();
    run.past.seconds = seconds + start.elapsed().as_secs_f64();
    let gathered = run.team.gather(&mut run.simulation);
    result?;
    gathered?;
    run.outputs.save(&mut run.simulation, &mut run.past)
}
