//! When a device lists collisions and sweeps over them: only where some share bodies, for that takes a dispatch a sweep.
//!
//! A step that turns out to need sweeps, or more room for collisions, is void and is run again with them. Results do not depend on it.

use crate::error::Result;
use crate::model::layout::{FEW_COLLISIONS, SWEEPS_FEW, SWEEPS_ON};
use crate::model::status::{REJECTED_MANY, Status};
use crate::simulation::Simulation;

/// Steps without collisions that share bodies after which sweeps are left out.
const CALM: u64 = 128;
/// There is room for so many collisions at least, and for one of so many movers: to make room takes milliseconds, and in a fall every
/// step has more of them.
const LEAST_ROOM: u32 = 1024;
/// See [`LEAST_ROOM`].
const MOVERS_A_COLLISION: u32 = 8;

impl Simulation {
    /// After a step that was void for want of sweeps or of room for collisions.
    pub(super) fn begin_sweeps(&mut self) -> Result<()> {
        (self.calm_steps, self.few_steps) = (0, 0);
        let needed = self.status.listed.max(self.status.total_counters().collisions);
        if needed.max(1) > self.world.step.collision_room {
            let usual = (self.world.step.movers() / MOVERS_A_COLLISION).max(LEAST_ROOM);
            self.world.step.collision_room = needed.saturating_mul(2).max(usual);
            self.engine.resize_collisions(&self.world)?;
        }
        let step = &mut self.world.step;
        let at_once = step.may_sweep_at_once() && needed <= FEW_COLLISIONS && self.status.rejected & REJECTED_MANY == 0;
        step.sweeps = if at_once { SWEEPS_FEW.max(step.sweeps) } else { SWEEPS_ON };
        Ok(())
    }

    /// Counts steps without collisions that share bodies, or without many, and does without sweeps, or without a dispatch for each, after
    /// enough of them.
    pub(super) fn count_calm(&mut self, done: u64, before: &Status) {
        let status = &self.status;
        let count = |steps: u64, unlike: bool| if unlike { 0 } else { steps + done };
        self.calm_steps = count(self.calm_steps, status.clustered_steps != before.clustered_steps);
        self.few_steps = count(self.few_steps, status.many_steps != before.many_steps);
        let step = &mut self.world.step;
        if self.calm_steps >= CALM {
            step.sweeps = step.calm_sweeps();
        } else if self.few_steps >= CALM && step.sweeps == SWEEPS_ON && step.may_sweep_at_once() {
            step.sweeps = SWEEPS_FEW;
        }
    }
}
