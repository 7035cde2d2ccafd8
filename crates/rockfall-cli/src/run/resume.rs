//! Continues a run from a checkpoint.

use std::path::{Path, PathBuf};

use clap::ArgMatches;
use clap::parser::ValueSource;
use rockfall::{Checkpoint, Error, Simulation};

use super::outputs::Outputs;
use super::past::{Past, PastFile};
use super::place::{folder_of, is_below};
use super::team::Starting;
use super::wanted::Wanted;
use super::{Arguments, Run};
use crate::failure::Failure;
use crate::files;
use crate::options::{Setting, Substeps, is_rigid};
use crate::output;

/// Distinguishes arguments on the command line from defaults.
pub(crate) struct Given<'a>(pub(crate) &'a ArgMatches);

impl Given<'_> {
    /// Whether an argument is on the command line. A subcommand need not have it: `view` has no `--substeps`.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.0.try_contains_id(name).is_ok() && self.0.value_source(name) == Some(ValueSource::CommandLine)
    }
}

pub(super) fn open(arguments: &Arguments, given: &Given, path: &Path, starting: &Starting) -> Result<Run, Failure> {
    let mut checkpoint = Checkpoint::load(path).map_err(Failure::usage)?;
    // Checkpoints of programs that use the library, such as Python, have no such note.
    let noted = Past::of_note(&checkpoint.note, path);
    let is_noted = noted.is_some();
    if !is_noted && !given.has("steps") {
        let (file, done) = (path.display(), checkpoint.report.steps);
        let message =
            format!("{file} is at step {done} and was not written by `rockfall run`: expected --steps N, {done} or more");
        return Err(Failure::usage(message));
    }
    let mut past = noted.unwrap_or_else(|| Past::without_note(path, &checkpoint.report));
    if past.dt <= 0.0 {
        past.dt = checkpoint.time_step;
    }
    let done = past.step(checkpoint.report.steps);
    if given.has("steps") {
        past.steps = arguments.steps.unwrap_or(past.steps);
    }
    if past.steps < done {
        let message = format!("--steps {}: {} is at step {done} already, expected at least {done}", past.steps, path.display());
        return Err(Failure::usage(message));
    }
    change(&mut checkpoint, &mut past, arguments, given)?;

    let wanted = if starting.is_first() { wanted(arguments, &past, path)? } else { Wanted::default() };
    checkpoint.options = starting.options(checkpoint.options);
    let mut outputs = Outputs::open(wanted, Some(&past))?;
    let (device, program) = (checkpoint.device.clone(), checkpoint.program.clone());
    let mut simulation = Simulation::resume(checkpoint).map_err(|error| match error {
        Error::NoAdapter(_) if !given.has("backend") => {
            Failure::Run(format!("{error}; the run of {} used {device}", path.display()))
        }
        error => error.into(),
    })?;
    let team = starting.share(&mut simulation)?;
    let now = [simulation.backend().device.as_str(), env!("CARGO_PKG_VERSION")];
    for (what, then, now) in [("device", &device, now[0]), ("rockfall", &program, now[1])] {
        // The part after the comma is the number of CPU threads, which does not change results.
        if then.split(',').next() != now.split(',').next() {
            output::note(&format!("note: {what}: {now} instead of {then}; results may be rounded differently"));
        }
    }
    if !is_noted {
        past.set_before(&simulation.energy()?);
    }
    outputs.begin(&mut simulation, &past)?;
    starting.check(&outputs)?;
    let precision = simulation.settings().precision.to_string();
    Ok(Run { simulation, outputs, past, precision, team })
}

/// Applies the options on the command line, which override those of the checkpoint, and reports what changes the motion.
fn change(checkpoint: &mut Checkpoint, past: &mut Past, arguments: &Arguments, given: &Given) -> Result<(), Failure> {
    let simulated = checkpoint.report.steps;
    let step = past.step(simulated);
    let differs = |what: &str, now: &str, then: &str| {
        if now != then {
            output::note(&format!("note: {what} {now} instead of {then} from step {step} on"));
        }
    };
    let (physics, options) = (&arguments.physics, &mut checkpoint.options);
    if given.has("dt") {
        let dt = physics.dt_or(past.dt);
        differs("--dt", &dt.to_string(), &past.dt.to_string());
        past.set_time_step(step, dt);
    }
    if given.has("integrator") {
        let integrator = physics.integrator_for(&checkpoint.scene).into();
        differs("--integrator", &format!("{integrator}"), &options.integrator.to_string());
        options.integrator = integrator;
    }
    for Setting { name, value } in &physics.set {
        let settings = &mut checkpoint.scene.settings;
        let then = settings.get(name).unwrap_or_default();
        settings.set(name, value)?;
        differs(&format!("--set {name}"), &settings.get(name).unwrap_or_default(), &then);
    }
    if !physics.set.is_empty() {
        past.changed = true;
        // A resumed simulation uses its constants as stored, so `resting_overlap` has to be resolved here.
        checkpoint.scene.settings = checkpoint.scene.with_grains().resolved_settings();
    }
    if is_rigid(&checkpoint.scene) {
        Substeps::give(arguments.substeps, &mut checkpoint.scene);
    } else if let Some(substeps) = arguments.substeps {
        let integrator = options.integrator.resolve(checkpoint.scene.settings.contact_law);
        let substeps = substeps.of(&checkpoint.scene, past.dt, integrator)?;
        differs("--substeps", &substeps.to_string(), &past.parts().to_string());
        past.divide(substeps, simulated);
    }
    checkpoint.time_step = past.part();
    let engine = arguments.engine.options(physics);
    if given.has("backend") {
        options.backend = engine.backend;
    }
    if given.has("broad_phase") {
        options.broad_phase = engine.broad_phase;
    }
    options.without = engine.without;
    options.keep_going |= arguments.keep_going;
    options.pair_capacity = arguments.capacity.or(options.pair_capacity);
    Ok(())
}

