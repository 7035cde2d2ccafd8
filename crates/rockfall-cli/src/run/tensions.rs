//! The file of `--tensions`: the lengths and tensions of springs and tethers at the end, or at a fixed interval.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::output::{AtomicFile, Mark};
use rockfall::{Body, Error, Link, Scene, Simulation, SphereId, Tension};
use rockfall_trajectory::csv::numbers;

use super::errors::lost;
use super::past::{Past, PastFile, whole};
use crate::failure::Failure;

const HEADER: &str = "step,time,kind,index,a,b,length,tension";

pub(super) struct TensionsFile {
    path: PathBuf,
    file: AtomicFile,
    /// Steps between two states, if there are several.
    every: Option<u64>,
}

impl TensionsFile {
    /// Begins a file with its header, or continues one at a mark.
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        let file = match mark.filter(|_| every.is_some()) {
            Some(mark) => AtomicFile::resume(&path, mark)
                .map_err(|source| lost(&Error::File { file: path.clone(), source }, "--tensions"))?,
            None => {
                let begin = || {
                    let mut file = AtomicFile::create(&path)?;
                    writeln!(file, "{HEADER}").map(|()| file)
                };
                begin().map_err(|error| Failure::file(&path, &error))?
            }
        };
        Ok(Self { path, file, every })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn every(&self) -> Option<u64> {
        self.every
    }

    /// Adds the present state if one is due after this step.
    pub(super) fn after_step(&mut self, simulation: &mut Simulation, past: &Past, step: u64) -> Result<(), Failure> {
        match self.every {
            Some(every) if step.is_multiple_of(every) => self.add(simulation, past),
            _ => Ok(()),
        }
    }

    fn add(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        let tensions = simulation.tensions()?;
        let rows = rows(&tensions, simulation.scene())?;
        let mut write = || {
            let mut prefix = step.to_string().into_bytes();
            numbers(&mut prefix, &[past.time(step)])?;
            rows.iter().try_for_each(|row| self.file.write_all(&prefix).and_then(|()| self.file.write_all(row)))
        };
        write().map_err(|error: io::Error| Failure::file(&self.path, &error))
    }

    /// The file as a checkpoint refers to it.
    pub(super) fn as_past(&mut self) -> Result<PastFile, Failure> {
        let mark = match self.every {
            Some(_) => self.file.mark().map_err(|error| Failure::file(&self.path, &error))?,
            None => None,
        };
        Ok(PastFile::new(whole(&self.path), mark))
    }

    pub(super) fn finish(mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.every.is_none() {
            self.add(simulation, past)?;
        }
        self.file.commit().map_err(|error| Failure::file(&self.path, &error))
    }
}

/// The line of each spring and tether, after the step and the time.
fn rows(tensions: &[Tension], scene: &Scene) -> Result<Vec<Vec<u8>>, Failure> {
    let springs = scene.springs().len();
    let number = |id: SphereId| Body::Sphere(id).index(scene);
    let row = |(place, tension): (usize, &Tension)| {
        let (kind, index) = match tension.link {
            Link::Spring(id) if scene.spring(id)?.muscle.is_some() => ("muscle", place),
            Link::Spring(_) => ("spring", place),
            _ => ("tether", place - springs),
        };
        let b = tension.b.map(number).transpose()?.map_or(String::new(), |b| b.to_string());
        let mut line = format!(",{kind},{index},{},{b}", number(tension.a)?).into_bytes();
        // Adding 0 turns -0 into 0. Writing to memory cannot fail.
        let _ = numbers(&mut line, &[tension.length, tension.force + 0.0]);
        line.push(b'\n');
        Ok(line)
    };
    tensions.iter().enumerate().map(row).collect()
}
