//! One scene for several processes, with the same bits for any number of them.
//!
//! The scene is divided into slabs with equal numbers of spheres ([`Cluster`]). Every process has a [`Simulation`] of the spheres of its
//! slab and of *ghosts*: copies of the spheres of other processes that its own may touch. Spheres keep their order, so every sum runs in
//! the same order as in one process. A ghost takes a step like any sphere, but some of its neighbours are missing; the process that owns
//! it then sends the true state. Positions, velocities and spins of ghosts are exact whenever forces are evaluated: at the start of a step
//! of symplectic Euler, and after the drift of velocity Verlet, which depends on the state and on the rates of the sphere alone. So one
//! exchange per step is enough. The spring of a contact depends on its two bodies, so both sides compute the same one. A GPU computes the
//! spheres that are sent first, so that the exchange runs while it computes the others.
//!
//! Spheres are divided again before one of them has moved so far that copies could be missing. Each process then learns the whole state.

use std::fmt;
use std::time::Instant;

use crate::checkpoint::{Checkpoint, SUFFIX};
use crate::error::{Error, Result};
use crate::options::Backend;
use crate::report::Clock;
use crate::settings::Integrator;
use crate::simulation::Simulation;

#[cfg(feature = "mpi")]
mod communicator;
#[cfg(feature = "mpi")]
mod devices;
mod domain;
mod line;
mod part;
#[cfg(feature = "mpi")]
mod processes;
mod ranks;
mod report;
mod state;
mod supported;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod threads;
mod work;

#[cfg(feature = "mpi")]
pub use devices::with_device;
use part::Part;
#[cfg(feature = "mpi")]
pub use processes::Processes;
pub use ranks::Ranks;
pub use work::Work;

/// What one process has of a simulation that several processes share. [`Cluster::run`], [`Cluster::gather`], [`Cluster::report`],
/// [`Cluster::work`] and [`Cluster::max`] are collective: every process makes the same calls with the same arguments, in the same order.
pub struct Cluster<R: Ranks> {
    ranks: R,
    backend: Backend,
    /// The state of all spheres when they were last gathered, and the counts of all steps.
    whole: Checkpoint,
    clock: Clock,
    /// Factor by which a sphere reaches further than its radius.
    reach: f64,
    /// Velocity Verlet needs an evaluation of forces before its first step.
    has_rates: bool,
    /// The time step, and the number of the step before which inlets and outlets act next. `None` before the first step.
    next_flow: Option<(f32, u64)>,
    /// `None` until spheres are divided for the first time, and after a step of the whole scene.
    part: Option<Part>,
    /// The simulation of the last step of the whole scene.
    spare: Option<Simulation>,
    work: Work,
    /// What failed in this process since the processes last agreed.
    failure: Option<String>,
}

impl<R: Ranks> fmt::Debug for Cluster<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ranks, part, work, .. } = self;
        let numbers = (ranks.rank(), ranks.size());
        f.debug_struct("Cluster").field("ranks", &numbers).field("part", part).field("work", work).finish_non_exhaustive()
    }
}

impl<R: Ranks> Cluster<R> {
    /// Divides a simulation among processes, each of which has the same simulation. It stays as it is; [`Simulation::restore`] gives it
    /// a state that was gathered. This call does not communicate.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a simulation that cannot be divided; the message names what it has. Otherwise as for
    /// [`Simulation::checkpoint`].
    pub fn new(simulation: &mut Simulation, ranks: R) -> Result<Self> {
        let whole = simulation.checkpoint()?;
        supported::check(simulation, &whole)?;
        let is_verlet = simulation.integrator() == Integrator::VelocityVerlet;
        Ok(Self {
            ranks,
            backend: simulation.backend().kind,
            clock: Clock::default(),
            reach: simulation.reach().into(),
            has_rates: !is_verlet || !whole.rates.is_empty(),
            whole,
            next_flow: None,
            part: None,
            spare: None,
            work: Work::default(),
            failure: None,
        })
    }

    /// The number of this process, from 0.
    pub fn rank(&self) -> usize {
        self.ranks.rank()
    }

