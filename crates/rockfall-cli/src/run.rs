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
Ctrl-C or SIGTERM stops a run cleanly: it finishes the step under way, writes its results (--out, --trace, --contacts, --tensions, --gauges, --bodies, --joints, --events, --save, \
--checkpoint) and exits with code 130. A step that takes longer than 0.8 s and 20 times longer than all steps before it, or longer than 20 s, is abandoned: the last checkpoint and the .part files \
stay as they are. A second Ctrl-C ends the run at once if it comes at least 1 s \
after the first. If a step fails, --out and --trace are written up to that step if the \
device can still be read, and the last checkpoint is left unchanged.

--resume FILE continues a run from its checkpoint up to step N, counted from the start of the first run (--steps N). It takes \
everything from the checkpoint: constants, time step, integrator, backend, --out, --every, --trace, --trace-every, --contacts, --tensions, \
--gauges, --bodies, --joints, --events, --save and --checkpoint-every, and writes further checkpoints to FILE. Options on the command line override the checkpoint; a change that affects the motion is \
reported. Outputs below the folder of the checkpoint are used where the folder is now. Others need to be named again, or \
--outputs-as-recorded: a checkpoint of somebody else could name any file. With the \
same options on the same device, the final state, the trace and the trajectory are bitwise identical to \
those of a run that was never stopped. A checkpoint of a program that uses the library or of Python has no number of steps, so \
it needs --steps. Until a run ends, its trace and trajectory are next to their final path as .NAME.part. \
A run that is killed leaves these files; --resume continues them, and a new run that writes to the same path replaces them.

A line `@run dt=S integrator=NAME steps=N every=K substeps=N` of the scene says how it is meant to be run; each option overrides \
its value.

--substeps N divides every step into N equal parts, with the contact law rigid every frame into N substeps of its solver; auto chooses the smallest N for which the springs and the contact force \
are stable (rockfall check reports it). Everywhere else, steps and the time step are whole steps.

--trace writes a line for step 0 and then for every step, with --trace-every K for every K-th step. A line counts the collisions \
since the line before it; its contacts and overlap are those at its step, with --substeps those of the last part. work is \
what moving walls, conveyors and muscles have done on the bodies since the first line. In scenes with them, every step is read \
back for it. dissipated is work minus the growth of all energies in the line, with the contact laws linear and hertz-mindlin in \
scenes without external forces; elsewhere it is empty. It includes what the tangential springs of contacts store.

The extension of a file chooses its format, in upper or lower case; an unknown one is an error. Devices such as /dev/stdout get \
CSV. Without --every, --out writes the final state: .csv, .npz for NumPy, .vtp for ParaView. With --every K, it writes the state \
at the start and after every K-th step: .npz holds arrays [frames, spheres, ...], or where spheres come and go the spheres of all \
frames one after the other; .vtp or .pvd writes NAME.pvd and a folder NAME \
with the frames, .csv has the columns step,time in front.

--contacts writes the contacts of the same states: both bodies, point, normal, overlap, and the force or the impulse on the \
second body. Friction impulses (--set coulomb_friction=...) are not included: only the friction of contact forces is. .vtp and .pvd have a line from body to body for each contact, which shows force chains in ParaView.

--tensions writes the lengths and tensions of all springs, muscles and tethers in the same states, in the columns \
step,time,kind,index,a,b,length,tension: kind is spring, muscle or tether; index counts springs with muscles, or tethers, from 0; a \
and b are the indices of the spheres, with an empty b for a tether; length is in units, and tension in mass units/s², with the \
damping, negative where the spring pushes. Rods are not in it: the model keeps their lengths without a force.

--gauges writes what the @gauge lines of the scene measure, in the columns step,time,gauge,fx,fy,fz,tx,ty,tz,mass,count: for walls \
the force of the bodies on them and its torque about the origin, for planes the mass and the number of spheres that have passed \
since the start, along the normal minus against it. With --every K there is a line for each gauge at step 0 and then every K \
steps, where forces and torques are means over the states after the K steps; every step is read back for them.

--bodies writes the rigid bodies of the final state in the columns body,name,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz, with --every K \
those of every K-th state with the columns step,time in front: centre of mass, its velocity, the orientation, which turns coordinates \
of the shape into those of the world, and the angular momentum about the centre. The motions of walls (@motion, @servo) follow, with \
indices that count on: a point of the wall (for a turn one of its axis, else the origin of the scene at rest), its velocity, the turn \
since the start, and the angular velocity in rad/s in place of the angular momentum.

