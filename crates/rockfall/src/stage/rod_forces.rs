//! Contact forces on rods, each evaluated once a rod and shared over its two ends (physics.md section 4).
//!
//! In the first pass the contacts of a rod with objects of higher id are counted, and `lengths_due` is cleared (by the
//! first thread, unless the step is void).

use crate::stage::{Access, Binding, Buffer, Slot, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "rod_forces",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/forces.wgsl"),
        part!("stage/rod_forces.wgsl"),
    ],
    bindings: &[
        Binding {
            name: "state",
            slot: Slot::State,
            access: Access::Read,
        },
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        write("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Rods,
    cpu: rod_forces,
};

fn rod_forces(_world: &mut World, _pass: u32) {
    unimplemented!()
}