    /// Number of steps done, including those before a checkpoint from which the simulation was resumed.
    pub fn steps(&self) -> u64 {
        self.whole.report.steps
    }

    /// Number of times that the spheres were divided among the processes.
    pub fn divisions(&self) -> u64 {
        self.work.divisions
    }

    /// What all processes have, and where their time went, by their numbers.
    ///
    /// # Errors
    /// [`Error::Cluster`] when a process has ended.
    pub fn work(&mut self) -> Result<Vec<Work>> {
        let [own, ghosts] = self.part.as_ref().map_or([0; 2], Part::counts).map(|count| count as u64);
        let all = self.ranks.gather(&Work { own, ghosts, ..self.work }.words())?;
        Ok(all.iter().map(|words| Work::from_words(words)).collect())
    }

    /// Replaces every value by the largest of all processes.
    ///
    /// # Errors
    /// [`Error::Cluster`] when a process has ended.
    pub fn max(&mut self, values: &mut [u64]) -> Result<()> {
        self.ranks.max(values)
    }

    /// Runs `steps` steps of `dt` seconds each.
    ///
    /// # Errors
    /// [`Error::Cluster`] with the message of the process that failed, on all processes.
    pub fn run(&mut self, steps: u64, dt: f32) -> Result<()> {
        for _ in 0..steps {
            if self.is_whole(dt) {
                self.gather()?;
                let done = self.whole_step(dt);
                self.note(done);
                self.agree([])?;
                self.clock.add(1, dt, &mut self.whole.report);
                continue;
            }
            self.divide_if_due(dt)?;
            let Some(part) = &mut self.part else { continue };
            let done = part.step(dt, &mut self.ranks, &mut self.work)?;
            self.note(done);
            self.clock.add(1, dt, &mut self.whole.report);
        }
        self.settle(dt).map(drop)
    }

    /// The state of all spheres after the last step, on every process. Its counters `replays` and `list_builds` are those of the start.
    ///
    /// # Errors
    /// [`Error::Cluster`] when a process has ended.
    pub fn gather(&mut self) -> Result<&Checkpoint> {
        if let Some(part) = &mut self.part {
            let words = part.words(&self.whole.scene)?;
            let all = self.ranks.gather(&words)?;
            state::put(&all, part.domain(), &mut self.whole);
            part.put_history(&mut self.whole);
        }
        Ok(&self.whole)
    }

    /// Whether the next step is one of the whole scene on every process. Velocity Verlet has no rates before its first step, so it evaluates
    /// forces twice in it, and ghosts would have wrong places in the second evaluation. The same is so after spheres came in or left.
    fn is_whole(&self, dt: f32) -> bool {
        let scene = &self.whole.scene;
        let has_flow = !(scene.inlets().is_empty() && scene.outlets().is_empty());
        !self.has_rates || has_flow && self.next_flow.is_none_or(|(of, step)| of != dt || self.whole.report.steps >= step)
    }

    /// Takes a step of the whole scene, before which inlets and outlets act.
    fn whole_step(&mut self, dt: f32) -> Result<()> {
        let mut simulation = match self.free_simulation() {
            Some(mut simulation) => {
                simulation.restore(&self.whole)?;
                simulation
            }
            None => Simulation::resume(self.whole.clone())?,
        };
        let until = simulation.act(dt)?;
        self.next_flow = Some((dt, self.whole.report.steps.saturating_add(until)));
        simulation.run(1, dt)?;
        let Checkpoint { scene, flow, fronts, springs, rates, residues, history, time_step, report, .. } =
            simulation.checkpoint()?;
        self.spare = Some(simulation);
        let whole = &mut self.whole;
        (whole.scene, whole.flow, whole.fronts, whole.springs) = (scene, flow, fronts, springs);
        (whole.rates, whole.residues, whole.history, whole.time_step) = (rates, residues, history, time_step);
        (whole.report.contacts, whole.report.max_overlap) = (report.contacts, report.max_overlap);
        self.has_rates = true;
        Ok(())
    }

