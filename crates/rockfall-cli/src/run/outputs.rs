//! Files that a run writes: the final state or a trajectory, the trace, and checkpoints that refer to both.

use std::path::{Path, PathBuf};

use rockfall::output::{AtomicFile, Mark};
use rockfall::{Meter, Simulation};
use rockfall_trajectory::csv;
use rockfall_trajectory::{Format, Frame, Writer, vtp};

use super::bodies::BodiesFile;
use super::checkpoints::CheckpointFile;
use super::contacts::ContactsFile;
use super::errors::{lost, written};
use super::events::EventsFile;
use super::gauges::GaugesFile;
use super::joints::JointsFile;
use super::past::{Metered, Past, PastFile};
use super::place::Place;
use super::save;
use super::tensions::TensionsFile;
use super::trace::TraceFile;
use super::wanted::Wanted;
use crate::failure::Failure;
use crate::output;

/// Output of `--out`.
enum Out {
    /// The state at the end.
    State(PathBuf, AtomicFile),
    /// The state at the end, as a trajectory of one frame.
    LastFrame(PathBuf, Writer),
    /// A frame at a fixed interval, in steps.
    Frames(PathBuf, Writer, u64),
}

/// Open output files. They are opened before the run, so that a bad path fails at once.
pub(crate) struct Outputs {
    out: Option<Out>,
    trace: Option<TraceFile>,
    contacts: Option<ContactsFile>,
    tensions: Option<TensionsFile>,
    gauges: Option<GaugesFile>,
    bodies: Option<BodiesFile>,
    joints: Option<JointsFile>,
    events: Option<EventsFile>,
    save: Option<(PathBuf, AtomicFile)>,
    unwrapped: bool,
    checkpoint: Option<CheckpointFile>,
    /// Sums over steps, for the trace and the gauges.
    meter: Meter,
    /// Whether the trajectory, the contacts and the tensions are new, and need their first frame.
    is_new: [bool; 3],
}

impl Outputs {
    /// Opens the files. A file that the earlier run `past` had begun is continued.
    pub(crate) fn open(wanted: Wanted, past: Option<&Past>) -> Result<Self, Failure> {
        let checkpoint = CheckpointFile::of(&wanted)?;
        let Wanted {
            out,
            every,
            unwrapped,
            trace,
            trace_every,
            contacts,
            tensions,
            gauges,
            bodies,
            joints,
            events,
            save,
            checkpoint: _,
            checkpoint_every: _,
        } = wanted;
        let marked = |path: &Path, past: Option<&PastFile>| -> Option<Mark> {
            past.filter(|past| past.is_at(path)).and_then(PastFile::mark)
        };
        let out_mark = out.as_deref().and_then(|path| marked(path, past.and_then(|past| past.out.as_ref())));
        let contacts_mark = contacts.as_deref().and_then(|path| marked(path, past.and_then(|past| past.contacts.as_ref())));
        let tensions_mark = tensions.as_deref().and_then(|path| marked(path, past.and_then(|past| past.tensions.as_ref())));
        let gauges_mark = gauges.as_deref().and_then(|path| marked(path, past.and_then(|past| past.gauges.as_ref())));
        let bodies_mark = bodies.as_deref().and_then(|path| marked(path, past.and_then(|past| past.bodies.as_ref())));
        let joints_mark = joints.as_deref().and_then(|path| marked(path, past.and_then(|past| past.joints.as_ref())));
        let events_mark = events.as_deref().and_then(|path| marked(path, past.and_then(|past| past.events.as_ref())));
        let continues =
            [out_mark, contacts_mark, tensions_mark, gauges_mark, bodies_mark, joints_mark].iter().any(Option::is_some);
        if let Some(begun) = past.and_then(|past| past.every).filter(|begun| continues && every != Some(*begun)) {
            let message = "omit --every, or give another --out";
            return Err(Failure::usage(format!("--every: the existing frames were written with --every {begun}; {message}")));
        }
        let begun = past.and_then(|past| past.trace_every).unwrap_or(1);
        let trace_mark = trace.as_deref().and_then(|path| marked(path, past.and_then(|past| past.trace.as_ref())));
        if trace_mark.is_some() && trace_every.unwrap_or(1) != begun {
            let message = "omit --trace-every, or give another --trace";
            return Err(Failure::usage(format!(
                "--trace-every: the existing lines were written with --trace-every {begun}; {message}"
            )));
        }
        Ok(Self {
            out: out.map(|path| Out::open(path, every, unwrapped, out_mark)).transpose()?,
            trace: trace.map(|path| TraceFile::open(path, trace_every, trace_mark, past)).transpose()?,
            contacts: contacts.map(|path| ContactsFile::open(path, every, contacts_mark)).transpose()?,
            tensions: tensions.map(|path| TensionsFile::open(path, every, tensions_mark)).transpose()?,
            gauges: gauges.map(|path| GaugesFile::open(path, every, gauges_mark)).transpose()?,
            bodies: bodies.map(|path| BodiesFile::open(path, every, bodies_mark)).transpose()?,
            joints: joints.map(|path| JointsFile::open(path, every, joints_mark)).transpose()?,
            events: events.map(|path| EventsFile::open(path, events_mark)).transpose()?,
            save: save.map(|path| save::open(&path).map(|file| (path, file))).transpose()?,
            unwrapped,
            checkpoint,
            meter: Meter::default(),
            is_new: [out_mark, contacts_mark, tensions_mark].map(|mark| mark.is_none()),
        })
    }

