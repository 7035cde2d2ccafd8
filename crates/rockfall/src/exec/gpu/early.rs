//! The early part of a step, in which the spheres are computed that other processes need (docs/cluster.md).

use std::ops::Range;
#[cfg(any(test, feature = "mpi"))]
use std::sync::Arc;

use crate::error::Result;
#[cfg(any(test, feature = "mpi"))]
use crate::exec::gpu::share::{Arrays, Link};
use crate::exec::gpu::world::GpuWorld;
#[cfg(any(test, feature = "mpi"))]
use crate::model::buffer::Buffer;
#[cfg(any(test, feature = "mpi"))]
use crate::model::layout::EARLY;
use crate::step::schedule::Run;
#[cfg(any(test, feature = "mpi"))]
use crate::step::stage::Slot;

#[cfg(any(test, feature = "mpi"))]
impl GpuWorld {
    /// Says where the rows go that other processes need.
    pub(crate) fn set_link(&mut self, link: Arc<Link>) {
        self.link = Some(link);
    }

    /// The arrays with the rows that processes share, after a step or after its early part.
    ///
    /// # Errors
    /// As for [`GpuWorld::buffer`].
    pub(crate) fn shared_arrays(&self, is_early: bool) -> Result<Arrays> {
        let pass = if is_early { EARLY } else { 0 };
        let layout = self.step().layout;
        let whole = |buffer: Buffer| self.buffer(buffer).cloned();
        Ok(Arrays {
            spheres: layout.spheres,
            slots_at: layout.slots_at,
            state: whole(Slot::Ended.buffer(pass))?,
            topology: whole(Buffer::Topology)?,
            rates: whole(Slot::EndedRates.buffer(pass))?,
            status: whole(Buffer::Status)?,
        })
    }

    /// Number of runs up to the last one that computes what other processes need; 0 where nothing is sent after them.
    pub(super) fn early_runs(&self, runs: &[Run], steps: &Range<u32>) -> usize {
        let is_last = |run: &Run| run.pass >= EARLY && run.applies(self.step());
        let count = runs.iter().rposition(is_last).map_or(0, |last| last + 1);
        let is_taken = self.link.as_ref().is_some_and(|link| link.note_submission()) && steps.len() == 1;
        if is_taken { count } else { 0 }
    }

    /// Submits the early part of a step, which an encoder has.
    pub(super) fn submit_early(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        let Some(link) = &self.link else { return Ok(()) };
        link.submit_early(&self.shared_arrays(true)?, self.shared_arrays(false)?, encoder)
    }
}

/// Without processes that share a scene, no step has an early part.
#[cfg(not(any(test, feature = "mpi")))]
impl GpuWorld {
    pub(super) fn early_runs(&self, _runs: &[Run], _steps: &Range<u32>) -> usize {
        0
    }

    pub(super) fn submit_early(&self, _encoder: wgpu::CommandEncoder) -> Result<()> {
        Ok(())
    }
}
