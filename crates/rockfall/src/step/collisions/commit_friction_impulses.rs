//! After the friction impulses: `Y2` becomes the state of all spheres, in scenes that have such impulses. Does nothing in a void step, nor when
//! the collisions of the step were done before. A sphere that may leave its AABB within the next step asks for new lists (`rebuild`).

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::commit::commit;
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
    cpu: commit_friction_impulses,
};

fn commit_friction_impulses(world: &mut World, _pass: u32) {
    if world.status.rejected == 0 && world.status.collided == 2 {
        commit(world);
    }
}