    /// The simulation of the part or of the last step of the whole scene, to be used again. The part ends.
    fn free_simulation(&mut self) -> Option<Simulation> {
        self.part.take().map(Part::into_simulation).or_else(|| self.spare.take())
    }

    /// Divides the spheres if one of them may move so far before the next evaluation of forces that a copy could be missing.
    fn divide_if_due(&mut self, dt: f32) -> Result<()> {
        let start = Instant::now();
        let is_due = self.settle(dt)?;
        self.work.waiting += start.elapsed().as_secs_f64();
        if !is_due {
            return Ok(());
        }
        let start = Instant::now();
        self.divide(dt)?;
        self.work.division += start.elapsed().as_secs_f64();
        Ok(())
    }

    fn divide(&mut self, dt: f32) -> Result<()> {
        if self.work.divisions == 0 {
            self.check_same()?;
        }
        self.gather()?;
        self.work.divisions += 1;
        match Part::new(self.free_simulation(), &self.whole, [self.ranks.rank(), self.ranks.size()], self.reach, dt) {
            Ok(part) => self.part = Some(part),
            Err(error) => self.failure = Some(error.to_string()),
        }
        // Another process may lack memory.
        self.agree([]).map(drop)
    }

    /// Checks that all processes have the same backend and the same scene, by its checksum.
    fn check_same(&mut self) -> Result<()> {
        // Hosts may have different numbers of cores.
        let device = std::mem::take(&mut self.whole.device);
        // Without the checksum at the end, which would make that of all bytes the same for all checkpoints.
        let bytes = self.whole.to_bytes();
        let checksum = u64::from(crc32fast::hash(&bytes[..bytes.len() - SUFFIX]));
        self.whole.device = device;
        let backend = self.backend as u64;
        let mine = [checksum, u64::MAX - checksum, backend, u64::MAX - backend];
        let mut values = mine;
        self.ranks.max(&mut values)?;
        if values == mine {
            return Ok(());
        }
        let message = if values[2..] == mine[2..] {
            "the processes have different scenes or options: expected the same files on all hosts"
        } else {
            "some processes run on a GPU and some on the CPU: expected --backend cpu, or a GPU on every host"
        };
        Err(Error::Cluster(message.to_owned()))
    }

    /// Notes what failed in this process, for the others.
    fn note(&mut self, done: Result<()>) {
        if let Err(error) = done {
            self.failure = Some(error.describe(&self.whole.scene));
        }
    }

    /// Exchanges the states of spheres again where the copies of some process may be wrong. Lets all processes build lists in the same step,
    /// since they wait for each other in every step. Returns whether spheres must be divided before the next step.
    fn settle(&mut self, dt: f32) -> Result<bool> {
        loop {
            let is_wrong = self.part.as_ref().is_some_and(Part::has_wrong_copies);
            let is_due = self.part.as_ref().is_none_or(|part| !part.has_room(dt));
            let wants_lists = self.part.as_ref().is_some_and(Part::wants_lists);
            let [is_wrong, is_due, wants_lists] = self.agree([is_wrong, is_due, wants_lists])?;
            let Some(part) = &mut self.part else { return Ok(is_due) };
            if !is_wrong {
                if wants_lists {
                    part.request_lists();
                }
                return Ok(is_due);
            }
            let done = part.exchange(dt, &mut self.ranks, &mut self.work)?;
            self.note(done);
        }
    }

    /// Whether each of some facts holds on any process.
    fn agree<const FACTS: usize>(&mut self, facts: [bool; FACTS]) -> Result<[bool; FACTS]> {
        let mut values: Vec<u64> = [self.failure.is_some()].iter().chain(&facts).map(|fact| u64::from(*fact)).collect();
        self.ranks.max(&mut values)?;
        if values[0] == 0 {
            return Ok(std::array::from_fn(|fact| values[fact + 1] != 0));
        }
        let mine: Vec<u32> = self.failure.take().unwrap_or_default().chars().map(u32::from).collect();
        let all = self.ranks.gather(&mine)?;
        let first = all.iter().find(|words| !words.is_empty());
        Err(Error::Cluster(first.into_iter().flatten().filter_map(|word| char::from_u32(*word)).collect()))
    }
}
