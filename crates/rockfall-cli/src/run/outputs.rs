//! Files that a run writes: the final state or a trajectory, the trace, and checkpoints that refer to both.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::output::{AtomicFile, Mark};
use rockfall::{Error, Report, Scene, Simulation};
use rockfall_trajectory::csv::{self, numbers};
use rockfall_trajectory::{Format, Frame, Writer, vtp};

use super::contacts::ContactsFile;
use super::errors::{lost, written};
use super::past::{Past, PastFile, whole};
use super::save;
use super::tensions::TensionsFile;
use crate::failure::Failure;
use crate::output;

const TRACE_HEADER: &str = "step,time,kinetic,potential,spring,contact,momentum_x,momentum_y,momentum_z,\
                            angular_x,angular_y,angular_z,max_overlap,contacts,collisions";

/// Output files requested by the command line or by the run that is resumed.
#[derive(Debug, Default)]
pub(crate) struct Wanted {
    pub(crate) out: Option<PathBuf>,
    pub(crate) every: Option<u64>,
    pub(crate) trace: Option<PathBuf>,
    pub(crate) trace_every: Option<u64>,
    pub(crate) contacts: Option<PathBuf>,
    pub(crate) tensions: Option<PathBuf>,
    pub(crate) save: Option<PathBuf>,
    pub(crate) checkpoint: Option<PathBuf>,
    pub(crate) checkpoint_every: Option<u64>,
}

impl Wanted {
    /// Returns an error if the options contradict each other.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let list = |path: &PathBuf| match Format::of(path) {
            Some(Format::Vtp) if self.every.is_some() => path.with_extension("pvd"),
            _ => path.clone(),
        };
        let [out, contacts] = [&self.out, &self.contacts].map(|path| path.as_ref().map(list));
        let names = [
            ("--out", &out),
            ("--contacts", &contacts),
            ("--tensions", &self.tensions),
            ("--trace", &self.trace),
            ("--save", &self.save),
            ("--checkpoint", &self.checkpoint),
        ];
        let names = names.map(|(name, path)| (name, path.as_deref().map(whole)));
        for (place, (one, path)) in names.iter().enumerate() {
            if let Some((other, _)) = names[..place].iter().find(|(_, other)| path.is_some() && other == path) {
                return Err(Failure::usage(format!("{other} and {one} name the same file")));
            }
        }
        if self.every.is_some() && [&self.out, &self.contacts, &self.tensions].into_iter().all(Option::is_none) {
            let message = "--every needs a file to write to: expected --out FILE, --contacts FILE or --tensions FILE";
            return Err(Failure::usage(message));
        }
        if self.trace_every.is_some() && self.trace.is_none() {
            return Err(Failure::usage("--trace-every needs a file to write to: expected --trace FILE"));
        }
        if self.checkpoint_every.is_some() && self.checkpoint.is_none() {
            return Err(Failure::usage("--checkpoint-every needs a file to write to: expected --checkpoint FILE"));
        }
        for (option, path) in [("--out", &self.out), ("--contacts", &self.contacts)] {
            let pvd = |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pvd"));
            if self.every.is_none() && path.as_ref().is_some_and(pvd) {
                return Err(Failure::usage(format!("{option}: a .pvd file holds a series of states, expected --every K")));
            }
        }
        Ok(())
    }
}

impl Wanted {
    /// Returns an error if a file cannot hold what happens in the scene.
    pub(super) fn check_for(&self, scene: &Scene) -> Result<(), Failure> {
        let changes = !(scene.inlets().is_empty() && scene.outlets().is_empty());
        match &self.out {
            Some(path) if changes && self.every.is_some() && Format::of(path) == Some(Format::Npz) => {
                Err(Failure::usage(format!(
                    "--out {}: the number of spheres changes in a scene with inlets or outlets, but an .npz file has equally many in \
                     all frames; expected .csv or .pvd",
                    path.display()
                )))
            }
            _ => Ok(()),
        }
    }
}

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
    trace: Option<(PathBuf, AtomicFile)>,
    /// Steps between two lines of the trace; every step if it is not given.
    trace_every: Option<u64>,
    contacts: Option<ContactsFile>,
    tensions: Option<TensionsFile>,
    save: Option<(PathBuf, AtomicFile)>,
    checkpoint: Option<PathBuf>,
    checkpoint_every: Option<u64>,
    /// Whether the trace, the trajectory, the contacts and the tensions are new, and need their first line and frame.
    is_new: [bool; 4],
    /// The step of the last checkpoint.
    saved_at: Option<u64>,
    /// Total number of collisions up to the last line of the trace, once it is known.
    collisions: Option<u64>,
}

