//! Computes the acceleration a of every sphere before the collisions. It includes everything but contacts and damping
//! (docs/physics sections 3.1 and 5.2). The size of a goes to the table
//! [`Layout::free_at`](crate::model::step::Layout::free_at), which thresholds use. With symplectic Euler, v + dt/2 a goes to the
//! fifth region of `Start`: it is the velocity at the time of the positions. Does nothing when an earlier attempt at the step
//! has done its collisions: thresholds are those of the start of phase 3.

use glam::Vec3;
use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::traits::Traits;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::free_acceleration;
use crate::settings::Integrator;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "synchronise",
    wgsl: Wgsl::File(part!("step/collisions/synchronise.wgsl")),
    bindings: &[write("state", Buffer::Start), write("topology", Buffer::Topology), read("status", Buffer::Status)],
    threads: Threads::WideSpheres,
    // Reads the velocity, and writes one.
    moves: |_| Moves { rows: 2, ..NONE },
    cpu: synchronise,
};

/// Whether the stage has something to do.
pub(crate) fn is_needed(traits: &Traits) -> bool {
    traits.free_table || traits.integrator == Integrator::SymplecticEuler
}

fn synchronise(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.collided != 0 {
        return;
    }
    let view =
        View::new(&world.step, &world.topology, &world.states[0]).at_evaluation(&world.status, 0).with_laws(&world.user_laws);
    let (n, dt) = (world.step.layout.spheres as usize, world.step.constants.dt);
    let spheres = (0..world.step.layout.spheres).into_par_iter().with_min_len(GRAIN);
    // A body whose forces are not finite is stopped by the integration.
    let finite = |a: Vec3| if a.is_finite() { a } else { Vec3::ZERO };
    let of = |sphere: u32| if view.is_fixed(sphere) { Vec3::ZERO } else { finite(free_acceleration(&view, sphere)) };
    let accelerations: Vec<Vec3> = spheres.map(of).collect();
    if world.step.layout.free_at != 0 {
        let table = &mut world.topology[world.step.layout.free_at as usize..][..n];
        table.iter_mut().zip(&accelerations).for_each(|(word, acceleration)| *word = acceleration.length().to_bits());
    }
    if world.step.is_half_step() {
        let state = &mut world.states[0];
        for (sphere, acceleration) in accelerations.iter().enumerate() {
            let velocity = state[n + sphere];
            state[4 * n + sphere] = (velocity.truncate() + 0.5 * dt * *acceleration).extend(velocity.w);
        }
    }
}
