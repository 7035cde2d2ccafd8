//! What can be found out about the states of worlds.

use rayon::prelude::*;

use crate::checkpoint::Checkpoint;
use crate::error::{Error, Result};
use crate::options::{Backend, Options};
use crate::report::Energy;
use crate::simulation::Contact;
use crate::worlds::{World, Worlds};

impl Worlds {
    /// Time step of the last run, in s, or the one that was set after it. Observations assume it.
    pub fn time_step(&self) -> f32 {
        self.dt
    }

    /// Sets the time step that observations assume until the next run: see [`Simulation::set_time_step`](crate::Simulation::set_time_step).
    ///
    /// # Errors
    /// [`Error::Invalid`] for a time step that is not positive and finite.
    pub fn set_time_step(&mut self, dt: f32) -> Result<()> {
        if !(dt.is_finite() && dt > 0.0) {
            let expected = "a time step in seconds, finite and greater than 0";
            return Err(Error::Invalid { field: "dt", value: dt.to_string(), expected });
        }
        self.dt = dt;
        Ok(())
    }

    /// Energies and momenta of the current state of every world.
    ///
    /// # Errors
    /// As for [`Worlds::all_states`].
    pub fn energies(&mut self) -> Result<Vec<Energy>> {
        self.bring_to_host()?;
        let dt = self.dt;
        let energy = |world: &mut World| {
            world.simulation.set_time_step(dt)?;
            world.simulation.energy()
        };
        if self.info.kind == Backend::Cpu {
            return self.worlds.par_iter_mut().map(energy).collect();
        }
        self.worlds.iter_mut().map(energy).collect()
    }

    /// All contacts of the current state of a world, as [`Simulation::contacts`](crate::Simulation::contacts) gives them.
    ///
    /// # Errors
    /// As for [`Worlds::snapshot`].
    pub fn contacts(&mut self, world: usize) -> Result<Vec<Contact>> {
        let dt = self.dt;
        let simulation = &mut self.current(world)?.simulation;
        simulation.set_time_step(dt)?;
        simulation.contacts()
    }

    /// A checkpoint of a world. [`Simulation::resume`](crate::Simulation::resume) makes a simulation of it that goes on where the
    /// world is, with the options of the worlds and, on the same device, bitwise identical steps.
    ///
    /// # Errors
    /// As for [`Worlds::snapshot`].
    pub fn checkpoint(&mut self, world: usize) -> Result<Checkpoint> {
        let (dt, options) = (self.dt, self.options.clone());
        let simulation = &mut self.current(world)?.simulation;
        simulation.set_time_step(dt)?;
        let checkpoint = simulation.checkpoint()?;
        // The simulation that holds a world on the host has options of its own.
        let integrator = checkpoint.options.integrator;
        Ok(Checkpoint { options: Options { integrator, ..options }, ..checkpoint })
    }
}
