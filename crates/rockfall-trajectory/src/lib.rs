//! Writes trajectories, the states of a [`Simulation`] over time, to files for other tools, and reads them back.
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
//! | format | files | contents |
//! |---|---|---|
//! | [`Format::Csv`] | one text file | one line per sphere and frame; see [`csv`] |
//! | [`Format::Npz`] | one archive of arrays for NumPy | see [`npz`] |
//! | [`Format::Vtp`] | `NAME.pvd` and a folder `NAME` with the frames, for ParaView and VTK | see [`vtp`] |
//!
//! [`contacts`] writes the contacts between bodies in the same formats.
//! A [`Reader`] reads NumPy and ParaView trajectories back.
//!
//! Frames are written at once and not held in memory. All numbers are bitwise identical to those of the simulation. A file
//! appears under its name only when it is complete. A [`Mark`] records the position in an unfinished file, from which a later
//! program can continue.

use std::io;
use std::path::{Path, PathBuf};

use rockfall::output::Mark;
use rockfall::{Error, Result, Scene, Simulation};

pub mod contacts;
pub mod csv;
mod frame;
pub mod npz;
mod read;
pub mod vtp;

pub use frame::Frame;
pub use read::{Moment, Reader, States};

/// File format of a trajectory.
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
    /// Returns the format for the extension of a path: `csv`, `npz`, `vtp` or `pvd`, in upper or lower case. `None` for every
    /// other name.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "npz" => Some(Self::Npz),
            "vtp" | "pvd" => Some(Self::Vtp),
            _ => None,
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
    /// Begins a trajectory.
    ///
    /// # Errors
    /// [`Error::File`] if the path cannot be written to.
    pub fn create(path: impl AsRef<Path>, format: Format) -> Result<Self> {
        let path = path.as_ref();
        let file = match format {
            Format::Csv => csv::Series::create(path).map(File::Csv),
            Format::Npz => npz::Series::create(path).map(|series| File::Npz(Box::new(series))),
            Format::Vtp => vtp::Series::create(path).map(File::Vtp),
        };
        named(path, file).map(|file| Self { path: path.to_owned(), file })
    }

    /// Continues a trajectory from a mark, whether it was finished or not. Frames after the mark are removed.
    ///
    /// # Errors
    /// [`Error::File`] if the path cannot be written to, or if the contents before the mark are missing or have changed.
    pub fn resume(path: impl AsRef<Path>, format: Format, mark: Mark) -> Result<Self> {
        let path = path.as_ref();
        let file = match format {
            Format::Csv => csv::Series::resume(path, mark).map(File::Csv),
            Format::Npz => npz::Series::resume(path, mark).map(|series| File::Npz(Box::new(series))),
            Format::Vtp => vtp::Series::resume(path, mark).map(File::Vtp),
        };
        named(path, file).map(|file| Self { path: path.to_owned(), file })
    }

    /// Adds the current state as a frame. With [`Format::Npz`], the objects must be the same in all frames.
    ///
    /// # Errors
    /// [`Error::Device`] if the GPU failed, [`Error::File`] if the file cannot be written.
    pub fn frame(&mut self, simulation: &mut Simulation) -> Result<()> {
        let report = simulation.report();
        self.frame_at(simulation, report.steps, report.time)
    }

    /// Adds the current state with the given step number and time in s, for programs that divide their steps into several parts.
    ///
    /// # Errors
    /// As for [`Writer::frame`].
    pub fn frame_at(&mut self, simulation: &mut Simulation, step: u64, time: f64) -> Result<()> {
        let mut frame = Frame::of(simulation, !matches!(self.file, File::Csv(_)))?;
        (frame.step, frame.time) = (step, time);
        let written = match &mut self.file {
            File::Csv(series) => series.frame(&frame),
            File::Npz(series) => series.frame(&frame),
            File::Vtp(series) => series.frame(&frame, simulation.scene()),
        };
        named(&self.path, written)
    }

    /// Writes everything so far to the disk and returns the position for [`Writer::resume`]. From then on, the unfinished file
    /// is kept when the writer is dropped. Returns `None` if the trajectory is written to a device or a pipe.
    ///
    /// # Errors
    /// [`Error::File`] if the file cannot be written.
    pub fn mark(&mut self) -> Result<Option<Mark>> {
        let mark = match &mut self.file {
            File::Csv(series) => series.mark(),
            File::Npz(series) => series.mark(),
            File::Vtp(series) => series.mark(),
        };
        named(&self.path, mark)
    }

    /// Completes the trajectory and moves it to its final path. The scene provides the data that is the same in all frames.
    ///
    /// # Errors
    /// [`Error::File`] if the file cannot be written.
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
