//! What `run` leaves in a checkpoint beside the simulation, so that a resumed run goes on as the first one was asked to.

use std::path::PathBuf;

use rockfall::output::Mark;
use rockfall::{Energy, Error};
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
    /// Time step in s, before it is divided.
    pub(crate) dt: f32,
    /// Equal parts that a step is divided into; each of them is a step of the simulation.
    pub(crate) substeps: u32,
    /// The step from which on it is divided so, and how many steps the simulation had done then.
    pub(crate) divided_from: [u64; 2],
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
    /// How many whole steps were done when the simulation had done so many.
    pub(crate) fn step(&self, simulated: u64) -> u64 {
        let [step, before] = self.divided_from;
        step + simulated.saturating_sub(before) / u64::from(self.parts())
    }

    /// Parts of a step; a checkpoint of an older program does not tell them.
    pub(crate) fn parts(&self) -> u32 {
        self.substeps.max(1)
    }

    /// The time step of the simulation.
    pub(crate) fn part(&self) -> f32 {
        self.dt / self.parts() as f32
    }

    /// Divides steps otherwise from now on.
    pub(crate) fn divide(&mut self, substeps: u32, simulated: u64) {
        self.divided_from = [self.step(simulated), simulated];
        self.substeps = substeps;
    }

    /// An error of the simulation that names the whole step.
    pub(crate) fn in_steps(&self, error: Error) -> Error {
        match error {
            Error::NonFinite { sphere, step, stage } => Error::NonFinite { sphere, step: self.step(step), stage },
            other => other,
        }
    }

    pub(crate) fn before(&self) -> Energy {
        let mut energy = Energy::default();
        [energy.kinetic, energy.potential, energy.spring, energy.contact] = self.before;
        energy
    }

    pub(crate) fn set_before(&mut self, energy: &Energy) {
        self.before = [energy.kinetic, energy.potential, energy.spring, energy.contact];
    }
}
