//! After the friction impulses: `Y2` becomes the state of all spheres, in scenes that have such impulses. Does nothing in a void step, nor when
//! the collisions of the step were done before. A sphere that may leave its AABB within the next step asks for new lists (`rebuild`).

use super::commit_leap::commit;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_rubs",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/travel.wgsl"),
        part!("wgsl/margin.wgsl"),
        part!("wgsl/two_states.wgsl"),
        part!("wgsl/take_next.wgsl"),
        part!("wgsl/commit.wgsl"),
        part!("stage/commit_rubs.wgsl"),
    ],
    bindings: &[
        write("state", Buffer::Start),
        read("next", Buffer::Y2),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    cpu: commit_rubs,
};

fn commit_rubs(world: &mut World, _pass: u32) {
    if world.status.void == 0 && world.status.collided == 2 {
        commit(world);
    }
}
