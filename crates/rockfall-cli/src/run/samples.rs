//! A file of samples: one of the final state, or several at a fixed interval.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::Error;
use rockfall::output::{AtomicFile, Mark};

use super::errors::lost;
use super::past::PastFile;
use crate::failure::Failure;

pub(super) struct Samples {
    path: PathBuf,
    file: AtomicFile,
    /// Steps between two samples, if there are several.
    every: Option<u64>,
    is_new: bool,
}

impl Samples {
    /// Begins the file of an option with its header, or continues one at a mark.
    pub(super) fn open(
        option: &str,
        header: &str,
        path: PathBuf,
        every: Option<u64>,
        mark: Option<Mark>,
    ) -> Result<Self, Failure> {
        let mark = mark.filter(|_| every.is_some());
        let file = match mark {
            Some(mark) => {
                AtomicFile::resume(&path, mark).map_err(|source| lost(&Error::File { file: path.clone(), source }, option))?
            }
            None => {
                let begin = || {
                    let mut file = AtomicFile::create(&path)?;
                    writeln!(file, "{header}").map(|()| file)
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

    /// Whether the file was begun, and not continued.
    pub(super) fn is_new(&self) -> bool {
        self.is_new
    }

    /// Whether the state before the first step is a sample.
    pub(super) fn has_start(&self) -> bool {
        self.every.is_some() && self.is_new
    }

    /// Whether the state after this step is a sample.
    pub(super) fn is_due(&self, step: u64) -> bool {
        self.every.is_some_and(|every| step.is_multiple_of(every))
    }

    /// Whether the final state is the only sample.
    pub(super) fn has_end(&self) -> bool {
        self.every.is_none()
    }

    /// Adds a sample.
    pub(super) fn add(&mut self, write: impl FnOnce(&mut AtomicFile) -> io::Result<()>) -> Result<(), Failure> {
        write(&mut self.file).map_err(|error| Failure::file(&self.path, &error))
    }

    /// The file as a checkpoint refers to it.
    pub(super) fn as_past(&mut self) -> Result<PastFile, Failure> {
        let mark = match self.every {
            Some(_) => self.file.mark().map_err(|error| Failure::file(&self.path, &error))?,
            None => None,
        };
        Ok(PastFile::new(self.path.clone(), mark))
    }

    pub(super) fn commit(self) -> Result<(), Failure> {
        self.file.commit().map_err(|error| Failure::file(&self.path, &error))
    }
}