/// Output files of the earlier run, except those that the command line replaces.
fn wanted(arguments: &Arguments, past: &Past, path: &Path) -> Result<Wanted, Failure> {
    let mut wanted = arguments.wanted(None)?;
    let mut recorded = Recorded { checkpoint: path, outside: Vec::new() };
    for (option, known, file, before) in [
        ("--out", files::SERIES, &mut wanted.out, &past.out),
        ("--contacts", files::SERIES, &mut wanted.contacts, &past.contacts),
        ("--tensions", files::TENSIONS, &mut wanted.tensions, &past.tensions),
        ("--gauges", files::GAUGES, &mut wanted.gauges, &past.gauges),
        ("--bodies", files::BODIES, &mut wanted.bodies, &past.bodies),
        ("--joints", files::JOINTS, &mut wanted.joints, &past.joints),
        ("--events", files::EVENTS, &mut wanted.events, &past.events),
    ] {
        recorded.take(option, known, file, before.as_ref())?;
    }
    wanted.every = wanted.every.or(past.every);
    if recorded.take("--trace", files::TRACE, &mut wanted.trace, past.trace.as_ref())? {
        wanted.trace_every = wanted.trace_every.or(past.trace_every);
    }
    if let (None, Some(place)) = (&wanted.save, &past.save) {
        wanted.save = Some(recorded.checked("--save", files::SCENE, &place.0)?);
    }
    if !arguments.outputs_as_recorded {
        recorded.refuse()?;
    }
    wanted.checkpoint = wanted.checkpoint.or(Some(path.to_owned()));
    wanted.unwrapped |= past.unwrapped;
    wanted.checkpoint_every = wanted.checkpoint_every.or(past.checkpoint_every);
    wanted.check()?;
    Ok(wanted)
}

/// The outputs that a checkpoint names. It may come from a stranger.
struct Recorded<'a> {
    checkpoint: &'a Path,
    /// Options and paths of files that are not below the folder of the checkpoint.
    outside: Vec<String>,
}

impl Recorded<'_> {
    /// Takes the file of the earlier run if the command line names none. Returns whether the earlier file is used.
    fn take(
        &mut self,
        option: &str,
        known: &[&str],
        file: &mut Option<PathBuf>,
        before: Option<&PastFile>,
    ) -> Result<bool, Failure> {
        let Some(before) = before else { return Ok(false) };
        match file {
            Some(file) => Ok(before.is_at(file)),
            None => {
                *file = Some(self.checked(option, known, &before.path.0)?);
                Ok(true)
            }
        }
    }

    /// A path of the checkpoint. It has the extension of its kind, as all that `run` writes.
    fn checked(&mut self, option: &str, known: &[&str], path: &Path) -> Result<PathBuf, Failure> {
        let file = self.checkpoint.display();
        files::check(option, path, known).map_err(|failure| match failure {
            Failure::Usage(message) => {
                Failure::Usage(format!("{file}: its output {}; name another {option}", output::on_one_line(&message)))
            }
            failure => failure,
        })?;
        if !is_below(path, folder_of(self.checkpoint)) {
            self.outside.push(format!("{option} {}", output::on_one_line(&path.display().to_string())));
        }
        Ok(path.to_owned())
    }

    /// Returns an error if an output is not below the folder of the checkpoint.
    fn refuse(self) -> Result<(), Failure> {
        if self.outside.is_empty() {
            return Ok(());
        }
        let (file, all) = (self.checkpoint.display(), self.outside.join(", "));
        Err(Failure::usage(format!(
            "{file}: it has outputs that are not below its folder: {all}; name them again, or give --outputs-as-recorded if you trust \
             this checkpoint"
        )))
    }
}
