//! Runs steps and examines the state after each of them.

use crate::error::Result;
use crate::model::rest::Rest;
use crate::simulation::Simulation;

impl Simulation {
    /// Runs steps on the CPU backend, and counts those without motion.
    ///
    /// # Errors
    /// As for [`Simulation::run`].
    pub(crate) fn run_watched(&mut self, steps: u64, dt: f32, rest: &mut Rest) -> Result<()> {
        // Edits may replace the arrays.
        self.flush()?;
        self.world.rest = Some(*rest);
        let ran = self.run(steps, dt);
        *rest = self.world.rest.take().unwrap_or(*rest);
        ran.map(|_| ())
    }
}
