//! After symplectic Euler, in scenes without rods: `commit_leap`, then every sphere turns by its new spin (exponential map).

use glam::Vec4;
use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::cpu::view::View;
use crate::stage::commit_leap::commit;
use crate::stage::turn::turn_for;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_and_turn",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/travel.wgsl"),
        part!("wgsl/margin.wgsl"),
        part!("wgsl/two_states.wgsl"),
        part!("wgsl/take_next.wgsl"),
        part!("wgsl/commit.wgsl"),
        part!("wgsl/sine.wgsl"),
        part!("wgsl/rotation.wgsl"),
        part!("stage/commit_and_turn.wgsl"),
    ],
    bindings: &[
        write("state", Buffer::Start),
        read("next", Buffer::Y2),
        write("orientations", Buffer::Orientations),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    cpu: commit_and_turn,
};

fn commit_and_turn(world: &mut World, _pass: u32) {
    if world.status.void != 0 {
        return;
    }
    commit(world);
    let World { step, words, states, orientations, .. } = world;
    let view = View::new(step, words, &states[0]);
    let turn = |(sphere, orientation): (usize, &mut Vec4)| turn_for(orientation, view.spin(sphere as u32), step.dt);
    orientations.par_iter_mut().enumerate().with_min_len(GRAIN).for_each(turn);
}
