//! The file of `--bodies`: poses and motions of rigid bodies and moving walls at the end, or at a fixed interval.

use std::io::Write;
use std::path::PathBuf;

use rockfall::Simulation;
use rockfall::output::Mark;
use rockfall_trajectory::csv;

use super::past::Past;
use super::samples::Samples;
use crate::failure::Failure;

pub(super) struct BodiesFile(pub(super) Samples);

impl BodiesFile {
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        let prefix = if every.is_some() { "step,time," } else { "" };
        Samples::open("--bodies", &format!("{prefix}{}", csv::BODIES), path, every, mark).map(Self)
    }

    /// Adds the state before the first step, if there are several states.
    pub(super) fn begin(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.0.has_start() { self.add(simulation, past) } else { Ok(()) }
    }

    /// Adds the present state if one is due after this step.
    pub(super) fn after_step(&mut self, simulation: &mut Simulation, past: &Past, step: u64) -> Result<(), Failure> {
        if self.0.is_due(step) { self.add(simulation, past) } else { Ok(()) }
    }

    fn add(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        simulation.sync()?;
        let has_step = !self.0.has_end();
        self.0.add(|file| {
            let mut prefix = Vec::new();
            if has_step {
                write!(prefix, "{step}")?;
                csv::numbers(&mut prefix, &[past.time(step)])?;
                prefix.push(b',');
            }
            csv::bodies(file, &String::from_utf8_lossy(&prefix), simulation)
        })
    }

    pub(super) fn finish(mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.0.has_end() {
            self.add(simulation, past)?;
        }
        self.0.commit()
    }
}
