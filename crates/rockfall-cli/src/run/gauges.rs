//! The file of `--gauges`: what gauges measure in the final state, or their means at a fixed interval.

use std::io::{self, Write};
use std::path::PathBuf;

use rockfall::glam::DVec3;
use rockfall::output::Mark;
use rockfall::{GaugeReading, Meter, Simulation};
use rockfall_trajectory::csv::numbers;

use super::past::Past;
use super::samples::Samples;
use crate::failure::Failure;

const HEADER: &str = "step,time,gauge,fx,fy,fz,tx,ty,tz,mass,count";

pub(super) struct GaugesFile(pub(super) Samples);

impl GaugesFile {
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        Samples::open("--gauges", HEADER, path, every, mark).map(Self)
    }

    /// Adds the state before the first step, if there are several samples.
    pub(super) fn begin(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.0.has_start() { self.add(simulation, past, None) } else { Ok(()) }
    }

    /// Adds the means of the steps since the last sample if one is due after this step.
    pub(super) fn after_step(
        &mut self,
        simulation: &mut Simulation,
        past: &Past,
        meter: &mut Meter,
        step: u64,
    ) -> Result<(), Failure> {
        if !self.0.is_due(step) {
            return Ok(());
        }
        let means = meter.take_means();
        self.add(simulation, past, Some(&means))
    }

    /// Adds a line for each gauge. Loads are those of the present state, or given means.
    fn add(&mut self, simulation: &mut Simulation, past: &Past, means: Option<&[[DVec3; 2]]>) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        let readings = simulation.gauges()?;
        self.0.add(|file| {
            for (index, (gauge, reading)) in simulation.scene().gauges().iter().zip(&readings).enumerate() {
                write!(file, "{step}")?;
                numbers(file, &[past.time(step)])?;
                write!(file, ",{}", gauge.name)?;
                match reading {
                    GaugeReading::Plane { mass, count } => {
                        write!(file, ",,,,,,")?;
                        numbers(file, &[*mass])?;
                        writeln!(file, ",{count}")?;
                    }
                    GaugeReading::Wall(load) => {
                        let loads = means.map_or([load.force, load.torque], |means| means[index]);
                        // Adding 0 turns -0 into 0.
                        loads.iter().try_for_each(|load| numbers(file, &(*load + 0.0).to_array()))?;
                        writeln!(file, ",,")?;
                    }
                    _ => return Err(io::Error::other(format!("no columns for {reading:?}"))),
                }
            }
            Ok(())
        })
    }

    pub(super) fn finish(mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.0.has_end() {
            self.add(simulation, past, None)?;
        }
        self.0.commit()
    }
}
