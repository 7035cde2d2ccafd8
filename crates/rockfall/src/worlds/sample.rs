//! Shows the states of all worlds while they run.

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::error::{Error, Result};
#[cfg(feature = "gpu")]
use crate::exec::gpu::worlds::{Download, States};
use crate::report::SphereState;
use crate::simulation::Simulation;
use crate::worlds::Worlds;

/// The states of all worlds at one time ([`Worlds::sample`], [`Worlds::run_sampled`]). Several threads may read it.
#[derive(Debug)]
pub struct Sample<'a> {
    /// The simulations that hold the worlds on the host, and whether the world runs no more.
    worlds: Vec<(&'a Simulation, bool)>,
    /// The states on the device, if the host's are older.
    #[cfg(feature = "gpu")]
    device: Option<&'a States<'a>>,
    /// Steps of this call of [`Worlds::run_sampled`] that were done before this time; 0 in [`Worlds::sample`].
    steps: u64,
}

impl Sample<'_> {
    /// Number of steps that were done since [`Worlds::run_sampled`] was called; 0 in [`Worlds::sample`].
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Number of worlds.
    pub fn len(&self) -> usize {
        self.worlds.len()
    }

    /// Whether there are no worlds.
    pub fn is_empty(&self) -> bool {
        self.worlds.is_empty()
    }

    /// The states of all spheres of all worlds: one list per world. Uses the threads of rayon's pool.
    pub fn all_states(&self) -> Vec<Vec<SphereState>> {
        (0..self.len()).into_par_iter().map(|world| self.states(world)).collect()
    }

    /// The states of all spheres of a world, in order of addition. A world that is stopped keeps its last state.
    ///
    /// # Panics
    /// For a world that does not exist.
    pub fn states(&self, world: usize) -> Vec<SphereState> {
        let (simulation, is_stopped) = self.worlds[world];
        let states = simulation.scene().spheres().iter().map(SphereState::from);
        #[cfg(feature = "gpu")]
        if let Some(device) = self.device.filter(|_| !is_stopped) {
            return states.enumerate().map(|(sphere, state)| on_device(state, device.sphere(world, sphere))).collect();
        }
        let _ = is_stopped;
        states.collect()
    }
}

/// A state with the rows that the device has. Fixed spheres have only turned.
#[cfg(feature = "gpu")]
fn on_device(state: SphereState, [position, velocity, momentum, low, orientation]: [glam::Vec4; 5]) -> SphereState {
    let orientation = glam::Quat::from_vec4(orientation);
    if state.fixed {
        return SphereState { orientation, ..state };
    }
    SphereState {
        position: position.truncate(),
        position_low: low.truncate(),
        velocity: velocity.truncate(),
        angular_momentum: momentum.truncate(),
        orientation,
        ..state
    }
}

/// A sample that was not seen yet.
struct Taken {
    steps: u64,
    #[cfg(feature = "gpu")]
    download: Option<Download>,
}

impl Taken {
    fn is_on_its_way(&self) -> bool {
        #[cfg(feature = "gpu")]
        return self.download.is_some();
        #[cfg(not(feature = "gpu"))]
        false
    }
}

impl Worlds {
    /// Advances the worlds as [`Worlds::run`] does, and calls `see` with the states of all worlds after every `every` steps and
    /// after the last step. Returns the number of steps done. If `see` returns [`ControlFlow::Break`], no more steps are
    /// submitted.
    ///
    /// On a GPU this is faster than calls of [`Worlds::run`] and [`Worlds::all_states`]: the device already runs the next steps
    /// while `see` looks at a sample. So after a break, up to `every` more steps may be done than the sample says. If a world has a
    /// simulation of its own on the GPU ([`WorldPath::Simulation`](crate::WorldPath::Simulation)), the device waits.
    ///
    /// # Errors
    /// As for [`Worlds::run`]. [`Error::Invalid`] if `every` is 0.
    pub fn run_sampled(
        &mut self,
        steps: u64,
        dt: f32,
        every: u64,
        mut see: impl FnMut(&Sample<'_>) -> ControlFlow<()>,
    ) -> Result<u64> {
        if every == 0 {
            let expected = "a number of steps of at least 1";
            return Err(Error::Invalid { field: "every", value: "0".to_owned(), expected });
        }
        let (mut done, mut unseen) = (0, None);
        while done < steps {
            let portion = every.min(steps - done);
            self.run(portion, dt)?;
            done += portion;
            let taken = self.take_sample(done)?;
            // One that is on its way from the device is seen when the device has the next steps to do.
            let due = if taken.is_on_its_way() { unseen.replace(taken) } else { Some(taken) };
            if let Some(due) = due
                && self.show_sample(due, &mut see)?.is_break()
            {
                return Ok(done);
            }
        }
        if let Some(due) = unseen {
            // Nothing is left to stop.
            let _ = self.show_sample(due, &mut see)?;
        }
        Ok(done)
    }

    /// Calls `see` with the present states of all worlds. After steps on a GPU this is faster than [`Worlds::all_states`], because the
    /// states are not kept on the host. It is not faster if a world has a simulation of its own
    /// ([`WorldPath::Simulation`](crate::WorldPath::Simulation)).
    ///
    /// # Errors
    /// [`Error::Device`] when the GPU fails.
    pub fn sample<T>(&mut self, see: impl FnOnce(&Sample<'_>) -> T) -> Result<T> {
        let taken = self.take_sample(0)?;
        self.show_sample(taken, see)
    }

    /// Takes a sample of the present states after `steps` steps.
    fn take_sample(&mut self, steps: u64) -> Result<Taken> {
        #[cfg(feature = "gpu")]
        if let Some(batch) = &mut self.batch
            && batch.is_ahead()
            && batch.has_all(&self.worlds)
        {
            // Their states are those on the host.
            let mut stopped = self.worlds.iter_mut().filter(|world| world.stopped.is_some());
            stopped.try_for_each(|world| world.simulation.sync().map(drop))?;
            return Ok(Taken { steps, download: Some(batch.start_sample()?) });
        }
        self.bring_to_host()?;
        Ok(Taken {
            steps,
            #[cfg(feature = "gpu")]
            download: None,
        })
    }

    fn show_sample<T>(&mut self, taken: Taken, see: impl FnOnce(&Sample<'_>) -> T) -> Result<T> {
        let worlds = self.worlds.iter().map(|world| (&world.simulation, world.stopped.is_some())).collect();
        #[cfg(feature = "gpu")]
        if let (Some(batch), Some(download)) = (&mut self.batch, taken.download) {
            return batch.finish_sample(download, |states| see(&Sample { worlds, device: Some(states), steps: taken.steps }));
        }
        let sample = Sample {
            worlds,
            #[cfg(feature = "gpu")]
            device: None,
            steps: taken.steps,
        };
        Ok(see(&sample))
    }
}