--joints writes the joints of the final state in the columns step,time,joint,position,speed,fx,fy,fz,tx,ty,tz,error, with --every K \
those of every K-th state: the name of the joint (its number from 0 where it has none), the angle in rad, or the way or distance in units, \
and its rate, the force and the torque that the joint exerts on its second body at the anchor, which are means over the \
step, and by how much the anchors miss what the joint wants. A broken joint has no numbers.

--events writes a line for every contact that begins or ends, and for all that enters or leaves a sensor (a line @sensor of the scene), \
in the columns step,time,event,a,b,x,y,z,nx,ny,nz,fx,fy,fz: event is begin, end, enter or leave; a and b are the kind and the index of \
the object, as in `body 2` or `box 0`, and b of a sensor is its name; then the point, the normal from a to b, and the force on b in the \
state in which the contact began, 0 at its end. A rigid body or a capsule is one object with all its parts. For a sensor the point is the \
centre, and the others are empty. What touches or is inside at the start has no line. Every step is read back for it.

--save FILE.txt writes the final state as a scene file with all settings, also those of --set. It keeps the comment at the \
beginning of the scene, up to the first empty line, but no other comments. Its line @run has the time step and the integrator of \
the run, so `rockfall run FILE.txt` goes on from there, except that a text leaves out the springs of contacts (contact laws linear, \
hertz-mindlin and user): their friction and cohesion begin anew, and bodies at rest move. Under the law rigid it leaves out the impulses of \
contacts and joints, which jolt a loaded machine for some steps. --checkpoint keeps all of them.

`mpirun -n N rockfall run SCENE` gives one scene to N processes with the same results, if rockfall was built with the cargo feature mpi. \
They run on the CPU. The first process prints and writes all files. Scenes with other things than spheres among walls, and \
with collisions on, are refused (docs/cluster.md).";

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
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the state to --out, the contacts to --contacts, the tensions to --tensions, the gauges to --gauges, the rigid bodies to --bodies, and the joints to --joints, every K steps instead: .csv, .npz or .pvd [default: that of the scene]
    #[arg(long, value_name = "K", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    every: Option<u64>,
    /// In periodic scenes, write to --out where spheres have got to, with all periods that they have passed, not where they are in the box
    #[arg(long)]
    unwrapped: bool,
    /// Write the energies and momenta of every step: .csv
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Write a line of --trace every K steps instead
    #[arg(long, value_name = "K", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    trace_every: Option<u64>,
    /// Write every contact of the final state, with both bodies, point, normal, overlap and force: .csv, .npz or .vtp
    #[arg(long, value_name = "FILE")]
    contacts: Option<PathBuf>,
    /// Write the length and tension of every spring, muscle and tether of the final state: .csv
    #[arg(long, value_name = "FILE")]
    tensions: Option<PathBuf>,
    /// Write what the gauges of the scene measure in the final state, or their means over K steps every K steps: .csv
    #[arg(long, value_name = "FILE")]
    gauges: Option<PathBuf>,
    /// Write the pose and the motion of every rigid body in the final state, or every K steps: .csv
    #[arg(long, value_name = "FILE")]
    bodies: Option<PathBuf>,
    /// Write the position, the speed and the load of every joint in the final state, or every K steps: .csv
    #[arg(long, value_name = "FILE")]
    joints: Option<PathBuf>,
    /// Write a line for every contact that begins or ends, and for all that enters or leaves a sensor: .csv
    #[arg(long, value_name = "FILE")]
    events: Option<PathBuf>,
    /// Write the final state as a scene file, with its settings: .txt
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Write a checkpoint for --resume when the run ends or is interrupted: .ckpt
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Also write the checkpoint every N steps, replacing the previous one
    #[arg(long, value_name = "N", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    checkpoint_every: Option<u64>,
    /// Continue the run from a checkpoint
    #[arg(long, value_name = "FILE", conflicts_with = "scene")]
    resume: Option<PathBuf>,
    /// With --resume, also write to outputs of the checkpoint that are not below its folder
    #[arg(long, requires = "resume", conflicts_with = "scene")]
    outputs_as_recorded: bool,
    /// Print one JSON object instead of the summary
    #[arg(long)]
    json: bool,
    /// Fail with exit code 1 when the energy grows without a cause in the scene, as after an explosion
    #[arg(long)]
    strict: bool,
    /// Continue when the state of a body is no longer finite: the body is stopped and counted
    #[arg(long)]
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
