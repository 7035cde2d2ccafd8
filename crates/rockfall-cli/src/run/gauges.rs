//! The file of `--gauges`: what gauges measure in the final state, or their means at a fixed interval.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::glam::DVec3;
use rockfall::output::{AtomicFile, Mark};
use rockfall::{Error, GaugeReading, Meter, Simulation};
use rockfall_trajectory::csv::numbers;

use super::errors::lost;
use super::past::{Past, PastFile, whole};
use crate::failure::Failure;

const HEADER: &str = "step,time,gauge,fx,fy,fz,tx,ty,tz,mass,count";

pub(super) struct GaugesFile {
    path: PathBuf,
    file: AtomicFile,
    /// Steps between two samples, if there are several.
    every: Option<u64>,
    is_new: bool,
}

impl GaugesFile {
    /// Begins a file with its header, or continues one at a mark.
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        let mark = mark.filter(|_| every.is_some());
        let file = match mark {
            Some(mark) => AtomicFile::resume(&path, mark)
                .map_err(|source| lost(&Error::File { file: path.clone(), source }, "--gauges"))?,
            None => {
                let begin = || {
                    let mut file = AtomicFile::create(&path)?;
                    writeln!(file, "{HEADER}").map(|()| file)
                };
                begin().map_err(|error| Failure::file(&path, &error))?
            }
        };
        Ok(Self { path, file, every, is_new: mark.is_none() })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn is_new(&self) -> bool {
        self.is_new
    }

    pub(super) fn every(&self) -> Option<u64> {
        self.every
    }

    /// Adds the state before the first step, if there are several samples.
    pub(super) fn begin(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.every.is_some() && self.is_new { self.add(simulation, past, None) } else { Ok(()) }
    }

    /// Adds the means of the steps since the last sample if one is due after this step.
    pub(super) fn after_step(
        &mut self,
        simulation: &mut Simulation,
        past: &Past,
        meter: &mut Meter,
        step: u64,
    ) -> Result<(), Failure> {
        match self.every {
            Some(every) if step.is_multiple_of(every) => {
                let means = meter.take_means();
                self.add(simulation, past, Some(&means))
            }
            _ => Ok(()),
        }
    }

    /// Adds a line for each gauge. Loads are those of the present state, or given means.
    fn add(&mut self, simulation: &mut Simulation, past: &Past, means: Option<&[[DVec3; 2]]>) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        let readings = simulation.gauges()?;
        let mut write = || {
            for (index, (gauge, reading)) in simulation.scene().gauges().iter().zip(&readings).enumerate() {
                write!(self.file, "{step}")?;
                numbers(&mut self.file, &[past.time(step)])?;
                write!(self.file, ",{}", gauge.name)?;
                match reading {
                    GaugeReading::Plane { mass, count } => {
                        write!(self.file, ",,,,,,")?;
                        numbers(&mut self.file, &[*mass])?;
                        writeln!(self.file, ",{count}")?;
                    }
                    GaugeReading::Wall(load) => {
                        let loads = means.map_or([load.force, load.torque], |means| means[index]);
                        // Adding 0 turns -0 into 0.
                        loads.iter().try_for_each(|load| numbers(&mut self.file, &(*load + 0.0).to_array()))?;
                        writeln!(self.file, ",,")?;
                    }
                    _ => return Err(io::Error::other(format!("no columns for {reading:?}"))),
                }
            }
            Ok(())
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
            self.add(simulation, past, None)?;
        }
        self.file.commit().map_err(|error| Failure::file(&self.path, &error))
    }
}
