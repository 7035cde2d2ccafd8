//! After symplectic Euler: `Y2` becomes the state, in scenes with rods; in others `commit_and_turn` does it. Does nothing in a
//! void step. A sphere that may leave its AABB within the next step asks for new lists (`rebuild`).

use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::cpu::tally::asks_for_lists;
use crate::cpu::view::View;
use crate::layout::LISTS_ASKED;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_leap",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/travel.wgsl"),
        part!("wgsl/margin.wgsl"),
        part!("wgsl/two_states.wgsl"),
        part!("wgsl/take_next.wgsl"),
        part!("wgsl/commit.wgsl"),
        part!("stage/commit_leap.wgsl"),
    ],
    bindings: &[
        write("state", Buffer::Start),
        read("next", Buffer::Y2),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    cpu: commit_leap,
};

fn commit_leap(world: &mut World, _pass: u32) {
    if world.status.void == 0 {
        commit(world);
    }
}

/// `Y2` becomes the state, and spheres ask for lists.
pub(super) fn commit(world: &mut World) {
    let [start, y2, ..] = &mut world.states;
    start.copy_from_slice(y2);
    let view = View::new(&world.step, &world.words, start);
    let spheres = (0..world.step.spheres).into_par_iter().with_min_len(GRAIN);
    if spheres.any(|sphere| asks_for_lists(&view, &world.aabbs, sphere, view.position(sphere), view.velocity(sphere))) {
        world.status.rebuild |= LISTS_ASKED;
    }
}
