//! The file of `--contacts`: the contacts of the final state, or of a state at a fixed interval.

use std::path::{Path, PathBuf};

use rockfall::Simulation;
use rockfall::output::{AtomicFile, Mark};
use rockfall_trajectory::Format;
use rockfall_trajectory::contacts::{Contacts, Writer, lines};

use super::errors::{lost, written};
use super::past::{Past, PastFile};
use crate::failure::Failure;

pub(super) enum ContactsFile {
    /// The contacts at the end, as a single `.vtp` file.
    Lines(PathBuf, AtomicFile),
    /// The contacts at the end, as a series of one frame.
    Last(PathBuf, Writer),
    /// A frame at a fixed interval, in steps.
    Frames(PathBuf, Writer, u64),
}

impl ContactsFile {
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        let format = Format::of(&path).unwrap_or(Format::Csv);
        match (every, mark) {
            (Some(every), Some(mark)) => {
                let writer = Writer::resume(&path, format, mark).map_err(|error| lost(&error, "--contacts"))?;
                Ok(Self::Frames(path, writer, every))
            }
            (Some(every), None) => Ok(Self::Frames(path.clone(), written(Writer::create(path, format))?, every)),
            (None, _) if format == Format::Vtp => {
                let file = AtomicFile::create(&path).map_err(|error| Failure::file(&path, &error))?;
                Ok(Self::Lines(path, file))
            }
            (None, _) => Ok(Self::Last(path.clone(), written(Writer::create(path, format))?)),
        }
    }

    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Lines(path, _) | Self::Last(path, _) | Self::Frames(path, ..) => path,
        }
    }

    /// Steps between two frames, if there are several.
    pub(super) fn every(&self) -> Option<u64> {
        match self {
            Self::Frames(_, _, every) => Some(*every),
            _ => None,
        }
    }

    /// Adds a frame if one is due after this step.
    pub(super) fn after_step(&mut self, simulation: &mut Simulation, past: &Past, step: u64) -> Result<(), Failure> {
        match self {
            Self::Frames(_, writer, every) if step.is_multiple_of(*every) => {
                written(contacts(simulation, past).and_then(|contacts| writer.frame(&contacts)))
            }
            _ => Ok(()),
        }
    }

    /// The file as a checkpoint refers to it.
    pub(super) fn as_past(&mut self) -> Result<PastFile, Failure> {
        let mark = match self {
            Self::Frames(_, writer, _) => written(writer.mark())?,
            _ => None,
        };
        Ok(PastFile::new(self.path().to_owned(), mark))
    }

    pub(super) fn finish(self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        match self {
            Self::Frames(_, writer, _) => written(writer.finish()),
            Self::Last(_, mut writer) => {
                written(contacts(simulation, past).and_then(|contacts| writer.frame(&contacts)).and_then(|()| writer.finish()))
            }
            Self::Lines(path, mut file) => {
                let contacts = contacts(simulation, past)?;
                lines(&mut file, &contacts).and_then(|()| file.commit()).map_err(|error| Failure::file(&path, &error))
            }
        }
    }
}

/// The contacts of the present state, at a whole step.
fn contacts(simulation: &mut Simulation, past: &Past) -> rockfall::Result<Contacts> {
    let step = past.step(simulation.report().steps);
    let mut contacts = Contacts::of(simulation)?;
    (contacts.step, contacts.time) = (step, past.time(step));
    Ok(contacts)
}
