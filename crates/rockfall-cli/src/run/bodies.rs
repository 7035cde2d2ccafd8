//! The file of `--bodies`: poses and motions of rigid bodies at the end, or at a fixed interval.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::output::{AtomicFile, Mark};
use rockfall::{Error, Simulation};
use rockfall_trajectory::csv;

use super::errors::lost;
use super::past::{Past, PastFile, whole};
use crate::failure::Failure;

pub(super) struct BodiesFile {
    path: PathBuf,
    file: AtomicFile,
    /// Steps between two states, if there are several.
    every: Option<u64>,
    is_new: bool,
}

impl BodiesFile {
    /// Begins a file with its header, or continues one at a mark.
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        let mark = mark.filter(|_| every.is_some());
        let file = match mark {
            Some(mark) => AtomicFile::resume(&path, mark)
                .map_err(|source| lost(&Error::File { file: path.clone(), source }, "--bodies"))?,
            None => {
                let begin = || {
                    let mut file = AtomicFile::create(&path)?;
                    let prefix = if every.is_some() { "step,time," } else { "" };
                    writeln!(file, "{prefix}{}", csv::BODIES).map(|()| file)
                };
                begin().map_err(|error| Failure::file(&path, &error))?
            }
        };
        Ok(Self { path, file, every, is_new: mark.is_none() })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn every(&self) -> Option<u64> {
        self.every
    }

    /// Adds the state before the first step, if there are several states.
    pub(super) fn begin(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.every.is_some() && self.is_new { self.add(simulation, past) } else { Ok(()) }
    }

    /// Adds the present state if one is due after this step.
    pub(super) fn after_step(&mut self, simulation: &mut Simulation, past: &Past, step: u64) -> Result<(), Failure> {
        match self.every {
            Some(every) if step.is_multiple_of(every) => self.add(simulation, past),
            _ => Ok(()),
        }
    }

    fn add(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        let scene = simulation.sync()?;
        let mut write = || {
            let mut prefix = Vec::new();
            if self.every.is_some() {
                write!(prefix, "{step}")?;
                csv::numbers(&mut prefix, &[past.time(step)])?;
                prefix.push(b',');
            }
            csv::bodies(&mut self.file, &String::from_utf8_lossy(&prefix), scene)
        };
        write().map_err(|error: io::Error| Failure::file(&self.path, &error))
    }

    /// The file as a checkpoint refers to it.
    pub(super) fn as_past(&mut self) -> Result<PastFile, Failure> {
        let mark = match self.every {
            Some(_) => self.file.mark().map_err(|error| Failure::file(&self.path, &error))?,
            None => None,
        };
        Ok(PastFile::new(whole(&self.path), mark))
    }

    pub(super) fn finish(mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.every.is_none() {
            self.add(simulation, past)?;
        }
        self.file.commit().map_err(|error| Failure::file(&self.path, &error))
    }
}
