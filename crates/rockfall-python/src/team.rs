//! The processes that share a simulation: those of a communicator of mpi4py.
//!
//! All of them make the same calls. Each call that communicates begins with a meeting, in which every process learns whether the others make
//! the same call, so that different calls end with an error on all.

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rockfall::cluster::{Cluster, Processes, Ranks, with_device};
use rockfall::{Options, Report};

use crate::errors::{Raise, SimulationError, in_python};
use crate::portions::Stop;

/// The processes of a communicator, which any thread may use.
#[derive(Debug)]
struct Members(Processes);

// SAFETY: `Processes::of_communicator` refuses an MPI that does not allow calls from all threads. There is no other copy of these processes
// that another thread could use or drop at the same time.
#[allow(unsafe_code)]
unsafe impl Send for Members {}

impl Ranks for Members {
    fn rank(&self) -> usize {
        self.0.rank()
    }

    fn size(&self) -> usize {
        self.0.size()
    }

    fn exchange(&mut self, to: &[Vec<u32>], from: &mut [Vec<u32>]) -> rockfall::Result<()> {
        self.0.exchange(to, from)
    }

    fn max(&mut self, values: &mut [u64]) -> rockfall::Result<()> {
        self.0.max(values)
    }

    fn gather(&mut self, mine: &[u32]) -> rockfall::Result<Vec<Vec<u32>>> {
        self.0.gather(mine)
    }
}

/// Processes that will share a simulation.
pub(crate) struct Starting(Members);

impl Starting {
    /// The processes of the communicator with this Fortran handle.
    pub(crate) fn of(handle: i32) -> PyResult<Self> {
        Processes::of_communicator(handle).map(|processes| Self(Members(processes))).or_raise()
    }

    /// Options with the GPU of this process.
    pub(crate) fn options(&self, options: Options) -> Options {
        with_device(options, self.0.rank())
    }

    /// Shares a simulation, if all processes have made it.
    pub(crate) fn share(mut self, made: PyResult<rockfall::Simulation>) -> PyResult<(rockfall::Simulation, Team)> {
        let has_failed = made.is_err();
        let rank = self.0.rank() as u64;
        // The first process that has failed, counted from the end.
        let mut first = [if has_failed { u64::MAX - rank } else { 0 }];
        self.0.max(&mut first).or_raise()?;
        let mut simulation = made?;
        if first != [0] {
            return Err(SimulationError::new_err(format!(
                "comm: process {} could not make its simulation",
                u64::MAX - first[0]
            )));
        }
        let cluster = Cluster::new(&mut simulation, self.0).or_raise()?;
        Ok((simulation, Team { cluster, is_current: true, failure: None }))
    }
}

/// Calls that all processes make together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Call {
    Run = 1,
    Read,
    Report,
    Write,
}

/// The processes that share a simulation.
#[derive(Debug)]
pub(crate) struct Team {
    cluster: Cluster<Members>,
    /// Whether the simulation has the state after the last step.
    is_current: bool,
    /// Why the processes cannot go on.
    failure: Option<String>,
}

impl Team {
    /// The number of this process, from 0.
    pub(crate) fn rank(&self) -> usize {
        self.cluster.rank()
    }

    /// Number of steps done, and time in s.
    pub(crate) fn elapsed(&self) -> (u64, f64) {
        (self.cluster.steps(), self.cluster.time())
    }

    /// Whether the simulation has the state after the last step.
    pub(crate) fn is_current(&self) -> bool {
        self.is_current
    }

    /// Counts and times of all steps.
    pub(crate) fn report(&mut self) -> PyResult<Report> {
        self.meet(Call::Report, [0; 2], Stop::No, 0)?;
        let report = self.cluster.report();
        self.kept(report)
    }

    /// Ends a call of which the first process may have failed. Then all others fail, too.
    pub(crate) fn agree(&mut self, has_failed: bool) -> PyResult<()> {
        let stop = if has_failed { Stop::Failure } else { Stop::No };
        match self.meet(Call::Write, [0; 2], stop, 0)? {
            (stopped, _) if stopped == Stop::No as u64 || has_failed => Ok(()),
            _ => Err(SimulationError::new_err("comm: the first process could not write a file")),
        }
    }

    /// Gives the simulation the state after the last step.
    pub(crate) fn gather(&mut self, simulation: &mut rockfall::Simulation) -> PyResult<()> {
        if self.is_current {
            return Ok(());
        }
        self.meet(Call::Read, [0; 2], Stop::No, 0)?;
        let dt = simulation.time_step();
        let restored = self.cluster.gather().and_then(|state| simulation.restore(state));
        self.kept(restored)?;
        simulation.set_time_step(dt).or_raise()?;
        self.is_current = true;
        Ok(())
    }

    /// Runs as many of `left` steps as the first process wants; `Err` if a process stops all of them.
    pub(crate) fn portion(&mut self, [left, wanted]: [u64; 2], dt: f32, stop: Stop) -> PyResult<u64> {
        let (stopped, count) = self.meet(Call::Run, [left, dt.to_bits().into()], stop, wanted.min(left))?;
        if stopped == Stop::Interrupt as u64 {
            return Err(PyKeyboardInterrupt::new_err("a process that shares the simulation was interrupted"));
        }
        if stopped != Stop::No as u64 {
            return Err(SimulationError::new_err("comm: another process stopped the run because of an error of its own"));
        }
        self.is_current &= count == 0;
        let done = self.cluster.run(count, dt);
        self.kept(done)?;
        Ok(count)
    }

    /// Waits for all processes, and checks that they make the same call. Returns what stops it, and the value of the first process.
    fn meet(&mut self, call: Call, arguments: [u64; 2], stop: Stop, value: u64) -> PyResult<(u64, u64)> {
        if let Some(failure) = &self.failure {
            return Err(SimulationError::new_err(format!(
                "comm: the processes cannot go on, because of an error before: {failure}"
            )));
        }
        let value = if self.rank() == 0 { value } else { 0 };
        let [one, other] = arguments;
        let mut values = [stop as u64, value, call as u64, !(call as u64), one, !one, other, !other];
        let mine = values;
        let met = self.cluster.max(&mut values);
        self.kept(met)?;
        if values[2..] != mine[2..] {
            let failure = "the processes made different calls: expected that all of them run the same steps, read the state and write \
                           files in the same order";
            self.failure = Some(failure.to_owned());
            return Err(SimulationError::new_err(format!("comm: {failure}")));
        }
        Ok((values[0], values[1]))
    }

    /// Notes an error, after which the processes have different states.
    fn kept<T>(&mut self, result: rockfall::Result<T>) -> PyResult<T> {
        self.failure = result.as_ref().err().map(|error| in_python(&error.to_string()));
        result.or_raise()
    }
}
