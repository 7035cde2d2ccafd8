//! Computes what the contacts of every sphere and rod contribute to the force and to the stiffness of every servo (docs/physics section
//! 2.18). `drive_servos` adds them up.
//!
//! It evaluates the contacts of `loads` again, but only those of movers whose list has a wall that follows a servo. So `loads` has no code
//! for servos. The pass is that of the evaluation that counts contacts.

use glam::Vec2;
use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, SERVO_ROWS};
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::servo::ServoRecord;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::contacts::Contacts;
use crate::physics::laws::history::Histories;
use crate::physics::servo::add_contacts;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "servo_loads",
    wgsl: Wgsl::File(part!("step/walls/servo_loads.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::State, access: Access::Read },
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("histories", Buffer::Histories),
        read("servos", Buffer::Servos),
        write("contributions", Buffer::ServoLoads),
        write("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    moves: |_| Moves { counts: 1, ..NONE },
    cpu: servo_loads,
};

fn servo_loads(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let table = world.history_words();
    let World { step, topology, states, user_laws, lists, histories, servos, servo_loads, status, .. } = world;
    let (first, second) = histories.split_at(table);
    let before = if status.history_table == 0 { first } else { second };
    let view = View::new(step, topology, &states[pass as usize]).at_evaluation(status, pass).with_laws(user_laws);
    let lists = Lists::new(step, lists);
    let contacts = Contacts { view: &view, lists: &lists, histories: Histories::new(before) };
    let servos: Vec<ServoRecord> = servos.chunks_exact(SERVO_ROWS as usize).map(ServoRecord::of).collect();
    let movers = step.movers() as usize;
    let of = |mover: u32| {
        let mut sums = vec![Vec2::ZERO; servos.len()];
        add_contacts(&contacts, mover, &servos, &mut sums);
        (view.insertion_index(mover) as usize, sums)
    };
    let all: Vec<(usize, Vec<Vec2>)> = (0..step.movers()).into_par_iter().with_min_len(GRAIN).map(of).collect();
    for (index, sums) in all {
        sums.into_iter().enumerate().for_each(|(servo, sum)| servo_loads[servo * movers + index] = sum);
    }
}
