//! Copies `Y2` to the state of all spheres after the friction impulses, in scenes that have them. Does nothing in a
//! rejected step, or when an earlier attempt at the step has done its collisions. Requests new lists (`rebuild`) if a
//! sphere may leave its AABB within the next step.

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
    name: "commit_friction_impulses",
    wgsl: Wgsl::File(part!("step/collisions/commit_friction_impulses.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        read("next", Buffer::Y2),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    moves: |_| Moves { rows: 6, sphere_aabbs: 1, ..NONE },
    cpu: commit_friction_impulses,
};

fn commit_friction_impulses(world: &mut World, _pass: u32) {
    if world.status.rejected == 0 && world.status.collided == 2 {
        commit(world);
    }
}
