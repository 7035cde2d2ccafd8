//! Data that `run` stores in a checkpoint in addition to the simulation, so that a resumed run continues with the same options.

use std::path::{Path, PathBuf};

use rockfall::glam::DVec3;
use rockfall::output::Mark;
use rockfall::{Energy, Error, Meter, Report, decimal_time};
use serde::{Deserialize, Serialize};

use super::place::{Place, folder_of, whole};

/// Options and progress of a run. Stored as JSON in the note of a checkpoint.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Past {
    /// Name of the scene.
    pub(crate) scene: String,
    /// Number of lines of the scene that are comments.
    pub(crate) comments: usize,
    /// The comment at the beginning of the scene, without `#`.
    pub(crate) title: Vec<String>,
    /// Total number of steps requested.
    pub(crate) steps: u64,
    /// Wall time of the steps so far, in s.
    pub(crate) seconds: f64,
    /// Kinetic, potential, spring and contact energy at the start.
    pub(crate) before: [f64; 4],
    /// Whether constants were changed since the start, or rods jumped to their length in the first step, so that energies cannot
    /// be compared with `before`.
    pub(crate) changed: bool,
    pub(crate) out: Option<PastFile>,
    /// Steps between two frames of `out`.
    pub(crate) every: Option<u64>,
    /// Whether spheres of periodic scenes are written where they have got to.
    pub(crate) unwrapped: bool,
    pub(crate) trace: Option<PastFile>,
    /// Steps between two lines of `trace`; every step if missing.
    pub(crate) trace_every: Option<u64>,
    /// Total number of collisions up to the last line of `trace`. Checkpoints of older versions do not contain it.
    pub(crate) traced_collisions: Option<u64>,
    pub(crate) contacts: Option<PastFile>,
    pub(crate) tensions: Option<PastFile>,
    pub(crate) gauges: Option<PastFile>,
    pub(crate) bodies: Option<PastFile>,
    pub(crate) joints: Option<PastFile>,
    pub(crate) events: Option<PastFile>,
    /// Bits of the total energy at the first line of `trace`.
    pub(crate) traced_energy: Option<u64>,
    pub(crate) metered: Option<Metered>,
    /// Scene file that is written at the end.
    pub(crate) save: Option<Place>,
    pub(crate) checkpoint_every: Option<u64>,
    /// Time step in s, before it is divided.
    pub(crate) dt: f32,
    /// Number of equal parts of a step. Each part is one step of the simulation.
    pub(crate) substeps: u32,
    /// First step with this number of parts, and the number of simulation steps done before it.
    pub(crate) divided_from: [u64; 2],
    /// First step with this time step, and the time at which it began, in s.
    pub(crate) timed_from: (u64, f64),
}

/// An output file and how far it was written.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PastFile {
    pub(crate) path: Place,
    bytes: Option<u64>,
    crc32: u32,
}

/// The sums of a [`Meter`], as the bits of their numbers.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Metered {
    work: u64,
    steps: u64,
    /// Force and torque of every gauge.
    loads: Vec<[u64; 6]>,
}

impl Metered {
    pub(super) fn of(meter: &Meter) -> Self {
        let bits = |[force, torque]: &[DVec3; 2]| {
            let [x, y, z] = force.to_array();
            let [u, v, w] = torque.to_array();
            [x, y, z, u, v, w].map(f64::to_bits)
        };
        Self { work: meter.work.to_bits(), steps: meter.steps, loads: meter.loads.iter().map(bits).collect() }
    }

    pub(super) fn work(&self) -> f64 {
        f64::from_bits(self.work)
    }

    /// Gives a meter the sums of loads, if it has as many gauges.
    pub(super) fn put_loads(&self, meter: &mut Meter) {
        if self.loads.len() == meter.loads.len() {
            meter.steps = self.steps;
            for (sums, bits) in meter.loads.iter_mut().zip(&self.loads) {
                let numbers = bits.map(f64::from_bits);
                *sums = [DVec3::from_slice(&numbers), DVec3::from_slice(&numbers[3..])];
            }
        }
    }
}

impl PastFile {
    pub(crate) fn new(path: PathBuf, mark: Option<Mark>) -> Self {
        Self { path: Place(path), bytes: mark.map(|mark| mark.bytes), crc32: mark.map_or(0, |mark| mark.crc32) }
    }

    /// Whether this is the file of a path.
    pub(super) fn is_at(&self, path: &Path) -> bool {
        whole(&self.path.0) == whole(path)
    }

    /// `None` for a file that is not regular, and for a file that is written only at the end.
    pub(crate) fn mark(&self) -> Option<Mark> {
        self.bytes.map(|bytes| Mark { bytes, crc32: self.crc32 })
    }
}

impl Past {
    /// Reads the note of a checkpoint that `run` wrote.
    pub(crate) fn of_note(note: &str, checkpoint: &Path) -> Option<Self> {
        let mut past: Self = serde_json::from_str(note).ok()?;
        past.places().for_each(|place| *place = place.found_in(folder_of(checkpoint)));
        Some(past)
    }

    /// The note of a checkpoint.
    pub(super) fn to_note(&self, checkpoint: &Path) -> serde_json::Result<String> {
        let mut past = self.clone();
        past.places().for_each(|place| *place = place.stored_in(folder_of(checkpoint)));
        serde_json::to_string(&past)
    }

    /// The paths of all output files.
    fn places(&mut self) -> impl Iterator<Item = &mut Place> {
        let Self { out, trace, contacts, tensions, gauges, bodies, joints, events, save, .. } = self;
        let files = [out, trace, contacts, tensions, gauges, bodies, joints, events].into_iter().flatten();
        files.map(|file| &mut file.path).chain(save)
    }

    /// The past of a checkpoint that `run` did not write: a run of whole steps without files, whose start is the checkpoint.
    pub(crate) fn without_note(path: &Path, report: &Report) -> Self {
        Self { scene: path.display().to_string(), timed_from: (report.steps, report.time), ..Self::default() }
    }

    /// Number of whole steps done after `simulated` steps of the simulation.
    pub(crate) fn step(&self, simulated: u64) -> u64 {
        let [step, before] = self.divided_from;
        step + simulated.saturating_sub(before) / u64::from(self.parts())
    }

    /// Time at the end of a step, in s.
    pub(crate) fn time(&self, step: u64) -> f64 {
        let (first, start) = self.timed_from;
        decimal_time(start, step.saturating_sub(first), self.dt)
    }

    /// Changes the time step from a step on.
    pub(crate) fn set_time_step(&mut self, step: u64, dt: f32) {
        self.timed_from = (step, self.time(step));
        self.dt = dt;
    }

    /// Number of parts of a step. Checkpoints of older versions do not contain it, which means 1.
    pub(crate) fn parts(&self) -> u32 {
        self.substeps.max(1)
    }

    /// Time step of the simulation, in s: the length of one part.
    pub(crate) fn part(&self) -> f32 {
        self.dt / self.parts() as f32
    }

    /// Changes the number of parts from the present step on.
    pub(crate) fn divide(&mut self, substeps: u32, simulated: u64) {
        self.divided_from = [self.step(simulated), simulated];
        self.substeps = substeps;
    }

    /// Converts the step number in an error of the simulation to whole steps.
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
