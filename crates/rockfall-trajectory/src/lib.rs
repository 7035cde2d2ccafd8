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
//! [`fields`] computes density, velocity and stress on a grid, and writes them.
//! A [`Reader`] reads NumPy and ParaView trajectories back.
//!
//! Frames are written at once and not held in memory. All numbers are bitwise identical to those of the simulation. A file
//! appears under its name only when it is complete. A [`Mark`] records the position in an unfinished file, from which a later
//! program can continue.

use std::io;
use std::path::Path;

use rockfall::output::{AtomicFile, Mark};
use rockfall::{Result, Scene, Simulation};

use target::{Content, Series, Target};

pub mod contacts;
pub mod csv;
pub mod fields;
mod frame;
pub mod npz;
mod read;
mod target;
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

/// The contents of a trajectory.
enum Trajectory {}

impl Content for Trajectory {
    const HEADER: &str = csv::HEADER;
    type Arrays = npz::Frames;

    fn unpack(path: &Path, scratch: &mut AtomicFile, mark: Mark) -> io::Result<()> {
        npz::unpack(path, scratch, mark)
    }

    fn arrays(scratch: &mut AtomicFile, bytes: u64) -> io::Result<Self::Arrays> {
        npz::Frames::new(scratch, bytes)
    }
}

/// A trajectory that is being written.
#[derive(Debug)]
pub struct Writer {
    target: Target<npz::Frames>,
    unwrapped: bool,
}

impl Writer {
    /// Begins a trajectory.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the path cannot be written to.
    pub fn create(path: impl AsRef<Path>, format: Format) -> Result<Self> {
        Ok(Self { target: Target::create::<Trajectory>(path.as_ref(), format)?, unwrapped: false })
    }

    /// Continues a trajectory from a mark, whether it was finished or not. Frames after the mark are removed.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the path cannot be written to, or if the contents before the mark are missing or have changed.
    pub fn resume(path: impl AsRef<Path>, format: Format, mark: Mark) -> Result<Self> {
        Ok(Self { target: Target::resume::<Trajectory>(path.as_ref(), format, mark)?, unwrapped: false })
    }

    /// Sets whether spheres of periodic scenes are written where they have got to, with all periods that they have passed. Without it,
    /// they are written where they are in the box.
    pub fn unwrapped(mut self, unwrapped: bool) -> Self {
        self.unwrapped = unwrapped;
        self
    }

    /// Adds the current state as a frame. Spheres may come and go between frames.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] if the GPU failed, [`rockfall::Error::File`] if the file cannot be written.
    pub fn frame(&mut self, simulation: &mut Simulation) -> Result<()> {
        let report = simulation.report();
        self.frame_at(simulation, report.steps, report.time)
    }

    /// Adds the current state with the given step number and time in s, for programs that divide their steps into several parts.
    ///
    /// # Errors
    /// As for [`Writer::frame`].
    pub fn frame_at(&mut self, simulation: &mut Simulation, step: u64, time: f64) -> Result<()> {
        let mut frame = Frame::of(simulation, !self.target.is_csv())?;
        if !self.unwrapped {
            frame.bring_into_box(simulation.scene());
        }
        (frame.step, frame.time) = (step, time);
        self.target.write(|series| match series {
            Series::Csv(file) => csv::frame(file, &frame),
            Series::Npz(npz) => npz.1.frame(&mut npz.0.scratch, &frame, simulation.scene()),
            Series::Vtp(series) => series.frame(&frame, simulation.scene()),
        })
    }

    /// Writes everything so far to the disk and returns the position for [`Writer::resume`]. From then on, the unfinished file
    /// is kept when the writer is dropped. Returns `None` if the trajectory is written to a device or a pipe.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the file cannot be written.
    pub fn mark(&mut self) -> Result<Option<Mark>> {
        self.target.mark()
    }

    /// Completes the trajectory and moves it to its final path. The scene provides the data that is the same in all frames.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the file cannot be written.
    pub fn finish(self, scene: &Scene) -> Result<()> {
        self.target.finish(|archive, frames| frames.finish(archive, scene))
    }
}
