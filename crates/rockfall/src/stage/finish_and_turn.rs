//! RK4, pass 3, and the orientations, in scenes without rods: `finish`, then every sphere turns by its mean spin
//! (exponential map). One pass over memory less than two stages.

use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::stage::finish::finish_all;
use crate::stage::turn::turn_for;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "finish_and_turn",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/entries.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/one_state.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/attached.wgsl"),
        part!("wgsl/forces.wgsl"),
        part!("wgsl/teams.wgsl"),
        part!("wgsl/ordered_sums.wgsl"),
        part!("wgsl/team_forces.wgsl"),
        part!("wgsl/tell.wgsl"),
        part!("wgsl/stage_states.wgsl"),
        part!("wgsl/finished.wgsl"),
        part!("wgsl/sine.wgsl"),
        part!("wgsl/rotation.wgsl"),
        part!("stage/finish_and_turn.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Y4),
        read("y2", Buffer::Y2),
        read("y3", Buffer::Y3),
        write("start", Buffer::Start),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        write("orientations", Buffer::Orientations),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    cpu: finish_and_turn,
};

fn finish_and_turn(world: &mut World, _pass: u32) {
    if world.status.void != 0 {
        return;
    }
    let done = finish_all(world);
    let dt = world.step.dt;
    let turning = world.orientations.par_iter_mut().zip(&done).with_min_len(GRAIN);
    turning.for_each(|(orientation, done)| turn_for(orientation, done.spin, dt));
}
