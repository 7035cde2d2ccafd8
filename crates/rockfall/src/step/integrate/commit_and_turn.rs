//! Completes symplectic Euler in scenes without rods: does what `commit_symplectic_euler` does, then rotates every sphere
//! by its new spin (exponential map, docs/physics.md section 5.3).

use glam::Vec4;
use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::view::View;
use crate::model::world::World;
use crate::step::commit::commit;
use crate::step::integrate::turn::turn_for;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_and_turn",
    wgsl: Wgsl::File(part!("step/integrate/commit_and_turn.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        read("next", Buffer::Y2),
        write("orientations", Buffer::Orientations),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Also reads and writes the orientation.
    moves: |_| Moves { rows: 8, sphere_aabbs: 1, ..NONE },
    cpu: commit_and_turn,
};

fn commit_and_turn(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    commit(world);
    let World { step, topology, states, orientations, .. } = world;
    let view = View::new(step, topology, &states[0]);
    let turn = |(sphere, orientation): (usize, &mut Vec4)| turn_for(orientation, view.spin(sphere as u32), step.dt);
    orientations.par_iter_mut().enumerate().with_min_len(GRAIN).for_each(turn);
}