    /// Writes the header of a new trace, and the state before the first step to a new trace and trajectory.
    pub(crate) fn begin(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        self.begin_meter(simulation, past);
        if self.events.is_some() {
            EventsFile::begin(simulation)?;
        }
        let [frames, contacts, tensions] = self.is_new;
        if let Some(trace) = &mut self.trace {
            trace.begin(simulation, past, &self.meter)?;
        }
        if let Some(gauges) = &mut self.gauges {
            gauges.begin(simulation, past)?;
        }
        if let Some(bodies) = &mut self.bodies {
            bodies.begin(simulation, past)?;
        }
        if let Some(joints) = &mut self.joints {
            joints.begin(simulation, past)?;
        }
        let step = past.step(simulation.report().steps);
        if let Some(Out::Frames(_, writer, _)) = self.out.as_mut().filter(|_| frames) {
            written(writer.frame_at(simulation, step, past.time(step)))?;
        }
        if let Some(file) = self.contacts.as_mut().filter(|_| contacts) {
            file.after_step(simulation, past, step)?;
        }
        match self.tensions.as_mut().filter(|_| tensions) {
            Some(file) => file.after_step(simulation, past, step),
            None => Ok(()),
        }
    }

    /// Begins the sums over steps, or continues those of files that the earlier run had begun.
    fn begin_meter(&mut self, simulation: &Simulation, past: &Past) {
        let has_means = self.gauges.as_ref().is_some_and(|gauges| gauges.0.every().is_some());
        self.meter = Meter::new(simulation.scene(), has_means, self.trace.is_some());
        let Some(metered) = &past.metered else { return };
        if self.trace.as_ref().is_some_and(|trace| !trace.is_new()) {
            self.meter.work = metered.work();
        }
        if self.gauges.as_ref().is_some_and(|gauges| !gauges.0.is_new()) {
            metered.put_loads(&mut self.meter);
        }
    }

    /// Whether something is added to sums after every step.
    pub(crate) fn are_metered(&self) -> bool {
        self.meter.is_active()
    }

    /// Runs steps of the simulation, and adds them to the sums that the files need.
    pub(crate) fn advance(&mut self, simulation: &mut Simulation, steps: u64, dt: f32) -> rockfall::Result<()> {
        simulation.run_metered(steps, dt, &mut self.meter)
    }

    /// Whether the states of all steps are looked at for events.
    pub(crate) fn are_watched(&self) -> bool {
        self.events.is_some()
    }

    /// Adds the events of the steps since the last call.
    pub(crate) fn add_events(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        self.events.as_mut().map_or(Ok(()), |events| events.add(simulation, past))
    }

    /// Number of steps from `step` until an output is due, at most `most`.
    pub(crate) fn steps_from(&self, step: u64, most: u64) -> u64 {
        self.intervals().map(|every| every - step % every).fold(most, u64::min)
    }

    /// Whether an output is due after `step`.
    pub(crate) fn are_due(&self, step: u64) -> bool {
        self.intervals().any(|every| step.is_multiple_of(every))
    }

