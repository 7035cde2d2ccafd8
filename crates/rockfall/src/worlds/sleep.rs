//! Worlds in which everything rests.

use crate::error::{Error, Result};
use crate::model::rest::Rest;
use crate::options::Backend;
use crate::worlds::{World, WorldPath, Worlds};

/// When a world sleeps ([`WorldReport::sleeping`](crate::WorldReport::sleeping)), and whether sleeping worlds advance.
///
/// A world sleeps when no sphere has moved for a number of steps one after the other. A sphere moves if at the end of a step its
/// centre, or its surface about the centre, is faster than a limit. This depends on nothing but the steps of the world: neither on other
/// worlds nor on how steps are divided among calls of [`Worlds::run`].
///
/// A world with muscles or with walls that follow a motion never sleeps. A world wakes up when its states, rest lengths or forces are
/// set, also to what they were, and when it is reset or replaced. Then the steps are counted again from 0.
///
/// Worlds with a simulation of their own on a GPU ([`WorldPath::Simulation`]) are not watched, and never sleep.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sleep {
    /// Greatest speed of a sphere that does not move, in units/s. 0.01 by default.
    pub speed: f32,
    /// Number of steps without motion after which a world sleeps, at least 1. 100 by default.
    pub steps: u32,
    /// Sleeping worlds are not advanced: their steps and times stand still until they wake up. `false` by default; then
    /// sleeping worlds are reported and advance as others.
    pub skip: bool,
}

impl Default for Sleep {
    fn default() -> Self {
        Self { speed: 0.01, steps: 100, skip: false }
    }
}

impl Sleep {
    /// The default: worlds sleep after 100 steps without speeds above 0.01 units/s, and advance all the same.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the greatest speed of a sphere that does not move, in units/s.
    pub fn speed(mut self, speed: f32) -> Self {
        self.speed = speed;
        self
    }

    /// Sets the number of steps without motion.
    pub fn steps(mut self, steps: u32) -> Self {
        self.steps = steps;
        self
    }

    /// Sets whether sleeping worlds stand still.
    pub fn skip(mut self, skip: bool) -> Self {
        self.skip = skip;
        self
    }

    pub(crate) fn validate(&self) -> Result<()> {
        if !(self.speed.is_finite() && self.speed >= 0.0) {
            let expected = "a speed in units/s, finite and not negative";
            return Err(Error::Invalid { field: "sleep.speed", value: self.speed.to_string(), expected });
        }
        if self.steps == 0 {
            let expected = "a number of steps of at least 1";
            return Err(Error::Invalid { field: "sleep.steps", value: "0".to_owned(), expected });
        }
        Ok(())
    }

    /// Number of calm steps after which worlds stand still; 0 for never.
    #[cfg(feature = "gpu")]
    pub(crate) fn skipped_after(&self) -> u32 {
        if self.skip { self.steps } else { 0 }
    }
}

impl World {
    fn can_sleep(&self) -> bool {
        let scene = self.simulation.scene();
        let moves = scene.springs().iter().any(|spring| spring.muscle.is_some())
            || scene.boxes().iter().any(|cuboid| cuboid.motion.is_some())
            || scene.polygons().iter().any(|polygon| polygon.motion.is_some());
        !scene.spheres().is_empty() && !moves
    }

    pub(super) fn is_sleeping(&self, sleep: &Sleep) -> bool {
        self.stopped.is_none() && self.calm >= sleep.steps && self.can_sleep()
    }

    /// Runs steps in a simulation of its own, unless the world is stopped.
    pub(super) fn run(&mut self, steps: u64, dt: f32, sleep: &Sleep) {
        if self.path != WorldPath::Simulation {
            return;
        }
        let is_watched = self.simulation.backend().kind == Backend::Cpu;
        let skips = sleep.skip && is_watched && self.can_sleep();
        let mut left = steps;
        while left > 0 && self.stopped.is_none() && !(skips && self.calm >= sleep.steps) {
            // It does not sleep before these steps are done.
            let portion = if skips { left.min((sleep.steps - self.calm).into()) } else { left };
            let ran = if is_watched {
                let mut rest = Rest { speed: sleep.speed, calm: self.calm };
                let ran = self.simulation.run_watched(portion, dt, &mut rest);
                self.calm = rest.calm;
                ran
            } else {
                self.simulation.run(portion, dt).map(|_| ())
            };
            self.stopped = ran.err().map(|error| error.to_string());
            left -= portion;
        }
    }
}

impl Worlds {
    /// When worlds sleep, and whether sleeping worlds advance.
    pub fn sleep(&self) -> Sleep {
        self.sleep
    }

    /// Sets when worlds sleep, and whether sleeping worlds advance. The steps without motion are counted again from 0.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a speed that is negative or not finite, or 0 steps. Nothing is changed then.
    /// [`Error::Device`] when the GPU fails.
    pub fn set_sleep(&mut self, sleep: Sleep) -> Result<()> {
        sleep.validate()?;
        self.refresh()?;
        self.sleep = sleep;
        for world in 0..self.len() {
            self.changed(world);
        }
        Ok(())
    }
}
