//! A file that is being written frame by frame, in one of the formats.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::output::{AtomicFile, Mark};
use rockfall::{Error, Result};

use crate::npz::archive::Archive;
use crate::{Format, vtp};

/// What is written: trajectories and contacts.
pub(crate) trait Content {
    /// First line of a CSV file.
    const HEADER: &str;
    /// State of an unfinished `.npz` file.
    type Arrays;

    /// Writes the records of the frames before `mark`, which a finished archive has, to the scratch file.
    fn unpack(path: &Path, scratch: &mut AtomicFile, mark: Mark) -> io::Result<()>;
    /// Prepares to add frames to a scratch file with `bytes` bytes.
    fn arrays(scratch: &mut AtomicFile, bytes: u64) -> io::Result<Self::Arrays>;
}

/// An unfinished file.
#[derive(Debug)]
pub(crate) enum Series<A> {
    Csv(AtomicFile),
    Npz(Box<(Archive, A)>),
    Vtp(vtp::Series),
}

/// An unfinished file and its final path.
#[derive(Debug)]
pub(crate) struct Target<A> {
    path: PathBuf,
    series: Series<A>,
}

impl<A> Target<A> {
    pub(crate) fn create<C: Content<Arrays = A>>(path: &Path, format: Format) -> Result<Self> {
        Self::begin(path, || {
            Ok(match format {
                Format::Csv => {
                    let mut file = AtomicFile::create(path)?;
                    writeln!(file, "{}", C::HEADER)?;
                    Series::Csv(file)
                }
                Format::Npz => Self::arrays::<C>(Archive::create(path)?, 0)?,
                Format::Vtp => Series::Vtp(vtp::Series::create(path)?),
            })
        })
    }

    pub(crate) fn resume<C: Content<Arrays = A>>(path: &Path, format: Format, mark: Mark) -> Result<Self> {
        Self::begin(path, || {
            Ok(match format {
                Format::Csv => Series::Csv(AtomicFile::resume(path, mark)?),
                Format::Npz => Self::arrays::<C>(Archive::resume(path, mark, C::unpack)?, mark.bytes)?,
                Format::Vtp => Series::Vtp(vtp::Series::resume(path, mark)?),
            })
        })
    }

    fn begin(path: &Path, series: impl FnOnce() -> io::Result<Series<A>>) -> Result<Self> {
        Ok(Self { path: path.to_owned(), series: named(path, series())? })
    }

    fn arrays<C: Content<Arrays = A>>(mut archive: Archive, bytes: u64) -> io::Result<Series<A>> {
        let arrays = C::arrays(&mut archive.scratch, bytes)?;
        Ok(Series::Npz(Box::new((archive, arrays))))
    }

    pub(crate) fn is_csv(&self) -> bool {
        matches!(self.series, Series::Csv(_))
    }

    /// Adds a frame.
    pub(crate) fn write(&mut self, write: impl FnOnce(&mut Series<A>) -> io::Result<()>) -> Result<()> {
        named(&self.path, write(&mut self.series))
    }

    pub(crate) fn mark(&mut self) -> Result<Option<Mark>> {
        let mark = match &mut self.series {
            Series::Csv(file) => file.mark(),
            Series::Npz(npz) => npz.0.scratch.mark(),
            Series::Vtp(series) => series.mark(),
        };
        named(&self.path, mark)
    }

    /// Completes the file. `npz` turns the records of the scratch file into an archive.
    pub(crate) fn finish(self, npz: impl FnOnce(Archive, A) -> io::Result<()>) -> Result<()> {
        let finished = match self.series {
            Series::Csv(file) => file.commit(),
            Series::Npz(unfinished) => npz(unfinished.0, unfinished.1),
            Series::Vtp(series) => series.finish(),
        };
        named(&self.path, finished)
    }
}

fn named<T>(path: &Path, result: io::Result<T>) -> Result<T> {
    result.map_err(|source| Error::File { file: path.to_owned(), source })
}
