//! Velocity Verlet, in scenes without rods: does what `kick` does, then rotates every sphere by its spin in the middle of the step
//! (exponential map, docs/physics.md section 5.3).

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::integrate::kick::kick_all;
use crate::step::integrate::turn::turn_for;
use crate::step::moves::{FORCES, Moves};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "kick_and_turn",
    wgsl: Wgsl::File(part!("step/integrate/kick_and_turn.wgsl")),
    bindings: &[
        read("state", Buffer::Y4),
        write("start", Buffer::Start),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("wrenches", Buffer::Wrenches),
        write("kept_rates", Buffer::Rates),
        write("orientations", Buffer::Orientations),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    // As `kick`, and reads and writes the orientation.
    moves: |_| Moves { rows: 8, rates: 1, ..FORCES },
    cpu: kick_and_turn,
};

fn kick_and_turn(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let spins = kick_all(world, pass);
    let dt = world.step.dt;
    let turning = world.orientations.par_iter_mut().zip(&spins).with_min_len(GRAIN);
    turning.for_each(|(orientation, spin)| turn_for(orientation, *spin, dt));
}
