//! After symplectic Euler: `Y2` becomes the state, in scenes with rods; in others `commit_and_turn` does it. Does nothing in a
//! void step. A sphere that may leave its AABB within the next step asks for new lists (`rebuild`).

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::commit::commit;
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
    cpu: commit_symplectic_euler,
};

fn commit_symplectic_euler(world: &mut World, _pass: u32) {
    if world.status.rejected == 0 {
        commit(world);
    }
}
