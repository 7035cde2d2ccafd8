//! A simulation on the CPU whose steps run elsewhere: a world of a batch on a device.

use crate::error::{BadStage, Error, Result};
use crate::model::status::{BAD_STAGE_SHIFT, Status};
use crate::model::world::World;
use crate::simulation::Simulation;

/// The report of steps that ran elsewhere.
pub(crate) struct Elsewhere {
    /// Steps done.
    pub(crate) steps: u32,
    pub(crate) contacts: u32,
    pub(crate) max_overlap: f32,
    /// Bodies that were stopped because their state was not finite.
    pub(crate) bad: u32,
    /// The first of them, as in the status; `None` if there was none or the simulation goes on.
    pub(crate) stopped_by: Option<u32>,
}

impl Simulation {
    /// Applies edits, and returns the arrays with which steps of `dt` seconds begin.
    pub(crate) fn packed(&mut self, dt: f32) -> Result<&World> {
        self.set_time_step(dt)?;
        self.flush()?;
        self.muscle_clock.set_time_step(dt);
        self.world.set_muscles(&self.scene, &self.muscle_clock);
        self.world.set_time_step(dt);
        Ok(&self.world)
    }

    /// The arrays as they were packed last.
    pub(crate) fn packed_world(&self) -> &World {
        &self.world
    }

    /// The `FLAG_*` bits of the arrays.
    pub(crate) fn packed_flags(&self) -> u32 {
        self.world.step.constants.flags
    }

    /// Takes the state after steps that ran elsewhere, which `copy` writes to the arrays.
    ///
    /// # Errors
    /// [`Error::NonFinite`] when the steps were stopped by a state that is not finite.
    pub(crate) fn take_steps(&mut self, done: &Elsewhere, copy: impl FnOnce(&mut World)) -> Result<()> {
        copy(&mut self.world);
        self.synced = false;
        self.aabbs_due = true;
        self.lists_due = true;
        let before = self.status;
        self.status = Status {
            last_contacts: done.contacts,
            last_max_overlap: done.max_overlap.to_bits(),
            last_collisions: 0,
            total_bad: before.total_bad.wrapping_add(done.bad),
            rejected: 0,
            lengths_due: 0,
            forces_due: 1,
            ..before
        };
        self.book(done.steps.into(), &before);
        match done.stopped_by {
            None => Ok(()),
            Some(bad) => Err(Error::NonFinite {
                sphere: (bad & ((1 << BAD_STAGE_SHIFT) - 1)) as usize,
                step: self.report.steps,
                stage: BadStage::from_number(bad >> BAD_STAGE_SHIFT),
            }),
        }
    }
}
