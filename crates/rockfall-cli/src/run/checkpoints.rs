//! The file of `--checkpoint`, written at the end of a run and at a fixed interval.

use std::path::{Path, PathBuf};

use rockfall::Checkpoint;
use rockfall::output::AtomicFile;

use super::errors::written;
use super::place::{folder_of, is_below};
use super::wanted::Wanted;
use crate::failure::Failure;

pub(super) struct CheckpointFile {
    path: PathBuf,
    /// Steps between two checkpoints, if there are several.
    every: Option<u64>,
    /// The file of the next checkpoint. It is open, and so locked, during the whole run: two runs cannot write the same checkpoint.
    next: Option<AtomicFile>,
    /// The step of the last checkpoint.
    saved_at: Option<u64>,
    /// The command that continues the run.
    command: String,
}

impl CheckpointFile {
    /// Opens the file, if a run is asked for it.
    pub(super) fn of(wanted: &Wanted) -> Result<Option<Self>, Failure> {
        let Some(path) = wanted.checkpoint.clone() else { return Ok(None) };
        let is_outside = wanted.files().any(|file| !is_below(file, folder_of(&path)));
        let recorded = if is_outside { " --outputs-as-recorded" } else { "" };
        let command = format!("rockfall run --resume {}{recorded}", path.display());
        let mut file = Self { path, every: wanted.checkpoint_every, next: None, saved_at: None, command };
        file.next = Some(file.open()?);
        Ok(Some(file))
    }

    fn open(&self) -> Result<AtomicFile, Failure> {
        AtomicFile::create(&self.path).map_err(|error| Failure::file(&self.path, &error))
    }

    /// Replaces the last checkpoint by that of a step, once it has been read back.
    pub(super) fn save(&mut self, checkpoint: &Checkpoint, step: u64) -> Result<(), Failure> {
        let file = self.next.take().map_or_else(|| self.open(), Ok)?;
        written(checkpoint.save_to(file))?;
        self.saved_at = Some(step);
        self.next = Some(self.open()?);
        Ok(())
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn every(&self) -> Option<u64> {
        self.every
    }

    pub(super) fn saved_at(&self) -> Option<u64> {
        self.saved_at
    }

    pub(super) fn command(&self) -> &str {
        &self.command
    }
}
