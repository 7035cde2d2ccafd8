//! Runs of several processes.

use std::time::Instant;

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use super::Simulation;
use crate::errors::Raise;
use crate::portions::{Stop, next_portion};

/// Runs steps of a simulation that processes share, in portions. A signal or an error of `progress` on one process stops all.
pub(super) fn run(
    simulation: &Simulation,
    py: Python<'_>,
    steps: u64,
    dt: f32,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let (mut left, mut wanted) = (steps, 16);
    let mut stopped: Option<PyErr> = None;
    loop {
        let stop = match &stopped {
            None => Stop::No,
            Some(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => Stop::Interrupt,
            Some(_) => Stop::Failure,
        };
        let start = Instant::now();
        let done = simulation.with_team(py, |team, simulation| {
            simulation.set_time_step(dt).or_raise()?;
            team.portion([left, wanted], dt, stop)
        });
        if let Some(error) = stopped {
            return Err(error);
        }
        let count = done?;
        if left == 0 {
            return Ok(());
        }
        left -= count;
        wanted = next_portion(wanted, start.elapsed());
        let shown = || progress.map_or(Ok(()), |progress| progress.call1((count,)).map(drop));
        stopped = py.check_signals().and_then(|()| shown()).err();
    }
}
