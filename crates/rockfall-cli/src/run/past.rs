//! What `run` leaves in a checkpoint beside the simulation, so that a resumed run goes on as the first one was asked to.

use std::path::PathBuf;

use rockfall::Energy;
use rockfall::output::Mark;
use serde::{Deserialize, Serialize};

/// The note of a checkpoint, as JSON.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Past {
    /// The scene's name.
    pub(crate) scene: String,
    /// Steps in all that were asked for.
    pub(crate) steps: u64,
    /// Wall time of the steps up to now, in s.
    pub(crate) seconds: f64,
    /// Kinetic, potential, spring and contact energy at the start.
    pub(crate) before: [f64; 4],
    pub(crate) out: Option<PastFile>,
    /// Steps between two frames of `out`.
    pub(crate) every: Option<u64>,
    pub(crate) trace: Option<PastFile>,
    pub(crate) checkpoint_every: Option<u64>,
}

/// An output, and how far it was written.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PastFile {
    /// The whole path, so that the folder in which the run is resumed makes no difference.
    pub(crate) path: PathBuf,
    bytes: Option<u64>,
    crc32: u32,
}

impl PastFile {
    pub(crate) fn new(path: PathBuf, mark: Option<Mark>) -> Self {
        Self { path, bytes: mark.map(|mark| mark.bytes), crc32: mark.map_or(0, |mark| mark.crc32) }
    }

    /// `None` for what is no regular file, and for what is written at the end only.
    pub(crate) fn mark(&self) -> Option<Mark> {
        self.bytes.map(|bytes| Mark { bytes, crc32: self.crc32 })
    }
}

impl Past {
    pub(crate) fn before(&self) -> Energy {
        let mut energy = Energy::default();
        [energy.kinetic, energy.potential, energy.spring, energy.contact] = self.before;
        energy
    }

    pub(crate) fn set_before(&mut self, energy: &Energy) {
        self.before = [energy.kinetic, energy.potential, energy.spring, energy.contact];
    }
}
