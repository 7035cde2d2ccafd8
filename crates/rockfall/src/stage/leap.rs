//! Symplectic Euler: v += dt a(x, v), L += dt T, x += dt v, the new state to `Y2`.
//!
//! Leaves the old position in region 0 of `Y3` and the new spin in its region 2. Counts, voids and reports as `advance` does.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "leap",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/forces.wgsl"),
        part!("stage/leap.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        write("y3", Buffer::Y3),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("wrenches", Buffer::Wrenches),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    cpu: leap,
};

fn leap(_world: &mut World, _pass: u32) {
    unimplemented!()
}
