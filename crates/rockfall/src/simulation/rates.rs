//! Carries the rates of velocity Verlet over checkpoints (docs/physics section 5.7).

use bytemuck::{cast_slice, cast_slice_mut};

use crate::error::Result;
use crate::model::layout::{FLAG_VERLET, RATE_WORDS};
use crate::model::world::World;
use crate::simulation::Simulation;

/// Acceleration and torque of a sphere or rigid body.
type Rates = [f32; RATE_WORDS as usize];

/// Gives a world the rates of a checkpoint. Where they do not belong to its spheres, the next step evaluates the forces again.
pub(super) fn put_rates(world: &mut World, rates: &[Rates]) {
    let fits = world.step.constants.flags & FLAG_VERLET != 0
        && rates.len() == (world.step.layout.spheres + world.step.layout.rigid_bodies) as usize;
    if fits {
        cast_slice_mut(&mut world.rates).copy_from_slice(rates);
    }
    world.status.forces_due = u32::from(!fits);
}

impl Simulation {
    /// The rates of all spheres in insertion order, then of all rigid bodies, if the next step uses them.
    pub(super) async fn rates(&mut self) -> Result<Vec<Rates>> {
        if self.status.forces_due != 0 || self.world.step.constants.flags & FLAG_VERLET == 0 {
            return Ok(Vec::new());
        }
        self.engine.download_rates(&mut self.world).await?;
        Ok(cast_slice(&self.world.rates).to_vec())
    }
}
