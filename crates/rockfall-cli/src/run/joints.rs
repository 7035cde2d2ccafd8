//! The file of `--joints`: positions and loads of joints in the final state, or at a fixed interval.

use std::io::Write;
use std::path::PathBuf;

use rockfall::Simulation;
use rockfall::output::Mark;
use rockfall_trajectory::csv::numbers;

use super::past::Past;
use super::samples::Samples;
use crate::failure::Failure;

const HEADER: &str = "step,time,joint,position,speed,fx,fy,fz,tx,ty,tz,error";

pub(super) struct JointsFile(pub(super) Samples);

impl JointsFile {
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        Samples::open("--joints", HEADER, path, every, mark).map(Self)
    }

    /// Adds the state before the first step, if there are several states.
    pub(super) fn begin(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.0.has_start() { self.add(simulation, past) } else { Ok(()) }
    }

    /// Adds the present state if one is due after this step.
    pub(super) fn after_step(&mut self, simulation: &mut Simulation, past: &Past, step: u64) -> Result<(), Failure> {
        if self.0.is_due(step) { self.add(simulation, past) } else { Ok(()) }
    }

    /// Adds a line for each joint: its name, or its number from 0 where it has none. A broken joint has no numbers.
    fn add(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        let readings = simulation.joints()?;
        self.0.add(|file| {
            for (number, (joint, reading)) in simulation.scene().joints().iter().zip(&readings).enumerate() {
                write!(file, "{step}")?;
                numbers(file, &[past.time(step)])?;
                match &joint.name {
                    Some(name) => write!(file, ",{name}")?,
                    None => write!(file, ",{number}")?,
                }
                if reading.broken {
                    writeln!(file, ",,,,,,,,,")?;
                    continue;
                }
                // Adding 0 turns -0 into 0.
                let [force, torque] = [reading.force, reading.torque].map(|load| (load + 0.0).to_array().map(f64::from));
                numbers(file, &[f64::from(reading.position), f64::from(reading.speed)])?;
                numbers(file, &force)?;
                numbers(file, &torque)?;
                numbers(file, &[f64::from(reading.error)])?;
                writeln!(file)?;
            }
            Ok(())
        })
    }

    pub(super) fn finish(mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.0.has_end() {
            self.add(simulation, past)?;
        }
        self.0.commit()
    }
}
