//! Makes `Y2` the state: after collisions, and after a step of symplectic Euler. Does nothing in a void step, nor, after
//! collisions, when they were done before.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// After `apply_collisions`.
pub(crate) const COLLISIONS: Stage = Stage {
    name: "commit_collisions",
    parts: &[part!("wgsl/step.wgsl"), part!("stage/commit.wgsl")],
    bindings: &[write("state", Buffer::Start), read("next", Buffer::Y2), read("status", Buffer::Status)],
    threads: Threads::Spheres,
    cpu: commit_collisions,
};

/// After `leap`.
pub(crate) const LEAP: Stage = Stage { name: "commit_leap", cpu: commit_leap, ..COLLISIONS };

fn commit_collisions(world: &mut World, _pass: u32) {
    let status = &world.status;
    if status.void == 0 && status.collided == 0 && status.collisions > 0 {
        commit(world);
    }
}

fn commit_leap(world: &mut World, _pass: u32) {
    if world.status.void == 0 {
        commit(world);
    }
}

fn commit(world: &mut World) {
    let [start, y2, ..] = &mut world.states;
    start.copy_from_slice(y2);
}
