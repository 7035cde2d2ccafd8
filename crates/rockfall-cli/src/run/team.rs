//! The processes that share a run, if `mpirun` started them. All of them follow the same path; the first one prints and writes files.

#[cfg(feature = "mpi")]
use rockfall::cluster::{Cluster, Processes, Ranks as _, with_device};
use rockfall::{Options, Simulation};

use super::outputs::Outputs;
use crate::failure::Failure;
use crate::output;

/// The processes, before they share a simulation.
#[derive(Clone)]
pub(crate) struct Starting {
    #[cfg(feature = "mpi")]
    processes: Option<Processes>,
}

/// The processes that share a simulation; one alone without MPI.
pub(crate) struct Team {
    #[cfg(feature = "mpi")]
    cluster: Option<Cluster<Processes>>,
}

#[cfg(feature = "mpi")]
impl Starting {
    /// Starts MPI if `mpirun` started this process. All processes but the first are silent from then on.
    pub(crate) fn start() -> Result<Self, Failure> {
        if !Processes::are_started() {
            return Ok(Self { processes: None });
        }
        let processes = Processes::start()?;
        output::silence(processes.rank() > 0);
        Ok(Self { processes: Some(processes) })
    }

    /// Whether this process prints and writes files.
    pub(crate) fn is_first(&self) -> bool {
        self.processes.as_ref().is_none_or(|processes| processes.rank() == 0)
    }

    /// Whether several processes may share the run.
    pub(crate) fn is_shared(&self) -> bool {
        self.processes.is_some()
    }

    /// The options of a simulation that processes may share, with the GPU of this process.
    pub(crate) fn options(&self, options: Options) -> Options {
        match &self.processes {
            Some(processes) => with_device(options, processes.rank()),
            None => options,
        }
    }

    /// Waits until all processes have begun. If one of them has failed, all end, and the first that did reports it.
    pub(crate) fn all<T>(&mut self, begun: Result<T, Failure>) -> Result<T, Failure> {
        let Some(processes) = &mut self.processes else { return begun };
        let mine = if begun.is_err() { processes.size() - processes.rank() } else { 0 };
        let mut first = [mine as u64];
        processes.max(&mut first)?;
        match first {
            [0] => begun,
            [first] if first == mine as u64 => {
                output::silence(false);
                begun
            }
            _ => Err(Failure::Elsewhere),
        }
    }

    /// Shares a simulation among the processes, if there are some.
    pub(super) fn share(&self, simulation: &mut Simulation) -> Result<Team, Failure> {
        Ok(Team { cluster: self.cluster(simulation)? })
    }

    /// The simulation as the processes share it; `None` without `mpirun`.
    pub(crate) fn cluster(&self, simulation: &mut Simulation) -> Result<Option<Cluster<Processes>>, Failure> {
        let share = |processes: &Processes| Cluster::new(simulation, processes.clone());
        Ok(self.processes.as_ref().map(share).transpose()?)
    }
}

#[cfg(not(feature = "mpi"))]
impl Starting {
    /// Notes if `mpirun` started several processes, which cannot share a run.
    pub(crate) fn start() -> Result<Self, Failure> {
        let size = std::env::var("OMPI_COMM_WORLD_SIZE").unwrap_or_default();
        if size.parse().is_ok_and(|size: u32| size > 1) {
            output::note(&format!(
                "note: this rockfall was built without MPI (cargo feature mpi), so each of the {size} processes runs the whole scene"
            ));
        }
        Ok(Self {})
    }

    pub(crate) fn is_first(&self) -> bool {
        true
    }

    pub(crate) fn is_shared(&self) -> bool {
        false
    }

    pub(crate) fn options(&self, options: Options) -> Options {
        options
    }

    pub(crate) fn all<T>(&mut self, begun: Result<T, Failure>) -> Result<T, Failure> {
        begun
    }

    pub(super) fn share(&self, _simulation: &mut Simulation) -> Result<Team, Failure> {
        Ok(Team {})
    }
}

impl Starting {
    /// Checks that processes can share what the output files need.
    pub(super) fn check(&self, outputs: &Outputs) -> Result<(), Failure> {
        if self.is_shared() && outputs.are_watched() {
            let message =
                "MPI: --events looks at the state of every step, which processes do not share: expected a run without mpirun";
            return Err(Failure::usage(message));
        }
        if self.is_shared() && outputs.are_metered() {
            let message = "MPI: --trace adds up the work of moving surfaces and of a shear in every step, and --gauges with --every the \
                           loads on walls, which processes cannot share yet: expected neither of them, or a run without mpirun";
            return Err(Failure::usage(message));
        }
        Ok(())
    }
}

/// What the processes do next: whether one of them stops, how many whole steps follow, and whether the state is needed after them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Next {
    pub(super) stops: bool,
    pub(super) chunk: u64,
    pub(super) is_due: bool,
}

#[cfg(feature = "mpi")]
impl Team {
    /// Whether this process prints and writes files.
    pub(super) fn is_first(&self) -> bool {
        self.cluster.as_ref().is_none_or(|cluster| cluster.rank() == 0)
    }

    /// Number of steps of the simulation that are done.
    pub(super) fn steps(&self, simulation: &Simulation) -> u64 {
        self.cluster.as_ref().map_or(simulation.report().steps, Cluster::steps)
    }

    /// What all processes do next. One that stops stops all; the first process says how many steps follow.
    pub(super) fn agree(&mut self, next: Next) -> Result<Next, Failure> {
        let is_first = self.is_first();
        let Some(cluster) = &mut self.cluster else { return Ok(next) };
        let of_first = |value: u64| if is_first { value } else { 0 };
        let mut values = [u64::from(next.stops), of_first(next.chunk), of_first(next.is_due.into())];
        cluster.max(&mut values)?;
        Ok(Next { stops: values[0] > 0, chunk: values[1], is_due: values[2] > 0 })
    }

    /// Runs steps of the simulation. With several processes, the simulation of the first one is up to date afterwards if `is_due` is set.
    pub(super) fn advance(
        &mut self,
        simulation: &mut Simulation,
        outputs: &mut Outputs,
        (steps, dt): (u64, f32),
        is_due: bool,
    ) -> rockfall::Result<()> {
        let Some(cluster) = &mut self.cluster else { return outputs.advance(simulation, steps, dt) };
        cluster.run(steps, dt)?;
        if is_due { self.gather(simulation) } else { Ok(()) }
    }

    /// Brings the simulation of the first process up to date.
    pub(super) fn gather(&mut self, simulation: &mut Simulation) -> rockfall::Result<()> {
        let Some(cluster) = &mut self.cluster else { return Ok(()) };
        let is_first = cluster.rank() == 0;
        let state = cluster.gather()?;
        if is_first { simulation.restore(state) } else { Ok(()) }
    }
}

#[cfg(not(feature = "mpi"))]
impl Team {
    pub(crate) fn is_first(&self) -> bool {
        true
    }

    pub(super) fn steps(&self, simulation: &Simulation) -> u64 {
        simulation.report().steps
    }

    pub(super) fn agree(&mut self, next: Next) -> Result<Next, Failure> {
        Ok(next)
    }

    pub(super) fn advance(
        &mut self,
        simulation: &mut Simulation,
        outputs: &mut Outputs,
        (steps, dt): (u64, f32),
        _is_due: bool,
    ) -> rockfall::Result<()> {
        outputs.advance(simulation, steps, dt)
    }

    pub(super) fn gather(&mut self, _simulation: &mut Simulation) -> rockfall::Result<()> {
        Ok(())
    }
}
