//! Creates a record for every collision, and stores the number of the record with the list entries of both sides (docs/physics.md
//! sections 3.5 to 3.7).

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "list_collisions",
    wgsl: Wgsl::File(part!("step/collisions/list_collisions.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("collision_indices", Buffer::CollisionIndices),
        write("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideObjects,
    // Few bodies collide. The counts show which ones do not.
    moves: |_| Moves { counts: 1, ..NONE },
    cpu: list_collisions,
};

/// Does nothing: on the CPU, `apply_collisions` solves all collisions.
fn list_collisions(_world: &mut World, _pass: u32) {}
