//! The backend of a simulation, behind one set of calls.

use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use crate::cpu;
use crate::error::Result;
use crate::simulation::options::{Backend, BackendInfo};
use crate::stage::{Buffer, Run};
use crate::world::World;

/// Where the stages run.
#[derive(Debug)]
pub(super) enum Engine {
    /// On the host, on the simulation's own [`World`].
    Cpu,
}

/// What a blocking call has to poll while it waits.
pub(super) type Waiter = Option<()>;

impl Engine {
    pub(super) async fn open(backend: Backend, _world: &World) -> Result<(Self, BackendInfo)> {
        Ok((Self::Cpu, cpu_info(format!("{backend}"))))
    }

    pub(super) fn waiter(&self) -> Waiter {
        None
    }

    /// Runs `stages` up to `times` over, and reads the status back into `world`.
    pub(super) async fn run(&mut self, world: &mut World, stages: &[Run], times: u64) -> Result<()> {
        match self {
            Self::Cpu => {
                for _ in 0..times {
                    cpu::run(world, stages);
                    if world.status.void != 0 {
                        break;
                    }
                }
                Ok(())
            }
        }
    }

    /// The pair lists of `world` have a new capacity.
    pub(super) fn resize_lists(&mut self, _world: &World) -> Result<()> {
        match self {
            Self::Cpu => Ok(()),
        }
    }

    /// Everything about `world` changed.
    pub(super) fn replace(&mut self, _world: &World) -> Result<()> {
        match self {
            Self::Cpu => Ok(()),
        }
    }

    /// These buffers of `world` changed.
    pub(super) fn upload(&mut self, _world: &World, _buffers: &[Buffer]) -> Result<()> {
        match self {
            Self::Cpu => Ok(()),
        }
    }

    /// Reads buffers back into `world`.
    pub(super) async fn download(&mut self, _world: &mut World, _buffers: &[Buffer]) -> Result<()> {
        match self {
            Self::Cpu => Ok(()),
        }
    }
}

fn cpu_info(reason: String) -> BackendInfo {
    let threads = rayon::current_num_threads();
    let plural = if threads == 1 { "" } else { "s" };
    BackendInfo {
        kind: Backend::Cpu,
        device: format!("CPU, {threads} thread{plural}"),
        reason,
    }
}

/// Drives a future to its end on this thread.
pub(super) fn block_on<F: Future>(_waiter: Waiter, future: F) -> F::Output {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
            return output;
        }
        std::thread::yield_now();
    }
}