    /// The numbers of steps between two outputs of each kind.
    fn intervals(&self) -> impl Iterator<Item = u64> {
        let every = match &self.out {
            Some(Out::Frames(_, _, every)) => Some(*every),
            _ => None,
        };
        let trace = self.trace.as_ref().map(TraceFile::every);
        let gauges = self.gauges.as_ref().and_then(|gauges| gauges.0.every());
        let contacts = self.contacts.as_ref().and_then(ContactsFile::every);
        let tensions = self.tensions.as_ref().and_then(|tensions| tensions.0.every());
        let bodies = self.bodies.as_ref().and_then(|bodies| bodies.0.every());
        let joints = self.joints.as_ref().and_then(|joints| joints.0.every());
        let checkpoint = self.checkpoint.as_ref().and_then(CheckpointFile::every);
        [every, trace, contacts, tensions, gauges, bodies, joints, checkpoint].into_iter().flatten()
    }

    /// Writes the outputs that are due after a step.
    pub(crate) fn after_step(&mut self, simulation: &mut Simulation, past: &mut Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        if let Some(trace) = &mut self.trace {
            trace.after_step(simulation, past, &self.meter, step)?;
        }
        if let Some(Out::Frames(_, writer, every)) = &mut self.out
            && step.is_multiple_of(*every)
        {
            written(writer.frame_at(simulation, step, past.time(step)))?;
        }
        if let Some(file) = &mut self.contacts {
            file.after_step(simulation, past, step)?;
        }
        if let Some(file) = &mut self.tensions {
            file.after_step(simulation, past, step)?;
        }
        if let Some(file) = &mut self.gauges {
            file.after_step(simulation, past, &mut self.meter, step)?;
        }
        if let Some(file) = &mut self.bodies {
            file.after_step(simulation, past, step)?;
        }
        if let Some(file) = &mut self.joints {
            file.after_step(simulation, past, step)?;
        }
        match self.checkpoint.as_ref().and_then(CheckpointFile::every) {
            Some(every) if step.is_multiple_of(every) => self.save(simulation, past),
            _ => Ok(()),
        }
    }

    /// Writes a checkpoint, unless one of this step has been written.
    pub(crate) fn save(&mut self, simulation: &mut Simulation, past: &mut Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        let Some(file) = self.checkpoint.as_mut().filter(|file| file.saved_at() != Some(step)) else { return Ok(()) };
        (past.out, past.every) = match &mut self.out {
            Some(Out::Frames(path, writer, every)) => {
                (Some(PastFile::new(path.clone(), written(writer.mark())?)), Some(*every))
            }
            Some(Out::State(path, _) | Out::LastFrame(path, _)) => (Some(PastFile::new(path.clone(), None)), None),
            None => (None, None),
        };
        (past.trace, past.trace_every, past.traced_collisions, past.traced_energy) = (None, None, None, None);
        if let Some(trace) = &mut self.trace {
            trace.put(past)?;
        }
        past.metered = (self.trace.is_some() || self.gauges.is_some()).then(|| Metered::of(&self.meter));
        if let Some(file) = &mut self.contacts {
            past.contacts = Some(file.as_past()?);
            past.every = past.every.or(file.every());
        } else {
            past.contacts = None;
        }
        past.tensions = self.tensions.as_mut().map(|tensions| tensions.0.as_past()).transpose()?;
        past.every = past.every.or_else(|| self.tensions.as_ref()?.0.every());
        past.gauges = self.gauges.as_mut().map(|gauges| gauges.0.as_past()).transpose()?;
        past.every = past.every.or_else(|| self.gauges.as_ref()?.0.every());
        past.bodies = self.bodies.as_mut().map(|bodies| bodies.0.as_past()).transpose()?;
        past.every = past.every.or_else(|| self.bodies.as_ref()?.0.every());
        past.joints = self.joints.as_mut().map(|joints| joints.0.as_past()).transpose()?;
        past.every = past.every.or_else(|| self.joints.as_ref()?.0.every());
        past.events = self.events.as_mut().map(EventsFile::as_past).transpose()?;
        past.save = self.save.as_ref().map(|(path, _)| Place(path.clone()));
        past.checkpoint_every = file.every();
        past.unwrapped = self.unwrapped;
        let mut checkpoint = simulation.checkpoint()?;
        checkpoint.note = past.to_note(file.path()).map_err(|error| Failure::Run(error.to_string()))?;
        file.save(&checkpoint, step)
    }

