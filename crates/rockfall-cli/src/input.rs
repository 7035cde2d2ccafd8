//! What `render` and `view` show: a scene, a checkpoint or a trajectory. The contents of the file decide, not its name.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use rockfall::Checkpoint;
use rockfall_trajectory::Reader;

use crate::failure::Failure;
use crate::options::{Engine, Physics};
use crate::run::{Given, Past};
use crate::source::Source;

/// First bytes of a checkpoint and of a `.npz` archive.
const CHECKPOINT: &[u8] = b"\x89RKF";
const ARCHIVE: &[u8] = b"PK\x03\x04";

/// A file that was opened.
pub(crate) enum Input {
    Scene(Box<Source>),
    Checkpoint(Box<Saved>),
    Trajectory(Box<Reader>),
}

/// A checkpoint with the steps of the run that wrote it.
pub(crate) struct Saved {
    pub(crate) checkpoint: Checkpoint,
    /// Time step, in s, before it is divided.
    pub(crate) dt: f32,
    /// Number of equal parts of a step.
    pub(crate) parts: u32,
}

impl Input {
    /// Opens a file. `None` selects the built-in scene, `-` a scene from standard input.
    pub(crate) fn read(path: Option<&Path>) -> Result<Self, Failure> {
        let Some(path) = path else {
            return Self::scene(None);
        };
        match Kind::of(path) {
            Kind::Checkpoint => Saved::read(path).map(|saved| Self::Checkpoint(Box::new(saved))),
            Kind::Trajectory => Reader::open(path).map(|reader| Self::Trajectory(Box::new(reader))).map_err(Failure::usage),
            Kind::State(what) => Err(Failure::usage(format!(
                "{}: {what} cannot be shown; expected a scene, a checkpoint, or a trajectory as \
                 `run --every K --out NAME.npz` or `NAME.pvd` writes it",
                path.display()
            ))),
            Kind::Scene => Self::scene(Some(path)),
        }
    }
}

impl Input {
    fn scene(path: Option<&Path>) -> Result<Self, Failure> {
        Source::read(path).map(|source| Self::Scene(Box::new(source)))
    }
}

enum Kind {
    Scene,
    Checkpoint,
    Trajectory,
    /// A file of rockfall that has not all that a picture needs.
    State(&'static str),
}

impl Kind {
    fn of(path: &Path) -> Self {
        let mut start = Vec::new();
        // Only regular files, because a pipe can be read only once.
        let regular = path != Path::new("-") && path.is_file();
        if let Some(file) = regular.then(|| File::open(path).ok()).flatten() {
            // A file that cannot be read is reported when it is opened as what its name says.
            let _ = file.take(512).read_to_end(&mut start);
        }
        let has = |text: &str| start.windows(text.len()).any(|window| window == text.as_bytes());
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            _ if start.starts_with(CHECKPOINT) => Self::Checkpoint,
            _ if start.starts_with(ARCHIVE) => Self::Trajectory,
            _ if has("<VTKFile type=\"Collection\"") => Self::Trajectory,
            _ if has("<VTKFile") => Self::State("a single .vtp file"),
            _ if start.starts_with(b"sphere,x,y,z,") => Self::State("a state in CSV"),
            _ if start.starts_with(b"step,time,sphere,x,y,z,") => Self::State("a trajectory in CSV"),
            // Damaged files are reported as what they should be.
            Some("ckpt") => Self::Checkpoint,
            Some("npz" | "pvd") => Self::Trajectory,
            _ => Self::Scene,
        }
    }
}

impl Given<'_> {
    /// Returns an error if an option was given that has no effect on a trajectory.
    pub(crate) fn refuse_for_trajectory(&self, name: &str) -> Result<(), Failure> {
        match ["dt", "integrator", "set", "broad_phase", "substeps"].into_iter().find(|id| self.has(id)) {
            Some(id) => {
                Err(Failure::usage(format!("--{}: {name} is a trajectory, which is not simulated again", id.replace('_', "-"))))
            }
            None => Ok(()),
        }
    }
}

impl Saved {
    fn read(path: &Path) -> Result<Self, Failure> {
        let checkpoint = Checkpoint::load(path).map_err(Failure::usage)?;
        // A checkpoint of another program has no such note, and its steps are not divided.
        let past: Past = Past::of_note(&checkpoint.note, path).unwrap_or_default();
        let dt = if past.dt > 0.0 { past.dt } else { checkpoint.time_step };
        Ok(Self { parts: past.parts(), dt, checkpoint })
    }

    /// Applies the options of the command line. Returns the time step, its number of parts, and the checkpoint.
    pub(crate) fn changed(self, given: &Given, physics: &Physics, engine: &Engine) -> Result<(f32, u32, Checkpoint), Failure> {
        let Self { mut checkpoint, dt, parts } = self;
        let dt = physics.dt_or(dt);
        let wanted = engine.options(physics);
        if given.has("integrator") {
            checkpoint.options.integrator = wanted.integrator;
        }
        if given.has("backend") {
            checkpoint.options.backend = wanted.backend;
        }
        if given.has("broad_phase") {
            checkpoint.options.broad_phase = wanted.broad_phase;
        }
        if !physics.set.is_empty() {
            physics.change(&mut checkpoint.scene.settings)?;
            // A resumed simulation uses its constants as stored, so `resting_overlap` has to be resolved here.
            checkpoint.scene.settings = checkpoint.scene.with_grains().resolved_settings();
        }
        checkpoint.time_step = dt / parts as f32;
        Ok((dt, parts, checkpoint))
    }
}
