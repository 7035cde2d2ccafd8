//! Trajectories: the states of a [`Simulation`] over time, as files for other tools.
//!
//! ```no_run
//! use rockfall::{Scene, Simulation};
//! use rockfall_trajectory::{Format, Writer};
//!
//! # fn main() -> rockfall::Result<()> {
//! let mut simulation = Simulation::new(Scene::load("scenes/bridge.txt")?.scene)?;
//! let mut writer = Writer::create("bridge.npz", Format::Npz)?;
//! for _ in 0..100 {
//!     simulation.run(10, 0.02)?;
//!     writer.frame(&mut simulation)?;
//! }
//! writer.finish(simulation.scene())
//! # }
//! ```
//!
//! | format | files | holds |
//! |---|---|---|
//! | [`Format::Csv`] | one text file | a line a sphere and frame; see [`csv`] |
//! | [`Format::Npz`] | one archive of arrays for NumPy | see [`npz`] |
//! | [`Format::Vtp`] | `NAME.pvd` and a folder `NAME` of frames, for ParaView and VTK | see [`vtp`] |
//!
//! Frames are written as they come; none is held in memory. All numbers are those of the simulation, bit for bit. A file
//! appears under its name complete or not at all; a [`Mark`] taken on the way lets a later program go on with it.

use std::io;
use std::path::{Path, PathBuf};

use rockfall::output::Mark;
use rockfall::{Error, Result, Scene, Simulation};

pub mod csv;
mod frame;
pub mod npz;
pub mod vtp;

pub use frame::Frame;

/// What kind of file a trajectory is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Comma-separated values.
    Csv,
    /// Arrays for NumPy.
    Npz,
    /// A series for ParaView.
    Vtp,
}

impl Format {
    /// The format that a file's name asks for by its extension: `npz`, `vtp` and `pvd`, else comma-separated values.
    pub fn of(path: &Path) -> Self {
        match path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("npz") => Self::Npz,
            Some("vtp" | "pvd") => Self::Vtp,
            _ => Self::Csv,
        }
    }
}

#[derive(Debug)]
enum File {
    Csv(csv::Series),
    Npz(Box<npz::Series>),
    Vtp(vtp::Series),
}

/// A trajectory that is being written.
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    file: File,
}

impl Writer {
    /// Begins a trajectory. A path that cannot be written to shows here.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn create(path: impl AsRef<Path>, format: Format) -> Result<Self> {
        let path = path.as_ref();
        let file = match format {
            Format::Csv => csv::Series::create(path).map(File::Csv),
            Format::Npz => npz::Series::create(path).map(|series| File::Npz(Box::new(series))),
            Format::Vtp => vtp::Series::create(path).map(File::Vtp),
        };
        named(path, file).map(|file| Self { path: path.to_owned(), file })
    }

    /// Goes on with a trajectory behind a mark, whether it was finished or not; what came after the mark is dropped.
    ///
    /// # Errors
    /// [`Error::File`], also when what was written up to the mark is gone or has changed.
    pub fn resume(path: impl AsRef<Path>, format: Format, mark: Mark) -> Result<Self> {
        let path = path.as_ref();
        let file = match format {
            Format::Csv => csv::Series::resume(path, mark).map(File::Csv),
            Format::Npz => npz::Series::resume(path, mark).map(|series| File::Npz(Box::new(series))),
            Format::Vtp => vtp::Series::resume(path, mark).map(File::Vtp),
        };
        named(path, file).map(|file| Self { path: path.to_owned(), file })
    }

    /// Adds the present state. The objects must be the same in all frames of an archive of arrays.
    ///
    /// # Errors
    /// [`Error::Device`] when the GPU failed, [`Error::File`] when the file cannot be written.
    pub fn frame(&mut self, simulation: &mut Simulation) -> Result<()> {
        self.frame_of_step(simulation, simulation.report().steps)
    }

    /// The same under another number of steps, for a program that divides its steps.
    ///
    /// # Errors
    /// As for [`Writer::frame`].
    pub fn frame_of_step(&mut self, simulation: &mut Simulation, step: u64) -> Result<()> {
        let mut frame = Frame::of(simulation, !matches!(self.file, File::Csv(_)))?;
        frame.step = step;
        let written = match &mut self.file {
            File::Csv(series) => series.frame(&frame),
            File::Npz(series) => series.frame(&frame),
            File::Vtp(series) => series.frame(&frame, simulation.scene()),
        };
        named(&self.path, written)
    }

    /// Puts on the disk what was written so far, for [`Writer::resume`]; kept from now on, even unfinished. `None` where
    /// the trajectory goes into a device or a pipe.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn mark(&mut self) -> Result<Option<Mark>> {
        let mark = match &mut self.file {
            File::Csv(series) => series.mark(),
            File::Npz(series) => series.mark(),
            File::Vtp(series) => series.mark(),
        };
        named(&self.path, mark)
    }

    /// Finishes the trajectory and puts it in its place. The scene gives what does not change from frame to frame.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn finish(self, scene: &Scene) -> Result<()> {
        let finished = match self.file {
            File::Csv(series) => series.finish(),
            File::Npz(series) => series.finish(scene),
            File::Vtp(series) => series.finish(),
        };
        named(&self.path, finished)
    }
}

fn named<T>(path: &Path, result: io::Result<T>) -> Result<T> {
    result.map_err(|source| Error::File { file: path.to_owned(), source })
}