    /// Completes every file with the results so far and moves it to its final path. Returns the completed files, or the first
    /// failure; further failures are only printed.
    pub(crate) fn finish(self, simulation: &mut Simulation, past: &Past) -> Result<Vec<PathBuf>, Failure> {
        let mut done = Vec::new();
        let mut first = Ok(());
        let mut note = |path: PathBuf, result: Result<(), Failure>| match result {
            Ok(()) => done.push(path),
            Err(failure) if first.is_ok() => first = Err(failure),
            Err(failure) => drop(output::report(failure)),
        };
        if let Some(file) = self.trace {
            note(file.path().to_owned(), file.finish());
        }
        match self.out {
            Some(Out::State(path, file)) => {
                let result = write_state(&path, file, self.unwrapped, simulation, past);
                note(path, result);
            }
            Some(Out::LastFrame(path, mut writer)) => {
                let step = past.step(simulation.report().steps);
                let result =
                    writer.frame_at(simulation, step, past.time(step)).and_then(|()| writer.finish(simulation.scene()));
                note(path, written(result));
            }
            Some(Out::Frames(path, writer, _)) => note(path, written(writer.finish(simulation.scene()))),
            None => {}
        }
        if let Some(file) = self.contacts {
            note(file.path().to_owned(), file.finish(simulation, past));
        }
        if let Some(file) = self.tensions {
            note(file.0.path().to_owned(), file.finish(simulation, past));
        }
        if let Some(file) = self.gauges {
            note(file.0.path().to_owned(), file.finish(simulation, past));
        }
        if let Some(file) = self.bodies {
            note(file.0.path().to_owned(), file.finish(simulation, past));
        }
        if let Some(file) = self.joints {
            note(file.0.path().to_owned(), file.finish(simulation, past));
        }
        if let Some(file) = self.events {
            note(file.0.path().to_owned(), file.0.commit());
        }
        if let Some((path, file)) = self.save {
            let result = save::write(&path, file, simulation, past);
            note(path, result);
        }
        first.map(|()| done)
    }

    /// What is left of the results if the program ends now, for a message.
    pub(crate) fn left(&self) -> String {
        match self.checkpoint.as_ref().and_then(|file| Some((file.command(), file.saved_at()?))) {
            Some((command, step)) => format!("; continue from step {step} with: {command}"),
            None => "; no results are written".to_owned(),
        }
    }

    /// The command that continues the run, if a checkpoint is written.
    pub(crate) fn command(&self) -> Option<String> {
        self.checkpoint.as_ref().map(|file| file.command().to_owned())
    }
}

impl Out {
    fn open(path: PathBuf, every: Option<u64>, unwrapped: bool, mark: Option<Mark>) -> Result<Self, Failure> {
        let format = Format::of(&path).unwrap_or(Format::Csv);
        if let Some(every) = every {
            let writer = match mark {
                Some(mark) => Writer::resume(&path, format, mark).map_err(|error| lost(&error, "--out"))?,
                None => written(Writer::create(&path, format))?,
            };
            return Ok(Self::Frames(path, writer.unwrapped(unwrapped), every));
        }
        // A single state as .vtp or CSV needs no trajectory writer.
        if format == Format::Npz {
            let writer = written(Writer::create(&path, format))?;
            return Ok(Self::LastFrame(path, writer.unwrapped(unwrapped)));
        }
        let file = AtomicFile::create(&path).map_err(|error| Failure::file(&path, &error))?;
        Ok(Self::State(path, file))
    }
}

fn write_state(
    path: &Path,
    mut file: AtomicFile,
    unwrapped: bool,
    simulation: &mut Simulation,
    past: &Past,
) -> Result<(), Failure> {
    let is_vtp = Format::of(path) == Some(Format::Vtp);
    let mut frame = Frame::of(simulation, is_vtp)?;
    if !unwrapped {
        frame.bring_into_box(simulation.scene());
    }
    frame.step = past.step(frame.step);
    frame.time = past.time(frame.step);
    let write = match is_vtp {
        true => vtp::state(&mut file, &frame, simulation.scene()),
        false => csv::state(&mut file, &frame),
    };
    write.and_then(|()| file.commit()).map_err(|error| Failure::file(path, &error))
}

/// Prints which files hold the results so far.
pub(super) fn note_written(files: &[PathBuf], step: u64) {
    let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
    if !names.is_empty() {
        output::note(&format!("written up to step {step}: {}", names.join(", ")));
    }
}
