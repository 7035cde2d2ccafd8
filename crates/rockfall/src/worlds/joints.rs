//! Joints of worlds: what they do, and their drives.

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::options::Backend;
use crate::scene::Joint;
use crate::simulation::JointReading;
use crate::worlds::{World, Worlds};

impl Worlds {
    /// What all joints of a world do, in order of addition: see [`Simulation::joints`](crate::Simulation::joints).
    ///
    /// # Errors
    /// As for [`Worlds::snapshot`].
    pub fn joints(&mut self, world: usize) -> Result<Vec<JointReading>> {
        self.current(world)?.simulation.joints()
    }

    /// What all joints of all worlds do: one list per world.
    ///
    /// # Errors
    /// As for [`Worlds::all_states`].
    pub fn all_joints(&mut self) -> Result<Vec<Vec<JointReading>>> {
        self.refresh()?;
        let read = |world: &mut World| world.simulation.joints();
        match self.info.kind {
            Backend::Cpu => self.worlds.par_iter_mut().map(read).collect(),
            _ => self.worlds.iter_mut().map(read).collect(),
        }
    }

    /// Changes the drive, the limits and the strength of a joint of a world, from the next step on, until
    /// [`Worlds::reset`]. `joint` counts joints in order of
    /// addition.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world or a joint that does not exist. Otherwise as for
    /// [`Simulation::update_joint`](crate::Simulation::update_joint).
    pub fn update_joint(&mut self, world: usize, joint: usize, change: impl FnOnce(&mut Joint)) -> Result<()> {
        let simulation = &mut self.current(world)?.simulation;
        let count = simulation.scene().joints().len();
        let id = simulation.scene().joint_ids().nth(joint).ok_or_else(|| Error::Invalid {
            field: "joint",
            value: format!("{joint} of {count}"),
            expected: "a number below that of joints",
        })?;
        simulation.update_joint(id, change)?;
        self.changed(world);
        Ok(())
    }
}