impl Outputs {
    /// Opens the files. A file that the earlier run `past` had begun is continued.
    pub(crate) fn open(wanted: Wanted, past: Option<&Past>) -> Result<Self, Failure> {
        let Wanted { out, every, trace, trace_every, contacts, tensions, save, checkpoint, checkpoint_every } = wanted;
        let marked = |path: &Path, past: Option<&PastFile>| -> Option<Mark> {
            past.filter(|past| past.path == whole(path)).and_then(PastFile::mark)
        };
        let out_mark = out.as_deref().and_then(|path| marked(path, past.and_then(|past| past.out.as_ref())));
        let contacts_mark = contacts.as_deref().and_then(|path| marked(path, past.and_then(|past| past.contacts.as_ref())));
        let tensions_mark = tensions.as_deref().and_then(|path| marked(path, past.and_then(|past| past.tensions.as_ref())));
        let continues = out_mark.is_some() || contacts_mark.is_some() || tensions_mark.is_some();
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
        let collisions = past.and_then(|past| past.traced_collisions).filter(|_| trace_mark.is_some());
        let trace = trace.map(|path| open_trace(&path, trace_mark).map(|file| (path, file))).transpose()?;
        if let Some(path) = &checkpoint {
            // Only tests that the path is writable: every checkpoint is written as a new file.
            AtomicFile::create(path).map_err(|error| Failure::file(path, &error))?.discard();
        }
        Ok(Self {
            out: out.map(|path| Out::open(path, every, out_mark)).transpose()?,
            trace,
            trace_every,
            contacts: contacts.map(|path| ContactsFile::open(path, every, contacts_mark)).transpose()?,
            tensions: tensions.map(|path| TensionsFile::open(path, every, tensions_mark)).transpose()?,
            save: save.map(|path| save::open(&path).map(|file| (path, file))).transpose()?,
            checkpoint,
            checkpoint_every,
            is_new: [trace_mark.is_none(), out_mark.is_none(), contacts_mark.is_none(), tensions_mark.is_none()],
            saved_at: None,
            collisions,
        })
    }

