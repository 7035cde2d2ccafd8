//! RK4, pass 3: the last force evaluation and the new state, without a running sum:
//! y + [(Y2 - y) + 2 (Y3 - y) + (Y4 - y)] / 3 + dt/6 f(Y4).
//!
//! Leaves the old position in region 0 of `Y3` and the mean spin (w1 + 2 w2 + 2 w3 + w4) / 6 in its region 2.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "finish",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/forces.wgsl"),
        part!("stage/finish.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Y4),
        read("y2", Buffer::Y2),
        write("y3", Buffer::Y3),
        write("start", Buffer::Start),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    cpu: finish,
};

fn finish(_world: &mut World, _pass: u32) {
    unimplemented!()
}
