//! RK4, passes 0 to 2: net force on every sphere, and the next stage state from it (physics.md sections 4, 5).
//!
//! With f the right side at stage state Y(p+1): Y(p+2) = y + c f, c = dt/2, dt/2, dt. Pass 0 counts contacts. A sphere
//! whose stage state leaves its AABB voids the step; one whose next state is not finite gets its starting position,
//! no velocity and no spin there, and is reported.

use crate::stage::{Access, Binding, Buffer, Slot, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "advance",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/forces.wgsl"),
        part!("stage/advance.wgsl"),
    ],
    bindings: &[
        Binding {
            name: "state",
            slot: Slot::State,
            access: Access::Read,
        },
        read("start", Buffer::Start),
        Binding {
            name: "next",
            slot: Slot::Next,
            access: Access::Write,
        },
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("wrenches", Buffer::Wrenches),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    cpu: advance,
};

fn advance(_world: &mut World, _pass: u32) {
    unimplemented!()
}