    /// Writes the header of a new trace, and the state before the first step to a new trace and trajectory.
    pub(crate) fn begin(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        self.collisions.get_or_insert(simulation.report().total_collisions);
        let [trace, frames, contacts, tensions] = self.is_new;
        if let Some((path, file)) = self.trace.as_mut().filter(|_| trace) {
            writeln!(file, "{TRACE_HEADER}").map_err(|error| Failure::file(path, &error))?;
            self.trace(simulation, past)?;
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

    /// Number of steps from `step` until an output is due, at most `most`.
    pub(crate) fn steps_from(&self, step: u64, most: u64) -> u64 {
        let every = match &self.out {
            Some(Out::Frames(_, _, every)) => Some(*every),
            _ => None,
        };
        let trace = self.trace.as_ref().map(|_| self.trace_every.unwrap_or(1));
        let until = |every: u64| every - step % every;
        let contacts = self.contacts.as_ref().and_then(ContactsFile::every);
        let tensions = self.tensions.as_ref().and_then(TensionsFile::every);
        [every, trace, contacts, tensions, self.checkpoint_every].into_iter().flatten().map(until).fold(most, u64::min)
    }

    /// Writes the outputs that are due after a step.
    pub(crate) fn after_step(&mut self, simulation: &mut Simulation, past: &mut Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        if step.is_multiple_of(self.trace_every.unwrap_or(1)) {
            self.trace(simulation, past)?;
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
        match self.checkpoint_every {
            Some(every) if step.is_multiple_of(every) => self.save(simulation, past),
            _ => Ok(()),
        }
    }

    /// Writes the line of the current state to the trace.
    fn trace(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        let Some((path, file)) = &mut self.trace else { return Ok(()) };
        let energy = simulation.energy()?;
        let report: Report = simulation.report();
        let before = self.collisions.replace(report.total_collisions).unwrap_or_default();
        let collisions = report.total_collisions.saturating_sub(before);
        let mut write = || {
            let step = past.step(report.steps);
            write!(file, "{step}")?;
            let energies = [energy.kinetic, energy.potential, energy.spring, energy.contact];
            numbers(file, &[past.time(step)])?;
            // Adding 0 turns -0, the value of an empty sum, into 0.
            numbers(file, &energies.map(|energy| energy + 0.0))?;
            numbers(file, &(energy.momentum + 0.0).to_array())?;
            numbers(file, &(energy.angular_momentum + 0.0).to_array())?;
            numbers(file, &[report.max_overlap])?;
            writeln!(file, ",{},{collisions}", report.contacts)
        };
        write().map_err(|error: io::Error| Failure::file(path, &error))
    }

    /// Writes a checkpoint, unless one of this step has been written.
    pub(crate) fn save(&mut self, simulation: &mut Simulation, past: &mut Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        let Some(path) = self.checkpoint.clone().filter(|_| self.saved_at != Some(step)) else { return Ok(()) };
        (past.out, past.every) = match &mut self.out {
            Some(Out::Frames(path, writer, every)) => (Some(PastFile::new(whole(path), written(writer.mark())?)), Some(*every)),
            Some(Out::State(path, _) | Out::LastFrame(path, _)) => (Some(PastFile::new(whole(path), None)), None),
            None => (None, None),
        };
        past.trace = match &mut self.trace {
            Some((path, file)) => {
                let mark = file.mark().map_err(|error| Failure::file(path, &error))?;
                Some(PastFile::new(whole(path), mark))
            }
            None => None,
        };
        (past.trace_every, past.traced_collisions) = (self.trace_every, self.collisions);
        if let Some(file) = &mut self.contacts {
            past.contacts = Some(file.as_past()?);
            past.every = past.every.or(file.every());
        } else {
            past.contacts = None;
        }
        past.tensions = self.tensions.as_mut().map(TensionsFile::as_past).transpose()?;
        past.every = past.every.or_else(|| self.tensions.as_ref()?.every());
        past.save = self.save.as_ref().map(|(path, _)| whole(path));
        past.checkpoint_every = self.checkpoint_every;
        let mut checkpoint = simulation.checkpoint()?;
        checkpoint.note = serde_json::to_string(past).map_err(|error| Failure::Run(error.to_string()))?;
        written(checkpoint.save(&path))?;
        self.saved_at = Some(step);
        Ok(())
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
        if let Some((path, file)) = self.trace {
            let result = file.commit().map_err(|error| Failure::file(&path, &error));
            note(path, result);
        }
        match self.out {
            Some(Out::State(path, file)) => {
                let result = write_state(&path, file, simulation, past);
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
            note(file.path().to_owned(), file.finish(simulation, past));
        }
        if let Some((path, file)) = self.save {
            let result = save::write(&path, file, simulation, past);
            note(path, result);
        }
        first.map(|()| done)
    }

    /// What is left of the results if the program ends now, for a message.
    pub(crate) fn left(&self) -> String {
        match (&self.checkpoint, self.saved_at) {
            (Some(path), Some(step)) => {
                format!("; continue from step {step} with: rockfall run --resume {}", path.display())
            }
            _ => "; no results are written".to_owned(),
        }
    }

    /// Path of the checkpoint, if one is written.
    pub(crate) fn checkpoint(&self) -> Option<&Path> {
        self.checkpoint.as_deref()
    }
}

impl Out {
    fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        let format = Format::of(&path).unwrap_or(Format::Csv);
        if let Some(every) = every {
            let writer = match mark {
                Some(mark) => Writer::resume(&path, format, mark).map_err(|error| lost(&error, "--out"))?,
                None => written(Writer::create(&path, format))?,
            };
            return Ok(Self::Frames(path, writer, every));
        }
        // A single state as .vtp or CSV needs no trajectory writer.
        if format == Format::Npz {
            let writer = written(Writer::create(&path, format))?;
            return Ok(Self::LastFrame(path, writer));
        }
        let file = AtomicFile::create(&path).map_err(|error| Failure::file(&path, &error))?;
        Ok(Self::State(path, file))
    }
}

fn write_state(path: &Path, mut file: AtomicFile, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
    let is_vtp = Format::of(path) == Some(Format::Vtp);
    let mut frame = Frame::of(simulation, is_vtp)?;
    frame.step = past.step(frame.step);
    frame.time = past.time(frame.step);
    let write = match is_vtp {
        true => vtp::state(&mut file, &frame, simulation.scene()),
        false => csv::state(&mut file, &frame),
    };
    write.and_then(|()| file.commit()).map_err(|error| Failure::file(path, &error))
}

fn open_trace(path: &Path, mark: Option<Mark>) -> Result<AtomicFile, Failure> {
    match mark {
        Some(mark) => {
            AtomicFile::resume(path, mark).map_err(|source| lost(&Error::File { file: path.to_owned(), source }, "--trace"))
        }
        None => AtomicFile::create(path).map_err(|error| Failure::file(path, &error)),
    }
}

/// Prints which files hold the results so far.
pub(super) fn note_written(files: &[PathBuf], step: u64) {
    let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
    if !names.is_empty() {
        output::note(&format!("written up to step {step}: {}", names.join(", ")));
    }
}
