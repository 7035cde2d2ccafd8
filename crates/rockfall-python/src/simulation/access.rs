//! Access to a simulation that several threads and processes use.

use std::sync::PoisonError;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::Backend;

use super::Simulation;
use crate::errors::Raise;
use crate::fork::detached;
use crate::portions::PATIENCE;
use crate::running::Running;
use crate::team::Team;

impl Simulation {
    /// Calls a function with the processes that share the simulation.
    pub(crate) fn with_team<R: Send>(
        &self,
        py: Python<'_>,
        call: impl FnOnce(&mut Team, &mut rockfall::Simulation) -> PyResult<R> + Send,
    ) -> PyResult<R> {
        self.locked(py, |running| {
            let Running { team, simulation, .. } = running;
            let team = team.as_mut().ok_or_else(|| PyValueError::new_err("no processes share the simulation"))?;
            call(team, simulation)
        })
    }

    /// Calls a function without the GIL, while no other thread uses the simulation. Threads that wait for it do not hold the GIL.
    pub(crate) fn locked<R: Send>(&self, py: Python<'_>, call: impl FnOnce(&mut Running) -> PyResult<R> + Send) -> PyResult<R> {
        detached(py, || {
            self.waiting.fetch_add(1, Ordering::Relaxed);
            let mut running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
            self.waiting.fetch_sub(1, Ordering::Relaxed);
            running.check(running.simulation.backend().kind == Backend::Gpu)?;
            let running = &mut **running;
            running.ids.add_incoming(running.simulation.scene());
            call(running)
        })
    }

    /// Lets other threads use the simulation if they wait for it: the lock itself prefers the thread that has just had it.
    pub(super) fn make_way(&self, py: Python<'_>) {
        if self.waiting.load(Ordering::Relaxed) > 0 {
            py.detach(|| {
                let end = Instant::now() + PATIENCE;
                while self.waiting.load(Ordering::Relaxed) > 0 && Instant::now() < end {
                    std::thread::sleep(Duration::from_micros(50));
                }
            });
        }
    }

    /// Calls a function that changes the memory of the state.
    pub(crate) fn change<R: Send>(
        &self,
        py: Python<'_>,
        call: impl FnOnce(&mut rockfall::Simulation) -> PyResult<R> + Send,
    ) -> PyResult<R> {
        self.locked(py, |running| {
            running.check_alone()?;
            running.lender.release(&mut running.simulation);
            running.edited = false;
            call(&mut running.simulation)
        })
    }

    /// Calls a function that collects edits, which change memory with the next step or read.
    pub(crate) fn edit<R: Send>(&self, py: Python<'_>, call: impl FnOnce(&mut Running) -> PyResult<R> + Send) -> PyResult<R> {
        self.locked(py, |running| {
            running.check_alone()?;
            running.edited = true;
            call(running)
        })
    }

    /// Calls a function that leaves the memory of the state as it is. All processes that share the simulation must call it together.
    pub(crate) fn read<R: Send>(&self, py: Python<'_>, call: impl FnOnce(&mut Running) -> PyResult<R> + Send) -> PyResult<R> {
        self.flushed(py, |running| {
            running.gather()?;
            call(running)
        })
    }

    /// Calls a function after edits have reached the memory. With other processes, the state may be that of an earlier step.
    pub(crate) fn flushed<R: Send>(
        &self,
        py: Python<'_>,
        call: impl FnOnce(&mut Running) -> PyResult<R> + Send,
    ) -> PyResult<R> {
        self.locked(py, |running| {
            if std::mem::take(&mut running.edited) {
                running.lender.release(&mut running.simulation);
                running.simulation.flush().or_raise()?;
            }
            call(running)
        })
    }
}
