//! The interface of `team.rs` without the feature `mpi`.

use pyo3::prelude::*;
use rockfall::{Options, Report};

use crate::errors::SimulationError;
use crate::portions::Stop;

/// Processes that will share a simulation. There are none.
pub(crate) enum Starting {}

/// The processes that share a simulation. There are none.
#[derive(Debug)]
pub(crate) enum Team {}

impl Starting {
    pub(crate) fn of(_handle: i32) -> PyResult<Self> {
        Err(SimulationError::new_err(
            "comm: this rockfall was built without MPI: expected a build from its sources with the cargo feature mpi, as by \
             `pip install . --config-settings=build-args=\"--features mpi\"` (docs/cluster.md)",
        ))
    }

    pub(crate) fn options(&self, _options: Options) -> Options {
        match *self {}
    }

    pub(crate) fn share(self, _made: PyResult<rockfall::Simulation>) -> PyResult<(rockfall::Simulation, Team)> {
        match self {}
    }
}

impl Team {
    pub(crate) fn rank(&self) -> usize {
        match *self {}
    }

    pub(crate) fn elapsed(&self) -> (u64, f64) {
        match *self {}
    }

    pub(crate) fn is_current(&self) -> bool {
        match *self {}
    }

    pub(crate) fn report(&mut self) -> PyResult<Report> {
        match *self {}
    }

    pub(crate) fn agree(&mut self, _has_failed: bool) -> PyResult<()> {
        match *self {}
    }

    pub(crate) fn gather(&mut self, _simulation: &mut rockfall::Simulation) -> PyResult<()> {
        match *self {}
    }

    pub(crate) fn portion(&mut self, _steps: [u64; 2], _dt: f32, _stop: Stop) -> PyResult<u64> {
        match *self {}
    }
}
