//! Copies `Y2` to the state after symplectic Euler, in scenes with rods. In other scenes `commit_and_turn` does it.
//! Requests new lists (`rebuild`) if a sphere may leave its AABB within the next step. Does nothing in a rejected step.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::commit::commit;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_symplectic_euler",
    wgsl: Wgsl::File(part!("step/integrate/commit_symplectic_euler.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        read("next", Buffer::Y2),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    moves: |_| Moves { rows: 6, sphere_aabbs: 1, ..NONE },
    cpu: commit_symplectic_euler,
};

fn commit_symplectic_euler(world: &mut World, _pass: u32) {
    if world.status.rejected == 0 {
        commit(world);
    }
}
