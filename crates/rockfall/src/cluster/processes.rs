//! Processes that `mpirun` started.

use std::fmt;
use std::mem::ManuallyDrop;
use std::rc::Rc;

use mpi::Threading;
use mpi::collective::SystemOperation;
use mpi::datatype::PartitionMut;
use mpi::environment::{Universe, is_finalized};
use mpi::request::multiple_scope;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator as _, CommunicatorCollectives as _, Destination as _, Source as _};

use crate::cluster::communicator;
use crate::cluster::ranks::Ranks;
use crate::error::{Error, Result};

/// Names of variables that `mpirun` of Open MPI, MPICH, Intel MPI and Slurm's `srun` give to the processes that they start.
const STARTED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"];

/// The processes of an MPI program. An error of MPI, such as the end of a process, ends all of them.
#[derive(Clone)]
pub struct Processes {
    world: Rc<World>,
}

struct World {
    all: ManuallyDrop<SimpleCommunicator>,
    /// Ends MPI when it is dropped. `None` where the program has started MPI.
    _universe: Option<Universe>,
}

impl Drop for World {
    fn drop(&mut self) {
        if std::thread::panicking() {
            // The others may wait for this process, which would wait for them at the end of MPI.
            self.all.abort(1);
        }
        // Nothing can be freed after the end of MPI.
        if !is_finalized() {
            communicator::free(&mut self.all);
        }
    }
}

impl fmt::Debug for Processes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Processes").field("rank", &self.rank()).field("size", &self.size()).finish()
    }
}

impl Processes {
    /// Whether `mpirun` or a similar program started this process.
    pub fn are_started() -> bool {
        STARTED.iter().any(|name| std::env::var_os(name).is_some())
    }

    /// Starts MPI. All calls must come from the thread that calls this. MPI ends when the last copy is dropped.
    ///
    /// # Errors
    /// [`Error::Cluster`] when MPI was started before.
    pub fn start() -> Result<Self> {
        let failed = || Error::Cluster("MPI has been started before".to_owned());
        let (universe, _) = mpi::initialize_with_threading(Threading::Funneled).ok_or_else(failed)?;
        Ok(Self { world: Rc::new(World { all: ManuallyDrop::new(universe.world()), _universe: Some(universe) }) })
    }

    /// The processes of a communicator of a program that has started MPI itself, by its Fortran handle (`MPI_Comm_c2f`, in mpi4py
    /// `comm.py2f()`). All processes of the communicator must call this together. Messages go through a duplicate of it, which is freed
    /// with the last copy; MPI does not end then. Calls may come from any thread.
    ///
    /// # Errors
    /// [`Error::Cluster`] when MPI has not been started, has ended, or was started without `MPI_THREAD_MULTIPLE`, and for a null
    /// communicator or one between two groups.
    pub fn of_communicator(handle: i32) -> Result<Self> {
        let all = ManuallyDrop::new(communicator::duplicate(handle)?);
        Ok(Self { world: Rc::new(World { all, _universe: None }) })
    }
}

impl Ranks for Processes {
    fn rank(&self) -> usize {
        self.world.all.rank() as usize
    }

    fn size(&self) -> usize {
        self.world.all.size() as usize
    }

    fn exchange(&mut self, to: &[Vec<u32>], from: &mut [Vec<u32>]) -> Result<()> {
        let world = &self.world.all;
        let count = to.iter().chain(from.iter()).filter(|words| !words.is_empty()).count();
        multiple_scope(count, |scope, requests| {
            for (rank, words) in from.iter_mut().enumerate().filter(|(_, words)| !words.is_empty()) {
                requests.add(world.process_at_rank(rank as i32).immediate_receive_into(scope, &mut words[..]));
            }
            for (rank, words) in to.iter().enumerate().filter(|(_, words)| !words.is_empty()) {
                requests.add(world.process_at_rank(rank as i32).immediate_send(scope, &words[..]));
            }
            requests.wait_all(&mut Vec::new());
        });
        Ok(())
    }

    fn max(&mut self, values: &mut [u64]) -> Result<()> {
        let mine = values.to_vec();
        self.world.all.all_reduce_into(&mine[..], values, SystemOperation::max());
        Ok(())
    }

    fn gather(&mut self, mine: &[u32]) -> Result<Vec<Vec<u32>>> {
        let mut lengths = vec![0_u64; self.size()];
        self.world.all.all_gather_into(&(mine.len() as u64), &mut lengths[..]);
        let total: u64 = lengths.iter().sum();
        if total > i32::MAX as u64 {
            return Err(Error::Cluster(format!("a state of {total} words is too large to gather, the limit is {}", i32::MAX)));
        }
        let counts: Vec<i32> = lengths.iter().map(|length| *length as i32).collect();
        let starts: Vec<i32> = counts.iter().scan(0, |at, count| Some(std::mem::replace(at, *at + count))).collect();
        let mut all = vec![0_u32; total as usize];
        let mut parts = PartitionMut::new(&mut all[..], &counts[..], &starts[..]);
        self.world.all.all_gather_varcount_into(mine, &mut parts);
        let part = |(start, count): (&i32, &i32)| all[*start as usize..(*start + *count) as usize].to_vec();
        Ok(starts.iter().zip(&counts).map(part).collect())
    }
}
