//! Decides when collisions are solved by sweeps: only when some collisions share a body, because sweeps take one dispatch each.
//!
//! A step that needs sweeps, or more room for collisions, is rejected and repeated with them. Results do not depend on it.

use crate::error::{Error, Result};
use crate::model::buffer::Buffer;
use crate::model::layout::{COLLISION_WORDS, FEW_COLLISIONS, SWEEPS_FEW, SWEEPS_LISTED, SWEEPS_ON, most_collisions};
use crate::model::status::{REJECTED_MANY, Status};
use crate::options::Optimization;
use crate::simulation::Simulation;
use crate::step::collisions::sweep_at_once;

/// Number of steps without collisions that share bodies after which sweeps are left out.
const CALM: u64 = 128;
/// Least room for collisions. There is also room for at least one collision per [`MOVERS_A_COLLISION`] movers. Allocating room
/// takes milliseconds, and while bodies fall every step has more collisions than the one before.
const LEAST_ROOM: u32 = 1024;
/// See [`LEAST_ROOM`].
const MOVERS_A_COLLISION: u32 = 8;

impl Simulation {
    /// Handles a step that was rejected for lack of sweeps or of room for collisions.
    pub(super) fn begin_sweeps(&mut self) -> Result<()> {
        (self.calm_steps, self.few_steps) = (0, 0);
        let needed = self.status.listed.max(self.status.total_counters().collisions);
        if needed.max(1) > self.world.step.layout.collision_room {
            let most = most_collisions(self.world.movers());
            if needed > most {
                let bytes = |records: u32| 4 * u64::from(COLLISION_WORDS) * u64::from(records);
                return Err(Error::DeviceLimit { what: Buffer::Collisions.label(), needed: bytes(needed), limit: bytes(most) });
            }
            let usual = (self.world.step.movers() / MOVERS_A_COLLISION).max(LEAST_ROOM);
            self.world.set_collision_records(needed.saturating_mul(2).max(usual).min(most));
            self.engine.resize_collisions(&self.world)?;
        }
        let at_once = self.may_sweep_at_once() && needed <= FEW_COLLISIONS && self.status.rejected & REJECTED_MANY == 0;
        let present = self.world.step.constants.sweeps;
        self.world.set_sweeps(if at_once { SWEEPS_FEW.max(present) } else { SWEEPS_ON });
        Ok(())
    }

    /// Whether one workgroup may do all sweeps when there are few collisions.
    fn may_sweep_at_once(&self) -> bool {
        sweep_at_once::fits(&self.world.step.traits()) && self.options.uses(Optimization::SweepsAtOnce)
    }

    /// Counts the steps without collisions that share bodies, and those without many of them. After enough such steps, sweeps
    /// are left out, or done in a single dispatch.
    pub(super) fn count_calm(&mut self, done: u64, before: &Status) {
        let status = &self.status;
        let count = |steps: u64, unlike: bool| if unlike { 0 } else { steps + done };
        self.calm_steps = count(self.calm_steps, status.clustered_steps != before.clustered_steps);
        self.few_steps = count(self.few_steps, status.many_steps != before.many_steps);
        let at_once = self.may_sweep_at_once();
        if self.calm_steps >= CALM {
            self.world.set_sweeps(SWEEPS_LISTED);
        } else if self.few_steps >= CALM && self.world.step.constants.sweeps == SWEEPS_ON && at_once {
            self.world.set_sweeps(SWEEPS_FEW);
        }
    }
}
