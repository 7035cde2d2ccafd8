//! RK4, pass 3, and the orientations, in scenes without rods: does what `finish` does, then rotates every sphere by its
//! mean spin (exponential map, docs/physics.md section 5.3). Compared with two stages, this saves a pass over memory.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::integrate::finish::finish_all;
use crate::step::integrate::turn::turn_for;
use crate::step::moves::{FORCES, Moves};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "finish_and_turn",
    wgsl: Wgsl::File(part!("step/integrate/finish_and_turn.wgsl")),
    bindings: &[
        read("state", Buffer::Y4),
        read("y2", Buffer::Y2),
        read("y3", Buffer::Y3),
        write("start", Buffer::Start),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("orientations", Buffer::Orientations),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    // The same without the last two, but reads and writes the orientation.
    moves: |_| Moves { rows: 17, ..FORCES },
    cpu: finish_and_turn,
};

fn finish_and_turn(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let done = finish_all(world);
    let dt = world.step.dt;
    let turning = world.orientations.par_iter_mut().zip(&done).with_min_len(GRAIN);
    turning.for_each(|(orientation, done)| turn_for(orientation, done.spin, dt));
}
